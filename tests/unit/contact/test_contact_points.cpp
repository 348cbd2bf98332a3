// Points of pairs as arrays: what shares memory, and what does not.
#include <gtest/gtest.h>

#include "contact/kernels/contact_points.hpp"

namespace cgcontact::test_contact_points {
namespace {

ContactPoints points_of(std::initializer_list<double> weights) {
  std::vector<ContactPoint> points(weights.size());
  std::size_t q = 0;
  for (const double weight : weights) points[q++].weight = weight;
  return ContactPoints(points);
}

/// A solution is kept aside with its closed points while another one is tried.
TEST(ContactPoints, CopiesKeepWhatIsClosed) {
  ContactPoints first = points_of({1, 2}), second = points_of({3});
  ContactPoints::join({&first, &second});
  const ContactPoints kept = second;
  ContactPoints assigned;
  assigned = second;
  second.set_active(0, false);
  EXPECT_TRUE(kept.active(0));
  EXPECT_TRUE(assigned.active(0));
  EXPECT_EQ(kept.weight(0), 3);
  second = kept;
  EXPECT_TRUE(second.active(0));
}

/// Kernels run over the points of all pairs at once: each pair sees what they write. Copies are joined anew.
TEST(ContactPoints, JoinedPointsShareArrays) {
  ContactPoints first = points_of({1, 2}), second = points_of({3});
  const HostContactPoints all = ContactPoints::join({&first, &second});
  ASSERT_EQ(all.size(), 3u);
  for (int q = 0; q < 3; ++q) EXPECT_EQ(all.weight(q), q + 1);
  all.active(2) = 0;
  EXPECT_FALSE(second.active(0));
  EXPECT_EQ(ContactPoints::join({&first, &second}).weight.data(), all.weight.data());
  ContactPoints moved = std::move(second);
  EXPECT_EQ(ContactPoints::join({&first, &moved}).weight.data(), all.weight.data());
  ContactPoints copy = moved;
  const HostContactPoints again = ContactPoints::join({&first, &copy});
  EXPECT_NE(again.weight.data(), all.weight.data());
  EXPECT_EQ(again.weight(2), 3);
  EXPECT_FALSE(copy.active(0));
}

}  // namespace
}  // namespace cgcontact::test_contact_points
