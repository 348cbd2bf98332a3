#include "core/output/fields/output_vtk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/process/parallel.hpp"

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

int active_cell(const ClippedMesh& mesh, std::size_t i) {
  if (i < mesh.hexahedra.size()) return mesh.cell_of_hexahedron[i];
  i -= mesh.hexahedra.size();
  return i < mesh.tetrahedra.size() ? mesh.cell_of_tetrahedron[i] : mesh.interior.cells[i - mesh.tetrahedra.size()];
}

bool is_tetrahedron(const ClippedMesh& mesh, std::size_t i) {
  return i >= mesh.hexahedra.size() && i - mesh.hexahedra.size() < mesh.tetrahedra.size();
}

/// Connectivity entries before cell i.
std::size_t offset_of_cell(const ClippedMesh& mesh, std::size_t i) {
  const std::size_t before = std::min(i, mesh.hexahedra.size());
  return 8 * i - 4 * std::min(i - before, mesh.tetrahedra.size());
}

Vec3 point_of(const ClippedMesh& mesh, int point) {
  const auto p = static_cast<std::size_t>(point);
  return p < mesh.points.size() ? mesh.points[p] : mesh.interior_point(p - mesh.points.size());
}

/// Writes the bodies' arrays in turn, block by block.
class BodyWriter {
 public:
  BodyWriter(const std::vector<DrawnBody>& bodies, HdfFile& file) : bodies_(bodies), file_(file) {}

  /// fill(body, i, row) sets the row of the body's i-th cell.
  template <class T, class Fill>
  void cells(const std::string& name, int columns, const Fill& fill,
             HdfStorage storage = HdfStorage::compressed) const {
    write<T>(
        name, columns, [](const ClippedMesh& mesh) { return mesh.num_polyhedra(); }, fill, storage);
  }

  /// Displacement, stress and von Mises stress of the bodies; only those that all of them have. can_grow: behind the
  /// rows of earlier steps.
  void fields(bool can_grow) const {
    const auto all = [&](const auto& has) { return std::all_of(bodies_.begin(), bodies_.end(), has); };
    std::size_t total = 0;
    for (const DrawnBody& body : bodies_) total += body.mesh.num_points();
    std::optional<HdfRows<float>> displacement, stress, mises;
    if (all([](const DrawnBody& body) { return !body.displacement.empty(); }))
      displacement.emplace(file_, "/VTKHDF/PointData/displacement", total, 3, HdfStorage::plain, can_grow);
    if (all([](const DrawnBody& body) { return !body.stress.empty(); })) {
      stress.emplace(file_, "/VTKHDF/PointData/stress_recovered", total, 6, HdfStorage::plain, can_grow);
      mises.emplace(file_, "/VTKHDF/PointData/von_mises", total, 0, HdfStorage::plain, can_grow);
    }
    const auto add = [](const auto& values, int columns, const auto& fill, HdfRows<float>& rows) {
      for (std::size_t first = 0; first < values.size(); first += rows_per_block) {
        std::vector<float> block(columns * std::min(rows_per_block, values.size() - first));
        parallel_for("cgcontact::output_vtk::values", block.size() / columns, 1024,
                     [&](std::size_t i) { fill(values[first + i], &block[columns * i]); });
        rows.add(block);
      }
    };
    const auto add_all = [&](const PointValues& values) {
      const auto copy = [](const auto& value, float* row) { set(value, row); };
      if (displacement) add(values.displacement, 3, copy, *displacement);
      if (stress) add(values.stress, 6, copy, *stress);
      if (mises)
        add(
            values.stress, 1, [](const Sym3& s, float* row) { *row = static_cast<float>(von_mises(s)); }, *mises);
    };
    for (const DrawnBody& body : bodies_) {
      add_all(body);
      if (displacement || stress) each_interior_block(body, [&](int, const PointValues& values) { add_all(values); });
    }
  }

  void grid(long long version = 1) const {
    GridSizes sizes;
    for (const DrawnBody& body : bodies_) {
      sizes.points += body.mesh.num_points();
      sizes.cells += body.mesh.num_polyhedra();
      sizes.ids += offset_of_cell(body.mesh, body.mesh.num_polyhedra());
    }
    write_header(sizes, file_, version);
    write<double>(
        "Points", 3, [](const ClippedMesh& mesh) { return mesh.num_points(); },
        [&](std::size_t b, std::size_t p, double* row) { set(position_of(bodies_[b], p), row); }, HdfStorage::plain);
    cells<unsigned char>("Types", 0, [&](std::size_t b, std::size_t i, unsigned char* row) {
      *row = is_tetrahedron(bodies_[b].mesh, i) ? vtk_tetrahedron : vtk_hexahedron;
    });
    connectivity(sizes);
  }

