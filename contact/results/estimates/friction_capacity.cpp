#include "contact/results/estimates/friction_capacity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact/motions/sliding.hpp"
#include "contact/results/estimates/open_force.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/figures/zone_figures.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Mean squares, summed over both sides, of what faces move along their normals in a motion that moves them by 1: of
/// exact surfaces, and of facets of a twenty-fourth of a turn.
constexpr double exact_face = 1e-9, faceted = 0.007;
/// Cosine with the mean normal: facets are nearly flat, and their mean normal is the axis.
constexpr double along_normal = 0.9;
/// Least fraction of a motion that is rotation, of exact surfaces and of facets: an axis that is 100, or 5, sizes of
/// the zone away is none.
constexpr double far_axis = 0.01, far_axis_of_facets = 0.2;
/// Fraction of a rotation that is none.
constexpr double no_rotation = 0.2;
/// Sine of an angle that is none.
constexpr double no_angle = 1e-6;

double largest_component(const Vec3& v) {
  Eigen::Index k;
  v.cwiseAbs().maxCoeff(&k);
  return v[k];
}

double distance_from(const Axis& axis, const Vec3& x) { return axis.direction.cross(x - axis.point).norm(); }

/// Motions of a zone (translation, then rotation about `centre` with lengths over `size`) that both sides resist by
/// less than a mean square.
Eigen::MatrixXd motions_along(const std::array<std::vector<PressedPoint>, 2>& sides, const Vec3& centre, double size,
                              const std::optional<Vec3>& across, double tolerance) {
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  for (const std::vector<PressedPoint>& side : sides) {
    double area = 0;
    for (const PressedPoint& point : side) area += point.area;
    for (const PressedPoint& point : side)
      for (const double shift : {-1.0, 1.0}) {  // rows of plane strain lie in one plane
        Eigen::Matrix<double, 6, 1> row;
        const Vec3 r = (point.x - centre) / size + (across ? Vec3(shift * *across) : Vec3(Vec3::Zero()));
        row << point.normal, r.cross(point.normal);
        sum += point.area / (2 * area) * row * row.transpose();
      }
  }
  const SymmetricEigen<6> eigen(sum);
  Eigen::Index count = 0;
  while (count < 6 && eigen.eigenvalues()[count] <= tolerance) ++count;
  return eigen.eigenvectors().leftCols(count);
}

