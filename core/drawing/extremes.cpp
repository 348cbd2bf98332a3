#include "core/drawing/extremes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/base/process/packing.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"

namespace cgcontact {

namespace {

/// Fraction of the stress above the error of principal stresses by their closed form (1e-8 where two are nearly equal).
constexpr double closed_form_error = 1e-6;

/// Extremes of values that come one by one.
class Collector {
 public:
  void displacement(const Vec3& x, const Vec3& u) { raise(u.norm(), x, max_.displacement); }
  /// The exact principal stresses, which take iterations, only where they may be more than those before.
  void stress(const Vec3& x, const Sym3& s) {
    const double mises = von_mises(s);
    raise(mises, x, max_.von_mises);
    if (any_stress_ && !may_raise_principal(s, mises)) return;
    const Vec3 principal = principal_stresses(s);
    raise(principal[0] - principal[2], x, max_.tresca);
    if (!any_stress_ || principal[0] > max_.tension.value) max_.tension = {principal[0], x};
    if (!any_stress_ || principal[2] < max_.compression.value) max_.compression = {principal[2], x};
    any_stress_ = true;
  }
  void pressure(const Vec3& x, double p) {
    if (!max_.pressure) max_.pressure = Extreme{0, x};
    raise(p, x, *max_.pressure);
  }

  /// Adds later extremes; of equal values the earlier one stays.
  void merge(const Collector& later) {
    const Extremes& other = later.max_;
    for (Extreme Extremes::*kind : {&Extremes::displacement, &Extremes::von_mises, &Extremes::tresca})
      raise((other.*kind).value, (other.*kind).at, max_.*kind);
    if (later.any_stress_ && (!any_stress_ || other.tension.value > max_.tension.value)) max_.tension = other.tension;
    if (later.any_stress_ && (!any_stress_ || other.compression.value < max_.compression.value))
      max_.compression = other.compression;
    any_stress_ |= later.any_stress_;
  }

  Extremes finish(const Material& material) {
    if (material.yield_stress && max_.von_mises.value > 0)
      max_.safety_factor = *material.yield_stress / max_.von_mises.value;
    return max_;
  }

 private:
  /// With mean stress m and r = 2/3 of the von Mises stress, the principal stresses are m + r cos of three angles, a
  /// third of a turn apart: first bounds for any angle, then those with the angle.
  bool may_raise_principal(const Sym3& s, double mises) const {
    const double mean = (s[0] + s[1] + s[2]) / 3, r = 2.0 / 3.0 * mises;
    const double slack = closed_form_error * (std::abs(mean) + r);
    const auto raises = [&](double tension, double compression) {
      return tension + slack >= max_.tension.value || compression - slack <= max_.compression.value ||
             tension - compression + slack >= max_.tresca.value;
    };
    const double a = s[0] - mean, b = s[1] - mean, c = s[2] - mean;
    const bool bound_raises = mean + r + slack >= max_.tension.value || mean - r - slack <= max_.compression.value ||
                              std::sqrt(3.0) * r + slack >= max_.tresca.value;
    if (!bound_raises || r == 0) return bound_raises;
    const double determinant =
        a * (b * c - s[4] * s[4]) - s[3] * (s[3] * c - s[4] * s[5]) + s[5] * (s[3] * s[4] - b * s[5]);
    const double angle = std::acos(std::clamp(4 * determinant / (r * r * r), -1.0, 1.0)) / 3;
    constexpr double third_of_turn = 2.0943951023931953;
    return raises(mean + r * std::cos(angle), mean + r * std::cos(angle + third_of_turn));
  }

  static void raise(double value, const Vec3& x, Extreme& most) {
    if (value > most.value) most = {value, x};
  }

  Extremes max_;
  bool any_stress_ = false;
};

/// One body with its fields, drawn.
class BodySearch {
 public:
  BodySearch(const Results& results, const DrawnBody& drawn, int body)
      : results_(results), fields_(results.bodies[body]), drawn_(drawn), cells_(*fields_.cut_cells), body_(body) {}

