/// Test main for several ranks: the first one prints, all of them fail if one does.
#include <gtest/gtest.h>

#include "core/base/process/ranks.hpp"
#include "core/base/process/resources.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace {

/// What fails on other ranks is told by them.
class Failures : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed())
      std::fprintf(stderr, "rank %d: %s:%d: %s\n", cgcontact::this_rank(), result.file_name() ? result.file_name() : "",
                   result.line_number(), result.message());
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (cgcontact::TrilinosScope::has_openmp()) cgcontact::restart_with_openmp_settings(0, argv);
  testing::InitGoogleTest(&argc, argv);
  const cgcontact::TrilinosScope scope(0);
  testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
  if (!cgcontact::is_first_rank()) {
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new Failures);
  }
  return cgcontact::largest_over_ranks(RUN_ALL_TESTS()) > 0 ? 1 : 0;
}