  template <class Vector, class T>
  static void set(const Vector& vector, T* row) {
    for (Eigen::Index k = 0; k < vector.size(); ++k) row[k] = static_cast<T>(vector[k]);
  }

 private:
  template <class T, class Count, class Fill>
  void write(const std::string& name, int columns, const Count& count, const Fill& fill, HdfStorage storage) const {
    std::size_t total = 0;
    for (const DrawnBody& body : bodies_) total += count(body.mesh);
    const std::size_t width = std::max(columns, 1);
    HdfRows<T> rows(file_, "/VTKHDF/" + name, total, columns, storage);
    each_block(count, [&](std::size_t b, std::size_t first, std::size_t end) {
      std::vector<T> block((end - first) * width);
      parallel_for("cgcontact::output_vtk::values", end - first, 1024,
                   [&](std::size_t i) { fill(b, first + i, &block[i * width]); });
      rows.add(block);
    });
  }

  /// use(body, first, end)
  template <class Count, class Use>
  void each_block(const Count& count, const Use& use) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t first = 0, n = count(bodies_[b].mesh); first < n; first += rows_per_block)
        use(b, first, std::min(n, first + rows_per_block));
  }

  void connectivity(const GridSizes& sizes) const {
    const auto count = [](const ClippedMesh& mesh) { return mesh.num_polyhedra(); };
    std::vector<long long> first_id(bodies_.size() + 1, 0), first_point(first_id);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const ClippedMesh& mesh = bodies_[b].mesh;
      first_id[b + 1] = first_id[b] + static_cast<long long>(offset_of_cell(mesh, mesh.num_polyhedra()));
      first_point[b + 1] = first_point[b] + static_cast<long long>(mesh.num_points());
    }
    HdfRows<long long> ids(file_, "/VTKHDF/Connectivity", sizes.ids);
    each_block(count, [&](std::size_t b, std::size_t first, std::size_t end) {
      const ClippedMesh& mesh = bodies_[b].mesh;
      const std::size_t offset = offset_of_cell(mesh, first);
      std::vector<long long> block(offset_of_cell(mesh, end) - offset);
      parallel_for("cgcontact::output_vtk::connectivity", end - first, 1024, [&](std::size_t i) {
        const ClippedMesh::Polyhedron cell = mesh.polyhedron(first + i);
        long long* id = &block[offset_of_cell(mesh, first + i) - offset];
        for (int p = 0; p < cell.num_points; ++p) id[p] = first_point[b] + cell.points[p];
      });
      ids.add(block);
    });
    HdfRows<long long> offsets(file_, "/VTKHDF/Offsets", sizes.cells + 1);
    offsets.add({0});
    each_block(count, [&](std::size_t b, std::size_t first, std::size_t end) {
      std::vector<long long> block;
      for (std::size_t i = first + 1; i <= end; ++i)
        block.push_back(first_id[b] + static_cast<long long>(offset_of_cell(bodies_[b].mesh, i)));
      offsets.add(block);
    });
  }

  const std::vector<DrawnBody>& bodies_;
  HdfFile& file_;
};