  Extremes whole() const {
    Collector most;
    add_points(
        drawn_, [&](std::size_t p) { return position_in_layer(p); }, drawn_.position.size(), most);
    each_interior_block(drawn_, [&](int first, const PointValues& values) {
      const std::size_t size = std::max(values.displacement.size(), values.stress.size());
      add_points(
          values, [&](std::size_t i) { return interior_position(drawn_, first + i); }, size, most);
    });
    for (const ContactRow& row : results_.contact_rows)
      if (row.body == body_) most.pressure(row.x, row.touching ? row.pressure_sprc : 0);
    return most.finish(fields_.material);
  }

  Extremes on(const FaceSpec& face) const {
    std::vector<char> selected;
    for (const Surface& surface : cells_.solid.surfaces()) selected.push_back(face.selects(surface.names));
    Collector most;
    const std::set<int> points = drawn_points(face, selected);
    for (const int p : points) add_point(drawn_, p, position_in_layer(p), most);
    if (points.empty()) add_boundary(face, selected, most);
    for (const ContactRow& row : results_.contact_rows) {
      if (row.body != body_) continue;
      const int surface =
          cells_.solid.surface_at(cells_.grid.to_grid(row.x), cells_.grid.rotation.transpose() * row.normal);
      if (surface >= 0 && selected[surface] && face.contains(row.x, row.normal))
        most.pressure(row.x, row.touching ? row.pressure_sprc : 0);
    }
    return most.finish(fields_.material);
  }

 private:
  static void add_point(const PointValues& values, std::size_t p, const Vec3& x, Collector& most) {
    if (!values.displacement.empty()) most.displacement(x, values.displacement[p]);
    if (!values.stress.empty()) most.stress(x, values.stress[p]);
  }

  /// Returns the position of a point; in its half-plane for a body of revolution, which is drawn with a thickness.
  Vec3 position_in_layer(std::size_t point) const {
    const Vec3& x = drawn_.position[point];
    return cells_.grid.is_axisymmetric() ? cells_.grid.in_layer(x) : x;
  }
  /// position(i) of the i-th of n points with values.
  template <class Position>
  static void add_points(const PointValues& values, const Position& position, std::size_t n, Collector& most) {
    std::vector<Collector> chunks(num_chunks(n, grain_of_light));
    parallel_chunks("cgcontact::extremes::points", n, grain_of_light,
                    [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      for (std::size_t p = begin; p < end; ++p) add_point(values, p, position(p), chunks[chunk]);
                    });
    for (const Collector& chunk : chunks) most.merge(chunk);
  }

  /// Corners of triangles on a surface of the face, where its box and its normals hold.
  std::set<int> drawn_points(const FaceSpec& face, const std::vector<char>& selected) const {
    std::set<int> points;
    for (const BoundaryTriangle& triangle : drawn_.mesh.boundary) {
      if (triangle.surface < 0 || !selected[triangle.surface]) continue;
      const Vec3 &a = drawn_.position[triangle.points[0]], &b = drawn_.position[triangle.points[1]],
                 &c = drawn_.position[triangle.points[2]];
      const Vec3 n = (b - a).cross(c - a).normalized();
      for (const int p : triangle.points)
        if (face.contains(drawn_.position[p], n)) points.insert(p);
    }
    return points;
  }

  void add_boundary(const FaceSpec& face, const std::vector<char>& selected, Collector& most) const {
    const BoundaryPoints& boundary = cells_.boundary;
    for (std::size_t i = 0; i < boundary.size(); ++i) {
      if (!selected[boundary.surface[i]] || !face.contains(cells_.grid.to_global(boundary.position_of_facet(i)),
                                                           cells_.grid.rotation * boundary.normal_of_facet(i)))
        continue;
      const Vec3 x = cells_.grid.to_global(boundary.position[i]);
      const Vec3 xi = clamped_cell_coordinates(cells_, boundary.cell[i], boundary.position[i]);
      if (fields_.displacement) most.displacement(x, fields_.displacement(boundary.cell[i], xi));
      if (fields_.stress_recovered) most.stress(x, fields_.stress_recovered(boundary.cell[i], xi));
    }
  }

