#include "contact/results/figures/pressure_paths.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/reference/reference.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

constexpr int num_samples = 401;
/// Fraction of a cell: this far below a point on a face there is material, but not beyond its end.
constexpr double below_face = 1e-3;
/// Steps of the first walk to the ends of a path, in cells, and their number at most.
constexpr double walk_step = 0.25;
constexpr int max_walk_steps = 4000;
/// Distance from the last pressure to the end of a path: fraction of its length, and cells.
constexpr double beyond = 0.3, beyond_cells = 2;
/// Fraction of the largest pressure of the pair.
constexpr double hardly_any_pressure = 0.01;
/// Fraction of the largest second moment of the zone from which a coordinate axis is taken.
constexpr double long_enough = 0.8;

/// The largest pressure of a pair: where, on which body, with which normal.
const ContactRow* largest_row(const Results& results, int pair) {
  const PairFigures& figures = results.pairs[pair];
  const ContactRow* largest = nullptr;
  for (const ContactRow& r : results.contact_rows)
    if (r.pair == pair && r.pressure_sprc > 0 && r.pressure_sprc <= figures.max_pressure &&
        (!largest || r.pressure_sprc > largest->pressure_sprc))
      largest = &r;
  return largest;
}

/// Returns the tangent at the largest pressure along which the zone is longest.
Vec3 direction_of(const Results& results, const ContactRow& top) {
  double area = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const ContactRow& r : results.contact_rows) {
    if (r.pair != top.pair || r.body != top.body || !(r.pressure_sprc > hardly_any_pressure * top.pressure_sprc))
      continue;
    Vec3 d = r.x - top.x;
    d -= d.dot(top.normal) * top.normal;
    area += r.weight;
    first += r.weight * d;
    second += r.weight * d * d.transpose();
  }
  second -= first * first.transpose() / area;  // about the middle: the largest pressure may lie at an end
  const SymmetricEigen<3> solver(second);
  for (int k = 0; k < 3; ++k) {
    Vec3 axis = Vec3::Unit(k);
    axis -= axis.dot(top.normal) * top.normal;
    if (axis.norm() < 0.3) continue;
    axis.normalize();
    if (axis.dot(second * axis) >= long_enough * solver.eigenvalues()[2]) return axis;
  }
  Vec3 e = solver.eigenvectors().col(2);
  e -= e.dot(top.normal) * top.normal;
  if (!(e.norm() > 1e-6)) e = top.normal.unitOrthogonal();
  int largest = 0;
  e.cwiseAbs().maxCoeff(&largest);
  return e.normalized() * (e[largest] < 0 ? -1 : 1);
}

/// Walks along the face within the plane of normal and direction at `top`; visit(row, way) after every step returns
/// false to stop. Ends with the face or back at the beginning.
template <class Visit>
void walk(const FaceProjection& project, const ContactRow& top, const Vec3& along, double step, int steps,
          const Visit& visit) {
  const Vec3 across = top.normal.cross(along);
  Vec3 x = top.x, normal = top.normal, forward = along;
  for (int k = 1; k <= steps; ++k) {
    Vec3 tangent = normal.cross(across).normalized();
    if (tangent.dot(forward) < 0) tangent = -tangent;
    if (!tangent.allFinite()) return;
    const std::optional<ContactRow> row = project(top.body, top.pair, x + step * tangent);
    // The end of a face throws the projection back.
    if (!row || (row->x - x).dot(tangent) < 0.3 * step) return;
    x = row->x;
    normal = row->normal;
    forward = tangent;
    if (!visit(*row, k * step)) return;
    if (k > 4 && (x - top.x).norm() < 0.7 * step) return;
  }
}

/// Extent of a path.
struct Extent {
  double length = 0;
  bool closed = false;          ///< back at its beginning
  bool ends_with_face = false;  ///< less than a step of the walk beyond
};

/// A little beyond the zone, to the end of the face, or once around it. h: size of a cell there, m.
Extent extent_of(const FaceProjection& project, const ContactRow& top, const Vec3& along, double h) {
  double last_pressed = 0;
  bool goes_on = true;
  Extent extent;
  walk(project, top, along, walk_step * h, max_walk_steps, [&](const ContactRow& row, double way) {
    extent.length = way;
    extent.closed = way > 4 * walk_step * h && (row.x - top.x).norm() < 0.7 * walk_step * h;
    if (row.pressure_sprc > hardly_any_pressure * top.pressure_sprc) last_pressed = way;
    return goes_on = way < (1 + beyond) * last_pressed + beyond_cells * h;
  });
  extent.ends_with_face = goes_on && !extent.closed;
  return extent;
}

struct PathPoint {
  double s;
  Vec3 x;
};

