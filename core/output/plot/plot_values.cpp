#include "core/output/plot/plot_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

/// Fraction of the corners beyond each end of the colours, as in scene.png.
constexpr double beyond_colours = 0.005;

void add_extreme(const PlotExtreme& candidate, PlotValues& values) {
  if (!std::isfinite(candidate.value)) return;
  if (values.largest.body < 0 || candidate.value > values.largest.value) values.largest = candidate;
  if (values.smallest.body < 0 || candidate.value < values.smallest.value) values.smallest = candidate;
}

/// The mean of some points of a body, with a value.
template <class Points>
PlotExtreme mean_of(const Points& points, int num_points, double value, int body, const DrawnBody& drawn,
                    const PlotShape& shape) {
  PlotExtreme mean{value, Vec3::Zero(), Vec3::Zero(), body};
  for (int v = 0; v < num_points; ++v) {
    mean.at += drawn.position[points[v]] / num_points;
    mean.drawn += shape.drawn(drawn, points[v]) / num_points;
  }
  return mean;
}

/// Finds the extremes in points of a body: all of them, or those of a section.
void add_points(const std::vector<double>& of_points, const DrawnBody& drawn, int body, const PlotShape& shape,
                PlotValues& values) {
  for (std::size_t p = 0; p < of_points.size(); ++p)
    if (shape.counts(drawn.position[p]))
      add_extreme({of_points[p], drawn.position[p], shape.drawn(drawn, static_cast<int>(p)), body}, values);
}

void add_cells(const std::vector<double>& of_cells, const DrawnBody& whole, const DrawnBody& shown, int body,
               const PlotShape& shape, PlotValues& values) {
  const auto add = [&](const PlotExtreme& candidate) {
    if (shape.counts(candidate.at)) add_extreme(candidate, values);
  };
  if (shape.is_section) {
    for (const BoundaryTriangle& t : shown.mesh.boundary)
      add(mean_of(t.points, 3, of_cells[t.cell], body, shown, shape));
    return;
  }
  for (std::size_t i = 0; i < whole.mesh.num_polyhedra(); ++i) {
    const ClippedMesh::Polyhedron p = whole.mesh.polyhedron(i);
    add(mean_of(p.points, p.num_points, of_cells[p.cell], body, whole, shape));
  }
}

void set_colours(const PlotField& field, const PlotShape& shape, PlotValues& values) {
  values.low = values.smallest.value;
  values.high = values.largest.value;
  if (shape.is_section) return;
  std::vector<double> seen;
  for (std::size_t b = 0; b < shape.shown.size(); ++b)
    for (const BoundaryTriangle& triangle : shape.shown[b].mesh.boundary)
      for (int v = 0; v < 3; ++v)
        if (const double value = values.at(b, triangle, v);
            std::isfinite(value) && shape.counts(shape.shown[b].position[triangle.points[v]]))
          seen.push_back(value);
  const auto quantile = [&](double fraction) {
    const auto nth = seen.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(seen.size() - 1));
    std::nth_element(seen.begin(), nth, seen.end());
    return *nth;
  };
  if (!field.can_be_negative()) values.low = 0;
  if (seen.empty()) return;
  values.high = quantile(1 - beyond_colours);
  if (field.can_be_negative()) values.low = quantile(beyond_colours);
}

void take_ends(const PlotField& field, const PlotOptions::Ends& ends, PlotValues& values) {
  const bool has_unit = field.unit == "m" || field.unit == "Pa";
  const std::string allowed = has_unit ? "LOW:HIGH with units: " + units_of(unit_named(field.unit).dimension)
                                       : "numbers without a unit, in " + field.unit;
  const auto refuse = [&](const std::string& problem) {
    throw InputError(fmt::format("--range: \"{}\" {} (allowed for {}: {})", ends.text, problem, field.name, allowed));
  };
  double* const found[] = {&values.low, &values.high};
  for (int k = 0; k < 2; ++k) {
    const Quantity& quantity = ends.values[k];
    if (has_unit && !quantity.has_units && quantity.value != 0) refuse("has no unit");
    if (!has_unit && quantity.has_units) refuse("has a unit");
    const SourceLocation option{"", 0, "--range"};
    *found[k] = has_unit ? value_in(unit_named(field.unit), quantity, option, ends.text, "LOW:HIGH") : quantity.value;
  }
}

}  // namespace

PlotValues values_to_plot(const PlotField& field, const PlotResult& result, const PlotShape& shape,
                          const VtkArrays& file, const std::optional<PlotOptions::Ends>& ends) {
  PlotValues values;
  values.of_cells = values_in_cells(field, result, file);
  for (std::size_t b = 0; b < shape.shown.size(); ++b) {
    const int body = static_cast<int>(b);
    const DrawnBody &shown = shape.shown[b], &whole = result.bodies[b];
    values.of_points.push_back(values_at_points(field, shown));
    if (!shape.is_chosen[b]) continue;
    if (field.in_cells())
      add_cells(values.of_cells[b], whole, shown, body, shape, values);
    else if (shape.is_section)
      add_points(values.of_points[b], shown, body, shape, values);
    else
      add_points(values_at_points(field, whole), whole, body, shape, values);
  }
  for (PlotExtreme* extreme : {&values.largest, &values.smallest})  // as report.json tells places
    if (extreme->body >= 0 && result.grids[extreme->body].grid.is_axisymmetric())
      extreme->at = result.grids[extreme->body].grid.in_layer(extreme->at);
  if (values.largest.body < 0)
    throw InputError(fmt::format("{}: {} has no value in what is to be drawn", file.file(), field.name));
  if (ends)
    take_ends(field, *ends, values);
  else
    set_colours(field, shape, values);
  if (!(values.high > values.low))
    values.high = values.low + std::max(1e-9 * std::abs(values.low), 1e-300);  // one value everywhere
  return values;
}

}  // namespace cgcontact
