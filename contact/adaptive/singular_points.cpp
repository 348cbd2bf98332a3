#include "contact/adaptive/singular_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace cgcontact {
namespace {

/// Cells: radius of the ball whose mean stress is followed from solve to solve.
constexpr double ball = 1.5;
/// Ratio of successive ball radii on the last grid; their number.
constexpr double radius_factor = 1.6;
constexpr int radii = 5;
/// Positions no farther apart than this, in cells or as a fraction of the body's longest side, are one.
constexpr double apart_cells = 8, apart_part = 1.0 / 12;
/// Number of candidates per body, those with the largest errors.
constexpr int max_candidates_of_body = 16;
/// Cells of less volume than that (of a whole one) are no candidates: their density is rounding.
constexpr double min_volume = 0.1;
/// Least values at a singular position (error: of the energy norm in the ball). Measured: notches, clamped edges, rims
/// and corners of punches: error 0.3 to 0.7, fall 0.23 to 0.7, growth 0.2 to 0.7. Edges of smooth contact zones: error
/// up to 0.3, fall -0.3 to 0.02; beneath contact and in holes: error up to 0.13, fall up to 0.22.
constexpr double min_ball_error = 0.25, min_fall = 0.15, min_growth = 0.15;
/// Cells, of the last solve's there: solves with larger ones say nothing of the exponent.
constexpr double max_cell_ratio = 40;
/// Least refinement of the cells there.
constexpr double min_refinement = 2;
/// Largest ratio of cells to those of the last solve for the final growth rate: where an edge lies in its cells changes
/// the measure by up to 1.3.
constexpr double end_refinement = 2.5;

/// Cosine of the angle by which a surface may turn in the ball: 30 degrees in three cells, a radius of six cells.
constexpr double min_turning_cosine = 0.87;

struct Ball {
  double energy = 0, error = 0, volume = 0;
  double stress() const { return volume > 0 ? std::sqrt(energy / volume) : 0; }  // times sqrt(E)
  double relative_error() const { return energy > 0 ? std::sqrt(error / energy) : 0; }
};

Ball ball_at(const CellEnergies& cells, const Vec3& x, double radius) {
  Ball sum;
  for (std::size_t c = 0; c < cells.x.size(); ++c) {
    if ((cells.x[c] - x).squaredNorm() > radius * radius) continue;
    sum.energy += cells.energy[c];
    sum.error += cells.error[c];
    sum.volume += cells.volume[c];
  }
  return sum;
}

/// Size of the cell whose middle is nearest.
double cell_at(const CellEnergies& cells, const Vec3& x) {
  double nearest = 1e300, h = 0;
  for (std::size_t c = 0; c < cells.x.size(); ++c)
    if (const double d = (cells.x[c] - x).squaredNorm(); d < nearest) {
      nearest = d;
      h = cells.h[c];
    }
  return h;
}

/// Slope of the line through the points by least squares.
double slope(const std::vector<std::pair<double, double>>& points) {
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (const auto& [x, y] : points) mx += x / points.size(), my += y / points.size();
  for (const auto& [x, y] : points) xx += (x - mx) * (x - mx), xy += (x - mx) * (y - my);
  return xx > 0 ? xy / xx : 0;
}

std::vector<std::size_t> candidates(const CellEnergies& cells) {
  std::vector<std::size_t> order(cells.x.size());
  std::iota(order.begin(), order.end(), 0);
  const auto density = [&](std::size_t c) {
    return cells.fraction[c] < min_volume ? 0 : cells.error[c] / cells.volume[c];
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return density(a) > density(b); });
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const Vec3& x : cells.x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double side = (high - low).maxCoeff();
  std::vector<std::size_t> found;
  for (const std::size_t c : order) {
    const bool is_new = std::none_of(found.begin(), found.end(), [&](std::size_t f) {
      return (cells.x[f] - cells.x[c]).norm() <
             std::max(apart_cells * std::max(cells.h[f], cells.h[c]), apart_part * side);
    });
    if (is_new) found.push_back(c);
    if (found.size() == max_candidates_of_body) break;
  }
  return found;
}

/// Growth from solve to solve, and the largest cells between which the end of it is seen.
struct Growth {
  double exponent, cell;
};

/// None: it does not grow enough, or not to the end.
std::optional<Growth> growth_at(const std::vector<std::vector<CellEnergies>>& solves, std::size_t body, const Vec3& x) {
  std::vector<std::pair<double, double>> points;  // logarithms of cell and stress
  double last = 0;
  for (auto solve = solves.rbegin(); solve != solves.rend(); ++solve) {
    const CellEnergies& cells = (*solve)[body];
    const double h = cell_at(cells, x), stress = ball_at(cells, x, ball * h).stress();
    if (last == 0) last = h;
    if (h > max_cell_ratio * last && points.size() > 1) break;
    if (stress > 0) points.emplace_back(std::log(h), std::log(stress));
  }
  if (points.size() < 2 || points.back().first - points.front().first < std::log(min_refinement)) return std::nullopt;
  const double growth = -slope(points);
  auto coarser = std::find_if(points.begin(), points.end(), [&](const auto& point) {
    return point.first > points.front().first + std::log(end_refinement);
  });
  if (coarser == points.end()) --coarser;
  const double at_the_end = -slope({points.front(), *coarser});
  if (std::min(growth, at_the_end) < min_growth) return std::nullopt;
  return Growth{growth, std::exp(coarser->first)};
}

