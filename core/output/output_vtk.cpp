#include "core/output/output_vtk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"

namespace cgcontact {

namespace {

constexpr unsigned char vtk_triangle = 5, vtk_tetrahedron = 10, vtk_hexahedron = 12;

struct GridSizes {
  std::size_t points = 0, cells = 0, ids = 0;
};

void write_header(const GridSizes& sizes, HdfFile& file, long long version = 1) {
  file.make_group("/VTKHDF");
  file.set_attribute("/VTKHDF", "Version", std::vector<long long>{version, 0});
  file.set_attribute("/VTKHDF", "Type", "UnstructuredGrid");
  const auto number = [&](const char* name, std::size_t n) {
    file.write(std::string("/VTKHDF/NumberOf") + name, std::vector<long long>{static_cast<long long>(n)});
  };
  number("Points", sizes.points);
  number("Cells", sizes.cells);
  number("ConnectivityIds", sizes.ids);
  for (const char* group : {"PointData", "CellData", "FieldData"}) file.make_group(std::string("/VTKHDF/") + group);
}

/// One cell of a drawn body: hexahedra come first, then tetrahedra.
struct DrawnCell {
  const int* points;
  int num_points;
  int cell;  ///< active cell
};

DrawnCell drawn_cell(const ClippedMesh& mesh, std::size_t i) {
  const std::size_t hexahedra = mesh.hexahedra.size();
  if (i < hexahedra) return {mesh.hexahedra[i].data(), 8, mesh.cell_of_hexahedron[i]};
  return {mesh.tetrahedra[i - hexahedra].data(), 4, mesh.cell_of_tetrahedron[i - hexahedra]};
}

std::size_t num_cells(const ClippedMesh& mesh) { return mesh.hexahedra.size() + mesh.tetrahedra.size(); }

/// Connectivity entries before cell i.
std::size_t offset_of_cell(const ClippedMesh& mesh, std::size_t i) {
  return 8 * std::min(i, mesh.hexahedra.size()) + 4 * (i - std::min(i, mesh.hexahedra.size()));
}

/// Writes the bodies' arrays one after the other, so that only one of them is in memory at a time.
class BodyWriter {
 public:
  BodyWriter(const std::vector<DrawnBody>& bodies, HdfFile& file) : bodies_(bodies), file_(file) {}

  /// fill(body, i, row) sets the row of the body's i-th point.
  template <class T, class Fill>
  void points(const std::string& name, int columns, const Fill& fill) const {
    write<T>(
        name, columns, [](const ClippedMesh& mesh) { return mesh.points.size(); }, fill);
  }
  /// fill(body, i, row) sets the row of the body's i-th cell.
  template <class T, class Fill>
  void cells(const std::string& name, int columns, const Fill& fill) const {
    write<T>(name, columns, num_cells, fill);
  }

  /// An array of points gets rows behind those that it has.
  template <class T, class Fill>
  void more_points(const std::string& name, int columns, const Fill& fill) const {
    const auto values = gathered<T>(
        columns, [](const ClippedMesh& mesh) { return mesh.points.size(); }, fill);
    file_.append("/VTKHDF/" + name, values, columns);
  }

  void grid(long long version = 1) const {
    GridSizes sizes;
    for (const DrawnBody& body : bodies_) {
      sizes.points += body.mesh.points.size();
      sizes.cells += num_cells(body.mesh);
      sizes.ids += offset_of_cell(body.mesh, num_cells(body.mesh));
    }
    write_header(sizes, file_, version);
    points<double>("Points", 3, [&](std::size_t b, std::size_t p, double* row) { set(bodies_[b].position[p], row); });
    cells<unsigned char>("Types", 0, [&](std::size_t b, std::size_t i, unsigned char* row) {
      *row = i < bodies_[b].mesh.hexahedra.size() ? vtk_hexahedron : vtk_tetrahedron;
    });
    connectivity(sizes);
  }

  template <class Vector, class T>
  static void set(const Vector& vector, T* row) {
    for (Eigen::Index k = 0; k < vector.size(); ++k) row[k] = static_cast<T>(vector[k]);
  }

 private:
  template <class T, class Count, class Fill>
  void write(const std::string& name, int columns, const Count& count, const Fill& fill) const {
    file_.write("/VTKHDF/" + name, gathered<T>(columns, count, fill), columns);
  }

