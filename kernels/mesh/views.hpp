/// Named Kokkos view aliases. Shapes are given where a view is a member or an argument.
#pragma once

#include <Kokkos_Core.hpp>

#include "kernels/mesh/hex.hpp"

namespace cgcontact {

using ExecSpace = Kokkos::DefaultExecutionSpace;
using MemSpace = ExecSpace::memory_space;

using IntView = Kokkos::View<int*, MemSpace>;
using RealView = Kokkos::View<double*, MemSpace>;
/// Views of elements of a degree: (cell, node); (ghost face, node); (matrix, row, column).
template <int degree>
using CellNodesViewOf = Kokkos::View<int * [HexElement<degree>::num_nodes], Kokkos::LayoutRight, MemSpace>;
template <int degree>
using FaceNodesViewOf = Kokkos::View<int * [GhostFace<degree>::num_nodes], Kokkos::LayoutRight, MemSpace>;
template <int degree>
using CellMatrixViewOf =
    Kokkos::View<double * [HexElement<degree>::num_dofs][HexElement<degree>::num_dofs], Kokkos::LayoutRight, MemSpace>;
using CellNodesView = CellNodesViewOf<1>;
using FaceNodesView = FaceNodesViewOf<1>;
using CellMatrixView = CellMatrixViewOf<1>;

}  // namespace cgcontact
