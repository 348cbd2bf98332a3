/// The execution spaces that Kokkos was built with, for typed tests of kernels.
#pragma once

#include <gtest/gtest.h>

#include <Kokkos_Core.hpp>
#include <type_traits>

namespace cgcontact {

/// The host's default one, and that which the program runs on where it is another one.
using HostSpaces = testing::Types<Kokkos::DefaultHostExecutionSpace>;
using HostAndDeviceSpaces = testing::Types<Kokkos::DefaultHostExecutionSpace, Kokkos::DefaultExecutionSpace>;
#if defined(KOKKOS_ENABLE_SERIAL) && defined(KOKKOS_ENABLE_OPENMP)
using ExecutionSpaces = testing::Types<Kokkos::Serial, Kokkos::OpenMP>;
#else
using ExecutionSpaces =
    std::conditional_t<std::is_same_v<Kokkos::DefaultHostExecutionSpace, Kokkos::DefaultExecutionSpace>, HostSpaces,
                       HostAndDeviceSpaces>;
#endif

}  // namespace cgcontact
