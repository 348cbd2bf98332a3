#include "core/output/plot/plot_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/base/errors/errors.hpp"
#include "core/output/plot/cell_faces.hpp"
#include "core/output/plot/cell_grid.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr long long type_of_tetrahedron = 10, type_of_hexahedron = 12;  // VTK's numbers

/// Where the cells of a file and their points lie.
struct CellTable {
  std::vector<long long> bodies, types, offsets, points;
};

CellTable read_table(const VtkArrays& file, std::size_t num_bodies, std::size_t num_points) {
  CellTable table{file.integers("CellData/body"), file.integers("Types"), file.integers("Offsets"),
                  file.integers("Connectivity")};
  const std::size_t n = table.types.size();
  if (table.bodies.size() != n || table.offsets.size() != n + 1) file.damaged("its cells are not as many everywhere");
  if (!std::is_sorted(table.bodies.begin(), table.bodies.end())) file.damaged("its bodies are mixed");
  for (std::size_t i = 0; i < n; ++i) {
    const long long corners = table.types[i] == type_of_tetrahedron ? 4 : table.types[i] == type_of_hexahedron ? 8 : 0;
    if (corners == 0) file.damaged(fmt::format("a cell has the type {}", table.types[i]));
    if (table.offsets[i] < 0 || table.offsets[i + 1] - table.offsets[i] != corners)
      file.damaged("a cell has too many or too few corners");
    if (table.bodies[i] < 0 || static_cast<std::size_t>(table.bodies[i]) >= num_bodies)
      file.damaged(fmt::format("it has a body number {}, report.json has {}", table.bodies[i], num_bodies));
  }
  if (static_cast<std::size_t>(table.offsets.back()) > table.points.size())
    file.damaged("corners of cells are missing");
  for (const long long p : table.points)
    if (p < 0 || static_cast<std::size_t>(p) >= num_points) file.damaged("a cell has a corner that does not exist");
  return table;
}

/// Rows of vectors of a length fixed at compile time.
template <class Vector>
std::vector<Vector> vectors(const VtkArrays& file, const std::string& name, std::size_t first, std::size_t count) {
  const std::vector<double> numbers = file.numbers(name, Vector::SizeAtCompileTime, first, count);
  std::vector<Vector> rows;
  rows.reserve(count);
  for (std::size_t p = 0; p < count; ++p)
    rows.emplace_back(Eigen::Map<const Vector>(&numbers[p * Vector::SizeAtCompileTime]));
  return rows;
}

/// Adds the cells [first, end) of the table, whose points are numbered from `point` on.
void add_cells(const CellTable& table, std::size_t first, std::size_t end, long long point, ClippedMesh& mesh) {
  for (std::size_t i = first; i < end; ++i) {
    const int cell = static_cast<int>(i - first);
    const long long* const corners = &table.points[table.offsets[i]];
    const auto take = [&](auto& polyhedra, std::vector<int>& cells) {
      auto& polyhedron = polyhedra.emplace_back();
      for (std::size_t v = 0; v < polyhedron.size(); ++v) polyhedron[v] = static_cast<int>(corners[v] - point);
      cells.push_back(cell);
    };
    if (table.types[i] == type_of_hexahedron)
      take(mesh.hexahedra, mesh.cell_of_hexahedron);
    else
      take(mesh.tetrahedra, mesh.cell_of_tetrahedron);
  }
}

std::string text_of(const Json& json, const char* key) {
  const Json value = json.is_object() ? json.value(key, Json()) : Json();
  return value.is_string() ? value.get<std::string>() : "";
}

double number_of(const Json& json, const char* key) {
  const Json value = json.is_object() ? json.value(key, Json()) : Json();
  return value.is_number() ? value.get<double>() : 0;
}

PairFigures pair_of(const Json& json) {
  PairFigures pair;
  pair.name = text_of(json, "name");
  pair.max_pressure = number_of(json, "max_pressure");
  const Json names = json.value("bodies", Json()), forces = json.value("force", Json());
  if (names.is_array() && names.size() == 2 && names[0].is_string()) pair.body_first = names[0].get<std::string>();
  if (forces.is_object() && !forces.empty() && forces.front().is_array() && forces.front().size() == 3)
    for (int k = 0; k < 3; ++k)
      if (forces.front()[k].is_number()) pair.force_on_first[k] = forces.front()[k].get<double>();
  return pair;
}

/// Sets the axis across a body of one layer: of revolution, or plane strain on cells of several sizes.
void set_layer(const Json& body, Grid& grid) {
  const auto axis_of = [&](const char* key) {
    const std::string name = text_of(body, key);
    return name.size() == 1 && name[0] >= 'x' && name[0] <= 'z' ? name[0] - 'x' : -1;
  };
  const int revolution = axis_of("axisymmetric"), strain = axis_of("plane_strain");
  if (revolution < 0 && (strain < 0 || !body.contains("smallest_cell_size"))) return;
  grid.plane_strain = revolution >= 0 ? (revolution + 2) % 3 : strain;
  grid.slice = 1;
  if (revolution >= 0) grid.unit_radius = 1;
}

/// Takes from the report what the views need of the grids, and the names.
void add_report(const Json& report, PlotResult& result) {
  result.known.title = text_of(report, "title");
  result.grids.resize(report.at("bodies").size());
  for (std::size_t b = 0; b < result.grids.size(); ++b) {
    const Json& body = report.at("bodies")[b];
    const double size = number_of(body, "cell_size");
    if (size > 0) result.grids[b].grid.cell_size = size;
    set_layer(body, result.grids[b].grid);
    result.known.bodies.emplace_back();
    result.known.bodies.back().name = text_of(body, "name");
    result.known.bodies.back().cut_cells = &result.grids[b];
  }
  for (const Json& pair : report.at("contact"))
    if (pair.is_object()) result.known.pairs.push_back(pair_of(pair));
}

