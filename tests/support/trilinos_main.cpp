/// Test main that starts Kokkos and Tpetra once.
#include <gtest/gtest.h>

#include "kernels/linear_solver.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const cgcontact::TrilinosScope scope(0);
  return RUN_ALL_TESTS();
}
