#include "core/output_vtk.hpp"

#include <cmath>

#include "core/output_hdf.hpp"

namespace cgcontact {

namespace {

constexpr unsigned char vtk_triangle = 5, vtk_tetrahedron = 10, vtk_hexahedron = 12;

/// Unstructured grid as VTK stores it.
struct VtkGrid {
  std::vector<double> points;
  std::vector<unsigned char> types;
  std::vector<long long> connectivity, offsets{0};

  long long num_points() const { return static_cast<long long>(points.size() / 3); }
  template <class Points>
  void add_cell(unsigned char type, const Points& cell, long long first_point) {
    for (int p : cell) connectivity.push_back(first_point + p);
    offsets.push_back(static_cast<long long>(connectivity.size()));
    types.push_back(type);
  }
};

void write_grid(const VtkGrid& grid, HdfFile& file) {
  file.make_group("/VTKHDF");
  file.set_attribute("/VTKHDF", "Version", std::vector<long long>{1, 0});
  file.set_attribute("/VTKHDF", "Type", "UnstructuredGrid");
  file.write("/VTKHDF/NumberOfPoints", std::vector<long long>{grid.num_points()});
  file.write("/VTKHDF/NumberOfCells", std::vector<long long>{static_cast<long long>(grid.types.size())});
  file.write("/VTKHDF/NumberOfConnectivityIds",
             std::vector<long long>{static_cast<long long>(grid.connectivity.size())});
  file.write("/VTKHDF/Points", grid.points, 3);
  file.write("/VTKHDF/Types", grid.types);
  file.write("/VTKHDF/Connectivity", grid.connectivity);
  file.write("/VTKHDF/Offsets", grid.offsets);
  file.make_group("/VTKHDF/PointData");
  file.make_group("/VTKHDF/CellData");
  file.make_group("/VTKHDF/FieldData");
}

template <class Vector>
void append(const Vector& vector, std::vector<float>& values) {
  for (Eigen::Index k = 0; k < vector.size(); ++k) values.push_back(static_cast<float>(vector[k]));
}

template <class Vector>
void append(const Vector& vector, std::vector<double>& values) {
  for (Eigen::Index k = 0; k < vector.size(); ++k) values.push_back(vector[k]);
}

/// Arrays of result.vtkhdf, cell by cell and point by point in the order of the grid.
struct BodyArrays {
  VtkGrid grid;
  std::vector<int> body, cell;
  std::vector<float> displacement, stress_recovered, von_mises, stress_raw, error, error_density;
};

/// One drawn cell with the values of its active cell.
template <class Points>
void add_cell(const BodyFields& fields, int body, unsigned char type, const Points& points, int cell,
              const std::vector<Vec3>& positions, long long first_point, BodyArrays& arrays) {
  arrays.grid.add_cell(type, points, first_point);
  arrays.body.push_back(body);
  arrays.cell.push_back(cell);
  const CutCells& cut_cells = *fields.cut_cells;
  if (fields.stress_raw) {
    Vec3 centroid = Vec3::Zero();
    for (int p : points) centroid += positions[p] / static_cast<double>(points.size());
    append(fields.stress_raw(cell, clamped_cell_coordinates(cut_cells, cell, centroid)), arrays.stress_raw);
  }
  const bool known = static_cast<std::size_t>(cell) < fields.error_of_cell.size();
  const double error = known ? fields.error_of_cell[cell] : 0;
  const double volume = cut_cells.volume_fraction(cell) * std::pow(cut_cells.grid.cell_size, 3);
  arrays.error.push_back(static_cast<float>(error));
  arrays.error_density.push_back(static_cast<float>(volume > 0 ? error / std::sqrt(volume) : 0));
}

void add_body(const BodyFields& fields, int body, const DrawnBody& drawn, BodyArrays& arrays) {
  const long long first_point = arrays.grid.num_points();
  for (const Vec3& x : drawn.position) append(x, arrays.grid.points);
  for (const Vec3& u : drawn.displacement) append(u, arrays.displacement);
  for (const Sym3& s : drawn.stress) {
    append(s, arrays.stress_recovered);
    arrays.von_mises.push_back(static_cast<float>(von_mises(s)));
  }
  const ClippedMesh& mesh = drawn.mesh;
  for (std::size_t i = 0; i < mesh.hexahedra.size(); ++i)
    add_cell(fields, body, vtk_hexahedron, mesh.hexahedra[i], mesh.cell_of_hexahedron[i], mesh.points, first_point,
             arrays);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i)
    add_cell(fields, body, vtk_tetrahedron, mesh.tetrahedra[i], mesh.cell_of_tetrahedron[i], mesh.points, first_point,
             arrays);
}

/// Writes an array unless some body lacks the field.
template <class T>
void write_full(HdfFile& file, const std::string& path, const std::vector<T>& values, std::size_t rows, int columns) {
  if (values.size() == rows * static_cast<std::size_t>(std::max(columns, 1))) file.write(path, values, columns);
}

}  // namespace

void write_vtk(const Results& results, const std::vector<DrawnBody>& bodies, const std::string& file_name) {
  BodyArrays arrays;
  for (std::size_t b = 0; b < bodies.size(); ++b) add_body(results.bodies[b], static_cast<int>(b), bodies[b], arrays);
  HdfFile file;
  write_grid(arrays.grid, file);
  const std::size_t points = arrays.grid.points.size() / 3, cells = arrays.grid.types.size();
  write_full(file, "/VTKHDF/PointData/displacement", arrays.displacement, points, 3);
  write_full(file, "/VTKHDF/PointData/stress_recovered", arrays.stress_recovered, points, 6);
  write_full(file, "/VTKHDF/PointData/von_mises", arrays.von_mises, points, 0);
  write_full(file, "/VTKHDF/CellData/body", arrays.body, cells, 0);
  write_full(file, "/VTKHDF/CellData/cell", arrays.cell, cells, 0);
  write_full(file, "/VTKHDF/CellData/stress_raw", arrays.stress_raw, cells, 6);
  write_full(file, "/VTKHDF/CellData/estimated_error", arrays.error, cells, 0);
  write_full(file, "/VTKHDF/CellData/estimated_error_density", arrays.error_density, cells, 0);
  file.save(file_name);
}

void write_vtk_contact(const ContactSurface& surface, const std::string& file_name) {
  static const char* const names[] = {"gap", "pressure_raw", "pressure_spr", "pressure_sprc"};
  VtkGrid grid;
  for (const Vec3& x : surface.position) append(x, grid.points);
  for (const auto& triangle : surface.triangles) grid.add_cell(vtk_triangle, triangle, 0);
  HdfFile file;
  write_grid(grid, file);
  std::vector<float> displacement;
  for (const Vec3& u : surface.displacement) append(u, displacement);
  write_full(file, "/VTKHDF/PointData/displacement", displacement, surface.position.size(), 3);
  file.write("/VTKHDF/CellData/body", surface.body);
  file.write("/VTKHDF/CellData/pair", surface.pair);
  file.write("/VTKHDF/CellData/status", surface.active);
  for (int k = 0; k < ContactSurface::num_values; ++k) {
    std::vector<float> of_triangles, of_points;
    for (const auto& values : surface.triangle_values) of_triangles.push_back(static_cast<float>(values[k]));
    for (const auto& values : surface.point_values) of_points.push_back(static_cast<float>(values[k]));
    file.write(std::string("/VTKHDF/CellData/") + names[k], of_triangles);
    file.write(std::string("/VTKHDF/PointData/") + names[k] + "_smooth", of_points);
  }
  file.save(file_name);
}

}  // namespace cgcontact