/// From one end to the other, s = 0 at the largest pressure.
std::vector<PathPoint> path_points(const SolvedState& state, const Results& results, const FaceProjection& project,
                                   const ContactRow& top) {
  const Vec3 along = direction_of(results, top);
  const double h = state.bodies[top.body].cut_cells.h(top.cell);
  const Extent whole = extent_of(project, top, along, h);
  const Extent other = whole.closed ? whole : extent_of(project, top, -along, h);
  const double share = whole.closed ? 0.5 : 1.0, ahead = share * whole.length, back = share * other.length;
  if (!(back + ahead > 0)) return {};
  const double step = (back + ahead) / (num_samples - 1);
  std::vector<PathPoint> points;
  const auto add = [&](double sign, const Extent& extent) {
    const double length = share * extent.length + (extent.ends_with_face ? walk_step * h : 0);
    walk(project, top, sign * along, step, static_cast<int>(length / step), [&](const ContactRow& row, double way) {
      points.push_back({sign * way, row.x});
      return true;
    });
  };
  add(-1, other);
  std::reverse(points.begin(), points.end());
  points.push_back({0, top.x});
  add(1, whole);
  return points;
}

class PathSampler {
 public:
  PathSampler(const SolvedState& state, const FaceProjection& project, Results& results)
      : state_(state), project_(project), results_(results), reference_(state.scene, state.reference) {}

  /// Both bodies of a pair, or of any for pair = -1.
  void add(const std::vector<PathPoint>& points, int pair) {
    const bool by_coordinate = !state_.reference.pressure_file.empty();
    for (int b = 0; b < static_cast<int>(state_.bodies.size()); ++b) {
      if (pair >= 0 && state_.pairs[pair].primary != b && state_.pairs[pair].secondary != b) continue;
      std::vector<std::optional<ContactRow>> rows(points.size());
      parallel_for("cgcontact::pressure_paths::points", points.size(), 8,
                   [&](std::size_t i) { rows[i] = project_(b, pair, points[i].x); });
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!rows[i]) continue;
        PathSample sample;
        sample.body = b;
        sample.pair = std::max(pair, 0);
        sample.x = rows[i]->x;
        sample.s = by_coordinate ? reference_.coordinate(sample.x) : points[i].s;
        sample.pressure_raw = rows[i]->pressure_raw;
        sample.pressure_spr = rows[i]->pressure_spr;
        sample.pressure_sprc = rows[i]->pressure_sprc;
        sample.has_reference = reference_.has_pressure();
        if (sample.has_reference) sample.pressure_reference = reference_.pressure(sample.x);
        results_.path.push_back(sample);
      }
    }
  }

 private:
  const SolvedState& state_;
  const FaceProjection& project_;
  Results& results_;
  const Reference reference_;
};

}  // namespace

FaceProjection::FaceProjection(const SolvedState& state, const Results& results) : state_(state), results_(results) {
  std::vector<double> reach(state.bodies.size(), 0.0);
  for (const ContactRow& row : results.contact_rows)
    reach[row.body] = std::max(reach[row.body], state.bodies[row.body].cut_cells.h(row.cell));
  for (const double r : reach) rows_.emplace_back(r > 0 ? r : 1.0);
  for (std::size_t i = 0; i < results.contact_rows.size(); ++i)
    rows_[results.contact_rows[i].body].add(results.contact_rows[i].x, static_cast<int>(i));
}

std::optional<ContactRow> FaceProjection::operator()(int body, int pair, const Vec3& anywhere) const {
  const BodyModel& model = state_.bodies[body];
  const Grid& grid = model.cut_cells.grid;
  const Vec3 x = grid.in_layer(anywhere);
  const ContactRow* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  rows_[body].each_near(x, [&](int i) {
    const ContactRow& row = results_.contact_rows[i];
    const double distance = (row.x - x).squaredNorm();
    if ((pair >= 0 && row.pair != pair) || distance > least || (distance == least && &row > nearest)) return;
    nearest = &row;
    least = distance;
  });
  if (!nearest || (nearest->x - x).norm() > model.cut_cells.h(nearest->cell)) return std::nullopt;
  const Vec3 g = grid.to_grid(x), row_normal = grid.rotation.transpose() * nearest->normal;
  const Solid& solid = model.cut_cells.solid;
  const Surface surface = solid.surfaces()[solid.surface_at(grid.to_grid(nearest->x), row_normal)].near(g);
  const Vec3 position = g - surface.signed_distance(g) * surface.gradient(g);
  Vec3 n = surface.gradient(position);
  if (n.dot(row_normal) < 0) n = -n;
  const int cell = model.cut_cells.locate(position - 1e-9 * n);
  if (cell < 0) return std::nullopt;
  // A cell that is cut goes on beyond the end of the face, and so does the surface.
  if (!solid.contains(position - below_face * model.cut_cells.size(cell) * n)) return std::nullopt;
  return contact_row(state_, body, nearest->pair, cell, position, grid.rotation * n);
}

void fill_paths(const SolvedState& state, Results& results) {
  if (results.contact_rows.empty()) return;
  const FaceProjection project(state, results);
  PathSampler sampler(state, project, results);
  if (state.scene.output.path) {
    const auto& [from, to] = *state.scene.output.path;
    std::vector<PathPoint> points;
    for (int i = 0; i < num_samples; ++i) {
      const double t = (i + 0.5) / num_samples;
      points.push_back({t * (to - from).norm(), (1 - t) * from + t * to});
    }
    sampler.add(points, -1);
    return;
  }
  results.path_from_largest = true;
  for (int pair = 0; pair < static_cast<int>(results.pairs.size()); ++pair)
    if (const ContactRow* const top = largest_row(results, pair))
      sampler.add(path_points(state, results, project, *top), pair);
}

}  // namespace cgcontact
