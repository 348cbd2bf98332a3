/// Test main that starts Kokkos once, where core/ has it.
#include <gtest/gtest.h>

#include "core/base/process/parallel.hpp"
#include "tests/support/run_tests.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const cgcontact::KokkosScope kokkos(0);
  return run_tests();
}
