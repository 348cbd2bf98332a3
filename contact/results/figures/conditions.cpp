#include "contact/results/figures/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/model/around_axis.hpp"
#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Smallest and largest value that a condition takes on its face.
struct Values {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool any() const { return low <= high; }
};

/// "5 .. 10 MPa", "0".
std::string range_text(const Values& values, const DisplayUnit& unit) {
  if (values.low == 0 && values.high == 0) return "0";
  const std::string high = short_number(values.high * unit.factor) + " " + unit.name;
  const double spread = values.high - values.low, size = std::max(std::abs(values.low), std::abs(values.high));
  return spread <= 1e-6 * size ? high : short_number(values.low * unit.factor) + " .. " + high;
}

double largest(const Values& values) { return std::max(std::abs(values.low), std::abs(values.high)); }

/// "force 500 N, moment 20 N m" of what is given for the whole face.
std::string resultants_text(const LoadSpec& load, double factor) {
  std::string text;
  if (!load.force.isZero(0))
    text = fmt::format("{} {}", load.bearing ? "bearing force" : "force", scaled(factor * load.force.norm(), "N"));
  if (!load.moment.isZero(0))
    text += fmt::format("{}moment {}", text.empty() ? "" : ", ", scaled(factor * load.moment.norm(), "N m"));
  return text;
}

/// Sets components of force, moment and position that are rounding to 0.
void leave_out_rounding(LoadFigures& load) {
  const double size = load.of_body ? std::cbrt(load.area) : std::sqrt(load.area), force = load.force.norm();
  const auto leave_out = [&](Vec3& v, double scale) { v = without_rounding(v, std::max(v.norm(), scale)); };
  leave_out(load.force, force);
  leave_out(load.moment, size * force);
  leave_out(load.about, size);
}

LoadFigures load_figures(const Scene& scene, const std::vector<BodyModel>& bodies, int number) {
  const LoadSpec& load = scene.loads[number];
  const double factor = scene.last_step().of(load);
  const BodyModel& body = bodies[load.face.body];
  const FaceTraction resultant = resultant_of(body, number);
  LoadFigures figures;
  figures.face = body.spec->name + "." + load.face.face.name;
  Values pressure;
  Values traction[3];
  Vec3 first = Vec3::Zero(), moment = Vec3::Zero();  // about the origin
  for (const int p : BodyFace(load.face.face, body).points()) {
    const Vec3 x = body.point(p), n = body.normal(p);
    pressure.add(factor * load.pressure(x));
    for (int k = 0; k < 3; ++k) traction[k].add(factor * load.traction[k](x));
    const double area = body.slices * body.area(p);
    const Vec3 force = area * factor * load.traction_at(x, n, resultant);
    figures.area += area;
    first += area * x;
    figures.force += force;
    moment += x.cross(force);
  }
  sum_around_axis(*body.spec, first);
  sum_around_axis(*body.spec, figures.force, &moment);
  figures.about = load.at.value_or(first / figures.area);
  figures.moment = moment - figures.about.cross(figures.force);
  sum_around_axis(*body.spec, figures.force, &figures.moment);
  figures.condition = resultants_text(load, factor);
  const auto add = [&](const std::string& name, const Values& values) {
    if (!values.any() || largest(values) == 0) return;
    figures.condition += fmt::format("{}{} {}", figures.condition.empty() ? "" : ", ", name,
                                     range_text(values, stress_unit(largest(values))));
  };
  add("pressure", pressure);
  static const char* const names[] = {"traction x", "traction y", "traction z"};
  for (int k = 0; k < 3; ++k) add(names[k], traction[k]);
  if (figures.condition.empty()) figures.condition = "zero";
  leave_out_rounding(figures);
  return figures;
}