  template <class T, class Count, class Fill>
  std::vector<T> gathered(int columns, const Count& count, const Fill& fill) const {
    std::size_t total = 0, first = 0;
    for (const DrawnBody& body : bodies_) total += count(body.mesh);
    const std::size_t width = std::max(columns, 1);
    std::vector<T> values(total * width);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const std::size_t n = count(bodies_[b].mesh);
      parallel_for("cgcontact::output_vtk::values", n, 1024,
                   [&](std::size_t i) { fill(b, i, &values[(first + i) * width]); });
      first += n;
    }
    return values;
  }

  void connectivity(const GridSizes& sizes) const {
    std::vector<long long> values(sizes.ids);
    std::size_t first_id = 0, first_point = 0;
    for (const DrawnBody& body : bodies_) {
      const std::size_t n = num_cells(body.mesh);
      parallel_for("cgcontact::output_vtk::connectivity", n, 1024, [&](std::size_t i) {
        const DrawnCell cell = drawn_cell(body.mesh, i);
        long long* id = &values[first_id + offset_of_cell(body.mesh, i)];
        for (int p = 0; p < cell.num_points; ++p) id[p] = static_cast<long long>(first_point) + cell.points[p];
      });
      first_id += offset_of_cell(body.mesh, n);
      first_point += body.mesh.points.size();
    }
    file_.write("/VTKHDF/Connectivity", values);
    values.assign(1, 0);
    values.reserve(sizes.cells + 1);
    for (const DrawnBody& body : bodies_) {
      const long long first = values.back();
      for (std::size_t i = 1; i <= num_cells(body.mesh); ++i)
        values.push_back(first + static_cast<long long>(offset_of_cell(body.mesh, i)));
    }
    file_.write("/VTKHDF/Offsets", values);
  }

  const std::vector<DrawnBody>& bodies_;
  HdfFile& file_;
};

/// What the patches around the cells are: small integers, their names in the attribute "names" of the array.
void write_patches(const Results& results, const std::vector<DrawnBody>& bodies, const BodyWriter& write,
                   HdfFile& file) {
  const auto array = [&](const std::string& name, std::vector<unsigned char> BodyFields::*values,
                         const std::vector<std::string>& names) {
    for (const BodyFields& fields : results.bodies)
      if ((fields.*values).size() != fields.cut_cells->cells.size()) return;
    write.cells<unsigned char>("CellData/" + name, 0, [&](std::size_t b, std::size_t i, unsigned char* row) {
      *row = (results.bodies[b].*values)[drawn_cell(bodies[b].mesh, i).cell];
    });
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k) text += fmt::format("{}{} {}", k ? ", " : "", k, names[k]);
    if (!text.empty()) file.set_attribute("/VTKHDF/CellData/" + name, "names", text);
  };
  array("patch_kind", &BodyFields::patch_kind, results.patch_kinds);
  array("patch_status", &BodyFields::patch_status, results.patch_statuses);
}

}  // namespace

