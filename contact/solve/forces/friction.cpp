#include "contact/solve/forces/friction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/model/around_axis.hpp"
#include "contact/motions/sliding.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "recovery/face/symmetry_planes.hpp"

namespace cgcontact {
namespace {

/// Fraction of what friction carries by which loads may exceed it: less is the error of the iteration. Largest relative
/// change of that from one iteration to the next, beyond which no body slides steadily.
constexpr double little_beyond = 1e-4, steady = 0.02;
/// Largest other imbalance, relative to mu times that of the pressure, of a state that slides; more is a state still on
/// its way.
constexpr double max_other_residual = 2;
/// Fraction of the sum of pressures: faces whose resultant is less are pressed from all sides, and come together
/// nowhere.
constexpr double min_common = 0.1;

template <class View>
auto host_of(const View& view) {
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
}

std::size_t count_points(const std::vector<ContactPair>& pairs) {
  std::size_t count = 0;
  for (const ContactPair& pair : pairs) count += pair.num_tangents > 0 ? pair.points.size() : 0;
  return count;
}

FrictionArrays<MemSpace> make_arrays(const OuterProblem& problem) {
  std::vector<int> first_point{0}, normal_group, row, num_rows;
  std::vector<double> coefficient, weight;
  int rows = 0, group = 0;
  for (const ContactPair& pair : problem.pairs) {
    if (pair.num_tangents == 0) {
      group += static_cast<int>(pair.groups.size());
      continue;
    }
    for (const ContactGroup& g : pair.groups) {
      normal_group.push_back(group++);
      row.push_back(rows);
      num_rows.push_back(pair.num_tangents);
      rows += pair.num_tangents;
      coefficient.push_back(pair.friction());
      for (int q = g.first_point; q < g.last_point; ++q) weight.push_back(pair.points.weight(q));
      first_point.push_back(static_cast<int>(weight.size()));
    }
  }
  FrictionArrays<MemSpace> arrays(row.size(), rows, weight.size());
  arrays.first_point = copy_to_view<IntView>("cgcontact::friction::first_point", first_point);
  arrays.normal_group = copy_to_view<IntView>("cgcontact::friction::normal_group", normal_group);
  arrays.row = copy_to_view<IntView>("cgcontact::friction::row", row);
  arrays.num_rows = copy_to_view<IntView>("cgcontact::friction::num_rows", num_rows);
  arrays.coefficient = copy_to_view<RealView>("cgcontact::friction::coefficient", coefficient);
  arrays.weight = copy_to_view<RealView>("cgcontact::friction::weight", weight);
  Kokkos::deep_copy(arrays.frame, TangentFrame());
  Kokkos::deep_copy(arrays.linear, ZoneForce());
  arrays.lagged_unit = problem.scales.stress;
  return arrays;
}

}  // namespace

/// friction_state() on the host.
struct Friction::Now {
  FrictionArrays<MemSpace>::Vectors::HostMirror shear, slip;
  FrictionArrays<MemSpace>::Flags::HostMirror slips;
  FrictionArrays<MemSpace>::Vectors new_reference;
};

Friction::Friction(const OuterProblem& problem)
    : problem_(problem), arrays_(make_arrays(problem)), first_row_(static_cast<int>(problem.system.group_rows.size())) {
  first_row_ -= num_rows();
  for (const ContactPair& pair : problem_.pairs) {
    const BodyModel &a = problem_.bodies[pair.primary], &b = problem_.bodies[pair.secondary];
    planes_.emplace_back();
    if (pair.num_tangents > 0)
      planes_.back() = common_planes(symmetry_planes(a.cut_cells, a.boundary), symmetry_planes(b.cut_cells, b.boundary),
                                     a.cut_cells.grid.cell_size);
  }
  const auto frame = host_of(arrays_.frame);
  frames_.assign(frame.data(), frame.data() + frame.extent(0));
  stress = Stress("cgcontact::friction::stress", count_points(problem.pairs));
  arrays_.lagged = stress.d_view;
  forget();
}

void Friction::forget() {
  Kokkos::deep_copy(arrays_.reference, 0.0);
  Kokkos::deep_copy(arrays_.bound, 0.0);
  Kokkos::deep_copy(arrays_.pressure, 0.0);
  Kokkos::deep_copy(arrays_.linear, ZoneForce());
  Kokkos::deep_copy(arrays_.coupling, 0.0);
  Kokkos::deep_copy(stress.h_view, 0.0);
  stress.modify_host();
  stress.sync_device();
  residual_ = 1;
  bound_ = ShearBound::any;
  new_step_ = true;
  history_.clear();
  for (const ContactPair& pair : problem_.pairs) {
    const std::size_t count = pair.num_tangents > 0 ? pair.points.size() : 0;
    FrictionPoints points;
    points.slip.assign(count, Vec3::Zero());
    points.travelled.assign(count, 0.0);
    points.wear.assign(count, 0.0);
    points.bound.assign(count, 0.0);
    history_.push_back(points);
  }
}

RealView Friction::of_friction(const RealView& all) const {
  return Kokkos::subview(all, std::pair(first_row_, first_row_ + num_rows()));
}

void Friction::add_excess(const ContactGroupArrays<MemSpace>& groups, const RealView& start, const RealView& along,
                          double t, const RealView& excess) const {
  if (!any()) return;
  friction_excess(problem_.exec, groups, arrays_, start, along, of_friction(start), of_friction(along), t,
                  of_friction(excess));
  problem_.exec.fence();
}

void Friction::add_coupled_forces(const RealView& change, double unit, const RealView& forces) const {
  if (!any()) return;
  cgcontact::add_coupled_forces(problem_.exec, arrays_, change, unit, of_friction(forces));
}

std::vector<double> Friction::coupling() const {
  if (!any()) return {};
  const auto of_rows = host_of(arrays_.coupling);
  std::vector<double> all(first_row_, 0.0);
  for (int r = 0; r < num_rows(); ++r) all.push_back(-of_rows(r));
  return all;
}

std::vector<FrictionGroup> Friction::laws(const ContactGroupArrays<MemSpace>& groups, const RealView& change) const {
  std::vector<FrictionGroup> all;
  if (!any()) return all;
  FrictionArrays<MemSpace> now = arrays_;
  now.pressure = RealView("cgcontact::friction::pressure_now", arrays_.pressure.extent(0));
  now.bound = RealView("cgcontact::friction::bound_now", arrays_.bound.extent(0));
  take_pressures(problem_.exec, groups, now, change);
  set_bounds(problem_.exec, groups, now, bound_);
  problem_.exec.fence();
  const auto bound = host_of(now.bound), weight = host_of(arrays_.weight), approach = host_of(arrays_.approach);
  const auto lagged = host_of(arrays_.lagged), reference = host_of(arrays_.reference), drift = host_of(arrays_.drift);
  const auto slips = host_of(of_friction(change)), gaps = host_of(change), gap = host_of(arrays_.gap);
  const auto linear = host_of(arrays_.linear);
  const auto coupling = host_of(arrays_.coupling);
  const auto normal_group = host_of(arrays_.normal_group);
  std::size_t f = 0, point = 0;
  int row = 0;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    for (std::size_t g = 0; g < pair.groups.size() && pair.num_tangents > 0; ++g, ++f) {
      FrictionGroup group{k, g, pair.stiffness(pair.groups[g]), {}, {}, {}, {}};
      for (int i = 0; i < pair.num_tangents; ++i, ++row) {
        const double along[2] = {frames_[f].along(i, 0), frames_[f].along(i, 1)};
        const double force = linear(row).at(slips(row)) + coupling(row) * (gaps(normal_group(f)) - gap(f));
        for (int t = 0; t < 2; ++t) {
          group.slip[t] += along[t] * slips(row);
          group.force[t] += along[t] * force;
        }
        group.fall[0] += along[0] * along[0] * linear(row).stiffness;
        group.fall[1] += along[0] * along[1] * linear(row).stiffness;
        group.fall[2] += along[1] * along[1] * linear(row).stiffness;
      }
      for (int q = pair.groups[g].first_point; q < pair.groups[g].last_point; ++q, ++point) {
        FrictionGroup::Point p{weight(point), bound(point), {}, {}};
        for (int t = 0; t < 2; ++t) {
          p.lagged[t] = lagged(point, t) * arrays_.lagged_unit;
          p.held[t] = reference(point, t) + approach(f) * drift(f, t);
        }
        if (p.bound > 0) group.points.push_back(p);
      }
      all.push_back(std::move(group));
    }
  }
  return all;
}

