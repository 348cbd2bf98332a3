#include "contact/solve/floating/rigid_contact.hpp"

#include <algorithm>
#include <cmath>

#include "contact/model/surface_normals.hpp"
#include "contact/solve/floating/bodies_on_springs.hpp"
#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Factor on the outer iteration's kappa E/h at the start: with kappa = 10 the layer E/(10 h), ten cells thick.
constexpr double softer = 0.01;
/// Fraction of that along the faces: friction holds what nothing else does, and keeps nothing from where loads press
/// it.
constexpr double along_faces = 1e-3;
/// Imbalance, relative to the forces, below which bodies that friction holds stay where the linear solve has left them:
/// the balance, whose bounds do not follow the gap, would undo what that gains.
constexpr double near_balance = 1e-3;
/// Fraction of the loads that the exact normals of one side may leave over.
constexpr double max_load_left = 0.02;

/// Spring of a contact group along directions at its points, without these.
template <class DirectionAt>
Spring spring_along(const ContactPair& pair, const ContactGroup& group, const std::vector<RigidComponent>& components,
                    const DirectionAt& direction_at) {
  Spring spring;
  spring.first = pair.primary;
  spring.second = pair.secondary;
  spring.law = pair.law(group);
  for (int q = group.first_point; q < group.last_point; ++q) {
    const Vec3 x = pair.points.x(q), direction = direction_at(q);
    const double share = pair.points.weight(q) / group.area;
    // p acts on the primary body against its normal.
    spring.row.first -= share * components[pair.primary].row(x, direction);
    spring.row.second += share * components[pair.secondary].row(x, direction);
  }
  return spring;
}

Spring spring_of(const ContactPair& pair, const ContactGroup& group, const std::vector<RigidComponent>& components) {
  return spring_along(pair, group, components, [&](int q) { return pair.points.direction(q); });
}

/// Columns that span what a support's resistance leaves free, as a projection.
Eigen::Matrix<double, 6, 6> projection_on_free(const Eigen::Matrix<double, 6, 6>& resistance) {
  const Eigen::MatrixXd free = motions_not_resisted(resistance);
  return free * free.transpose();
}

}  // namespace

bool close_where_rigid_bodies_meet(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                   std::vector<ContactPair>& pairs) {
  const std::vector<RigidComponent> components = whole_bodies(bodies).list;
  BodiesOnSprings rigid(loads_on(bodies, components).first);
  double stiffest = 0;
  for (const ContactPair& pair : pairs) {
    for (const ContactGroup& group : pair.groups) {
      stiffest = std::max(stiffest, pair.stiffness(group));
      Spring spring = spring_of(pair, group, components);
      spring.law.k *= softer;
      spring.distance = group.initial_gap;
      rigid.add(spring, group.area);
    }
  }
  const std::size_t num_normal = rigid.springs.size();
  for (const ContactPair& pair : pairs)
    for (const ContactGroup& group : pair.groups)
      for (int i = 0; i < pair.num_tangents; ++i) {
        Spring spring = spring_along(pair, group, components, [&](int q) { return pair.tangents(q)[i]; });
        spring.law = {along_faces * softer * spring.law.k, true};
        rigid.add(spring, group.area);
      }
  for (const SupportPoint& p : supports) {
    if (p.follows) continue;
    Spring spring;
    spring.first = p.body;
    spring.row.first = components[p.body].row(global_position(bodies[p.body].cut_cells, p.cell, p.xi), p.direction);
    spring.law = {stiffest, true};
    spring.distance = -p.value;
    rigid.add(spring, p.weight);
  }
  if (!rigid.solve()) return false;
  rigid.springs.resize(num_normal);
  auto spring = rigid.springs.begin();
  for (ContactPair& pair : pairs)
    for (const ContactGroup& group : pair.groups) {
      const bool closed = rigid.gap(*spring++) < 0 || pair.bonded();
      for (int q = group.first_point; q < group.last_point; ++q) pair.points.set_active(q, closed);
    }
  return true;
}

FloatingBodies::FloatingBodies(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                               const std::vector<ContactPair>& pairs)
    : bodies_(bodies), pairs_(pairs), components_(whole_bodies(bodies).list) {
  std::vector<Resistance> held(bodies.size(), Resistance::Zero());
  const std::vector<int> assembly = bonded_assemblies(bodies.size(), pairs);
  const auto add = [&](const SupportPoint& p) { add_resistance(p, components_, bodies, assembly, held); };
  for (const SupportPoint& p : supports)
    if (!p.follows) add(p);
  // A body that supports carry and that only spins (a ball held along its normals): what follows the spin holds it.
  std::vector<char> carried;
  for (const auto& resistance : held)
    carried.push_back(eigenvalues(resistance.topLeftCorner<3, 3>())[0] >
                      1e-3 * resistance.topLeftCorner<3, 3>().trace());
  for (const SupportPoint& p : supports)
    if (p.follows && carried[p.body]) add(p);
  for (const auto& resistance : held) {
    free_.push_back(projection_on_free(resistance));
    any_ |= floats(static_cast<int>(free_.size()) - 1);
  }
  if (!any_) return;
  find_loaded();
  const std::vector<DisplacementDriven> led = displacement_driven_pairs();
  if (std::count(led.begin(), led.end(), DisplacementDriven::squeezed) > 0) hold_along_surfaces(supports);
}

