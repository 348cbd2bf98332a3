// Kernels of contact against plain loops over the points, on every execution space; what their results have to do with
// each other; the same to the last bit each time.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "contact/kernels/row_kernels.hpp"
#include "contact/kernels/support_kernels.hpp"
#include "contact/solve/floating/body_motion.hpp"
#include "tests/support/execution_spaces.hpp"

namespace cgcontact::test_contact_kernels {
namespace {

/// Sums of some ten terms in the same order: a few roundings, of fused multiplications and additions.
constexpr double rounding = 1e-14;

template <class Exec>
class ContactKernels : public testing::Test {
 protected:
  using TestMemory = typename Exec::memory_space;
  using TestValues = Kokkos::View<double*, TestMemory>;
  using TestNumbers = Kokkos::View<int*, TestMemory>;

  double random(double low = -1, double high = 1) { return std::uniform_real_distribution<>(low, high)(generator_); }
  int random_int(int low, int high) { return std::uniform_int_distribution<>(low, high)(generator_); }

  template <class View, class T>
  static View on_device(const std::vector<T>& values) {
    View view("values", values.size());
    const auto host = Kokkos::create_mirror_view(view);
    for (std::size_t i = 0; i < values.size(); ++i) host(i) = values[i];
    Kokkos::deep_copy(view, host);
    return view;
  }
  template <class View>
  static auto on_host(const View& view) {
    Kokkos::fence();
    const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
    return std::vector<typename View::non_const_value_type>(host.data(), host.data() + host.extent(0));
  }
  TestValues random_values(std::size_t size) {
    std::vector<double> values(size);
    for (double& v : values) v = random();
    return on_device<TestValues>(values);
  }
  Exec exec;

 private:
  std::mt19937 generator_{7};
};
TYPED_TEST_SUITE(ContactKernels, ExecutionSpaces);

/// Groups of up to 20 points, some of none, some bonded, some in a zone; on the host.
struct PlainGroups {
  std::vector<int> first{0};
  std::vector<NormalContact> law;
  std::vector<double> gap, weight, lagged, change;
  std::vector<char> in_zone, active;
  std::vector<ZoneForce> zone;
  double lagged_unit = 3;