void Friction::put_into(const ContactGroupArrays<MemSpace>& groups) const {
  if (!any()) return;
  const std::pair rows(first_row_, first_row_ + num_rows());
  Kokkos::deep_copy(Kokkos::subview(groups.in_zone, rows), 1);
  Kokkos::deep_copy(Kokkos::subview(groups.zone, rows), arrays_.linear);
}

void Friction::begin_step(const ContactGroupArrays<MemSpace>& groups, const RealView& change) {
  bound_ = ShearBound::any;
  if (!any() || !std::exchange(new_step_, false)) return;
  take_gaps(problem_.exec, groups, arrays_, change);
  problem_.exec.fence();
}

bool Friction::carries_less_than(const std::vector<double>& force) const {
  std::size_t group = 0, row = first_row_;
  for (const ContactPair& pair : problem_.pairs) {
    double carried = 0, asked = 0;
    for (std::size_t g = 0; g < pair.groups.size(); ++g, ++group) {
      carried += pair.friction() * std::max(0.0, force[group]);
      double square = 0;
      for (int i = 0; i < pair.num_tangents; ++i, ++row) square += force[row] * force[row];
      asked += std::sqrt(square);
    }
    if (asked > carried) return true;
  }
  return false;
}

/// Finds the direction in which bodies come together: the mean of what presses them, or of closed points without
/// pressures yet. Where a normal leans away from it a point has slipped, by gap times tangent, when it closes.
void Friction::take_drifts(const ContactGroupArrays<MemSpace>& groups) const {
  const auto pressure = host_of(arrays_.pressure);
  const auto active = host_of(groups.active);
  const auto drift = Kokkos::create_mirror_view(arrays_.drift);
  std::size_t point = 0, all = 0, f = 0;
  for (const ContactPair& pair : problem_.pairs) {
    if (pair.num_tangents == 0) {
      all += pair.points.size();
      continue;
    }
    Vec3 sum[2] = {Vec3::Zero(), Vec3::Zero()};
    double size[2] = {0, 0};
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      const double w = pair.points.weight(q), of[2] = {w * pressure(point + q), active(all + q) ? w : 0};
      for (int i = 0; i < 2; ++i) {
        sum[i] += of[i] * pair.points.normal(q);
        size[i] += of[i];
      }
    }
    const int i = size[0] > 0 ? 0 : 1;
    for (const SymmetryPlane& plane : planes_[&pair - problem_.pairs.data()])
      sum[i] -= plane.normal * plane.normal.dot(sum[i]);
    const bool one_way = sum[i].norm() > min_common * size[i];
    const Vec3 way = one_way ? Vec3(sum[i].normalized()) : Vec3::Zero();
    for (const ContactGroup& g : pair.groups) {
      for (int t = 0; t < 2; ++t) drift(f, t) = 0;
      for (int q = g.first_point; q < g.last_point; ++q) {
        const double along = std::max(way.dot(pair.points.normal(q)), min_common);
        const std::array<Vec3, 2> tangents = pair.tangents(q);
        for (int t = 0; t < pair.num_tangents; ++t)
          drift(f, t) -= pair.points.weight(q) / g.area * way.dot(tangents[t]) / along;
      }
      ++f;
    }
    point += pair.points.size();
    all += pair.points.size();
  }
  Kokkos::deep_copy(arrays_.drift, drift);
}