/// Exponent of the fall with the distance on one grid.
double fall_exponent(const CellEnergies& cells, const Vec3& x, double h) {
  std::vector<std::pair<double, double>> points;
  for (int k = 0; k < radii; ++k) {
    const double radius = ball * h * std::pow(radius_factor, k);
    points.emplace_back(std::log(radius), std::log(std::max(ball_at(cells, x, radius).stress(), 1e-300)));
  }
  return -slope(points);
}

/// Names the supports, loads and shapes that have points in the ball.
std::vector<std::string> faces_near(const SolvedState& state, std::size_t b, const Vec3& x, double radius) {
  const BodyModel& body = state.bodies[b];
  std::vector<int> points;
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p)
    if ((body.point(p) - x).norm() <= radius) points.push_back(p);
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  const auto add_face = [&](const FaceRef& reference) {
    if (reference.body != static_cast<int>(b)) return;
    const BodyFace face(reference.face, body);
    if (std::any_of(points.begin(), points.end(), [&](int p) { return face.contains(p); })) add(reference.face.name);
  };
  for (const SupportSpec& support : state.scene.supports) add_face(support.face);
  for (const LoadSpec& load : state.scene.loads) add_face(load.face);
  for (const int p : points)
    if (!body.surface_names(p).empty()) add(body.surface_names(p).back());
  std::sort(names.begin(), names.end());
  return names;
}

/// Returns whether one surface turns so much within the ball that cells of that size do not see its curvature. A fillet
/// looks to them like the notch that it rounds off, and the stress grows from solve to solve until they see it.
bool has_unseen_fillet(const BodyModel& body, const Vec3& x, double radius) {
  const BoundaryPoints& boundary = body.cut_cells.boundary;
  std::map<int, std::vector<Vec3>> normals;  // of each surface
  for (int p = 0; p < static_cast<int>(boundary.size()); ++p)
    if ((body.point(p) - x).norm() <= radius) normals[boundary.surface[p]].push_back(boundary.normal[p]);
  const auto farthest = [](const std::vector<Vec3>& all, const Vec3& from) {
    return *std::min_element(all.begin(), all.end(),
                             [&](const Vec3& a, const Vec3& b) { return a.dot(from) < b.dot(from); });
  };
  return std::any_of(normals.begin(), normals.end(), [&](const auto& surface) {
    const Vec3 end = farthest(surface.second, surface.second.front());
    return farthest(surface.second, end).dot(end) < min_turning_cosine;
  });
}

/// Without the ends of singular edges, where further faces meet them.
std::vector<SingularPoint> without_ends(const std::vector<SingularPoint>& points) {
  std::vector<SingularPoint> kept;
  for (const SingularPoint& point : points) {
    const bool is_end = std::any_of(points.begin(), points.end(), [&](const SingularPoint& edge) {
      return edge.body == point.body && edge.faces.size() < point.faces.size() && !edge.faces.empty() &&
             std::includes(point.faces.begin(), point.faces.end(), edge.faces.begin(), edge.faces.end());
    });
    if (!is_end) kept.push_back(point);
  }
  return kept;
}

}  // namespace

std::vector<CellEnergies> cell_energies(const Results& results) {
  std::vector<CellEnergies> all;
  for (const BodyFields& body : results.bodies) {
    CellEnergies& cells = all.emplace_back();
    cells.energy = body.energy_of_cell;
    for (int c = 0; c < static_cast<int>(body.error_of_cell.size()); ++c) {
      const double h = body.cut_cells->h(c);
      cells.x.push_back(global_position(*body.cut_cells, c, Vec3::Zero()));
      cells.h.push_back(h);
      cells.fraction.push_back(body.cut_cells->volume_fraction(c));
      // Figures of a quadtree are those of the whole thickness, whatever the slice.
      cells.volume.push_back(cells.fraction.back() * std::pow(h, body.cut_cells->grid.is_quadtree() ? 2 : 3));
      cells.error.push_back(body.error_of_cell[c] * body.error_of_cell[c]);
    }
  }
  return all;
}

std::vector<SingularPoint> singular_points(const SolvedState& state,
                                           const std::vector<std::vector<CellEnergies>>& solves) {
  std::vector<SingularPoint> points;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    if (state.bodies[b].spec->rigid()) continue;
    const CellEnergies& last = solves.back()[b];
    for (const std::size_t c : candidates(last)) {
      SingularPoint point;
      point.x = last.x[c];
      point.cell = last.h[c];
      if (ball_at(last, point.x, ball * point.cell).relative_error() < min_ball_error) continue;
      if (fall_exponent(last, point.x, point.cell) < min_fall) continue;
      const auto growth = growth_at(solves, b, point.x);
      if (!growth || has_unseen_fillet(state.bodies[b], point.x, ball * growth->cell)) continue;
      point.exponent = growth->exponent;
      point.body = state.bodies[b].spec->name;
      point.faces = faces_near(state, b, point.x, ball * point.cell);
      const bool is_new = std::none_of(points.begin(), points.end(), [&](const SingularPoint& other) {
        return other.body == point.body && other.faces == point.faces;
      });
      if (is_new) points.push_back(point);
    }
  }
  return without_ends(points);
}

std::string describe(const SingularPoint& point) {
  const Vec3& x = point.x;
  std::string faces;
  for (const std::string& face : point.faces) faces += fmt::format("{}\"{}\"", faces.empty() ? "" : ", ", face);
  return fmt::format(
      "body \"{}\": the stress at ({:.4g}, {:.4g}, {:.4g}) m{} has no finite value: from solve to solve it grows like "
      "h^-{:.2f} (cells of {:.2g} m now); a fillet, or a load or support that does not end there, would make it finite",
      point.body, x[0], x[1], x[2], faces.empty() ? "" : " (faces " + faces + ")", point.exponent, point.cell);
}

}  // namespace cgcontact