  const Results& results_;
  const BodyFields& fields_;
  const DrawnBody& drawn_;
  const CutCells& cells_;
  const int body_;
};

int body_with(const std::vector<BodyExtremes>& bodies, Extreme Extremes::*kind, double sign) {
  int best = -1;
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b)
    if (best < 0 || sign * (bodies[b].body.*kind).value > sign * (bodies[best].body.*kind).value) best = b;
  return best;
}

BodyExtremes extremes_of_body(const Results& results, const Scene& scene, const DrawnBody& drawn, std::size_t b) {
  const BodySearch search(results, drawn, static_cast<int>(b));
  BodyExtremes extremes{search.whole(), {}};
  if (b < scene.bodies.size())  // not of results that were put together without a scene (tests)
    for (const FaceSpec& face : scene.bodies[b].faces) extremes.faces.emplace_back(face.name, search.on(face));
  return extremes;
}

constexpr Extreme Extremes::*extreme_members[] = {&Extremes::displacement, &Extremes::von_mises, &Extremes::tresca,
                                                  &Extremes::tension, &Extremes::compression};

void pack(const Extreme& extreme, Packing& to) {
  to.put(extreme.value);
  to.put(extreme.at);
}

void pack(const Extremes& extremes, Packing& to) {
  for (const auto kind : extreme_members) pack(extremes.*kind, to);
  to.put(extremes.pressure.has_value());
  if (extremes.pressure) pack(*extremes.pressure, to);
  to.put(extremes.safety_factor.value_or(0));
}

void unpack(Unpacking& from, Extreme& extreme) {
  from.take(extreme.value);
  from.take(extreme.at);
}

void unpack(Unpacking& from, Extremes& extremes) {
  for (const auto kind : extreme_members) unpack(from, extremes.*kind);
  bool has_pressure = false;
  from.take(has_pressure);
  if (has_pressure) unpack(from, extremes.pressure.emplace());
  double safety_factor = 0;
  from.take(safety_factor);
  if (safety_factor > 0) extremes.safety_factor = safety_factor;
}

/// Rank that draws each body: the one with the most cut cells first, always by the rank that has the fewest.
std::vector<int> drawing_ranks(const Results& results) {
  std::vector<std::size_t> order(results.bodies.size()), work(num_ranks(), 0);
  std::iota(order.begin(), order.end(), 0);
  const auto size = [&](std::size_t b) { return results.bodies[b].cut_cells->active_of_cut.size(); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  std::vector<int> ranks(order.size());
  for (const std::size_t b : order) {
    const auto rank = std::min_element(work.begin(), work.end());
    *rank += size(b);
    ranks[b] = static_cast<int>(rank - work.begin());
  }
  return ranks;
}

}  // namespace

std::vector<BodyExtremes> extremes_of(const Results& results, const Scene& scene, const std::vector<DrawnBody>& drawn) {
  std::vector<BodyExtremes> bodies;
  for (std::size_t b = 0; b < drawn.size(); ++b) bodies.push_back(extremes_of_body(results, scene, drawn[b], b));
  return bodies;
}

std::vector<BodyExtremes> extremes_by_ranks(const Results& results, const Scene& scene) {
  const std::vector<int> ranks = drawing_ranks(results);
  Packing own;
  for (std::size_t b = 0; b < ranks.size(); ++b) {
    if (ranks[b] != this_rank()) continue;
    const BodyExtremes extremes = extremes_of_body(results, scene, draw_body(results.bodies[b]), b);
    pack(extremes.body, own);
    for (const auto& [name, of_face] : extremes.faces) pack(of_face, own);
  }
  const std::vector<char> bytes = gather_bytes(own.bytes().data(), own.bytes().size());
  Unpacking all(bytes);
  std::vector<BodyExtremes> bodies(ranks.size());
  for (int rank = 0; rank < num_ranks(); ++rank)
    for (std::size_t b = 0; b < ranks.size(); ++b) {
      if (ranks[b] != rank) continue;
      unpack(all, bodies[b].body);
      for (const FaceSpec& face : scene.bodies[b].faces)
        unpack(all, bodies[b].faces.emplace_back(face.name, Extremes()).second);
    }
  return bodies;
}

int body_with_largest(const std::vector<BodyExtremes>& bodies, Extreme Extremes::*kind) {
  return body_with(bodies, kind, 1);
}
int body_with_smallest(const std::vector<BodyExtremes>& bodies, Extreme Extremes::*kind) {
  return body_with(bodies, kind, -1);
}

}  // namespace cgcontact
