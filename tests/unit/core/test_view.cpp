#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/files/text.hpp"
#include "core/drawing/contact_fit.hpp"
#include "core/drawing/sampled_cells.hpp"
#include "core/drawing/thin_boundary.hpp"
#include "core/output/view/output_view.hpp"
#include "core/output/view/packed_values.hpp"

namespace cgcontact::test_view {
namespace {

using Json = nlohmann::json;

std::string from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int held = 0;
  for (const char c : text) {
    const std::size_t digit = letters.find(c);
    if (digit == std::string::npos) break;
    bits = bits << 6 | static_cast<unsigned>(digit);
    if ((held += 6) >= 8) bytes += static_cast<char>(bits >> (held -= 8) & 0xff);
  }
  return bytes;
}

/// Unpacks as view_data.js does.
std::vector<double> unpacked(const std::vector<double>& low, const std::vector<double>& step, const std::string& data) {
  const std::string bytes = from_base64(data);
  std::vector<double> values;
  for (std::size_t i = 0; i < bytes.size() / 2; ++i) {
    const unsigned code =
        static_cast<unsigned char>(bytes[2 * i]) + 256U * static_cast<unsigned char>(bytes[2 * i + 1]);
    const std::size_t k = i % low.size();
    values.push_back(code == packed_none ? std::nan("") : low[k] + step[k] * code);
  }
  return values;
}

std::vector<double> unpacked(const Json& packed) {
  return unpacked(packed["low"].get<std::vector<double>>(), packed["step"].get<std::vector<double>>(),
                  packed["data"].get<std::string>());
}

std::vector<int> varints(const std::string& text) {
  std::vector<int> numbers;
  int number = 0, shift = 0;
  for (const char c : from_base64(text)) {
    number |= (c & 0x7f) << shift;
    shift += 7;
    if (c & 0x80) continue;
    numbers.push_back(number);
    number = shift = 0;
  }
  return numbers;
}

std::vector<int> corners(const std::string& text) {
  std::vector<int> points = varints(text);
  int next = 0;
  for (int& point : points) point = point == 0 ? next++ : next - point;
  return points;
}

Vec3 displacement_at(const Vec3& x) { return Vec3(1e-3 * x[1], -2e-3 * x[0] + 1e-4, 3e-3 * x[2]); }
Sym3 stress_at(const Vec3& x) {
  Sym3 s;
  s << 1e6 * x[0], 2e6 * x[1], -1e6, 3e5 * x[2], 0, 5e5;
  return s;
}

/// Body with linear fields.
struct Body {
  CutCells cells;
  BodyFields fields;

