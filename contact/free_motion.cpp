#include "contact/free_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cgcontact {
namespace {

/// Loads whose part along a free motion is less than this part of them are in balance: they are integrated to 1e-9.
constexpr double no_load = 1e-7;
/// Boundary points among which the held ones are chosen: of all bodies, but at least so many of each.
constexpr std::size_t most_candidates = 3000, fewest_candidates = 12;

/// Columns that span the null space of a matrix whose singular values are of order 1 or zero.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k) rank += svd.singularValues()[k] > 1e-6;
  return svd.matrixV().rightCols(A.cols() - rank);
}

/// Rows of the rotations of all bodies.
Eigen::MatrixXd rotations(const Eigen::MatrixXd& modes) {
  Eigen::MatrixXd rows(modes.rows() / 2, modes.cols());
  for (Eigen::Index b = 0; b < modes.rows() / 6; ++b) rows.middleRows(3 * b, 3) = modes.middleRows(6 * b + 3, 3);
  return rows;
}

/// The directions that the columns of a 3 x k matrix span: "along (..)", "in the plane normal to (..)", ...
std::string span_text(const Eigen::MatrixXd& columns, const char* one, const char* two, const char* three) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(columns, Eigen::ComputeFullU);
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k)
    rank += svd.singularValues()[k] > 1e-4 * svd.singularValues()[0];
  if (rank == 1) return one + direction_text(svd.matrixU().col(0));
  if (rank == 2) return two + direction_text(svd.matrixU().col(2));
  return three;
}

/// Work of the loads on the motions of one body, N, and the sum of the forces' magnitudes.
std::pair<RigidMotion, double> load_on(const BodyModel& body, const RigidPiece& piece) {
  RigidMotion sum = RigidMotion::Zero();
  double magnitude = 0;
  each_force(body, [&](int, const Vec3&, const Vec3& x, const Vec3& force) {
    sum += piece.row(x, force);
    magnitude += force.norm();
  });
  return {sum, magnitude};
}

}  // namespace

std::string direction_text(Vec3 axis) {
  Eigen::Index largest;
  axis.normalize();
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;
  if ((axis - Vec3::Unit(largest)).norm() < 1e-3) return std::string(1, "xyz"[largest]);
  axis = (1000 * axis).array().round().matrix() / 1000 + Vec3::Zero();  // three digits, and no -0
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", axis[0], axis[1], axis[2]);
}

bool FreeMotions::slides() const { return null_space(rotations(modes)).cols() > 0; }

FreeMotions find_free_motions(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                              const std::vector<ContactPair>& pairs, double no_stiffness) {
  RigidPieces pieces = whole_bodies(bodies);
  FreeMotions free;
  free.modes = free_rigid_motions(pieces, bodies, supports, pairs, no_stiffness);
  free.bodies = std::move(pieces.list);
  return free;
}

FreeMotions driven_by_loads(const FreeMotions& free, const std::vector<BodyModel>& bodies) {
  FreeMotions driven = free;
  driven.modes.resize(free.modes.rows(), 0);
  Eigen::VectorXd load(free.modes.rows());
  double magnitude = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto [sum, size] = load_on(bodies[b], free.bodies[b]);
    load.segment<6>(6 * b) = sum;
    magnitude += size;
  }
  const Eigen::VectorXd along = free.modes * (free.modes.transpose() * load);
  if (along.norm() > no_load * magnitude) driven.modes = along.normalized();
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
  if (slide.cols() > 0 && slide.norm() > 1e-6)
    text = span_text(slide, "move along ", "move in the plane normal to ", "move in all directions");
  if (rotation.norm() > 1e-3)
    text += (text.empty() ? "" : " and to ") +
            span_text(rotation, "rotate about ", "rotate about the axes normal to ", "rotate about all axes");
  return fmt::format("body \"{}\" is free to {}", scene.bodies[body].name, text);
}

std::vector<SupportPoint> hold(const FreeMotions& free, const std::vector<BodyModel>& bodies) {
  std::vector<SupportPoint> candidates;
  const std::size_t per_body = std::max(fewest_candidates, most_candidates / bodies.size());
  std::vector<Eigen::VectorXd> rows;  // of each candidate: its displacement in every motion
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    const BodyModel& body = bodies[b];
    const BoundaryPoints& boundary = body.cut_cells.boundary;
    const std::size_t stride = 1 + boundary.size() / per_body;
    const double h = body.cut_cells.grid.cell_size;
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
        point.weight = h * h;
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
