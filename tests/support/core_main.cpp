/// Test main that starts Kokkos once, where core/ has it.
#include <gtest/gtest.h>

#include "core/base/parallel.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const cgcontact::KokkosScope kokkos(0);
  return RUN_ALL_TESTS();
}
