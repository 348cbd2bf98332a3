#include "contact/checks/load_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/files/text.hpp"

namespace cgcontact {
namespace {

/// Divisions along each side of a cell: at first, and where these differ from the whole.
constexpr int few_divisions = 2, many_divisions = 8;
/// Fraction of what acts in a cell: a difference that is rounding, or that of a smooth load.
constexpr double no_difference = 1e-6;
/// Fraction of the area of a face in a cell: facets whose divisions do not add up to it are not compared.
constexpr double same_area = 1e-6;

/// Resultants of what acts on a region of a face, and the integral of the magnitudes.
struct Sums {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double magnitude = 0, area = 0;

  void add(const Vec3& x, double weight, const Vec3& traction) {
    force += weight * traction;
    moment += weight * x.cross(traction);
    magnitude += weight * traction.norm();
    area += weight;
  }
  void add(const Sums& other) {
    force += other.force;
    moment += other.moment;
    magnitude += other.magnitude;
    area += other.area;
  }
};

bool is_field(const LoadSpec& load) {
  return !load.pressure.is_constant() ||
         std::any_of(load.traction.begin(), load.traction.end(),
                     [](const Expression& component) { return !component.is_constant(); });
}

/// Returns planes that divide a cell into `divisions` along each of its sides.
std::vector<Plane> planes_in(const CutCells& cells, int cell, int divisions) {
  std::vector<Plane> planes;
  for (int k = 0; k < 3; ++k) {
    if (cells.grid.is_quadtree() && k == cells.grid.plane_strain) continue;
    for (int i = 1; i < divisions; ++i)
      planes.push_back({Vec3::Unit(k), cells.corner(cell)[k] + cells.size(cell) * i / divisions});
  }
  return planes;
}

/// Resultants of a load's expressions on one face, the force and moment of the face as a whole aside.
class LoadOnFace {
 public:
  LoadOnFace(const LoadSpec& load, const BodyModel& body, int order)
      : load_(load), body_(body), face_(load.face.face, body), order_(order) {
    for (const int p : face_.points()) {
      const int cell = body.cut_cells.boundary.cell[p];
      cells_[cell].insert(body.cut_cells.boundary.surface[p]);
      first_ += body.area(p) * body.point(p);
      area_ += body.area(p);
    }
    for (const int p : face_.points())
      used_[body.cut_cells.boundary.cell[p]].add(body.point(p) - first_ / area_, body.area(p),
                                                 traction(body.point(p), body.normal(p)));
  }

  /// With the points of the load vector, and with more of them.
  std::pair<Sums, Sums> compare() const {
    Sums used, finer;
    for (const auto& [cell, surfaces] : cells_) {
      const Sums& here = used_.at(cell);
      used.add(here);
      Sums divided = sums_in(cell, surfaces, few_divisions);
      if (differ(here, divided)) divided = sums_in(cell, surfaces, many_divisions);
      finer.add(std::abs(divided.area - here.area) <= same_area * here.area ? divided : here);
    }
    return {used, finer};
  }

  /// m, of the whole face.
  double size() const { return std::sqrt(area_); }

 private:
  Vec3 traction(const Vec3& x, const Vec3& n) const {
    return Vec3(load_.traction[0](x), load_.traction[1](x), load_.traction[2](x)) - load_.pressure(x) * n;
  }

  static bool differ(const Sums& a, const Sums& b) {
    return (a.force - b.force).norm() > no_difference * a.magnitude ||
           std::abs(a.magnitude - b.magnitude) > no_difference * a.magnitude;
  }

  Sums sums_in(int cell, const std::set<int>& surfaces, int divisions) const {
    const CutCells& cells = body_.cut_cells;
    const Grid& grid = cells.grid;
    BoundaryPoints points;
    boundary_points_of_cell(cells, cell, {surfaces.begin(), surfaces.end()}, planes_in(cells, cell, divisions), order_,
                            points);
    Sums sums;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 n = grid.rotation * points.normal[i];
      const std::vector<std::string>& names = cells.solid.surfaces()[points.surface[i]].names;
      if (!load_.face.face.contains(names, grid.to_global(points.position_of_facet(i)),
                                    grid.rotation * points.normal_of_facet(i)))
        continue;
      const Vec3 x = grid.to_global(points.position[i]);
      sums.add(x - first_ / area_, points.weight[i] * std::pow(grid.cell_size, 2), traction(x, n));
    }
    return sums;
  }