bool FloatingBodies::floats(int body) const { return free_[body].norm() > 0.5; }

void FloatingBodies::find_loaded() {
  loaded_.assign(bodies_.size(), 0);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    each_force(bodies_[b], [&](int, const Vec3&, const Vec3&, const Vec3& force) { loaded_[b] |= !force.isZero(0); });
  for (bool changed = true; changed;) {
    changed = false;
    for (const ContactPair& pair : pairs_) {
      if (!floats(pair.primary) || !floats(pair.secondary) || loaded_[pair.primary] == loaded_[pair.secondary])
        continue;
      loaded_[pair.primary] = loaded_[pair.secondary] = changed = true;
    }
  }
}

void FloatingBodies::hold_along_surfaces(const std::vector<SupportPoint>& supports) {
  std::vector<SupportPoint> own;
  for (const SupportPoint& p : supports)
    if (!p.follows) own.push_back(p);
  SurfaceMotions motions = find_surface_motions(bodies_, own, pairs_);
  motions.own.add(motions.others);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!floats(static_cast<int>(b)) || loaded_[b]) continue;
    const Eigen::MatrixXd along = motions.own.modes.middleRows<6>(6 * static_cast<Eigen::Index>(b));
    free_[b] = projection_on_free(Eigen::Matrix<double, 6, 6>::Identity() - free_[b] + along * along.transpose());
  }
}

std::vector<DisplacementDriven> FloatingBodies::displacement_driven_pairs() const {
  std::vector<DisplacementDriven> led;
  for (const ContactPair& pair : pairs_) {
    const auto driven = [&](int body) { return floats(body) && loaded_[body]; };
    const bool held = !floats(pair.primary) && !floats(pair.secondary);
    // Line contact has no approach of its own: its bodies give it.
    const bool line = bodies_[pair.primary].spec->quadtree;
    // The law of small zones knows no friction.
    const bool other_law = pair.bonded() || pair.num_tangents > 0;
    led.push_back(line || other_law                                ? DisplacementDriven::no
                  : held                                           ? DisplacementDriven::held
                  : driven(pair.primary) || driven(pair.secondary) ? DisplacementDriven::no
                                                                   : DisplacementDriven::squeezed);
  }
  return led;
}

/// On the motions that are free.
Eigen::VectorXd FloatingBodies::load() const {
  Eigen::VectorXd load = loads_on(bodies_, components_).first;
  for (std::size_t b = 0; b < components_.size(); ++b)
    load.segment<6>(6 * b) = free_[b] * load.segment<6>(6 * b).eval();
  return load;
}

std::vector<char> FloatingBodies::pairs_that_open(const FreeMotions& motions) const {
  constexpr double opens = 0.05;  // of the fastest point of a pair
  std::vector<char> open(pairs_.size(), 0);
  if (motions.empty()) return open;
  const Eigen::VectorXd motion = motions.modes * (motions.modes.transpose() * load());
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const ContactPair& pair = pairs_[k];
    const RigidMotion first = motion.segment<6>(6 * pair.primary), second = motion.segment<6>(6 * pair.secondary);
    double slowest = 1e300, fastest = 0;
    for (const ContactPoint& q : pair.points) {
      const double rate = components_[pair.secondary].row(q.x, q.normal).dot(second) -
                          components_[pair.primary].row(q.x, q.normal).dot(first);
      slowest = std::min(slowest, rate);
      fastest = std::max(fastest, std::abs(rate));
    }
    open[k] = !pair.bonded() && fastest > 0 && slowest > opens * fastest;
  }
  return open;
}

bool FloatingBodies::held_without_friction() const {
  BodiesOnSprings rigid(load());
  for (const ContactPair& pair : pairs_)
    for (const ContactGroup& group : pair.groups) {
      Spring spring = spring_of(pair, group, components_);
      spring.row = spring.row.on(free_, pair.primary, pair.secondary);
      spring.law.k *= softer;
      spring.distance = group.initial_gap;
      rigid.add(spring, group.area);
    }
  return rigid.solve() && rigid.holds(free_);
}