void Friction::add_forceless_gaps(const ContactGroupArrays<MemSpace>& groups, double factor,
                                  const RealView& change) const {
  Stress(stress).sync_device();  // shares the memory
  cgcontact::add_forceless_gaps(problem_.exec, groups, arrays_, factor, change, of_friction(change));
  problem_.exec.fence();
}

bool Friction::renew(const ContactGroupArrays<MemSpace>& groups, const RealView& change) {
  if (!any()) return false;
  stress.sync_device();
  take_pressures(problem_.exec, groups, arrays_, change);
  set_bounds(problem_.exec, groups, arrays_, bound_);
  take_drifts(groups);
  linearise_friction(problem_.exec, groups, arrays_, change, of_friction(change));
  problem_.exec.fence();
  const auto mismatch = host_of(arrays_.mismatch);
  const auto first_point = host_of(arrays_.first_point);
  const auto weight = host_of(arrays_.weight), pressure = host_of(arrays_.pressure);
  double square = 0, pressed = 0;
  for (int f = 0; f < arrays_.num_groups(); ++f) {
    double area = 0;
    for (int q = first_point(f); q < first_point(f + 1); ++q) {
      area += weight(q);
      pressed += weight(q) * pressure(q) * pressure(q);
    }
    square += (mismatch(f, 0) * mismatch(f, 0) + mismatch(f, 1) * mismatch(f, 1)) / area;
  }
  residual_ = pressed > 0 ? std::sqrt(square / pressed) : square > 0 ? 1 : 0;
  look_for_sliding(groups, change);
  const auto turned = host_of(arrays_.turned);
  const bool any_turned = std::any_of(turned.data(), turned.data() + turned.extent(0), [](char t) { return t != 0; });
  if (any_turned) turn_rows();
  return any_turned;
}

