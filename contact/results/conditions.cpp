#include "contact/results/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/text.hpp"

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

LoadFigures load_figures(const SolvedState& state, int number, double factor) {
  const LoadSpec& load = state.scene.loads[number];
  const BodyModel& body = state.bodies[load.face.body];
  const BodyFace face(load.face.face, body);
  const LinearTraction resultant = resultant_of(body, number);
  LoadFigures figures;
  figures.face = body.spec->name + "." + load.face.face.name;
  Values pressure;
  Values traction[3];
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    if (!face.contains(p)) continue;
    const Vec3 x = body.point(p), n = body.normal(p);
    const double normal = factor * load.pressure(x);
    const Vec3 t = factor * (Vec3(load.traction[0](x), load.traction[1](x), load.traction[2](x)) + resultant.at(x));
    pressure.add(normal);
    for (int k = 0; k < 3; ++k) traction[k].add(t[k]);
    figures.area += body.area(p);
    figures.force += body.area(p) * (t - normal * n);
  }
  const auto add = [&](const std::string& name, const Values& values) {
    if (!values.any() || largest(values) == 0) return;
    figures.condition += fmt::format("{}{} {}", figures.condition.empty() ? "" : ", ", name,
                                     range_text(values, stress_unit(largest(values))));
  };
  add("pressure", pressure);
  static const char* const names[] = {"traction x", "traction y", "traction z"};
  for (int k = 0; k < 3; ++k) add(names[k], traction[k]);
  if (figures.condition.empty()) figures.condition = "zero";
  return figures;
}

/// Body forces are what of the load on a body its faces do not carry.
void add_body_forces(const SolvedState& state, Results& results) {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const BodySpec& body = *state.bodies[b].spec;
    if (!has_body_force(body)) continue;
    const CutCells& cells = state.bodies[b].cut_cells;
    LoadFigures figures{body.name, "body force", state.outer.load_of_body[b],
                        volume(cells) * std::pow(cells.grid.cell_size, 3), true};
    for (std::size_t l = 0; l < state.scene.loads.size(); ++l)
      if (state.scene.loads[l].face.body == static_cast<int>(b)) figures.force -= results.loads[l].force;
    results.loads.push_back(figures);
  }
}

std::string condition_of(const SolvedState& state, int support) {
  const SupportSpec& spec = state.scene.supports[support];
  if (spec.by_plane_strain) return "plane strain";
  if (spec.symmetry) return "symmetry";
  Values normal, axes[3];
  for (const SupportPoint& point : state.supports) {
    if (point.support != support) continue;
    int axis = -1;
    for (int k = 0; k < 3; ++k)
      if (spec.displacement[k] && point.direction == Vec3(Vec3::Unit(k))) axis = k;
    const bool along_normal = spec.normal_displacement && (axis < 0 || point.direction == point.normal);
    (along_normal ? normal : axes[std::max(axis, 0)]).add(point.value);
  }
  std::string text;
  const auto add = [&](const char* name, const Values& values) {
    if (values.any())
      text +=
          fmt::format("{}{} = {}", text.empty() ? "" : ", ", name, range_text(values, length_unit(largest(values))));
  };
  add("x", axes[0]);
  add("y", axes[1]);
  add("z", axes[2]);
  add("normal", normal);
  return text;
}

double area_of(const SolvedState& state, const FaceRef& reference, bool is_end) {
  const BodyModel& body = state.bodies[reference.body];
  const BodyFace face(reference.face, body);
  double area = 0;
  if (body.spec->quadtree && is_end)
    for (int cell = 0; cell < static_cast<int>(body.cut_cells.cells.size()); ++cell)
      area += body.cut_cells.volume_fraction(cell) * std::pow(body.cut_cells.h(cell), 2);
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p)
    if (face.contains(p)) area += body.area(p);
  return area;
}

}  // namespace

void fill_conditions(const SolvedState& state, Results& results) {
  const double factor = state.scene.steps.empty() ? 1 : state.scene.steps.back().loads;
  for (std::size_t l = 0; l < state.scene.loads.size(); ++l)
    results.loads.push_back(load_figures(state, static_cast<int>(l), factor));
  add_body_forces(state, results);
  for (std::size_t s = 0; s < results.supports.size(); ++s) {
    results.supports[s].condition = condition_of(state, static_cast<int>(s));
    results.supports[s].area = area_of(state, state.scene.supports[s].face, state.scene.supports[s].by_plane_strain);
  }
  for (std::size_t k = 0; k < results.pairs.size(); ++k) results.pairs[k].interference = state.pairs[k].interference;
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    std::vector<int> contacts = state.bodies[b].boundary.pair_of_point;
    for (int& contact : contacts)
      if (contact >= 0) contact = static_cast<int>(state.pairs[contact].spec - state.scene.contacts.data());
    results.bodies[b].contact_of_point = std::move(contacts);
  }
}

}  // namespace cgcontact
