#include "core/output/plot/plot_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/errors/errors.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/base/files/text.hpp"
#include "core/drawing/cut_open.hpp"
#include "core/output/pictures/picture_sheet.hpp"

namespace cgcontact {

namespace {

std::vector<char> chosen_bodies(const Results& known, const std::vector<std::string>& names) {
  std::vector<std::string> there;
  for (const BodyFields& body : known.bodies) there.push_back(body.name);
  std::vector<char> chosen(there.size(), names.empty());
  for (const std::string& name : names) {
    const auto found = std::find(there.begin(), there.end(), name);
    if (found == there.end())
      throw InputError(fmt::format("--body {}: the result has no such body{} (allowed: {})", name,
                                   did_you_mean(name, there), join(there)));
    chosen[found - there.begin()] = true;
  }
  return chosen;
}

/// The pair whose zone is looked at: the one that is named, else the pressed one with the largest force.
int pair_to_look_at(const Results& known, const PlotOptions& options) {
  std::vector<std::string> names;
  int most = -1;
  for (int p = 0; p < static_cast<int>(known.pairs.size()); ++p) {
    names.push_back(known.pairs[p].name);
    if (!options.pair.empty() && names.back() == options.pair) return p;
    const double force = known.pairs[p].force_on_first.norm();
    if (known.pairs[p].max_pressure > 0 && (most < 0 || force > known.pairs[most].force_on_first.norm())) most = p;
  }
  if (!options.pair.empty())
    throw InputError(fmt::format("--zoom contact:{}: the result has no such pair{} (allowed: {})", options.pair,
                                 did_you_mean(options.pair, names), names.empty() ? "none" : join(names)));
  if (most < 0) throw InputError("--zoom contact: the result has no pair that is pressed");
  return most;
}

ContactZoneBox zone_to_look_at(const PlotResult& result, const PlotOptions& options, std::string& name) {
  const int pair = pair_to_look_at(result.known, options);
  name = result.known.pairs[pair].name;
  if (result.known.contact_rows.empty())
    throw InputError(fmt::format("--zoom contact: there is no contact.vtkhdf with a contact in {}", result.directory));
  const std::optional<ContactZoneBox> zone = zone_of_pair(result.known, pair);
  if (!zone) throw InputError(fmt::format("--zoom contact:{}: nothing is pressed there", name));
  return *zone;
}

/// Frames what is around the zone, where the displacements have taken it. What counts is a cube as wide as the square
/// that is seen, corner to corner: a zone is nearly flat, but the largest stress lies below it.
void look_near(const PlotResult& result, const ContactZoneBox& zone, PlotShape& shape) {
  shape.frame = corners_around(zone.box);
  Panel seen;
  seen.camera = shape.camera;
  seen.fit(shape.frame);
  const Vec3 middle = (zone.box.low + zone.box.high) / 2;
  const Vec3 half = Vec3::Constant(std::sqrt(0.5) * seen.side / seen.camera.pixels_per_metre);
  shape.near = SceneBox{middle - half, middle + half};
  Vec3 moved = Vec3::Zero();
  double count = 0;
  for (const DrawnBody& body : result.bodies)
    for (std::size_t p = 0; p < body.displacement.size(); ++p) {
      const Vec3& x = body.position[p];
      if (!shape.counts(x) || !body.displacement[p].allFinite()) continue;
      moved += body.displacement[p];
      ++count;
    }
  if (count > 0)
    for (Vec3& corner : shape.frame) corner += shape.factor / count * moved;
}

void cut_bodies(const PlotResult& result, const PlotOptions::Plane& plane, PlotShape& shape) {
  const Vec3 normal = (plane.axis == 1 ? -1.0 : 1.0) * Vec3::Unit(plane.axis);  // x to the right in all but x = ...
  shape.is_section = true;
  shape.shaded = false;
  look_against(normal, shape.camera);
  SceneBox box;
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    if (shape.is_chosen[b])
      for (const Vec3& x : result.bodies[b].position) box.add(x);
    shape.shown.push_back(
        shape.is_chosen[b] ? section_of(result.bodies[b], plane.value * Vec3::Unit(plane.axis), normal) : DrawnBody());
  }
  const auto meets = [](const DrawnBody& body) { return !body.mesh.boundary.empty(); };
  if (std::any_of(shape.shown.begin(), shape.shown.end(), meets)) return;
  std::array<double, 2> ends{box.low[plane.axis], box.high[plane.axis]};
  const double extent = box.extent().maxCoeff();
  for (double& end : ends)
    if (std::abs(end) < 1e-9 * extent) end = 0;  // rounding
  const DisplayUnit unit = length_unit(std::max(std::abs(ends[0]), std::abs(ends[1])));
  throw InputError(fmt::format("--section {}: the plane meets no body that is drawn (allowed: {} between {} and {} {})",
                               plane.text, "xyz"[plane.axis], short_number(ends[0] * unit.factor),
                               short_number(ends[1] * unit.factor), unit.name));
}

void show_surfaces(const PlotResult& result, const std::optional<ContactZoneBox>& zone, PlotShape& shape) {
  SceneView view = direction_to_scene(result.known, result.bodies);
  if (zone && view.thin_axis < 0)
    view = look_at_zone(result.bodies, view, *zone);
  else
    view.shown = shown_in(view, result.bodies);
  shape.camera = view.camera;
  shape.shaded = view.thin_axis < 0;
  shape.shown = std::move(view.shown);
  for (std::size_t b = 0; b < shape.shown.size(); ++b)
    if (!shape.is_chosen[b]) shape.shown[b] = DrawnBody();
}

}  // namespace

PlotShape shape_to_plot(const PlotResult& result, const PlotOptions& options) {
  PlotShape shape;
  shape.is_chosen = chosen_bodies(result.known, options.bodies);
  shape.factor = options.deformed.value_or(options.section ? 0 : 1);
  std::optional<ContactZoneBox> zone;
  if (options.zoom) zone = zone_to_look_at(result, options, shape.pair);
  if (options.section)
    cut_bodies(result, *options.section, shape);
  else
    show_surfaces(result, zone, shape);
  if (zone) {
    look_near(result, *zone, shape);
    return shape;
  }
  for (const DrawnBody& body : shape.shown)
    for (int p = 0; p < static_cast<int>(body.position.size()); ++p)
      if (const Vec3 x = shape.drawn(body, p); x.allFinite()) shape.frame.push_back(x);
  return shape;
}

}  // namespace cgcontact