void write_vtk(const Results& results, const std::vector<DrawnBody>& bodies, const std::string& file_name) {
  HdfFile file(file_name);
  const BodyWriter write(bodies, file);
  write.grid();
  // An array is left out if some body lacks the field.
  const auto all = [&](const auto& has) { return std::all_of(bodies.begin(), bodies.end(), has); };
  if (all([](const DrawnBody& body) { return !body.displacement.empty(); }))
    write.points<float>("PointData/displacement", 3, [&](std::size_t b, std::size_t p, float* row) {
      BodyWriter::set(bodies[b].displacement[p], row);
    });
  if (all([](const DrawnBody& body) { return !body.stress.empty(); })) {
    write.points<float>("PointData/stress_recovered", 6,
                        [&](std::size_t b, std::size_t p, float* row) { BodyWriter::set(bodies[b].stress[p], row); });
    write.points<float>("PointData/von_mises", 0, [&](std::size_t b, std::size_t p, float* row) {
      *row = static_cast<float>(von_mises(bodies[b].stress[p]));
    });
  }
  write.cells<int>("CellData/body", 0, [](std::size_t b, std::size_t, int* row) { *row = static_cast<int>(b); });
  write.cells<int>("CellData/cell", 0,
                   [&](std::size_t b, std::size_t i, int* row) { *row = drawn_cell(bodies[b].mesh, i).cell; });
  if (std::all_of(results.bodies.begin(), results.bodies.end(), [](const auto& fields) { return fields.stress_raw; }))
    write.cells<float>("CellData/stress_raw", 6, [&](std::size_t b, std::size_t i, float* row) {
      const DrawnCell cell = drawn_cell(bodies[b].mesh, i);
      Vec3 centroid = Vec3::Zero();
      for (int p = 0; p < cell.num_points; ++p) centroid += bodies[b].mesh.points[cell.points[p]] / cell.num_points;
      const BodyFields& fields = results.bodies[b];
      BodyWriter::set(fields.stress_raw(cell.cell, clamped_cell_coordinates(*fields.cut_cells, cell.cell, centroid)),
                      row);
    });
  const auto error_of_cell = [&](std::size_t b, int cell) {
    const std::vector<double>& errors = results.bodies[b].error_of_cell;
    return static_cast<std::size_t>(cell) < errors.size() ? errors[cell] : 0.0;
  };
  write.cells<float>("CellData/estimated_error", 0, [&](std::size_t b, std::size_t i, float* row) {
    *row = static_cast<float>(error_of_cell(b, drawn_cell(bodies[b].mesh, i).cell));
  });
  write.cells<float>("CellData/estimated_error_density", 0, [&](std::size_t b, std::size_t i, float* row) {
    const int cell = drawn_cell(bodies[b].mesh, i).cell;
    const CutCells& cut_cells = *results.bodies[b].cut_cells;
    const double volume = volume_of_cell(cut_cells, cell);
    *row = static_cast<float>(volume > 0 ? error_of_cell(b, cell) / std::sqrt(volume) : 0);
  });
  write_patches(results, bodies, write, file);
  file.finish();
}

VtkSteps::VtkSteps(const std::vector<DrawnBody>& bodies, const std::string& file_name) : file_(file_name) {
  const BodyWriter write(bodies, file_);
  write.grid(2);
  write.cells<int>("CellData/body", 0, [](std::size_t b, std::size_t, int* row) { *row = static_cast<int>(b); });
  write.cells<int>("CellData/cell", 0,
                   [&](std::size_t b, std::size_t i, int* row) { *row = drawn_cell(bodies[b].mesh, i).cell; });
  for (const DrawnBody& body : bodies) num_points_ += body.position.size();
}

void VtkSteps::add(const std::vector<DrawnBody>& bodies) {
  const BodyWriter write(bodies, file_);
  write.more_points<float>("PointData/displacement", 3, [&](std::size_t b, std::size_t p, float* row) {
    BodyWriter::set(bodies[b].displacement[p], row);
  });
  write.more_points<float>("PointData/stress_recovered", 6, [&](std::size_t b, std::size_t p, float* row) {
    BodyWriter::set(bodies[b].stress[p], row);
  });
  write.more_points<float>("PointData/von_mises", 0, [&](std::size_t b, std::size_t p, float* row) {
    *row = static_cast<float>(von_mises(bodies[b].stress[p]));
  });
  ++num_steps_;
}

void VtkSteps::read(std::size_t step, std::vector<DrawnBody>& bodies) {
  std::size_t row = step * num_points_;
  for (DrawnBody& body : bodies) {
    const std::size_t n = body.position.size();
    const std::vector<float> u = file_.read("/VTKHDF/PointData/displacement", row, n);
    const std::vector<float> s = file_.read("/VTKHDF/PointData/stress_recovered", row, n);
    for (std::size_t p = 0; p < n; ++p) {
      body.displacement[p] = Eigen::Map<const Eigen::Matrix<float, 3, 1>>(&u[3 * p]).cast<double>();
      body.stress[p] = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(&s[6 * p]).cast<double>();
    }
    row += n;
  }
}

void VtkSteps::finish() {
  file_.make_group("/VTKHDF/Steps");
  file_.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<long long>(num_steps_));
  std::vector<double> time;
  std::vector<long long> first_row;
  for (std::size_t k = 0; k < num_steps_; ++k) {
    time.push_back(static_cast<double>(k + 1));
    first_row.push_back(static_cast<long long>(k * num_points_));
  }
  const std::vector<long long> zeros(num_steps_, 0), ones(num_steps_, 1);
  file_.write("/VTKHDF/Steps/Values", time);
  file_.write("/VTKHDF/Steps/NumberOfParts", ones);
  for (const char* of_grid : {"PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"})
    file_.write(std::string("/VTKHDF/Steps/") + of_grid, zeros);
  file_.make_group("/VTKHDF/Steps/PointDataOffsets");
  for (const char* array : {"displacement", "stress_recovered", "von_mises"})
    file_.write(std::string("/VTKHDF/Steps/PointDataOffsets/") + array, first_row);
  file_.make_group("/VTKHDF/Steps/CellDataOffsets");
  for (const char* array : {"body", "cell"}) file_.write(std::string("/VTKHDF/Steps/CellDataOffsets/") + array, zeros);
  file_.finish();
}

