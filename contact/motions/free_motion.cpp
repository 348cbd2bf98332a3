#include "contact/motions/free_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "contact/model/surface_normals.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// A single motion that rotates by less than this fraction of what it moves is a translation in words: the centre of a
/// body's cells is not that of the body.
constexpr double mostly = 0.1;
/// Number of boundary points among which the held ones are chosen: of all bodies, and least of each.
constexpr std::size_t max_candidates = 3000, min_candidates = 12;

/// Columns that span the null space of a matrix whose singular values are of order 1 or zero.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& A) {
  if (A.cols() == 0) return Eigen::MatrixXd(0, 0);
  const SingularValues svd(A, Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < svd.values().size(); ++k) rank += svd.values()[k] > 1e-6;
  return svd.right().rightCols(A.cols() - rank);
}

/// Orthonormal columns that span those of a matrix whose columns have length 1.
Eigen::MatrixXd column_space(const Eigen::MatrixXd& A) {
  if (A.cols() == 0) return A;
  const SingularValues svd(A, Eigen::ComputeThinU);
  return svd.left().leftCols((svd.values().array() > 1e-3).count());
}

/// Rows of the rotations of all bodies.
Eigen::MatrixXd rotations(const Eigen::MatrixXd& modes) {
  Eigen::MatrixXd rows(modes.rows() / 2, modes.cols());
  for (Eigen::Index b = 0; b < modes.rows() / 6; ++b) rows.middleRows(3 * b, 3) = modes.middleRows(6 * b + 3, 3);
  return rows;
}

/// Directions that the columns of a 3 x k matrix span: "along (..)", "in the plane normal to (..)", ...
std::string span_text(const Eigen::MatrixXd& columns, const char* one, const char* two, const char* three) {
  const SingularValues svd(columns, Eigen::ComputeFullU);
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < svd.values().size(); ++k) rank += svd.values()[k] > 1e-4 * svd.values()[0];
  if (rank == 1) return one + direction_text(svd.left().col(0));
  if (rank == 2) return two + direction_text(svd.left().col(2));
  return three;
}

/// Returns the resistance of a body's contact with others (it and those bonded to it), with the normals of its own
/// surface and with those of the others.
std::pair<Resistance, Resistance> contact_resistance(int b, const RigidComponent& component,
                                                     const std::vector<BodyModel>& bodies,
                                                     const std::vector<ContactPair>& pairs,
                                                     const std::vector<int>& assembly,
                                                     const std::vector<SurfaceNormals>& normals) {
  Resistance own = Resistance::Zero(), others = Resistance::Zero();
  for (const ContactPair& pair : pairs) {
    const bool is_primary = assembly[pair.primary] == assembly[b];
    if (is_primary == (assembly[pair.secondary] == assembly[b])) continue;
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      const ContactPoint point = pair.points[q];
      pair.each_tangent(q, [&](const Vec3& t) {  // friction resists along both surfaces
        const RigidMotion along = component.row(point.x, t);
        own += point.weight * along * along.transpose();
        others += point.weight * along * along.transpose();
      });
      const RigidMotion primary =
          component.row(point.x, normals[pair.primary](point.primary_cell, point.primary_position));
      const Vec3 opposite = global_position(bodies[pair.secondary].cut_cells, point.secondary_cell, point.secondary_xi);
      const RigidMotion secondary =
          component.row(opposite, normals[pair.secondary](point.secondary_cell, point.secondary_position));
      (is_primary ? own : others) += point.weight * primary * primary.transpose();
      (is_primary ? others : own) += point.weight * secondary * secondary.transpose();
    }
  }
  return {own, others};
}

/// Returns the resistance of supports for every body; those of bodies that are bonded to it count as its own.
std::vector<Resistance> support_resistance(const std::vector<RigidComponent>& components,
                                           const std::vector<BodyModel>& bodies,
                                           const std::vector<SupportPoint>& supports,
                                           const std::vector<int>& assembly) {
  std::vector<Resistance> held(bodies.size(), Resistance::Zero());
  for (const SupportPoint& p : supports) add_resistance(p, components, bodies, assembly, held);
  return held;
}

/// Appends motions of one body, which take those bonded to it along.
void append_of_assembly(int b, const Eigen::MatrixXd& modes, const std::vector<int>& assembly, FreeMotions& all) {
  const Eigen::Index first = all.modes.cols();
  all.modes.conservativeResize(Eigen::NoChange, first + modes.cols());
  all.modes.rightCols(modes.cols()).setZero();
  all.modes.block(6 * b, first, 6, modes.cols()) = modes;
  bool alone = true;
  for (int other = 0; other < static_cast<int>(assembly.size()); ++other) {
    if (other == b || assembly[other] != assembly[b]) continue;
    alone = false;
    const Vec3 from = all.bodies[b].centre(), to = all.bodies[other].centre();
    const double size = all.bodies[b].size();
    for (Eigen::Index k = 0; k < modes.cols(); ++k) {
      const Vec3 translation = modes.col(k).head<3>(), rotation = modes.col(k).tail<3>();
      all.modes.col(first + k).segment<3>(6 * other) = translation + rotation.cross(to - from) / size;
      all.modes.col(first + k).segment<3>(6 * other + 3) = all.bodies[other].size() / size * rotation;
    }
  }
  for (Eigen::Index k = first; k < all.modes.cols() && !alone; ++k) all.modes.col(k).normalize();
}