  template <class Test>
  PlainGroups(Test& test, int num_groups) {
    for (int g = 0; g < num_groups; ++g) {
      first.push_back(first.back() + test.random_int(0, 20));
      law.push_back({test.random(1, 2), test.random() > 0.5});
      gap.push_back(test.random());
      change.push_back(test.random());
      in_zone.push_back(test.random() > 0.7);
      zone.push_back({test.random(), test.random(), test.random()});
    }
    for (int q = 0; q < first.back(); ++q) {
      weight.push_back(test.random(0, 1));
      lagged.push_back(test.random());
      active.push_back(test.random() > 0);
    }
  }
  double closed(int g, int q, double more = 0) const {
    return lagged[q] * lagged_unit - law[g].k * (gap[g] + change[g] + more);
  }
  template <class Memory, class Test>
  ContactGroupArrays<Memory> arrays() const {
    ContactGroupArrays<Memory> a(law.size(), weight.size());
    a.first_point = Test::template on_device<decltype(a.first_point)>(first);
    a.law = Test::template on_device<decltype(a.law)>(law);
    a.initial_gap = Test::template on_device<decltype(a.initial_gap)>(gap);
    a.in_zone = Test::template on_device<decltype(a.in_zone)>(in_zone);
    a.zone = Test::template on_device<decltype(a.zone)>(zone);
    a.weight = Test::template on_device<decltype(a.weight)>(weight);
    a.lagged = Test::template on_device<decltype(a.lagged)>(lagged);
    a.active = Test::template on_device<decltype(a.active)>(active);
    a.lagged_unit = lagged_unit;
    return a;
  }
};

// The members of the fixture are public for PlainGroups.
template <class Exec>
class GroupKernels : public ContactKernels<Exec> {
 public:
  using Base = ContactKernels<Exec>;
  using Base::on_device;
  using Base::on_host;
  using Base::random;
  using Base::random_int;
  using typename Base::TestMemory;
  using typename Base::TestValues;
};
TYPED_TEST_SUITE(GroupKernels, ExecutionSpaces);

TYPED_TEST(GroupKernels, ForcesAndStiffnessAreSumsOverClosedPoints) {
  using Memory = typename TestFixture::TestMemory;
  using Values = typename TestFixture::TestValues;
  for (const int num_groups : {0, 1, 300}) {
    const PlainGroups plain(*this, num_groups);
    const auto groups = plain.arrays<Memory, TestFixture>();
    const Values change = this->template on_device<Values>(plain.change), force("force", num_groups),
                 stiffness("stiffness", num_groups), largest("largest", num_groups);
    group_forces(this->exec, groups, change, 7, force);
    closed_stiffness(this->exec, groups, 5, stiffness);
    largest_pressures(this->exec, groups, change, largest);
    const auto f = this->on_host(force), k = this->on_host(stiffness), p = this->on_host(largest);
    for (int g = 0; g < num_groups; ++g) {
      double sum = 0, area = 0, most = 0;
      for (int q = plain.first[g]; q < plain.first[g + 1]; ++q) {
        most = std::max(most, std::abs(plain.closed(g, q)));
        if (!plain.active[q]) continue;
        sum += plain.weight[q] * plain.closed(g, q);
        area += plain.weight[q];
      }
      const ZoneForce& zone = plain.zone[g];
      if (plain.in_zone[g]) sum = zone.force - zone.stiffness * (plain.gap[g] + plain.change[g] - zone.gap);
      EXPECT_NEAR(f[g], sum / 7, 20 * rounding);
      EXPECT_NEAR(k[g], (plain.in_zone[g] ? zone.stiffness : plain.law[g].k * area) / 5, 20 * rounding);
      EXPECT_NEAR(p[g], most, rounding * (1 + most));
    }
    for (int again = 0; again < 3; ++again) {
      group_forces(this->exec, groups, change, 7, force);
      EXPECT_EQ(this->on_host(force), f);
    }
  }
}

TYPED_TEST(GroupKernels, CloseWhatPressesWhereItMayChange) {
  using Memory = typename TestFixture::TestMemory;
  using Values = typename TestFixture::TestValues;
  PlainGroups plain(*this, 200);
  std::vector<char> may_change;
  for (std::size_t g = 0; g < plain.law.size(); ++g) may_change.push_back(this->random() > 0);
  const auto groups = plain.arrays<Memory, TestFixture>();
  close_pressing(this->exec, groups, this->template on_device<Values>(plain.change),
                 this->template on_device<Kokkos::View<char*, Memory>>(may_change));
  for (int g = 0; g < 200; ++g)
    for (int q = plain.first[g]; may_change[g] && q < plain.first[g + 1]; ++q)
      plain.active[q] = plain.law[g].bonded || plain.closed(g, q) > 0;
  EXPECT_EQ(this->on_host(groups.active), plain.active);
}

/// Along a step the excess is what the energy of all points that press falls by, less that of those taken for closed.
TYPED_TEST(GroupKernels, ExcessIsTheDerivativeOfTheEnergyThatPointsOpenAndCloseWith) {
  using Memory = typename TestFixture::TestMemory;
  using Values = typename TestFixture::TestValues;
  const PlainGroups plain(*this, 100);
  const auto groups = plain.arrays<Memory, TestFixture>();
  std::vector<double> step;
  for (int g = 0; g < 100; ++g) step.push_back(this->random());
  const Values excess("excess", 100);
  constexpr double t = 0.4, dt = 1e-6;
  excess_forces(this->exec, groups, this->template on_device<Values>(plain.change),
                this->template on_device<Values>(step), t, excess);
  const auto found = this->on_host(excess);
  const auto energy = [&](int g, double at) {
    double sum = 0;
    for (int q = plain.first[g]; q < plain.first[g + 1]; ++q) {
      const double lagged = plain.lagged[q] * plain.lagged_unit, gap = plain.gap[g] + plain.change[g] + at * step[g];
      const double closed = NormalContact{plain.law[g].k, true}.energy(lagged, gap);
      sum += plain.weight[q] * (plain.law[g].energy(lagged, gap) - (plain.active[q] ? closed : 0));
    }
    return sum;
  };
  for (int g = 0; g < 100; ++g) {
    if (plain.in_zone[g] || plain.law[g].bonded)
      EXPECT_EQ(found[g], 0);
    else  // differences of a piecewise quadratic: exact but for rounding and kinks, whose force is k w step dt at most
      EXPECT_NEAR(-found[g] * step[g], (energy(g, t + dt) - energy(g, t - dt)) / (2 * dt), 1e-4) << g;
  }
}

/// Supports in cells that share nodes, of two bodies whose nodes follow one another.
template <class Exec>
class SupportKernels : public ContactKernels<Exec> {
 protected:
  using typename ContactKernels<Exec>::TestMemory;
  using typename ContactKernels<Exec>::TestValues;
  using typename ContactKernels<Exec>::TestNumbers;
  static constexpr int num_supports = 150, num_nodes = 60, num_groups = 40;