/// Rows of the system by the new axes: each group's are turned in their plane.
void Friction::turn_rows() {
  const auto turned = host_of(arrays_.turned);
  const auto frame = host_of(arrays_.frame);
  const auto row = host_of(arrays_.row);
  ElasticSystem& system = problem_.system;
  system.changed_rows.resize(system.group_rows.size(), 0);  // the solver may not have seen the last ones yet
  for (int f = 0; f < arrays_.num_groups(); ++f) {
    if (!turned(f)) continue;
    const TangentFrame from = frames_[f], to = frame(f);
    const double c = from.cosine * to.cosine + from.sine * to.sine, s = from.cosine * to.sine - from.sine * to.cosine;
    const std::size_t first = first_row_ + row(f);
    auto &one = system.group_rows[first].entries, &two = system.group_rows[first + 1].entries;
    for (std::size_t e = 0; e < one.size(); ++e) {
      const double a = one[e].second, b = two[e].second;
      one[e].second = c * a + s * b;
      two[e].second = c * b - s * a;
    }
    frames_[f] = to;
    system.changed_rows[first] = system.changed_rows[first + 1] = 1;
  }
  compress_group_rows(system);
}

Friction::Now Friction::now(const ContactGroupArrays<MemSpace>& groups, const RealView& change) const {
  const std::size_t points = arrays_.weight.extent(0);
  const FrictionArrays<MemSpace>::Vectors shear("cgcontact::friction::shear", points),
      slip("cgcontact::friction::slip", points), reference("cgcontact::friction::new_reference", points);
  const FrictionArrays<MemSpace>::Flags slips("cgcontact::friction::slips", points);
  friction_state(problem_.exec, groups, arrays_, of_friction(change), {shear, slip, reference, slips});
  problem_.exec.fence();
  return {host_of(shear), host_of(slip), host_of(slips), reference};
}