/// Writes the kinds of the patches around the cells: small integers, their names in the attribute "names" of the array.
void write_patches(const Results& results, const std::vector<DrawnBody>& bodies, const BodyWriter& write,
                   HdfFile& file) {
  const auto array = [&](const std::string& name, std::vector<unsigned char> BodyFields::*values,
                         const std::vector<std::string>& names) {
    for (const BodyFields& fields : results.bodies)
      if ((fields.*values).size() != fields.cut_cells->cells.size()) return;
    write.cells<unsigned char>("CellData/" + name, 0, [&](std::size_t b, std::size_t i, unsigned char* row) {
      *row = (results.bodies[b].*values)[active_cell(bodies[b].mesh, i)];
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
  write.fields(false);
  write.cells<int>("CellData/body", 0, [](std::size_t b, std::size_t, int* row) { *row = static_cast<int>(b); });
  write.cells<int>("CellData/cell", 0,
                   [&](std::size_t b, std::size_t i, int* row) { *row = active_cell(bodies[b].mesh, i); });
  if (std::all_of(results.bodies.begin(), results.bodies.end(), [](const auto& fields) { return fields.stress_raw; }))
    write.cells<float>(
        "CellData/stress_raw", 6,
        [&](std::size_t b, std::size_t i, float* row) {
          const ClippedMesh::Polyhedron cell = bodies[b].mesh.polyhedron(i);
          Vec3 centroid = Vec3::Zero();
          for (int p = 0; p < cell.num_points; ++p)
            centroid += point_of(bodies[b].mesh, cell.points[p]) / cell.num_points;
          const BodyFields& fields = results.bodies[b];
          BodyWriter::set(
              fields.stress_raw(cell.cell, clamped_cell_coordinates(*fields.cut_cells, cell.cell, centroid)), row);
        },
        HdfStorage::plain);
  const auto error_of_cell = [&](std::size_t b, int cell) {
    const std::vector<double>& errors = results.bodies[b].error_of_cell;
    return static_cast<std::size_t>(cell) < errors.size() ? errors[cell] : 0.0;
  };
  write.cells<float>("CellData/estimated_error", 0, [&](std::size_t b, std::size_t i, float* row) {
    *row = static_cast<float>(error_of_cell(b, active_cell(bodies[b].mesh, i)));
  });
  write.cells<float>("CellData/estimated_error_density", 0, [&](std::size_t b, std::size_t i, float* row) {
    const int cell = active_cell(bodies[b].mesh, i);
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
                   [&](std::size_t b, std::size_t i, int* row) { *row = active_cell(bodies[b].mesh, i); });
  for (const DrawnBody& body : bodies) num_points_ += body.mesh.num_points();
}

void VtkSteps::add(const std::vector<DrawnBody>& bodies) {
  BodyWriter(bodies, file_).fields(true);
  ++num_steps_;
}

PointValues VtkSteps::read_rows(std::size_t first, std::size_t n) {
  const std::vector<float> u = file_.read("/VTKHDF/PointData/displacement", first, n);
  const std::vector<float> s = file_.read("/VTKHDF/PointData/stress_recovered", first, n);
  PointValues values;
  for (std::size_t p = 0; p < n; ++p) {
    values.displacement.emplace_back(Eigen::Map<const Eigen::Matrix<float, 3, 1>>(&u[3 * p]).cast<double>());
    values.stress.emplace_back(Eigen::Map<const Eigen::Matrix<float, 6, 1>>(&s[6 * p]).cast<double>());
  }
  return values;
}

void VtkSteps::read(std::size_t step, std::vector<DrawnBody>& bodies) {
  std::size_t row = step * num_points_;
  for (DrawnBody& body : bodies) {
    const std::size_t n = body.position.size();
    static_cast<PointValues&>(body) = read_rows(row, n);
    body.interior = [this, first = row + n](const ClippedMesh&, const std::vector<int>& points) {
      PointValues values, block;
      std::size_t begin = 0, end = 0;  // of the block
      for (const int p : points) {
        const auto point = static_cast<std::size_t>(p);
        if (point >= end) {
          begin = point;
          end = std::min<std::size_t>(points.back() + 1, begin + rows_per_block);
          block = read_rows(first + begin, end - begin);
        }
        values.displacement.push_back(block.displacement[point - begin]);
        values.stress.push_back(block.stress[point - begin]);
      }
      return values;
    };
    row += body.mesh.num_points();
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
                   [&](std::size_t b, std::size_t i, int* row) { *row = active_cell(bodies[b].mesh, i); });
  write.cells<unsigned char>("CellData/cut", 0, [&](std::size_t b, std::size_t i, unsigned char* row) {
    *row = cut_cells[b]->cut_of_active[active_cell(bodies[b].mesh, i)] >= 0;
  });
  write.cells<float>("CellData/volume_fraction", 0, [&](std::size_t b, std::size_t i, float* row) {
    *row = static_cast<float>(cut_cells[b]->volume_fraction(active_cell(bodies[b].mesh, i)));
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

void write_vtk_contact(const ContactSurface& surface, bool friction, const std::string& file_name) {
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
  if (friction) {
    file.write("/VTKHDF/CellData/shear", flat(surface.shear, 0.0f), 3);
    file.write("/VTKHDF/CellData/slip", flat(surface.slip, 0.0f), 3);
    file.write("/VTKHDF/CellData/slips", surface.slips);
    file.write("/VTKHDF/CellData/wear", surface.wear);
  }
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