  SupportKernels() : arrays(num_supports) {
    const auto nodes = Kokkos::create_mirror_view(arrays.nodes);
    const auto xi = Kokkos::create_mirror_view(arrays.xi),
               direction = Kokkos::create_mirror_view(arrays.local_direction);
    for (int s = 0; s < num_supports; ++s) {
      const int first = this->random_int(0, num_nodes - 9);
      for (int a = 0; a < 8; ++a) nodes(s, a) = first + a;
      for (int d = 0; d < 3; ++d) {
        xi(s, d) = this->random();
        direction(s, d) = this->random();
      }
    }
    Kokkos::deep_copy(arrays.nodes, nodes);
    Kokkos::deep_copy(arrays.xi, xi);
    Kokkos::deep_copy(arrays.local_direction, direction);
    arrays.weight = this->random_values(num_supports);
    arrays.k = this->random_values(num_supports);
    arrays.value = this->random_values(num_supports);
    arrays.lagged = this->random_values(num_supports);
    arrays.lagged_unit = 3;
    make_touched(nodes);
  }

  /// Every node, in another order; groups with up to 10 unknowns.
  template <class Nodes>
  void make_touched(const Nodes& nodes) {
    std::vector<int> node, support_begin{0}, support_corner, group_begin{0}, group;
    std::vector<double> coefficient;
    for (int t = 0; t < num_nodes; ++t) {
      node.push_back((7 * t) % num_nodes);
      for (int s = 0; s < num_supports; ++s)
        for (int a = 0; a < 8; ++a)
          if (nodes(s, a) == node.back()) support_corner.push_back(8 * s + a);
      support_begin.push_back(static_cast<int>(support_corner.size()));
      for (int i = 0; i < 3; ++i) {
        for (int g = this->random_int(0, num_groups - 1); g < num_groups; g += 11) {
          group.push_back(g);
          coefficient.push_back(this->random());
        }
        group_begin.push_back(static_cast<int>(group.size()));
      }
    }
    touched.node = this->template on_device<TestNumbers>(node);
    touched.support_begin = this->template on_device<TestNumbers>(support_begin);
    touched.support_corner = this->template on_device<TestNumbers>(support_corner);
    touched.group_begin = this->template on_device<TestNumbers>(group_begin);
    touched.group = this->template on_device<TestNumbers>(group);
    touched.coefficient = this->template on_device<TestValues>(coefficient);
  }
  SupportArrays<TestMemory> arrays;
  TouchedNodes<TestMemory> touched;
};
TYPED_TEST_SUITE(SupportKernels, ExecutionSpaces);

/// The work of the nodal forces is that of the supports' forces over their displacements, for any of both.
TYPED_TEST(SupportKernels, ForcesAreTheTransposeOfDisplacements) {
  using Values = typename TestFixture::TestValues;
  const int dofs = dof_of(TestFixture::num_nodes);
  const Values u = this->random_values(dofs), amount = this->random_values(TestFixture::num_supports),
               moved("moved", TestFixture::num_supports), force("force", dofs), vector("vector", dofs);
  add_displacements(this->exec, this->arrays, u, 2, moved);
  add_support_forces(this->exec, this->touched, this->arrays, amount, force);
  put_at_nodes(this->exec, this->touched, force, vector);
  const auto a = this->on_host(amount), m = this->on_host(moved), f = this->on_host(vector), v = this->on_host(u);
  double by_supports = 0, by_nodes = 0, magnitude = 0;
  for (std::size_t s = 0; s < a.size(); ++s) by_supports += a[s] * m[s] / 2;
  for (std::size_t i = 0; i < f.size(); ++i) {
    by_nodes += f[i] * v[i];
    magnitude += std::abs(f[i] * v[i]);
  }
  EXPECT_GT(magnitude, 1);
  EXPECT_NEAR(by_nodes, by_supports, 10 * rounding * magnitude);
}

TYPED_TEST(SupportKernels, TractionsAndAmountsFollowTheLaw) {
  using Values = typename TestFixture::TestValues;
  const int n = TestFixture::num_supports;
  const Values moved = this->random_values(n), traction("traction", n), of_stress("of_stress", n),
               of_value("of_value", n);
  support_tractions(this->exec, this->arrays, moved, traction);
  support_amounts(this->exec, this->arrays, moved, 7, of_stress, of_value);
  const auto t = this->on_host(traction), s = this->on_host(of_stress), v = this->on_host(of_value),
             weight = this->on_host(this->arrays.weight);
  const auto lagged = this->on_host(this->arrays.lagged), k = this->on_host(this->arrays.k),
             value = this->on_host(this->arrays.value), m = this->on_host(moved);
  for (int i = 0; i < n; ++i) {
    EXPECT_NEAR(t[i], 3 * lagged[i] - k[i] * (m[i] - value[i]), 10 * rounding);
    EXPECT_NEAR(s[i] + v[i], weight[i] * t[i] / 7, 10 * rounding);
  }
}

/// Nodal forces of groups against the transposed rows in a plain loop.
TYPED_TEST(SupportKernels, GroupsActOnTheNodesOfTheirRows) {
  using Values = typename TestFixture::TestValues;
  const int dofs = dof_of(TestFixture::num_nodes);
  const Values amount = this->random_values(TestFixture::num_groups), force = this->random_values(dofs);
  auto expected = this->on_host(force);
  const auto a = this->on_host(amount), c = this->on_host(this->touched.coefficient);
  const auto begin = this->on_host(this->touched.group_begin), group = this->on_host(this->touched.group);
  for (int d = 0; d < dofs; ++d)
    for (int e = begin[d]; e < begin[d + 1]; ++e) expected[d] += c[e] * a[group[e]];
  add_contact_forces(this->exec, this->touched, amount, force);
  const auto found = this->on_host(force);
  for (int d = 0; d < dofs; ++d) EXPECT_NEAR(found[d], expected[d], rounding * 10);
}

TYPED_TEST(SupportKernels, RowsOfRigidMotions) {
  using Values = typename TestFixture::TestValues;
  using Memory = typename TestFixture::TestMemory;
  std::vector<BodyMotion> motions(2);
  for (BodyMotion& motion : motions)
    for (int d = 0; d < 3; ++d) {
      motion.translation[d] = this->random();
      motion.rotation[d] = this->random();
      motion.centre[d] = this->random();
      for (int e = 0; e < 3; ++e) motion.expansion(d, e) = this->random();
    }
  const int n = 50;
  const DirectionArrays<Memory> points(n);
  const auto body = Kokkos::create_mirror_view(points.body);
  const auto x = Kokkos::create_mirror_view(points.x), direction = Kokkos::create_mirror_view(points.direction);
  for (int i = 0; i < n; ++i) {
    body(i) = i % 2;
    for (int d = 0; d < 3; ++d) {
      x(i, d) = this->random();
      direction(i, d) = this->random();
    }
  }
  Kokkos::deep_copy(points.body, body);
  Kokkos::deep_copy(points.x, x);
  Kokkos::deep_copy(points.direction, direction);
  const Values moved("moved", n);
  rigid_displacements(this->exec, points, this->template on_device<Kokkos::View<BodyMotion*, Memory>>(motions), moved);
  const auto found = this->on_host(moved);
  for (int i = 0; i < n; ++i) {
    const BodyMotion& motion = motions[i % 2];
    const Vec3 arm = Vec3(x(i, 0), x(i, 1), x(i, 2)) - motion.centre;
    const Vec3 at = motion.translation + motion.rotation.cross(arm) + motion.expansion * arm;
    EXPECT_NEAR(found[i], at.dot(Vec3(direction(i, 0), direction(i, 1), direction(i, 2))), 10 * rounding);
  }
}

/// y = start + factor R x.
TYPED_TEST(SupportKernels, RowsMultiply) {
  using Values = typename TestFixture::TestValues;
  const auto& [begin, column, value] =
      std::tie(this->touched.group_begin, this->touched.group, this->touched.coefficient);
  const int rows = dof_of(TestFixture::num_nodes);
  const Values x = this->random_values(TestFixture::num_groups), start = this->random_values(rows), y("y", rows);
  multiply_rows(this->exec, begin, column, value, x, 0.0, start, y);
  EXPECT_EQ(this->on_host(y), this->on_host(start));
  multiply_rows(this->exec, begin, column, value, x, 2.0, start, y);
  const auto first = this->on_host(begin), columns = this->on_host(column);
  const auto values = this->on_host(value), right = this->on_host(x), from = this->on_host(start),
             found = this->on_host(y);
  for (std::size_t r = 0; r < found.size(); ++r) {
    double sum = 0;
    for (int e = first[r]; e < first[r + 1]; ++e) sum += values[e] * right[columns[e]];
    EXPECT_NEAR(found[r], from[r] + 2 * sum, 100 * rounding);
  }
}

/// Rows of the mean gap against sums in a map, point by point; groups of no point have none, and an axis that no point
/// moves along has no entry.
TYPED_TEST(ContactKernels, RowsOfGapsAreCombinedByUnknown) {
  using Memory = typename TestFixture::TestMemory;
  using Numbers = typename TestFixture::TestNumbers;
  using Values = typename TestFixture::TestValues;
  const int num_groups = 60, num_cells = 12;
  std::vector<std::array<int, 8>> cells[2];
  for (int side = 0; side < 2; ++side)
    for (int c = 0; c < num_cells; ++c) {
      cells[side].emplace_back();
      for (int a = 0; a < 8; ++a) cells[side].back()[a] = 100 * side + 3 * c + (5 * a) % 8;  // cells share nodes
    }
  std::vector<ContactPoint> points;
  std::vector<int> first{0};
  std::vector<double> area;
  for (int g = 0; g < num_groups; ++g) {
    const int size = g == 7 ? 0 : this->random_int(1, 15);
    for (int q = 0; q < size; ++q) {
      ContactPoint point;
      point.primary_cell = this->random_int(0, num_cells - 1);
      point.secondary_cell = this->random_int(0, num_cells - 1);
      for (Vec3* v : {&point.primary_xi, &point.secondary_xi, &point.direction})
        *v = Vec3(this->random(), this->random(), this->random());
      if (g == 3) point.direction[1] = 0;
      point.weight = this->random(0.1, 1);
      points.push_back(point);
    }
    first.push_back(static_cast<int>(points.size()));
    area.push_back(this->random(1, 2));
  }
  const Mat3 turned = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  using Cells = Kokkos::View<std::array<int, 8>*, Memory>;
  const RowSide<Memory> primary{this->template on_device<Cells>(cells[0])},
      secondary{this->template on_device<Cells>(cells[1]), turned};
  const auto rows =
      gap_rows(this->exec, copy_points<Memory>(ContactPoints(points).arrays()),
               this->template on_device<Numbers>(first), this->template on_device<Values>(area), primary, secondary);
  const auto begin = this->on_host(rows.begin), dof = this->on_host(rows.dof);
  const auto value = this->on_host(rows.value);
  for (int g = 0; g < num_groups; ++g) {
    std::map<int, double> plain;
    for (int q = first[g]; q < first[g + 1]; ++q)
      for (int side = 0; side < 2; ++side) {
        const ContactPoint& point = points[q];
        const Vec3 local = side ? Vec3(turned.transpose() * point.direction) : Vec3(-point.direction);
        double N[8];
        hex_shape(side ? point.secondary_xi.data() : point.primary_xi.data(), N);
        for (int a = 0; a < 8; ++a)
          for (int i = 0; i < 3; ++i)
            if (local[i] != 0)
              plain[dof_of(cells[side][side ? point.secondary_cell : point.primary_cell][a], i)] +=
                  point.weight / area[g] * local[i] * N[a];
      }
    ASSERT_EQ(begin[g + 1] - begin[g], static_cast<int>(plain.size())) << g;
    int e = begin[g];
    for (const auto& [number, sum] : plain) {
      EXPECT_EQ(dof[e], number);
      EXPECT_NEAR(value[e++], sum, 20 * rounding);
    }
  }
}

}  // namespace
}  // namespace cgcontact::test_contact_kernels