/// Measures what the loads ask along the shear of pairs that stick nowhere, beyond what friction carries, relative to
/// that; where it is steady the pair slides, as far as the loads exceed the use of friction by a motion of the whole.
void Friction::look_for_sliding(const ContactGroupArrays<MemSpace>& groups, const RealView& change) {
  const std::vector<double> before = asked_;
  asked_.assign(problem_.pairs.size(), 0.0);
  sliding_.assign(problem_.pairs.size(), 0.0);
  if (!is_released()) return;
  const Now state = now(groups, change);
  const auto mismatch = host_of(arrays_.mismatch);
  const auto bound = host_of(arrays_.bound);
  std::size_t point = 0, f = 0;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    if (pair.num_tangents == 0) continue;
    std::vector<FrictionLimit> limits;
    Wrench needed;
    double carried = 0, beyond = 0;
    bool sticks = false;
    for (const ContactGroup& group : pair.groups) {
      double shear[2] = {0, 0};
      for (int q = group.first_point; q < group.last_point; ++q, ++point) {
        const std::array<Vec3, 2> along = pair.tangents(q);
        Vec3 force = Vec3::Zero();
        for (int i = 0; i < pair.num_tangents; ++i)
          force += pair.points.weight(q) * (state.shear(point, i) - mismatch(f, i) / group.area) * along[i];
        for (int i = 0; i < 2; ++i) shear[i] += state.shear(point, i);
        carried += pair.points.weight(q) * bound(point);
        needed.force += force;
        needed.moment += pair.points.x(q).cross(force);
        limits.push_back({pair.points.x(q), pair.points.normal(q), pair.points.weight(q) * bound(point)});
        sticks |= bound(point) > 0 && !state.slips(point);
      }
      if (const double size = std::hypot(shear[0], shear[1]); size > 0)
        beyond -= (mismatch(f, 0) * shear[0] + mismatch(f, 1) * shear[1]) / size;
      ++f;
    }
    if (sticks || !(carried > 0)) continue;
    asked_[k] = beyond / carried;
    const bool is_all = residual_ < max_other_residual * pair.friction() * asked_[k];  // of what is out of balance
    if (!is_all || asked_[k] <= little_beyond || std::abs(asked_[k] - before[k]) >= steady * asked_[k]) continue;
    const BodySpec& body = *problem_.bodies[pair.primary].spec;
    sum_around_axis(body, needed.force, &needed.moment);
    const double excess = use_of_friction(limits, needed, contact_symmetry(body, planes_[k])) - 1;
    if (excess > little_beyond) sliding_[k] = excess;
  }
}

void Friction::end_step(const ContactGroupArrays<MemSpace>& groups, const RealView& change) {
  if (!any()) return;
  new_step_ = true;
  const Now last = now(groups, change);
  history_ = with_step(last);
  Kokkos::deep_copy(arrays_.reference, last.new_reference);
}

std::vector<FrictionPoints> Friction::state(const ContactGroupArrays<MemSpace>& groups, const RealView& change) const {
  return any() ? with_step(now(groups, change)) : history_;
}

/// Adds what a step has done to the steps before.
std::vector<FrictionPoints> Friction::with_step(const Now& state) const {
  std::vector<FrictionPoints> all = history_;
  const auto bound = host_of(arrays_.bound);
  std::size_t point = 0;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    FrictionPoints& points = all[k];
    const std::size_t count = points.slip.size();
    bool presses = false;  // a pair that opens wholly moves apart, and does not rub
    for (std::size_t q = 0; q < count; ++q) presses |= bound(point + q) > 0;
    points.shear.assign(count, Vec3::Zero());
    points.slips.assign(count, 0);
    for (std::size_t q = 0; q < count; ++q, ++point) {
      const std::array<Vec3, 2> along = pair.tangents(q);
      const auto global = [&](const auto& view) { return Vec3(view(point, 0) * along[0] + view(point, 1) * along[1]); };
      points.shear[q] = global(state.shear);
      points.slips[q] = state.slips(point);
      const double before = std::exchange(points.bound[q], 0.0);
      const bool open = !(bound(point) > 0);
      const Vec3 step = global(state.slip);
      points.slip[q] = open ? Vec3::Zero() : Vec3(points.slip[q] + step);
      if (!open) points.travelled[q] += step.norm();
      if (std::isfinite(bound(point))) points.bound[q] = bound(point);
      // Slip and pressure grow together from step to step, so that it rubs under their mean: one step is enough for
      // loads in proportion, and for a force that stays while it shifts from points that open to others.
      if (open && !presses) continue;
      const double mean = 0.5 * (before + bound(point));
      points.wear[q] += mean / pair.friction() * step.norm();
      points.work += pair.points.weight(q) * mean * step.norm();
    }
  }
  return all;
}

}  // namespace cgcontact