  const LoadSpec& load_;
  const BodyModel& body_;
  BodyFace face_;
  int order_;
  std::map<int, std::set<int>> cells_;  ///< active cell -> surfaces of the face in it
  std::map<int, Sums> used_;            ///< in each of them
  Vec3 first_ = Vec3::Zero();
  double area_ = 0;
};

std::string newtons(const Vec3& force) {
  return fmt::format("({:.5g}, {:.5g}, {:.5g}) N", force[0], force[1], force[2]);
}

/// Empty: nothing is lost. `size`: m, that moments are compared by.
std::string lost_text(const Sums& used, const Sums& finer, double size, double slices, double allowed,
                      const char* finer_points) {
  const double scale = std::max(used.magnitude, finer.magnitude);
  const double force = (used.force - finer.force).norm() / scale;
  const double moment = (used.moment - finer.moment).norm() / (size * scale);
  if (!(std::max(force, moment) > allowed)) return "";
  const std::string what = force >= moment
                               ? fmt::format("its resultant is {} in place of {} with {} points",
                                             newtons(slices * used.force), newtons(slices * finer.force), finer_points)
                               : fmt::format("its moment about the middle is not the one with {} points", finer_points);
  return fmt::format("{}, {} % of what acts; smaller cells, or faces declared where it jumps", what,
                     percent_number(std::max(force, moment)));
}

void check_body_force(const BodyModel& body, double allowed, std::vector<std::string>& warnings) {
  const auto& given = body.spec->body_force;
  if (std::all_of(given.begin(), given.end(), [](const Expression& component) { return component.is_constant(); }))
    return;
  const CutCells& cc = body.cut_cells;
  Sums sums[2];
  const int orders[2] = {5, 3};
  const Vec3 middle = 0.5 * (body.low + body.high);
  double weights[125];
  for (int cell = 0; cell < static_cast<int>(cc.cells.size()); ++cell) {
    const int cut = cc.cut_of_active[cell], level = cc.level(cell);
    const double volume = std::pow(cc.h(cell), 3) * cc.grid.thickness_of_cell(level) / 8;
    for (int k = 0; k < 2; ++k) {
      const int n = orders[k];
      const double* const points = n == 5 ? Gauss5::point : Gauss3::point;
      fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, weights);
      for (int q = 0; q < n * n * n; ++q) {
        const Vec3 x = global_position(cc, cell, {points[q / (n * n)], points[q / n % n], points[q % n]});
        sums[k].add(x - middle, volume * weights[q], Vec3(given[0](x), given[1](x), given[2](x)));
      }
    }
  }
  const std::string text =
      lost_text(sums[0], sums[1], (body.high - body.low).maxCoeff(), body.slices, allowed, "fewer");
  if (!text.empty())
    warnings.push_back(
        fmt::format("body force of \"{}\": its expression changes within cells: {}", body.spec->name, text));
}

}  // namespace

std::vector<std::string> load_resolution_warnings(const Scene& scene, const std::vector<BodyModel>& bodies) {
  std::vector<std::string> warnings;
  for (const LoadSpec& load : scene.loads) {
    if (!is_field(load)) continue;
    const BodyModel& body = bodies[load.face.body];
    const LoadOnFace on_face(load, body, scene.geometry.boundary_order);
    const auto [used, finer] = on_face.compare();
    const std::string text = lost_text(used, finer, on_face.size(), body.slices, scene.results.lost_load, "more");
    if (!text.empty())
      warnings.push_back(fmt::format("load on \"{}.{}\": its expression changes within cells: {}", body.spec->name,
                                     load.face.face.name, text));
  }
  for (const BodyModel& body : bodies) check_body_force(body, scene.results.lost_load, warnings);
  return warnings;
}

}  // namespace cgcontact
