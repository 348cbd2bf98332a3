/// Test main that starts Kokkos and Tpetra once.
#include <gtest/gtest.h>

#include "core/base/process/resources.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "tests/support/run_tests.hpp"

int main(int argc, char** argv) {
  if (cgcontact::TrilinosScope::has_openmp()) cgcontact::restart_with_openmp_settings(0, argv);
  testing::InitGoogleTest(&argc, argv);
  const cgcontact::TrilinosScope scope(0);
  return run_tests();
}