  Body(const Solid& solid, const Grid& grid) : cells(make_cut_cells(solid, grid)) {
    fields.name = "ball <&>";
    fields.cut_cells = &cells;
    fields.displacement = [this](int cell, const Vec3& xi) {
      return displacement_at(global_position(cells, cell, xi));
    };
    fields.stress_recovered = [this](int cell, const Vec3& xi) { return stress_at(global_position(cells, cell, xi)); };
    for (std::size_t c = 0; c < cells.cells.size(); ++c) fields.error_of_cell.push_back(1e-3 * (1.0 + c));
    fields.material.youngs_modulus = 1e9;
  }
  Body(const Body&) = delete;
};

Grid grid_of(int cells) {
  Grid grid;
  grid.cell_size = 0.25;
  grid.origin = Vec3(1, -2, 0.5);
  grid.num_cells = {cells, cells, cells};
  return grid;
}

Solid ball(double cells) { return Solid::sphere(Vec3::Constant(cells / 2), 0.42 * cells, "surface"); }

TEST(view, values_are_those_within_half_a_step) {
  const std::vector<double> rows{1, -1e9, 2, 3e9, std::nan(""), 0, 1.5, 7};
  const PackedValues packed = pack_values(rows, 2);
  const std::vector<double> found = unpacked(packed.low, packed.step, packed.data);
  ASSERT_EQ(found.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (std::isnan(rows[i]))
      EXPECT_TRUE(std::isnan(found[i]));
    else
      EXPECT_NEAR(found[i], rows[i], 0.501 * packed.step[i % 2]);
  EXPECT_NEAR(packed.step[1], 4e9 / packed_steps, 1);
}

TEST(view, a_constant_has_no_steps_and_nothing_has_no_value) {
  const PackedValues packed = pack_values({5, std::nan(""), 5, INFINITY}, 2);
  const std::vector<double> found = unpacked(packed.low, packed.step, packed.data);
  EXPECT_EQ(found[0], 5);
  EXPECT_EQ(found[2], 5);
  EXPECT_TRUE(std::isnan(found[1]) && std::isnan(found[3]));
}

TEST(view, corners_and_ascending_numbers_come_back) {
  std::vector<int> points;
  for (int i = 0; i < 1000; ++i) points.insert(points.end(), {i, std::max(0, i - 300), i / 2});
  EXPECT_EQ(corners(pack_corners(points)), points);
  const std::vector<int> ascending{0, 1, 130, 131, 40000};
  std::vector<int> found = varints(pack_ascending(ascending));
  for (std::size_t i = 1; i < found.size(); ++i) found[i] += found[i - 1];
  EXPECT_EQ(found, ascending);
}

TEST(view, boundary_and_fields_are_those_of_the_drawn_body) {
  const Body body(ball(6), grid_of(6));
  Results results;
  results.bodies = {body.fields};
  const std::vector<DrawnBody> drawn = draw_bodies(results);
  const ContactSurface surface;
  const ViewData view = view_data({results, drawn, surface, nullptr, nullptr, {}});
  for (const char* ending : {"<", ">", "&"}) EXPECT_EQ(view.json.find(ending), std::string::npos);
  const Json json = Json::parse(view.json), found = json["bodies"][0];
  EXPECT_EQ(found["name"], "ball <&>");
  const std::vector<double> x = unpacked(found["position"]), u = unpacked(found["displacement"]),
                            s = unpacked(found["stress"]);
  const std::vector<int> triangles = corners(found["triangles"]);
  ASSERT_EQ(triangles.size(), 3 * drawn[0].mesh.boundary.size());
  ASSERT_EQ(unpacked(found["error"]).size(), drawn[0].mesh.boundary.size());
  double volume = 0;
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const auto at = [&](std::size_t k) { return Eigen::Map<const Vec3>(&x[3 * triangles[i + k]]); };
    volume += at(0).cross(at(1)).dot(at(2)) / 6;
  }
  EXPECT_NEAR(volume, drawn[0].mesh.volume() * std::pow(0.25, 3), 1e-4 * volume);
  for (std::size_t p = 0; p < x.size() / 3; ++p) {
    const Vec3 position = Eigen::Map<const Vec3>(&x[3 * p]);
    EXPECT_LT((Eigen::Map<const Vec3>(&u[3 * p]) - displacement_at(position)).norm(), 2e-7);
    EXPECT_LT((Eigen::Map<const Sym3>(&s[6 * p]) - stress_at(position)).norm(), 200);
  }
}

TEST(view, contact_values_are_linear_between_rows_and_stay_in_their_range) {
  Results results;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      ContactRow row;
      row.x = Vec3(0.1 * i, 0.1 * j, 1);
      row.normal = Vec3::UnitZ();
      row.pressure_sprc = 3e6 * row.x[0] - 2e6 * row.x[1];
      row.gap = i < 10 ? 1e-6 : INFINITY;
      results.contact_rows.push_back(row);
    }
  ContactFit fit(results, 0);
  const auto inside = fit.at({0.53, 0.78, 1}, 0.5);
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->pressure, 3e6 * 0.53 - 2e6 * 0.78, 2e4);
  EXPECT_NEAR(inside->gap, 1e-6, 1e-12);
  EXPECT_TRUE(std::isnan(fit.at({1.7, 0.8, 1}, 0.2)->gap));
  EXPECT_LE(fit.at({2.0, -0.1, 1}, 0.5)->pressure, 3e6 * 1.9);
  EXPECT_FALSE(fit.at({9, 9, 9}, 0.5));
}