/// A contact row for each triangle of contact.vtkhdf.
void add_contact(const VtkArrays& file, Results& known) {
  const std::vector<Vec3> points = vectors<Vec3>(file, "Points", 0, file.rows("Points"));
  const std::vector<long long> corners = file.integers("Connectivity"), body = file.integers("CellData/body"),
                               pair = file.integers("CellData/pair"), status = file.integers("CellData/status");
  const std::vector<double> pressure = file.numbers("CellData/pressure_sprc", 1);
  const std::size_t n = body.size();
  if (corners.size() != 3 * n || pair.size() != n || status.size() != n || pressure.size() != n)
    file.damaged("its triangles are not as many everywhere");
  const auto is_below = [](long long number, std::size_t end) {
    return number >= 0 && static_cast<std::size_t>(number) < end;
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (int v = 0; v < 3; ++v)
      if (!is_below(corners[3 * i + v], points.size())) file.damaged("a triangle has a corner that does not exist");
    if (!is_below(body[i], known.bodies.size()) || !is_below(pair[i], known.pairs.size()))
      file.damaged("it has bodies or pairs that report.json does not have");
    const Vec3 &a = points[corners[3 * i]], &b = points[corners[3 * i + 1]], &c = points[corners[3 * i + 2]];
    ContactRow& row = known.contact_rows.emplace_back();
    row.body = static_cast<int>(body[i]);
    row.pair = static_cast<int>(pair[i]);
    row.active = status[i] != 0;
    row.pressure_sprc = pressure[i];
    row.x = (a + b + c) / 3;
    row.normal = (b - a).cross(c - a);
    row.weight = row.normal.norm() / 2;
    row.normal.normalize();
  }
}

}  // namespace

std::vector<DrawnBody> read_drawn_bodies(const VtkArrays& file, std::size_t num_bodies, std::size_t step,
                                         std::vector<std::size_t>& first_cell) {
  const std::size_t num_points = file.rows("Points"), row = step > 0 ? (step - 1) * num_points : 0;
  const CellTable table = read_table(file, num_bodies, num_points);
  std::vector<DrawnBody> bodies(num_bodies);
  std::size_t end_of_points = num_points;
  first_cell.resize(num_bodies);
  for (std::size_t b = num_bodies; b-- > 0;) {  // from the last one: points end where the next body's begin
    const auto [begin, end] = std::equal_range(table.bodies.begin(), table.bodies.end(), static_cast<long long>(b));
    first_cell[b] = begin - table.bodies.begin();
    const std::size_t last = end - table.bodies.begin();
    if (begin == end) continue;
    const auto corners = table.points.begin();
    const auto [low, high] = std::minmax_element(corners + table.offsets[first_cell[b]], corners + table.offsets[last]);
    const auto first = static_cast<std::size_t>(*low);
    if (static_cast<std::size_t>(*high) >= end_of_points) file.damaged("the points of its bodies are mixed");
    const std::size_t count = end_of_points - first;
    end_of_points = first;
    DrawnBody& body = bodies[b];
    add_cells(table, first_cell[b], last, *low, body.mesh);
    body.position = vectors<Vec3>(file, "Points", first, count);
    if (file.has("PointData/displacement"))
      body.displacement = vectors<Vec3>(file, "PointData/displacement", row + first, count);
    if (file.has("PointData/stress_recovered"))
      body.stress = vectors<Sym3>(file, "PointData/stress_recovered", row + first, count);
    body.mesh.cell_of_point.assign(count, 0);
    body.mesh.points.assign(count, Vec3::Constant(0.5));  // no grid lines
  }
  return bodies;
}

std::string result_file(const std::string& directory, std::size_t step) {
  const fs::path file = fs::path(directory) / (step > 0 ? "steps.vtkhdf" : "result.vtkhdf");
  std::error_code error;
  if (fs::is_regular_file(file, error)) return file.string();
  if (step == 0)
    throw InputError(fmt::format("{}: there is no result.vtkhdf in it (the scene needs output.vtk = true)", directory));
  throw InputError(
      fmt::format("--step {}: {} has no steps.vtkhdf (allowed: the result of a scene with two [steps] or more and "
                  "output.vtk = true)",
                  step, directory));
}

PlotResult read_plot_result(const std::string& directory, const Json& report, std::size_t step, const VtkArrays& file) {
  PlotResult result;
  result.directory = directory;
  result.step = step;
  if (step > 0) result.num_steps = file.rows("PointData/displacement") / std::max<std::size_t>(1, file.rows("Points"));
  if (step > result.num_steps)
    throw InputError(fmt::format("--step {}: {} has {} steps (allowed: 1 to {})", step, directory, result.num_steps,
                                 result.num_steps));
  add_report(report, result);
  result.bodies = read_drawn_bodies(file, result.grids.size(), step, result.first_cell);
  const std::vector<long long> cells =
      file.has("CellData/cell") ? file.integers("CellData/cell") : std::vector<long long>();
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    DrawnBody& body = result.bodies[b];
    if (!cells.empty()) find_grid(result.grids[b].grid.cell_size, cells.data() + result.first_cell[b], body);
    find_boundary(body.mesh);
  }
  const fs::path contact = fs::path(directory) / "contact.vtkhdf";
  std::error_code error;
  if (fs::is_regular_file(contact, error)) add_contact(VtkArrays(contact.string()), result.known);
  return result;
}

}  // namespace cgcontact