void write_vtk_cells(const std::vector<DrawnBody>& bodies, const std::vector<const CutCells*>& cut_cells,
                     const std::string& file_name) {
  HdfFile file;
  const BodyWriter write(bodies, file);
  write.grid();
  write.cells<int>("CellData/body", 0, [](std::size_t b, std::size_t, int* row) { *row = static_cast<int>(b); });
  write.cells<int>("CellData/cell", 0,
                   [&](std::size_t b, std::size_t i, int* row) { *row = drawn_cell(bodies[b].mesh, i).cell; });
  write.cells<unsigned char>("CellData/cut", 0, [&](std::size_t b, std::size_t i, unsigned char* row) {
    *row = cut_cells[b]->cut_of_active[drawn_cell(bodies[b].mesh, i).cell] >= 0;
  });
  write.cells<float>("CellData/volume_fraction", 0, [&](std::size_t b, std::size_t i, float* row) {
    *row = static_cast<float>(cut_cells[b]->volume_fraction(drawn_cell(bodies[b].mesh, i).cell));
  });
  file.save(file_name);
}

void write_vtk_boundary(const std::vector<DrawnBody>& bodies, const std::vector<BoundaryArray>& arrays,
                        const std::string& file_name) {
  std::vector<double> points;
  std::vector<long long> connectivity, offsets{0};
  for (const DrawnBody& body : bodies) {
    const auto first = static_cast<long long>(points.size() / 3);
    for (const Vec3& x : body.position) points.insert(points.end(), x.begin(), x.end());
    for (const BoundaryTriangle& triangle : body.mesh.boundary) {
      for (int p : triangle.points) connectivity.push_back(first + p);
      offsets.push_back(static_cast<long long>(connectivity.size()));
    }
  }
  HdfFile file;
  write_header({points.size() / 3, offsets.size() - 1, connectivity.size()}, file);
  file.write("/VTKHDF/Points", points, 3);
  file.write("/VTKHDF/Types", std::vector<unsigned char>(offsets.size() - 1, vtk_triangle));
  file.write("/VTKHDF/Connectivity", connectivity);
  file.write("/VTKHDF/Offsets", offsets);
  for (const BoundaryArray& array : arrays) {
    file.write("/VTKHDF/CellData/" + array.name, array.values);
    if (!array.names.empty()) file.set_attribute("/VTKHDF/CellData/" + array.name, "names", array.names);
  }
  file.save(file_name);
}

void write_vtk_contact(const ContactSurface& surface, const std::string& file_name) {
  static const char* const names[] = {"gap", "pressure_raw", "pressure_spr", "pressure_sprc", "pressure_error"};
  HdfFile file;
  write_header({surface.position.size(), surface.size(), 3 * surface.size()}, file);
  const auto flat = [](const std::vector<Vec3>& vectors, auto zero) {
    std::vector<decltype(zero)> values(3 * vectors.size());
    for (std::size_t p = 0; p < vectors.size(); ++p) BodyWriter::set(vectors[p], &values[3 * p]);
    return values;
  };
  std::vector<long long> connectivity, offsets{0};
  for (const auto& triangle : surface.triangles) {
    connectivity.insert(connectivity.end(), triangle.begin(), triangle.end());
    offsets.push_back(static_cast<long long>(connectivity.size()));
  }
  file.write("/VTKHDF/Points", flat(surface.position, 0.0), 3);
  file.write("/VTKHDF/Types", std::vector<unsigned char>(surface.size(), vtk_triangle));
  file.write("/VTKHDF/Connectivity", connectivity);
  file.write("/VTKHDF/Offsets", offsets);
  if (!surface.displacement.empty()) file.write("/VTKHDF/PointData/displacement", flat(surface.displacement, 0.0f), 3);
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
