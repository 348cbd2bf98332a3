/// Named Kokkos view aliases. Shapes are given where a view is a member or an argument.
#pragma once

#include <Kokkos_Core.hpp>

namespace cgcontact {

using ExecSpace = Kokkos::DefaultExecutionSpace;
using MemSpace = ExecSpace::memory_space;

using IntView = Kokkos::View<int*, MemSpace>;
using RealView = Kokkos::View<double*, MemSpace>;
using CellNodesView = Kokkos::View<int* [8], Kokkos::LayoutRight, MemSpace>;           // (cell, corner)
using FaceNodesView = Kokkos::View<int* [12], Kokkos::LayoutRight, MemSpace>;          // (face, node)
using CellMatrixView = Kokkos::View<double* [24][24], Kokkos::LayoutRight, MemSpace>;  // (matrix, row, column)

}  // namespace cgcontact
