// The law of friction: traction, stiffness and energy; its kernels against plain loops over the points, on every
// execution space.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "contact/kernels/friction_kernels.hpp"
#include "tests/support/execution_spaces.hpp"

namespace cgcontact::test_friction_kernels {
namespace {

/// Sums of some ten terms in the same order: a few roundings of each.
constexpr double rounding = 1e-13;

class Numbers {
 public:
  double operator()(double low = -1, double high = 1) {
    return std::uniform_real_distribution<>(low, high)(generator_);
  }

 private:
  std::mt19937 generator_{7};
};

/// z^2/(2k) where it sticks, (b |z| - b^2/2)/k where it slips.
double energy(const TangentialContact& law, double bound) {
  const double z = law.size();
  return (z <= bound ? z * z / 2 : bound * z - bound * bound / 2) / law.k;
}

TEST(FrictionLaw, TractionIsTheDerivativeOfTheEnergyAndStiffnessThatOfTheTraction) {
  Numbers random;
  constexpr double step = 1e-6, slip_held = 1e-4;
  for (int i = 0; i < 200; ++i) {
    const double k = random(1, 5), bound = random(0.1, 1), lagged[2] = {random(), random()},
                 slip[2] = {random(), random()}, reference[2] = {random(), random()};
    const auto at = [&](int j, double h) {
      double moved[2] = {slip[0], slip[1]};
      moved[j] += h;
      return TangentialContact(k, lagged, moved, reference);
    };
    const TangentialContact law = at(0, 0);
    if (std::abs(law.size() - bound) < 10 * k * step) continue;  // a kink of the traction
    for (int j = 0; j < 2; ++j) {
      EXPECT_NEAR((energy(at(j, step), bound) - energy(at(j, -step), bound)) / (2 * step),
                  -law.carried_fraction(bound) * law.z[j], 1e-8);
      for (int c = 0; c < 2; ++c) {
        const double slope = (at(j, step).carried_fraction(bound) * at(j, step).z[c] -
                              at(j, -step).carried_fraction(bound) * at(j, -step).z[c]) /
                             (2 * step);
        const double kept = law.sticks(bound) || c != j ? 0 : slip_held * k;
        EXPECT_NEAR(law.stiffness(bound, slip_held, c, j) - kept, -slope, 1e-7 * k);
      }
    }
    EXPECT_LE(law.carried_fraction(bound) * law.size(), bound * (1 + 1e-15));
  }
}

/// Groups of up to five points, some open; each on the host.
struct PlainFriction {
  explicit PlainFriction(int num_groups) {
    Numbers random;
    for (int g = 0; g < num_groups; ++g) {
      const int count = 1 + g % 5;
      first.push_back(first.back() + count);
      row.push_back(rows);
      num_rows.push_back(g % 7 == 3 ? 1 : 2);
      rows += num_rows.back();
      k.push_back(random(1, 3));
      coefficient.push_back(random(0.1, 0.5));
      gap.push_back(random(-0.5, 0.5));
      gap_change.push_back(random(-0.4, 0.4));
      gap_step.push_back(random(-0.4, 0.4));
      old_gap.push_back(random(-0.4, 0.4));
      frame.push_back({1, 0});
      if (num_rows.back() == 2) {
        const double angle = random(-3, 3);
        frame.back() = {std::cos(angle), std::sin(angle)};
      }
      for (int q = 0; q < count; ++q) {
        weight.push_back(random(0.5, 2));
        active.push_back(random() > -0.4);
        pressed.push_back(random(0.1, 2));
        const double p = pressed.back() - k.back() * (gap.back() + gap_change.back());
        bound.push_back(active.back() && p > 0 ? coefficient.back() * p : 0);
        if (g % 11 == 5 && active.back()) bound.back() = any_shear;
        lagged.push_back({random(), num_rows.back() == 2 ? random() : 0});
        reference.push_back({random(), num_rows.back() == 2 ? random() : 0});
      }
      approach.push_back(g % 3 == 0 ? random(0, 0.3) : 0);
      drift.push_back({random(), num_rows.back() == 2 ? random() : 0});
    }
    for (int r = 0; r < rows; ++r) {
      change.push_back(random());
      step.push_back(random());
      linear.push_back({random(), random(0, 1), random()});
      coupling.push_back(random());
    }
  }