TEST(view, neighbours_of_cells_of_two_sizes_share_whole_edges) {
  const CutCells cells = make_cut_cells(ball(8), grid_of(8));
  BodyFields fields;
  fields.cut_cells = &cells;
  DrawnBody drawn = draw_body(fields);
  // Points hang: the middle of an edge of the first triangle divides what lies beyond, not the triangle itself.
  const std::array<int, 3> first = drawn.mesh.boundary[0].points;
  const int middle = static_cast<int>(drawn.position.size());
  drawn.position.push_back((drawn.position[first[0]] + drawn.position[first[1]]) / 2);
  std::vector<BoundaryTriangle>& boundary = drawn.mesh.boundary;
  for (std::size_t i = 1; i < boundary.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::array<int, 3> points = boundary[i].points;
      if (points[k] != first[1] || points[(k + 1) % 3] != first[0]) continue;
      BoundaryTriangle half = boundary[i];
      boundary[i].points[(k + 1) % 3] = middle;
      half.points[k] = middle;
      boundary.push_back(half);
      i = boundary.size();
      break;
    }
  std::map<std::pair<int, int>, int> edges;
  const std::vector<ThinTriangle> triangles = conforming_boundary(drawn);
  for (const ThinTriangle& triangle : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = triangle.points[k], b = triangle.points[(k + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  EXPECT_EQ(triangles.size(), boundary.size() + 1);
  for (const auto& [edge, balance] : edges) EXPECT_EQ(balance, 0);
}

TEST(view, a_boundary_of_many_triangles_is_thinned_and_stays_closed) {
  const Body body(ball(20), grid_of(20));
  std::vector<DrawnBody> drawn{draw_body(body.fields)};
  SceneBox zone;
  zone.add(Vec3(3.4, 0.4, 4.9));
  zone.add(Vec3(3.6, 0.6, 5.2));
  const std::size_t all = drawn[0].mesh.boundary.size(), most = all / 3;
  const auto thin = thin_boundaries(drawn, {zone}, most)[0];
  EXPECT_LE(thin.size(), most);
  EXPECT_GT(thin.size(), most / 3);
  std::map<std::pair<int, int>, int> edges;  // of a closed boundary each has its opposite
  double volume = 0;
  std::size_t near = 0, near_before = 0;
  const auto is_near = [&](const std::array<int, 3>& points) {
    return std::all_of(points.begin(), points.end(), [&](int p) {
      return (drawn[0].position[p] - (zone.low + zone.high) / 2).cwiseAbs().maxCoeff() < 0.15;
    });
  };
  for (const ThinTriangle& triangle : thin) {
    for (int k = 0; k < 3; ++k) {
      const int a = triangle.points[k], b = triangle.points[(k + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
    const auto& x = drawn[0].position;
    volume += x[triangle.points[0]].cross(x[triangle.points[1]]).dot(x[triangle.points[2]]) / 6;
    near += is_near(triangle.points);
  }
  for (const BoundaryTriangle& triangle : drawn[0].mesh.boundary) near_before += is_near(triangle.points);
  for (const auto& [edge, balance] : edges) EXPECT_EQ(balance, 0);
  EXPECT_EQ(near, near_before);
  EXPECT_GT(near, 10);
  EXPECT_NEAR(volume, drawn[0].mesh.volume() * std::pow(0.25, 3), 0.05 * volume);
  EXPECT_EQ(thin_boundaries(drawn, {}, all)[0].size(), all);
}

TEST(view, blocks_fill_the_cells_with_their_values) {
  const Body body(ball(20), grid_of(20));
  SceneBox zone;
  zone.add(Vec3(3.5, 0.5, 5));
  for (const std::size_t most : {std::size_t{100000}, std::size_t{1500}}) {
    const SampledCells sampled = sample_cells(body.fields, {zone}, most);
    EXPECT_LE(sampled.blocks.size(), most);
    EXPECT_EQ(sampled.largest_block > 1, most == 1500);
    double volume = 0, smallest = INFINITY;
    for (const auto& block : sampled.blocks) {
      const double size = sampled.position[block[1]][0] - sampled.position[block[0]][0];
      volume += std::pow(size, 3);
      if ((sampled.position[block[0]] - zone.low).norm() < 0.4) smallest = std::min(smallest, size);
    }
    EXPECT_GE(volume, (1 - 1e-9) * static_cast<double>(body.cells.cells.size()) * std::pow(0.25, 3));
    EXPECT_NEAR(smallest, 0.25, 1e-12);
    const double outside = most == 1500 ? 1.0 : 0.0;  // corners outside of all cells have the values of the nearest one
    for (std::size_t p = 0; p < sampled.position.size(); ++p) {
      EXPECT_LE((sampled.displacement[p] - displacement_at(sampled.position[p])).norm(), 4e-3 * outside + 1e-12);
      EXPECT_LE((sampled.stress[p] - stress_at(sampled.position[p])).norm(), 4e6 * outside + 1e-3);
    }
    EXPECT_EQ(sampled.stress_error.size(), sampled.blocks.size());
  }
}

}  // namespace
}  // namespace cgcontact::test_view