/// No motions yet.
FreeMotions no_motions(const std::vector<BodyModel>& bodies) {
  FreeMotions none;
  none.bodies = whole_bodies(bodies).list;
  none.modes.resize(static_cast<Eigen::Index>(6 * bodies.size()), 0);
  return none;
}

}  // namespace

Eigen::MatrixXd motions_not_resisted(const Resistance& resistance) {
  const SymmetricEigen<6> eigen(resistance);
  Eigen::Index count = 0;
  while (count < 6 && eigen.eigenvalues()[count] <= rounding * eigen.eigenvalues()[5]) ++count;
  return eigen.eigenvectors().leftCols(count);
}

std::string direction_text(Vec3 axis) {
  Eigen::Index largest;
  axis.normalize();
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;
  if ((axis - Vec3::Unit(largest)).norm() < 1e-3) return std::string(1, "xyz"[largest]);
  axis = (1000 * axis).array().round().matrix() / 1000 + Vec3::Zero();  // three digits, and no -0
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", axis[0], axis[1], axis[2]);
}

void FreeMotions::add(const FreeMotions& other) {
  if (other.empty()) return;
  Eigen::MatrixXd both(modes.rows(), modes.cols() + other.modes.cols());
  both << modes, other.modes;
  modes = column_space(both);
}

void FreeMotions::leave_out(const std::vector<SupportPoint>& supports, const std::vector<BodyModel>& models) {
  Eigen::MatrixXd rows(supports.size(), modes.cols());
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const SupportPoint& p = supports[k];
    rows.row(static_cast<Eigen::Index>(k)) =
        modes.middleRows<6>(6 * p.body).transpose() *
        bodies[p.body].row(global_position(models[p.body].cut_cells, p.cell, p.xi), p.direction);
  }
  if (rows.size() > 0) modes = modes * null_space(rows);
}

bool FreeMotions::slides() const { return null_space(rotations(modes)).cols() > 0; }

FreeMotions FreeMotions::without_rotation() const {
  FreeMotions slides = *this;
  slides.modes = modes * null_space(rotations(modes));
  return slides;
}

FreeMotions find_free_motions(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                              const std::vector<ContactPair>& pairs, double no_stiffness) {
  RigidComponents components = whole_bodies(bodies);
  FreeMotions free;
  free.modes = free_rigid_motions(components, bodies, supports, pairs, no_stiffness);
  free.bodies = std::move(components.list);
  return free;
}

void add_resistance(const SupportPoint& p, const std::vector<RigidComponent>& components,
                    const std::vector<BodyModel>& bodies, const std::vector<int>& assembly,
                    std::vector<Resistance>& held) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (assembly[b] != assembly[p.body]) continue;
    const RigidMotion q = components[b].row(global_position(bodies[p.body].cut_cells, p.cell, p.xi), p.direction);
    held[b] += p.weight * q * q.transpose();
  }
}

SurfaceMotions find_surface_motions(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                    const std::vector<ContactPair>& pairs) {
  const FreeMotions none = no_motions(bodies);
  SurfaceMotions found{none, none};
  const std::vector<int> assembly = bonded_assemblies(bodies.size(), pairs);
  const std::vector<Resistance> held = support_resistance(none.bodies, bodies, supports, assembly);
  std::vector<int> floating;
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b)
    if (assembly[b] == b && motions_not_resisted(held[b]).cols() > 0) floating.push_back(b);
  if (floating.empty()) return found;
  const std::vector<SurfaceNormals> normals(bodies.begin(), bodies.end());
  for (const int b : floating) {
    const auto [own, others] = contact_resistance(b, none.bodies[b], bodies, pairs, assembly, normals);
    append_of_assembly(b, motions_not_resisted(held[b] + own), assembly, found.own);
    append_of_assembly(b, motions_not_resisted(held[b] + others), assembly, found.others);
  }
  return found;
}

FreeMotions free_on_both_sides(const FreeMotions& free, const std::vector<BodyModel>& bodies,
                               const std::vector<ContactPair>& pairs) {
  if (free.empty()) return free;
  const std::vector<SurfaceNormals> normals(bodies.begin(), bodies.end());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(free.modes.cols(), free.modes.cols());
  double area = 0;
  for (const ContactPair& pair : pairs)
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      const ContactPoint point = pair.points[q];
      const Vec3 y = global_position(bodies[pair.secondary].cut_cells, point.secondary_cell, point.secondary_xi);
      const auto add = [&](const Vec3& n) {
        const Eigen::VectorXd row =
            free.modes.middleRows<6>(6 * pair.secondary).transpose() * free.bodies[pair.secondary].row(y, n) -
            free.modes.middleRows<6>(6 * pair.primary).transpose() * free.bodies[pair.primary].row(y, n);
        gram += point.weight * row * row.transpose();
      };
      add(pair.bonded() ? point.direction : normals[pair.secondary](point.secondary_cell, point.secondary_position));
      pair.each_tangent(q, add);
      area += point.weight;
    }
  const SymmetricEigen<Eigen::Dynamic> eigen(gram);
  Eigen::Index count = 0;
  while (count < gram.cols() && eigen.eigenvalues()[count] <= rounding * area) ++count;
  FreeMotions left = free;
  left.modes = free.modes * eigen.eigenvectors().leftCols(count);
  return left;
}

