#include "contact/results/figures/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/results/figures/pressure_paths.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

/// Fraction of a cell: a point nearer to a contact face lies on it.
constexpr double on_face_distance = 1e-3;

class Prober {
 public:
  Prober(const SolvedState& state, const FaceProjection& project, const ProbeSpec& probe)
      : state_(state), project_(project), probe_(probe) {}

  /// Values in one body; none if it does not hold the point.
  std::optional<ProbeSample> sample(int body, int point) const {
    const Vec3& x = probe_.points[point];
    const std::optional<CellPoint> cell_point = find_cell_point(state_.bodies[body], x);
    if (!cell_point) return std::nullopt;
    ProbeSample sample = at(body, *cell_point, x);
    sample.point = point;
    sample.way = probe_.way[point];
    if (asks_pressure()) set_pressure(contact_pressure(body, x), sample);
    return sample;
  }

  /// At a boundary point of the face's body.
  ProbeSample on_boundary(int body, int boundary_point) const {
    const BodyModel& model = state_.bodies[body];
    const Vec3 x = model.point(boundary_point);
    ProbeSample sample = at(body, cell_point_of(model, boundary_point), x);
    sample.weight = model.slices * model.area(boundary_point);
    if (asks_pressure()) set_pressure(contact_pressure(body, x), sample);
    return sample;
  }

 private:
  bool asks_pressure() const {
    return std::find(probe_.fields.begin(), probe_.fields.end(), ScalarField::pressure) != probe_.fields.end();
  }

  ProbeSample at(int body, const CellPoint& cell_point, const Vec3& x) const {
    const Vec3 u = displacement(state_, body, cell_point.cell, cell_point.xi);
    const Sym3 stress = recovered_stress(state_, state_.sprc[body], body, cell_point.cell, cell_point.xi);
    ProbeSample sample;
    sample.body = body;
    sample.x = x;
    for (const ScalarField field : probe_.fields) sample.values.push_back(value_of(field, u, stress));
    return sample;
  }

  double contact_pressure(int body, const Vec3& x) const {
    const auto row = project_(body, -1, x);
    const CutCells& cells = state_.bodies[body].cut_cells;
    const bool there = row && (row->x - cells.grid.in_layer(x)).norm() < on_face_distance * cells.h(row->cell);
    return there ? row->pressure_sprc : std::numeric_limits<double>::quiet_NaN();
  }

  void set_pressure(double pressure, ProbeSample& sample) const {
    for (std::size_t f = 0; f < probe_.fields.size(); ++f)
      if (probe_.fields[f] == ScalarField::pressure) sample.values[f] = pressure;
  }

  const SolvedState& state_;
  const FaceProjection& project_;
  const ProbeSpec& probe_;
};

ProbeFigures figures_of(const SolvedState& state, const FaceProjection& project, const ProbeSpec& probe) {
  ProbeFigures figures;
  figures.name = probe.name;
  figures.kind = probe.kind;
  figures.fields = probe.fields;
  figures.points = probe.points.size();
  const Prober prober(state, project, probe);
  if (probe.kind == ProbeSpec::Kind::face) {
    const BodyModel& body = state.bodies[probe.body];
    const std::vector<int> points = BodyFace(probe.face.face, body).points();
    figures.points = points.size();
    figures.samples.resize(points.size());
    parallel_for("cgcontact::probes::face", points.size(), 16, [&](std::size_t i) {
      figures.samples[i] = prober.on_boundary(probe.body, points[i]);
      figures.samples[i].point = static_cast<int>(i);
    });
    return figures;
  }
  std::vector<std::vector<ProbeSample>> found(probe.points.size());
  parallel_for("cgcontact::probes::points", found.size(), 16, [&](std::size_t i) {
    for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b)
      if (probe.body < 0 || probe.body == b)
        if (auto sample = prober.sample(b, static_cast<int>(i))) found[i].push_back(std::move(*sample));
  });
  for (auto& samples : found) {
    figures.outside += samples.empty();
    for (ProbeSample& sample : samples) figures.samples.push_back(std::move(sample));
  }
  return figures;
}

}  // namespace

std::optional<CellPoint> find_cell_point(const BodyModel& body, const Vec3& x) {
  if (!body.spec->holds(x)) return std::nullopt;
  const Vec3 position = body.cut_cells.grid.to_grid(x);
  const int cell = body.cut_cells.locate(position);
  if (cell < 0) return std::nullopt;
  return CellPoint{cell, cell_coordinates(body.cut_cells, cell, position)};
}

CellPoint cell_point_of(const BodyModel& body, int point) {
  const BoundaryPoints& boundary = body.cut_cells.boundary;
  const int cell = boundary.cell[point];
  return {cell, cell_coordinates(body.cut_cells, cell, boundary.position[point])};
}

void fill_probes(const SolvedState& state, Results& results) {
  if (state.scene.probes.empty()) return;
  const FaceProjection project(state, results);
  for (const ProbeSpec& probe : state.scene.probes) {
    results.probes.push_back(figures_of(state, project, probe));
    const ProbeFigures& figures = results.probes.back();
    if (figures.outside > 0)
      results.warnings.push_back(fmt::format("probe \"{}\": {} of its {} points are outside of {}: no values there",
                                             probe.name, figures.outside, figures.points,
                                             probe.body < 0 ? "every body" : "the body"));
  }
}

}  // namespace cgcontact