  /// By tangents, from amounts by rows.
  std::array<double, 2> by_tangents(int g, const std::vector<double>& by_rows, double scale = 1) const {
    const double a = scale * by_rows[row[g]], b = num_rows[g] == 2 ? scale * by_rows[row[g] + 1] : 0;
    return {frame[g].cosine * a - frame[g].sine * b, frame[g].sine * a + frame[g].cosine * b};
  }
  TangentialContact law(int g, int q, const std::array<double, 2>& slip) const {
    const double held[2] = {reference[q][0] + approach[g] * drift[g][0], reference[q][1] + approach[g] * drift[g][1]};
    return {k[g], lagged[q].data(), slip.data(), held};
  }
  /// Largest shear after another change of the gap.
  double bound_at(int g, int q, double change) const {
    const double p = pressed[q] - k[g] * (gap[g] + change);
    return bound[q] == 0 || bound[q] == any_shear ? bound[q] : coefficient[g] * std::max(p, 0.0);
  }
  std::array<double, 2> force(int g, const std::array<double, 2>& slip, double change) const {
    std::array<double, 2> sum{0, 0};
    for (int q = first[g]; q < first[g + 1]; ++q)
      for (int i = 0; i < 2 && bound_at(g, q, change) > 0; ++i)
        sum[i] += weight[q] * law(g, q, slip).carried_fraction(bound_at(g, q, change)) * law(g, q, slip).z[i];
    return sum;
  }
  double linear_force(int g, int r, double slip, double gap_now) const {
    return linear[r].at(slip) + coupling[r] * (gap_now - old_gap[g]);
  }

  std::vector<int> first{0}, row, num_rows;
  int rows = 0;
  std::vector<double> k, coefficient, gap, weight, bound, pressed, change, step, approach, coupling;
  std::vector<double> gap_change, gap_step, old_gap;
  std::vector<TangentFrame> frame;
  std::vector<std::array<double, 2>> lagged, reference, drift;
  std::vector<ZoneForce> linear;
  std::vector<char> active;
};

template <class Exec>
class FrictionKernels : public testing::Test {
 protected:
  using Memory = typename Exec::memory_space;
  using Values = Kokkos::View<double*, Memory>;

  template <class View, class T>
  static void fill(const View& view, const std::vector<T>& values) {
    const auto host = Kokkos::create_mirror_view(view);
    for (std::size_t i = 0; i < values.size(); ++i)
      if constexpr (View::rank == 2) {
        for (int j = 0; j < 2; ++j) host(i, j) = values[i][j];
      } else {
        host(i) = values[i];
      }
    Kokkos::deep_copy(view, host);
  }
  template <class View>
  static auto on_host(const View& view) {
    Kokkos::fence();
    return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
  }
  static Values values_of(const std::vector<double>& values) {
    const Values view("values", values.size());
    fill(view, values);
    return view;
  }

  static FrictionArrays<Memory> friction(const PlainFriction& plain) {
    FrictionArrays<Memory> f(plain.k.size(), plain.rows, plain.weight.size());
    std::vector<int> group;
    for (std::size_t g = 0; g < plain.k.size(); ++g) group.push_back(static_cast<int>(g));
    fill(f.first_point, plain.first), fill(f.normal_group, group), fill(f.row, plain.row);
    fill(f.num_rows, plain.num_rows), fill(f.coefficient, plain.coefficient), fill(f.frame, plain.frame);
    fill(f.linear, plain.linear), fill(f.weight, plain.weight), fill(f.bound, plain.bound);
    fill(f.lagged, plain.lagged), fill(f.reference, plain.reference), fill(f.approach, plain.approach);
    fill(f.drift, plain.drift), fill(f.coupling, plain.coupling), fill(f.gap, plain.old_gap);
    return f;
  }
  /// Normal groups: no lagged pressure, so that p = -k gap.
  static ContactGroupArrays<Memory> groups(const PlainFriction& plain) {
    ContactGroupArrays<Memory> n(plain.k.size(), plain.weight.size());
    std::vector<NormalContact> law;
    for (const double k : plain.k) law.push_back({k, false});
    fill(n.first_point, plain.first), fill(n.law, law), fill(n.initial_gap, plain.gap), fill(n.active, plain.active),
        fill(n.lagged, plain.pressed);
    return n;
  }