std::optional<TorqueCapacity> axis_of_motions(const Eigen::MatrixXd& motions, const Vec3& zone_centre, double size,
                                              const Vec3& centre, double min_rotation) {
  if (motions.cols() == 0) return {};
  const SingularValues rotations(motions.bottomRows(3), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const auto rotation = [&](Eigen::Index k) { return k < rotations.values().size() ? rotations.values()[k] : 0.0; };
  if (!(rotation(0) > min_rotation) || rotation(1) > no_rotation * rotation(0)) return {};
  TorqueCapacity found;
  const double sign = largest_component(rotations.left().col(0)) < 0 ? -1 : 1;
  found.axis.direction = without_rounding(sign * rotations.left().col(0), 1);
  const Vec3 velocity = motions.topRows(3) * rotations.right().col(0) * (sign / rotation(0));
  if (std::abs(velocity.dot(found.axis.direction)) > no_rotation) return {};  // a screw
  found.axis.point = zone_centre + size * found.axis.direction.cross(velocity);
  for (Eigen::Index k = 1; k < motions.cols(); ++k) {  // along these the axis may lie anywhere
    const Vec3 along = (motions.topRows(3) * rotations.right().col(k)).normalized();
    found.axis.point += along.dot(centre - found.axis.point) * along;
  }
  found.axis.point = without_rounding(found.axis.point, size);
  found.from = motions.cols() == 3 ? TorqueCapacity::From::flat_faces : TorqueCapacity::From::faces_of_revolution;
  return found;
}

/// Zone of a pair: where it is pressed, by what the solution transmits and by the recovered pressure, with its images
/// behind planes of symmetry.
class FrictionZone {
 public:
  FrictionZone(const SolvedState& state, const Results& results, int pair, const double* group_force)
      : state_(state),
        pair_(state.pairs[pair]),
        figures_(results.pairs[pair]),
        frame_(frame_of_zone(state, results.contact_rows, results.pairs, pair)) {
    for (std::size_t g = 0; g < pair_.groups.size(); ++g) {
      const ContactGroup& group = pair_.groups[g];
      const double force = state.bodies[pair_.primary].slices * force_unit(state) * group_force[g];
      force_ += force;
      for (int q = group.first_point; q < group.last_point && force != 0; ++q)
        transmitted_.push_back(
            {pair_.points.x(q), force * pair_.points.weight(q) / group.area, pair_.points.normal(q)});
    }
    for (const ContactRow& row : results.contact_rows) {
      if (row.pair != pair || !row.touching || !is_pressed(row, figures_.max_pressure)) continue;
      sides_[row.body == pair_.primary ? 0 : 1].push_back({row.x, row.normal, row.weight});
      recovered_.push_back({row.x, row.weight * row.pressure_sprc, row.normal});
    }
  }

  double force() const { return force_; }
  /// Returns the use of friction by what the first body gets.
  double use(const Wrench& wrench) const {
    std::vector<FrictionLimit> limits;
    for (const Force& f : transmitted_) limits.push_back({f.x, f.normal, pair_.spec->friction * f.size});
    return use_of_friction(limits, wrench, contact_symmetry(*state_.bodies[pair_.primary].spec, frame_.planes));
  }
  double num_sectors() const { return std::pow(2.0, static_cast<double>(frame_.planes.size())); }

  /// Finds axis and capacity, without the error; or says why there is none.
  std::optional<TorqueCapacity> torque(std::string& why) const {
    std::optional<TorqueCapacity> torque = find_axis(why);
    if (!torque) return torque;
    torque->capacity = pair_.spec->friction * force_ * lever(torque->axis, recovered_, false);
    torque->whole = num_sectors() * pair_.spec->friction * force_ * lever(torque->axis, recovered_, true);
    return torque;
  }

  /// Relative difference between the mean distances from an axis by the transmitted and by the recovered pressure.
  double difference_of_levers(const Axis& axis) const {
    const double recovered = lever(axis, recovered_, false);
    return recovered > 0 ? std::abs(lever(axis, transmitted_, false) / recovered - 1) : 0;
  }

 private:
  struct Force {
    Vec3 x;
    double size;  ///< N, or in proportion to it
    Vec3 normal;
  };

  std::vector<Vec3> positions(const Vec3& x, bool with_images_of) const {
    return with_images_of ? with_images(x, frame_.planes) : std::vector<Vec3>{x};
  }

  /// Mean distance from an axis, m.
  double lever(const Axis& axis, const std::vector<Force>& forces, bool with_images_of) const {
    double sum = 0, all = 0;
    for (const Force& f : forces)
      for (const Vec3& x : positions(f.x, with_images_of)) {
        sum += f.size * distance_from(axis, x);
        all += f.size;
      }
    return all > 0 ? sum / all : 0;
  }

  /// Centre of the pressure on the whole zone, m.
  Vec3 centre() const {
    Vec3 sum = Vec3::Zero();
    double all = 0;
    for (const Force& f : transmitted_)
      for (const Vec3& x : positions(f.x, true)) {
        sum += f.size * x;
        all += f.size;
      }
    return all > 0 ? Vec3(sum / all) : sum;
  }

  std::optional<TorqueCapacity> find_axis(std::string& why) const {
    TorqueCapacity torque;
    const Vec3 centre = this->centre();
    const auto& strain = state_.bodies[pair_.primary].spec->plane_strain;
    const std::optional<Vec3> across =
        strain ? std::optional<Vec3>(Vec3::Unit(static_cast<int>(*strain))) : std::nullopt;
    if (const BodySpec& body = *state_.bodies[pair_.primary].spec; body.axisymmetric()) {
      torque.axis = {Vec3::Zero(), Vec3::Unit(body.axis_of_revolution())};
      torque.from = TorqueCapacity::From::faces_of_revolution;
      return torque;
    }
    if (const auto& given = pair_.spec->moment_about; given && given->axis) {
      torque.axis = {given->point, *given->axis};
    } else if (const auto found = axis_of_faces(sides_, centre, across)) {
      torque = *found;
    } else if (frame_.normal) {
      torque.axis = {centre, *frame_.normal};
      torque.from = TorqueCapacity::From::mean_normal;
    } else {
      why = "the zone is neither flat nor of revolution: moment_about with an axis names one";
      return {};
    }
    if (across && std::abs(across->dot(torque.axis.direction)) < 1 - no_angle) {
      why = "in plane strain friction has a torque about the axis of plane strain alone";
      return {};
    }
    return torque;
  }

  const SolvedState& state_;
  const ContactPair& pair_;
  const PairFigures& figures_;
  ZoneFrame frame_;
  double force_ = 0;
  std::vector<Force> transmitted_, recovered_;
  std::array<std::vector<PressedPoint>, 2> sides_;
};

/// Estimates the error of the normal force, relative.
std::optional<double> error_of_force(const SolvedState& state, const Results& results, std::size_t k, double force) {
  const PairFigures& figures = results.pairs[k];
  if (k >= results.verdict.pairs.size() || !figures.force_error_estimate) return {};
  const Verdict::Pair& verdict = results.verdict.pairs[k];
  if (verdict.closed_state() == Verdict::State::not_resolved) return {};
  if (is_tightened(state, k) || !figures.force_given_by_loads) return figures.force_error_estimate;
  const double turned = std::max(0.0, 1 - figures.force_on_first.norm() / force);
  return std::max(*figures.force_error_estimate, turned * figures.pressure_error_estimate);
}

/// Distance of the recovered shear from the transmitted one, relative; `pushed_ball`: 1.05 to 1.3 times the error
/// (docs/accuracy.md).
std::optional<double> error_of_shear(const Results& results, std::size_t k, double coefficient) {
  double difference = 0, size = 0, limit = 0;
  for (const ContactRow& row : results.contact_rows) {
    if (row.pair != static_cast<int>(k) || !row.active) continue;
    difference += row.weight * squared_shear_difference(row);
    size += row.weight * row.shear_sprc.squaredNorm();
    limit += row.weight * std::pow(coefficient * row.pressure_sprc, 2);
  }
  if (!(size > std::pow(relevant_force_fraction, 2) * limit)) return std::nullopt;
  return std::sqrt(difference / size);
}

/// Sets what the points of a pair do, for the thickness of the bodies. zone: none where nothing presses.
void fill_state(const SolvedState& state, std::size_t k, const std::optional<FrictionZone>& zone,
                FrictionFigures& friction) {
  const ContactPair& pair = state.pairs[k];
  const FrictionPoints& points = state.outer.friction[k];
  const double thickness = state.bodies[pair.primary].slices;
  for (std::size_t q = 0; q < points.shear.size(); ++q) {
    if (!pair.points.active(q)) continue;
    const double area = thickness * pair.points.weight(q);
    (points.slips[q] ? friction.slip_area : friction.stick_area) += area;
    friction.max_slip = std::max(friction.max_slip, points.slip[q].norm());
  }
  const auto [force, moment] = friction_on_first(state, k);
  friction.force = thickness * force;
  if (friction.torque) {
    const Axis& axis = friction.torque->axis;
    friction.torque->carried = thickness * axis.direction.dot(moment - axis.point.cross(force));
  }
  for (std::size_t q = 0; q < points.wear.size(); ++q)
    friction.wear += thickness * pair.points.weight(q) * points.wear[q];
  friction.work = thickness * points.work;
  if (friction.capacity > 0) friction.use = zone->use({friction.force, thickness * moment});
}

}  // namespace