/// Adds the loads on the volume of a body; the moments are about its centroid.
void add_volume_loads(const BodyModel& body, double factor, std::vector<LoadFigures>& all) {
  const BodySpec& spec = *body.spec;
  const auto is_zero = [](const Expression& component) { return component.is_zero(); };
  const bool has_force = !std::all_of(spec.body_force.begin(), spec.body_force.end(), is_zero);
  if (!has_force && !spec.inertia.any() && spec.temperature == 0) return;
  const CutCells& cells = body.cut_cells;
  LoadFigures figures;
  figures.face = spec.name;
  figures.of_body = true;
  figures.area = body.slices * volume(cells) * std::pow(cells.grid.cell_size, 3);
  const auto position = [](const Vec3& x) { return x; };
  figures.about = resultants_of_volume(body, position, Vec3::Zero()).first / figures.area;
  const auto add = [&](const std::string& condition, const std::function<Vec3(const Vec3&)>& force) {
    figures.condition = condition;
    std::tie(figures.force, figures.moment) = resultants_of_volume(
        body, [&](const Vec3& x) { return Vec3(factor * force(x)); }, figures.about);
    all.push_back(figures);
    leave_out_rounding(all.back());
  };
  if (has_force)
    add("body force",
        [&](const Vec3& x) { return Vec3(spec.body_force[0](x), spec.body_force[1](x), spec.body_force[2](x)); });
  if (!spec.inertia.weight.isZero(0)) add("gravity", [&](const Vec3&) { return spec.inertia.weight; });
  if (spec.inertia.spin != 0)
    add("rotation", [&](const Vec3& x) { return Vec3(spec.inertia.force(x) - spec.inertia.weight); });
  if (spec.temperature != 0)
    add(fmt::format("temperature {:+.4g} K, free strain {:.4g}", factor * spec.temperature,
                    factor * spec.temperature * spec.material.expansion.value_or(0)),
        [](const Vec3&) { return Vec3(Vec3::Zero()); });
}

/// "z = 0", "springs 1e+09 Pa/m".
std::string condition_of(const SolvedState& state, int support) {
  const SupportSpec& spec = state.scene.supports[support];
  if (spec.implied) return spec.face.face.normal_cone ? "plane strain" : "axis of revolution";
  if (spec.symmetry) return "symmetry";
  Values prescribed[num_held], springs[num_held];
  for (const SupportPoint& point : state.supports) {
    if (point.support != support) continue;
    const int k = static_cast<int>(point.component);
    if (point.spring > 0)
      springs[k].add(point.spring);
    else
      prescribed[k].add(point.value);
  }
  std::string text;
  const auto add = [&](const std::string& phrase) { text += (text.empty() ? "" : ", ") + phrase; };
  for (int k = 0; k < num_held; ++k) {
    const char* const name = name_of(static_cast<Held>(k));
    if (prescribed[k].any())
      add(fmt::format("{} = {}", name, range_text(prescribed[k], length_unit(largest(prescribed[k])))));
    if (springs[k].any()) add(fmt::format("springs along {} {:.4g} N/m^3", name, springs[k].high));
  }
  return text;
}

double area_of(const SolvedState& state, const FaceRef& reference, bool is_end) {
  const BodyModel& body = state.bodies[reference.body];
  if (is_end && body.spec->axisymmetric()) return 0;  // its axis
  double area = 0;
  if (body.spec->quadtree && is_end)
    for (int cell = 0; cell < static_cast<int>(body.cut_cells.cells.size()); ++cell)
      area += body.cut_cells.volume_fraction(cell) * std::pow(body.cut_cells.h(cell), 2);
  for (const int p : BodyFace(reference.face, body).points()) area += body.area(p);
  return area;
}

}  // namespace

std::vector<LoadFigures> load_figures(const Scene& scene, const std::vector<BodyModel>& bodies) {
  std::vector<LoadFigures> all;
  for (std::size_t l = 0; l < scene.loads.size(); ++l) all.push_back(load_figures(scene, bodies, static_cast<int>(l)));
  for (const BodyModel& body : bodies) add_volume_loads(body, scene.last_step().loads, all);
  return all;
}

void fill_conditions(const SolvedState& state, Results& results) {
  for (std::size_t s = 0; s < results.supports.size(); ++s) {
    results.supports[s].condition = condition_of(state, static_cast<int>(s));
    results.supports[s].area = area_of(state, state.scene.supports[s].face, state.scene.supports[s].implied);
  }
  for (std::size_t k = 0; k < results.pairs.size(); ++k) {
    results.pairs[k].interference = state.pairs[k].interference;
    results.pairs[k].preload = state.pairs[k].spec->preload;
  }
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    std::vector<int> contacts = state.bodies[b].boundary.pair_of_point;
    for (int& contact : contacts)
      if (contact >= 0) contact = static_cast<int>(state.pairs[contact].spec - state.scene.contacts.data());
    results.bodies[b].contact_of_point = std::move(contacts);
  }
}

}  // namespace cgcontact