std::vector<FreeMotions> motions_of_floating_bodies(const std::vector<BodyModel>& bodies,
                                                    const std::vector<SupportPoint>& supports,
                                                    const std::vector<ContactPair>& pairs) {
  const FreeMotions none = no_motions(bodies);
  const std::vector<int> assembly = bonded_assemblies(bodies.size(), pairs);
  const std::vector<Resistance> held = support_resistance(none.bodies, bodies, supports, assembly);
  std::vector<FreeMotions> list;
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    if (assembly[b] != b) continue;
    const Eigen::MatrixXd free = motions_not_resisted(held[b]);
    if (free.cols() == 0) continue;
    list.push_back(none);
    append_of_assembly(b, free, assembly, list.back());
  }
  return list;
}

std::pair<Eigen::VectorXd, double> loads_on(const std::vector<BodyModel>& bodies,
                                            const std::vector<RigidComponent>& components) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * bodies.size()));
  double magnitude = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    each_force(bodies[b], [&](int, const Vec3&, const Vec3& x, const Vec3& force) {
      load.segment<6>(6 * b) += components[b].row(x, force);
      magnitude += force.norm();
    });
  return {load, magnitude};
}

FreeMotions driven_by_loads(const FreeMotions& free, const std::vector<BodyModel>& bodies, double allowed) {
  FreeMotions driven = free;
  driven.modes.resize(free.modes.rows(), 0);
  const auto [load, magnitude] = loads_on(bodies, free.bodies);
  const Eigen::VectorXd along = free.modes * (free.modes.transpose() * load);
  if (along.norm() > allowed * magnitude) driven.modes = along.normalized();
  return driven;
}

std::string describe(const FreeMotions& free, const Scene& scene) {
  Eigen::Index body = 0;
  for (Eigen::Index b = 1; b < free.modes.rows() / 6; ++b)
    if (free.modes.middleRows(6 * b, 6).norm() > free.modes.middleRows(6 * body, 6).norm() * (1 + 1e-6)) body = b;
  const Eigen::MatrixXd translation = free.modes.middleRows(6 * body, 3),
                        rotation = free.modes.middleRows(6 * body + 3, 3);
  const Eigen::MatrixXd slide = translation * null_space(rotation);
  std::string text;
  if (free.modes.cols() == 1 && rotation.norm() < mostly * translation.norm())
    return fmt::format("body \"{}\" is free to {}", scene.bodies[body].name,
                       span_text(translation, "move along ", "", ""));
  if (slide.cols() > 0 && slide.norm() > 1e-6)
    text = span_text(slide, "move along ", "move in the plane normal to ", "move in all directions");
  if (rotation.norm() > 1e-3)
    text += (text.empty() ? "" : " and to ") +
            span_text(rotation, "rotate about ", "rotate about the axes normal to ", "rotate about all axes");
  return fmt::format("body \"{}\" is free to {}", scene.bodies[body].name, text);
}

std::vector<SupportPoint> hold(const FreeMotions& free, const std::vector<BodyModel>& bodies) {
  std::vector<SupportPoint> candidates;
  const std::size_t per_body = std::max(min_candidates, max_candidates / bodies.size());
  std::vector<Eigen::VectorXd> rows;  // of each candidate: its displacement in every motion
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    const BodyModel& body = bodies[b];
    const BoundaryPoints& boundary = body.cut_cells.boundary;
    const std::size_t stride = 1 + boundary.size() / per_body;
    for (std::size_t p = 0; p < boundary.size(); p += stride)
      for (int k = 0; k < 3; ++k) {
        const Vec3 d = Vec3::Unit(k);
        rows.push_back(free.modes.middleRows<6>(6 * b).transpose() *
                       free.bodies[b].row(body.point(static_cast<int>(p)), d));
        SupportPoint point;
        point.body = b;
        point.cell = boundary.cell[p];
        point.xi = cell_coordinates(body.cut_cells, point.cell, boundary.position[p]);
        point.direction = d;
        point.normal = body.normal(static_cast<int>(p));
        const double h = body.cut_cells.h(point.cell);
        point.weight = h * h * body.cut_cells.grid.thickness_of_cell(body.cut_cells.level(point.cell));
        candidates.push_back(point);
      }
  }
  std::vector<SupportPoint> chosen;
  for (Eigen::Index k = 0; k < free.modes.cols(); ++k) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < rows.size(); ++i)
      if (rows[i].norm() > rows[best].norm()) best = i;
    chosen.push_back(candidates[best]);
    const Eigen::VectorXd direction = rows[best].normalized();
    for (Eigen::VectorXd& row : rows) row -= row.dot(direction) * direction;
  }
  return chosen;
}

}  // namespace cgcontact