std::optional<TorqueCapacity> axis_of_faces(const std::array<std::vector<PressedPoint>, 2>& sides, const Vec3& centre,
                                            const std::optional<Vec3>& across) {
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();  // of the first side less the second one
  double area = 0, size = 0;
  for (const auto& side : sides)
    for (const PressedPoint& point : side) {
      middle += point.area * point.x;
      normal += (&side == sides.data() ? 1 : -1) * point.area * point.normal;
      area += point.area;
    }
  if (!(area > 0)) return {};
  middle /= area;
  for (const auto& side : sides)
    for (const PressedPoint& point : side) size = std::max(size, (point.x - middle).norm());
  if (!(size > 0)) return {};
  const auto find = [&](double tolerance, double min_rotation) {
    return axis_of_motions(motions_along(sides, middle, size, across, tolerance), middle, size, centre, min_rotation);
  };
  if (const auto exact = find(exact_face, far_axis)) return exact;
  const auto near = find(faceted, far_axis_of_facets);
  if (near && std::abs(near->axis.direction.dot(normal)) > along_normal * area) return {};
  return near;
}

namespace {

/// Fraction of the largest pressure by which shear may change it where that counts as nothing.
constexpr double no_change_by_shear = 0.005;
/// Least number of steps in which bodies of different materials are pressed; fraction of the closed area that was apart
/// before the first one; fraction of a cell that slip may be (contact points see what lay opposite in the beginning).
constexpr std::size_t min_steps = 10;
constexpr double little_area = 0.1, small_slip = 1.0 / 3;

/// Compliance 1/G; 0 of a rigid body.
double shear_compliance(const Material& material) {
  return std::isinf(material.youngs_modulus) ? 0 : 2 * (1 + material.poisson_ratio) / material.youngs_modulus;
}

/// Returns the fraction of a pair's closed area that was apart in the beginning.
double fraction_once_apart(const ContactPair& pair) {
  double apart = 0, closed = 0;
  for (std::size_t q = 0; q < pair.points.size(); ++q) {
    if (!pair.points.active(q)) continue;
    closed += pair.points.weight(q);
    if (pair.points.distance(q) > pair.interference) apart += pair.points.weight(q);
  }
  return closed > 0 ? apart / closed : 0;
}

}  // namespace

