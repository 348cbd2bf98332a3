/// Exit code of the test programs.
#pragma once

#include <gtest/gtest.h>

/// Runs the tests that are asked for. Returns 0, 1 where one failed, or 77 (for ctest: skipped) where one was skipped.
inline int run_tests() {
  if (RUN_ALL_TESTS() != 0) return 1;
  return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? 77 : 0;
}