bool FloatingBodies::may_slide(const ContactPair& pair) const {
  // Sine of the angle at which motions may leave faces: what triangles of a round face do, while wedges that loads
  // push out come apart.
  constexpr double along_face = 0.05;
  if (!floats(pair.primary) && !floats(pair.secondary)) return false;
  const Eigen::Index size = 6 * static_cast<Eigen::Index>(free_.size());
  Eigen::MatrixXd across = Eigen::MatrixXd::Zero(size, size), along = across;
  const auto add = [&](const ContactPair& of, const ContactGroup& group, const auto& direction_at,
                       Eigen::MatrixXd& to) {
    const Spring spring = spring_along(of, group, components_, direction_at);
    const Eigen::VectorXd row = spring.row.on(free_, of.primary, of.secondary).of_all(of.primary, of.secondary, size);
    double closed = 0;
    for (int q = group.first_point; q < group.last_point; ++q)
      if (of.points[q].active) closed += of.points.weight(q);
    to += closed * row * row.transpose();
  };
  for (const ContactPair& other : pairs_)
    for (const ContactGroup& group : other.groups) {
      add(
          other, group, [&](int q) { return other.points.direction(q); }, across);
      for (int i = 0; i < pair.num_tangents && &other == &pair; ++i)
        add(
            other, group, [&](int q) { return other.tangents(q)[i]; }, along);
    }
  const double largest = (across + along).diagonal().maxCoeff();
  const SymmetricEigen<Eigen::Dynamic> excess(along_face * along_face * along - across);
  return excess.eigenvalues()[size - 1] > rounding * largest;
}

FreeMotions FloatingBodies::not_stopped_by_the_other_side() const {
  BodiesOnSprings rigid(load());
  const std::vector<SurfaceNormals> normals(bodies_.begin(), bodies_.end());
  for (const ContactPair& pair : pairs_)
    for (const ContactGroup& group : pair.groups) {
      Spring spring;
      spring.first = pair.primary;
      spring.second = pair.secondary;
      spring.law = pair.law(group);
      for (int q = group.first_point; q < group.last_point; ++q) {
        const ContactPoint point = pair.points[q];
        Vec3 n = normals[pair.secondary](point.secondary_cell, point.secondary_position);
        if (n.dot(point.normal) > 0) n = -n;  // a surface of what is taken away
        if (pair.bonded()) n = point.direction;
        const double share = point.weight / group.area;
        spring.row.first += share * free_[pair.primary] * components_[pair.primary].row(point.x, n);
        spring.row.second -= share * free_[pair.secondary] * components_[pair.secondary].row(point.x, n);
      }
      for (int i = 0; i < pair.num_tangents; ++i) {
        Spring along = spring_along(pair, group, components_, [&](int q) { return pair.tangents(q)[i]; });
        along.law.bonded = true;
        along.row = along.row.on(free_, pair.primary, pair.secondary);
        rigid.add(along, group.area);
      }
      spring.distance = group.initial_gap;
      rigid.add(spring, group.area);
    }
  FreeMotions moving;
  if (rigid.solve() || rigid.unbalanced().norm() <= max_load_left * rigid.load.norm()) return moving;
  moving.bodies = components_;
  moving.modes = rigid.unbalanced().normalized();
  return moving;
}

FloatingBodies::Balance FloatingBodies::balance(const std::vector<double>& gap, const std::vector<double>& stress,
                                                const SmallZones& small_zones,
                                                const std::vector<FrictionGroup>& friction, bool by_law) const {
  BodiesOnSprings rigid(load());
  auto lagged = stress.begin();
  for (const ContactPair& pair : pairs_) {
    const int first_point = static_cast<int>(rigid.points.size());
    for (std::size_t q = 0; q < pair.points.size(); ++q) rigid.points.push_back({pair.points.weight(q), *lagged++});
    for (const ContactGroup& group : pair.groups) {
      Spring spring = spring_of(pair, group, components_);
      spring.row = spring.row.on(free_, pair.primary, pair.secondary);
      spring.distance = gap[rigid.springs.size()];
      spring.first_point = first_point + group.first_point;
      spring.last_point = first_point + group.last_point;
      if (const ZoneSpring zone = small_zones.spring(rigid.springs.size()); !zone.points.empty()) {
        spring.law.k = zone.stiffness;
        spring.first_point = static_cast<int>(rigid.points.size());
        for (const auto& [weight, at_no_gap] : zone.points) rigid.points.push_back({weight, at_no_gap});
        spring.last_point = static_cast<int>(rigid.points.size());
      }
      rigid.springs.push_back(spring);
    }
  }
  for (const FrictionGroup& law : friction) {
    const ContactPair& pair = pairs_[law.pair];
    Rubbing rubbing{pair.primary, pair.secondary, {}, &law, by_law};
    for (int i = 0; i < pair.num_tangents; ++i) {
      const ContactGroup& group = pair.groups[law.group];
      const Spring along = spring_along(pair, group, components_, [&](int q) { return pair.tangents(q)[i]; });
      rubbing.along[i] = along.row.on(free_, pair.primary, pair.secondary);
    }
    rigid.rubbing.push_back(rubbing);
  }
  Balance result;
  result.found = by_law && rigid.unbalanced().norm() < near_balance * rigid.scale();
  if (result.found) return result;
  result.found = rigid.solve();
  for (std::size_t b = 0; b < components_.size(); ++b) result.motions.emplace_back(rigid.motion.segment<6>(6 * b));
  if (!result.found) {
    result.unbalanced.bodies = components_;
    result.unbalanced.modes = rigid.unbalanced().normalized();
  }
  return result;
}

}  // namespace cgcontact
