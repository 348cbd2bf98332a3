// What is said of an active set that does not come to rest. The states are made by hand: no scene is known whose active
// set cycles.
#include <gtest/gtest.h>

#include "contact/solve/active_set_history.hpp"

namespace cgcontact::test_active_set_history {
namespace {

/// Two pairs, of four and of six points at x = 0, 1, 2, ... on y = number of the pair, all closed.
std::vector<ContactPair> two_pairs(const ContactSpec& first, const ContactSpec& second) {
  std::vector<ContactPair> pairs(2);
  pairs[0].spec = &first;
  pairs[1].spec = &second;
  for (int k = 0; k < 2; ++k) {
    std::vector<ContactPoint> points(4 + 2 * k);
    for (std::size_t q = 0; q < points.size(); ++q) points[q].x = {double(q), double(k), 0};
    pairs[k].points = ContactPoints(points);
  }
  return pairs;
}

class ActiveSetHistoryTest : public testing::Test {
 protected:
  ActiveSetHistoryTest() {
    first_.name = "first";
    second_.name = "second";
    pairs_ = two_pairs(first_, second_);
  }
  ContactSpec first_, second_;
  std::vector<ContactPair> pairs_;
};

TEST_F(ActiveSetHistoryTest, CountsChangesOfAllPairs) {
  ActiveSetHistory history(pairs_);
  EXPECT_EQ(history.record(pairs_), 0);
  pairs_[0].points.set_active(1, false);
  pairs_[1].points.set_active(0, false);
  pairs_[1].points.set_active(5, false);
  EXPECT_EQ(history.record(pairs_), 3);
  EXPECT_EQ(history.record(pairs_), 0);
}

/// A zone that shrinks point by point and rests never has a state twice.
TEST_F(ActiveSetHistoryTest, AShrinkingZoneIsNoCycle) {
  ActiveSetHistory history(pairs_);
  for (std::size_t q = 0; q < pairs_[1].points.size(); ++q) {
    pairs_[1].points.set_active(q, false);
    EXPECT_EQ(history.record(pairs_), 1);
  }
  for (int i = 0; i < 10; ++i) history.record(pairs_);
  EXPECT_FALSE(history.cycles());
}

/// Cycles of two and of three states are found; the message names the pair, how many of its points and where they are,
/// and not the point of the other pair that changed once, long ago.
TEST_F(ActiveSetHistoryTest, CyclesAreFoundAndLocated) {
  for (const int period : {2, 3}) {
    std::vector<ContactPair> pairs = two_pairs(first_, second_);  // copies would share their points
    ActiveSetHistory history(pairs);
    pairs[0].points.set_active(3, false);
    history.record(pairs);
    for (int i = 0; i < 3 * period; ++i) {
      pairs[1].points.set_active(2, i % period == 0);
      pairs[1].points.set_active(4, i % period != 0);
      history.record(pairs);
    }
    EXPECT_TRUE(history.cycles()) << period;
    const std::string text = history.describe(pairs);
    for (const char* phrase :
         {"the active set cycles (", "2 of 6 points of contact \"second\"", "between (2, 1, 0) and (4, 1, 0) m"})
      EXPECT_NE(text.find(phrase), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace cgcontact::test_active_set_history