  Exec exec;
};
TYPED_TEST_SUITE(FrictionKernels, ExecutionSpaces);

/// The linear forces are those of the law at the slip and the gap where they were made, fall with both as the law does
/// there, and act along rows between which nothing couples.
TYPED_TEST(FrictionKernels, LinearForcesAreTangentToTheLaw) {
  const PlainFriction plain(200);
  const auto f = this->friction(plain);
  const auto change = this->values_of(plain.change);
  linearise_friction(this->exec, this->groups(plain), f, this->values_of(plain.gap_change), change);
  const auto linear = this->on_host(f.linear);
  const auto coupling = this->on_host(f.coupling), gap = this->on_host(f.gap);
  const auto frame = this->on_host(f.frame);
  const auto turned = this->on_host(f.turned);
  const auto mismatch = this->on_host(f.mismatch);
  int num_turned = 0, num_coupled = 0;
  for (int g = 0; g < 200; ++g) {
    const double gap_now = plain.gap_change[g];
    const std::array<double, 2> slip = plain.by_tangents(g, plain.change), force = plain.force(g, slip, gap_now);
    EXPECT_EQ(gap(g), gap_now);
    num_turned += turned(g);
    if (!turned(g)) {
      EXPECT_EQ(frame(g).cosine, plain.frame[g].cosine);
    }
    std::vector<double> before(plain.rows, 0.0);
    for (int r = plain.row[g]; r < plain.row[g] + plain.num_rows[g]; ++r)
      before[r] = plain.linear_force(g, r, plain.change[r], gap_now);
    const std::array<double, 2> was = plain.by_tangents(g, before);
    for (int i = 0; i < plain.num_rows[g]; ++i) {
      EXPECT_NEAR(mismatch(g, i), force[i] - was[i], rounding * 20);
      const double c = i == 0 ? frame(g).cosine : -frame(g).sine, s = i == 0 ? frame(g).sine : frame(g).cosine;
      const ZoneForce& row = linear(plain.row[g] + i);
      EXPECT_NEAR(row.force, c * force[0] + s * force[1], rounding * 20);
      EXPECT_NEAR(row.gap, c * slip[0] + s * slip[1], rounding * 20);
      constexpr double h = 1e-6;
      const auto moved = [&](double by) { return plain.force(g, {slip[0] + by * c, slip[1] + by * s}, gap_now); };
      const auto up = moved(h), down = moved(-h);
      double kept = 0, all = 0;
      bool near_kink = false;
      for (int q = plain.first[g]; q < plain.first[g + 1]; ++q) {
        const double z = plain.law(g, q, slip).size();
        near_kink |= std::abs(z - plain.bound[q]) < 1e-4;
        all += plain.bound[q] > 0 ? plain.weight[q] * plain.k[g] : 0;
        if (plain.bound[q] > 0 && z > plain.bound[q]) kept += 1e-4 * plain.weight[q] * plain.k[g];
      }
      for (int q = plain.first[g]; q < plain.first[g + 1]; ++q)
        near_kink |= plain.bound[q] > 0 && plain.bound[q] < 1e-5;
      if (near_kink) continue;
      const auto closer = plain.force(g, slip, gap_now - h), farther = plain.force(g, slip, gap_now + h);
      EXPECT_NEAR(coupling(plain.row[g] + i), (c * (farther[0] - closer[0]) + s * (farther[1] - closer[1])) / (2 * h),
                  1e-7 * (1 + all));
      num_coupled += coupling(plain.row[g] + i) != 0;
      const double along = -(c * (up[0] - down[0]) + s * (up[1] - down[1])) / (2 * h);
      EXPECT_NEAR(row.stiffness - kept, along, 1e-7 * (1 + all));
      if (plain.num_rows[g] < 2) continue;
      const double across = (-s * (up[0] - down[0]) + c * (up[1] - down[1])) / (2 * h);
      EXPECT_LT(std::abs(across), 0.02 * 2 * all + 1e-7);  // of the trace
    }
  }
  EXPECT_GT(num_turned, 50) << "the case proves little";
  EXPECT_GT(num_coupled, 50) << "the case proves little";
}

/// Where the lagged stress of all points of a group changes by the same, gaps and slips can move so that no force does.
TYPED_TEST(FrictionKernels, GapsTakeUpWhatLaggedStressChanges) {
  const PlainFriction plain(100);
  PlainFriction other = plain;
  Numbers random;
  for (int g = 0; g < 100; ++g) {
    const double p = random(), t[2] = {random(), plain.num_rows[g] == 2 ? random() : 0};
    for (int q = plain.first[g]; q < plain.first[g + 1]; ++q) {
      other.pressed[q] += p;
      for (int i = 0; i < 2; ++i) other.lagged[q][i] += t[i];
    }
  }
  const auto gaps = this->values_of(plain.gap_change), slips = this->values_of(plain.change);
  add_forceless_gaps(this->exec, this->groups(plain), this->friction(plain), -1, gaps, slips);
  add_forceless_gaps(this->exec, this->groups(other), this->friction(other), 1, gaps, slips);
  const auto gap_change = this->on_host(gaps), change = this->on_host(slips);
  const std::vector<double> moved(change.data(), change.data() + plain.rows);
  for (int g = 0; g < 100; ++g) {
    const std::array<double, 2> slip = plain.by_tangents(g, plain.change), moved_slip = plain.by_tangents(g, moved);
    EXPECT_NE(gap_change(g), plain.gap_change[g]);
    for (int q = plain.first[g]; q < plain.first[g + 1]; ++q) {
      EXPECT_NEAR(other.pressed[q] - plain.k[g] * gap_change(g), plain.pressed[q] - plain.k[g] * plain.gap_change[g],
                  rounding * 20);
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(other.law(g, q, moved_slip).z[i], plain.law(g, q, slip).z[i], rounding * 20);
    }
  }
}

TYPED_TEST(FrictionKernels, ExcessIsTheLawLessTheLinearForce) {
  const PlainFriction plain(150);
  const auto f = this->friction(plain);
  const auto start = this->values_of(plain.change), step = this->values_of(plain.step);
  const typename TestFixture::Values excess("excess", plain.rows);
  constexpr double t = 0.3;
  friction_excess(this->exec, this->groups(plain), f, this->values_of(plain.gap_change),
                  this->values_of(plain.gap_step), start, step, t, excess);
  const auto found = this->on_host(excess);
  const typename TestFixture::Values coupled("coupled", plain.rows);
  add_coupled_forces(this->exec, f, this->values_of(plain.gap_change), 0.5, coupled);
  const auto of_gaps = this->on_host(coupled);
  for (int g = 0; g < 150; ++g) {
    std::vector<double> now(plain.rows);
    for (int r = 0; r < plain.rows; ++r) now[r] = plain.change[r] + t * plain.step[r];
    const double gap_now = plain.gap_change[g] + t * plain.gap_step[g];
    const std::array<double, 2> force = plain.force(g, plain.by_tangents(g, now), gap_now);
    for (int i = 0; i < plain.num_rows[g]; ++i) {
      const TangentFrame& frame = plain.frame[g];
      const double by_law =
          i == 0 ? frame.cosine * force[0] + frame.sine * force[1] : -frame.sine * force[0] + frame.cosine * force[1];
      const int r = plain.row[g] + i;
      EXPECT_NEAR(found(r), by_law - plain.linear_force(g, r, now[r], gap_now), rounding * 50);
      EXPECT_NEAR(of_gaps(r), plain.coupling[r] * (plain.gap_change[g] - plain.old_gap[g]) / 0.5, rounding);
    }
  }
}

/// What ends a load step is where the next one starts: the same slip has the same shear then, and nothing slips any
/// further. Work is never won.
TYPED_TEST(FrictionKernels, TheSameSlipAgainChangesNothing) {
  using Space = typename TestFixture::Memory;
  using Vectors = typename FrictionArrays<Space>::Vectors;
  const PlainFriction plain(120);
  const auto f = this->friction(plain);
  const auto n = this->groups(plain);
  const auto change = this->values_of(plain.change);
  const std::size_t points = plain.weight.size();
  const auto new_state = [&] {
    return FrictionState<Space>{Vectors("shear", points), Vectors("slip", points), Vectors("reference", points),
                                typename FrictionArrays<Space>::Flags("slips", points)};
  };
  const auto one = new_state(), two = new_state();
  friction_state(this->exec, n, f, change, one);
  Kokkos::fence();
  Kokkos::deep_copy(f.reference, one.reference);
  Kokkos::deep_copy(f.approach, 0.0);
  friction_state(this->exec, n, f, change, two);
  const auto first = this->on_host(one.shear), again = this->on_host(two.shear);
  const auto slip = this->on_host(one.slip), more = this->on_host(two.slip);
  int num_slipped = 0;
  for (std::size_t q = 0; q < points; ++q) {
    double work = 0;
    for (int i = 0; i < 2; ++i) {
      if (plain.bound[q] > 0) {
        EXPECT_NEAR(again(q, i), first(q, i), rounding * 10);
        EXPECT_NEAR(more(q, i), 0, rounding * 10);
      } else {
        EXPECT_EQ(first(q, i), 0);
      }
      work -= first(q, i) * slip(q, i);
    }
    num_slipped += work > 0;
    EXPECT_GE(work, -rounding);
    EXPECT_LE(std::hypot(first(q, 0), first(q, 1)), plain.bound[q] * (1 + 1e-14));
  }
  EXPECT_GT(num_slipped, 50) << "the case proves little";
}

/// mu times what presses, or anything, or nothing; nothing where points are open.
TYPED_TEST(FrictionKernels, BoundsFollowThePressure) {
  const PlainFriction plain(90);
  const auto f = this->friction(plain);
  const auto n = this->groups(plain);
  std::vector<double> gaps;
  Numbers random;
  for (std::size_t g = 0; g < plain.k.size(); ++g) gaps.push_back(random(-0.4, 0.4));
  const auto change = this->values_of(gaps);
  take_pressures(this->exec, n, f, change);
  set_bounds(this->exec, n, f, ShearBound::by_pressure);
  const auto pressure = this->on_host(f.pressure);
  std::vector<double> bound(plain.weight.size());
  const auto now = this->on_host(f.bound);  // the host's memory may be the same
  for (std::size_t q = 0; q < bound.size(); ++q) bound[q] = now(q);
  set_bounds(this->exec, n, f, ShearBound::any);
  const auto held_view = this->on_host(f.bound);
  const std::vector<double> held(held_view.data(), held_view.data() + held_view.extent(0));
  set_bounds(this->exec, n, f, ShearBound::none);
  const auto free = this->on_host(f.bound);
  for (int g = 0; g < 90; ++g)
    for (int q = plain.first[g]; q < plain.first[g + 1]; ++q) {
      const double p = std::max(0.0, plain.pressed[q] - plain.k[g] * (plain.gap[g] + gaps[g]));
      EXPECT_NEAR(pressure(q), plain.active[q] ? p : 0, rounding * 10);
      EXPECT_NEAR(bound[q], plain.active[q] ? plain.coefficient[g] * p : 0, rounding * 10);
      EXPECT_EQ(held[q], plain.active[q] ? any_shear : 0);
      EXPECT_EQ(free(q), 0);
    }
}

}  // namespace
}  // namespace cgcontact::test_friction_kernels