bool shear_changes_pressure(const SolvedState& state, const ContactPair& pair) {
  const Material& first = state.scene.bodies[pair.primary].material;
  const Material& second = state.scene.bodies[pair.secondary].material;
  const double a = shear_compliance(first), b = shear_compliance(second);
  const double beta = (a * (1 - 2 * first.poisson_ratio) - b * (1 - 2 * second.poisson_ratio)) /
                      (2 * (a * (1 - first.poisson_ratio) + b * (1 - second.poisson_ratio)));
  return pair.friction() * std::abs(beta) > no_change_by_shear;
}

std::vector<std::string> friction_warnings(const SolvedState& state) {
  std::vector<std::string> warnings;
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const ContactPair& pair = state.pairs[k];
    if (pair.num_tangents == 0) continue;
    const std::size_t steps = std::max<std::size_t>(1, state.scene.steps.size());
    if (steps < min_steps && shear_changes_pressure(state, pair) && fraction_once_apart(pair) > little_area)
      warnings.push_back(fmt::format(
          "contact \"{}\": bodies of different materials slip while they are pressed, here in {} step{}: what sticks "
          "depends on the steps, {} or more say it better",
          pair.spec->name, steps, steps == 1 ? "" : "s", min_steps));
    double farthest = 0, cells = 0;
    const std::vector<Vec3>& slip = state.outer.friction[k].slip;
    for (std::size_t q = 0; q < slip.size(); ++q) {
      if (!pair.points.active(q)) continue;
      farthest = std::max(farthest, slip[q].norm());
      cells = std::max(cells, slip[q].norm() / pair.groups[pair.points.group(q)].h);
    }
    if (cells > small_slip)
      warnings.push_back(fmt::format(
          "contact \"{}\": the faces slip by up to {:.2g} cells: gaps and opposite points are those before the "
          "slip, which counts as small; so are the arms of its forces, and their moments may be wrong by force times "
          "{:.2g} m",
          pair.spec->name, cells, farthest));
  }
  return warnings;
}

void fill_friction(const SolvedState& state, Results& results) {
  std::size_t group = 0;
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const ContactPair& pair = state.pairs[k];
    const double* const group_force = state.outer.group_force.data() + group;
    group += pair.groups.size();
    if (!(pair.spec->friction > 0)) continue;
    FrictionFigures friction;
    friction.coefficient = pair.spec->friction;
    std::optional<FrictionZone> zone;
    if (results.pairs[k].area > 0) {
      zone.emplace(state, results, static_cast<int>(k), group_force);
      friction.capacity = pair.spec->friction * zone->force();
      friction.whole = zone->num_sectors() * friction.capacity;
      friction.error = error_of_force(state, results, k, zone->force());
      friction.torque = zone->torque(friction.why_no_torque);
      if (friction.torque && friction.error)
        friction.torque->error = std::hypot(*friction.error, zone->difference_of_levers(friction.torque->axis));
    } else {
      friction.why_no_torque = "nothing presses the faces";
    }
    fill_state(state, k, zone, friction);
    friction.shear_error = error_of_shear(results, k, friction.coefficient);
    results.pairs[k].friction = friction;
  }
}

}  // namespace cgcontact
