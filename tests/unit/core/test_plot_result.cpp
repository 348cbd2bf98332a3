#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/drawing/cut_open.hpp"
#include "core/output/fields/output_vtk.hpp"
#include "core/output/plot/cell_faces.hpp"
#include "core/output/plot/cell_grid.hpp"
#include "core/output/plot/plot_result.hpp"
#include "core/program/plot_options.hpp"

namespace cgcontact::test_plot_result {
namespace {

Vec3 displacement_at(const Vec3& x) { return {0.1 * x[0] - 0.2 * x[1], 0.3, 0.4 * x[2] + 1}; }

/// A box on a grid that does not fit it, written and read again.
struct ReadBox {
  Grid grid;
  CutCells cells;
  std::string file = testing::TempDir() + "plot_result.vtkhdf";
  std::vector<DrawnBody> read;

  ReadBox() {
    grid.num_cells = {12, 12, 12};
    grid.cell_size = 0.5;
    cells = make_cut_cells(Solid::box({1.1, 1.2, 1.3}, {5.3, 5.4, 5.7}, "box"), grid);
    Results results;
    BodyFields& fields = results.bodies.emplace_back();
    fields.cut_cells = &cells;
    fields.displacement = [this](int cell, const Vec3& xi) {
      return displacement_at(global_position(cells, cell, xi));
    };
    write_vtk(results, draw_bodies(results), file);
    std::vector<std::size_t> first_cell;
    read = read_drawn_bodies(VtkArrays(file), 1, 0, first_cell);
    find_boundary(read[0].mesh);
  }
  ReadBox(const ReadBox&) = delete;
  ~ReadBox() { std::remove(file.c_str()); }
};

double enclosed_volume(const DrawnBody& body) {
  double sum = 0;
  for (const BoundaryTriangle& t : body.mesh.boundary)
    sum += body.position[t.points[0]].dot(body.position[t.points[1]].cross(body.position[t.points[2]])) / 6;
  return sum;
}

double area(const DrawnBody& body) {
  double sum = 0;
  for (const BoundaryTriangle& t : body.mesh.boundary) {
    const Vec3& a = body.position[t.points[0]];
    sum += (body.position[t.points[1]] - a).cross(body.position[t.points[2]] - a).norm() / 2;
  }
  return sum;
}

// The faces that occur once are the body's surface, outward: no face inside is left between squares and tetrahedra.
TEST(plot_result, faces_of_polyhedra_are_the_surface) {
  const ReadBox box;
  EXPECT_FALSE(box.read[0].mesh.hexahedra.empty());
  EXPECT_FALSE(box.read[0].mesh.tetrahedra.empty());
  const double a = 2.1, b = 2.1, c = 2.2;  // m
  EXPECT_NEAR(enclosed_volume(box.read[0]), a * b * c, 1e-12);
  EXPECT_NEAR(area(box.read[0]), 2 * (a * b + b * c + c * a), 1e-12);
}

// A linear field is exact on a section of what was read, to the rounding of the floats in the file.
TEST(plot_result, sections_of_a_linear_field_are_exact) {
  const ReadBox box;
  const DrawnBody section = section_of(box.read[0], {0, 0, 1.23}, Vec3::UnitZ());
  EXPECT_NEAR(area(section), 2.1 * 2.1, 1e-12);
  ASSERT_FALSE(section.position.empty());
  for (std::size_t p = 0; p < section.position.size(); ++p) {
    EXPECT_NEAR(section.position[p][2], 1.23, 1e-14);
    EXPECT_LT((section.displacement[p] - displacement_at(section.position[p])).norm(), 4e-7);
  }
}

// Grid lines are found again: coordinates differ from the true ones by whole cells.
TEST(plot_result, grid_is_that_of_the_cells) {
  ReadBox box;
  DrawnBody& body = box.read[0];
  const std::vector<long long> active = VtkArrays(box.file).integers("CellData/cell");
  find_grid(box.grid.cell_size, active.data(), body);
  const Vec3 shift = body.mesh.points[0] - box.grid.to_grid(body.position[0]);
  EXPECT_LT((shift - shift.array().round().matrix()).norm(), 1e-9);
  for (std::size_t p = 0; p < body.position.size(); ++p)
    EXPECT_LT((body.mesh.points[p] - box.grid.to_grid(body.position[p]) - shift).norm(), 1e-9);
}

TEST(plot_result, damaged_files_are_refused) {
  const ReadBox box;
  const std::string bytes = read_text(box.file);
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, bytes.size() / 2}) {
    write_text(box.file, bytes.substr(0, size));
    EXPECT_THROW(VtkArrays{box.file}, InputError) << size;
  }
  write_text(box.file, bytes);
  std::vector<std::size_t> first_cell;
  EXPECT_NO_THROW(read_drawn_bodies(VtkArrays(box.file), 1, 0, first_cell));
  EXPECT_THROW(read_drawn_bodies(VtkArrays(box.file), 0, 0, first_cell), InputError);  // its body is in no report
  EXPECT_THROW(read_drawn_bodies(VtkArrays(box.file), 1, 2, first_cell), InputError);  // it has no second step
}

TEST(plot_options, values_have_units) {
  EXPECT_DOUBLE_EQ(parse_plane("z=5mm").value, 5e-3);
  EXPECT_EQ(parse_plane("y = -2 cm").axis, 1);
  EXPECT_EQ(parse_plane("x=0").value, 0);
  for (const char* text : {"z=5", "z", "w=5mm", "z=5kg", "z=", "=5mm", "zz=5mm", "z=5mm=3"})
    EXPECT_THROW(parse_plane(text), InputError) << text;
  const PlotOptions::Ends ends = parse_ends("-10:300 MPa");
  EXPECT_DOUBLE_EQ(ends.values[0].value, -1e7);
  EXPECT_DOUBLE_EQ(ends.values[1].value, 3e8);
  EXPECT_DOUBLE_EQ(parse_ends("5 kPa:1MPa").values[0].value, 5e3);
  for (const char* text : {"", ":", "1 MPa", "3:1 MPa", "1:1 MPa", "1:2:3 MPa", ":3 MPa", "1 MPa:", "a:b"})
    EXPECT_THROW(parse_ends(text), InputError) << text;
  EXPECT_EQ(parse_zoom("contact"), "");
  EXPECT_EQ(parse_zoom("contact:a-b"), "a-b");
  for (const char* text : {"", "all", "contact:", "contacts"}) EXPECT_THROW(parse_zoom(text), InputError) << text;
}

}  // namespace
}  // namespace cgcontact::test_plot_result
