/// The pressure of a finished run as a reference for others.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include "contact/results/reference/pressure_error.hpp"
#include "contact/study/face_pressure.hpp"
#include "core/base/files/text.hpp"
#include "core/output/fields/output_csv.hpp"

namespace cgcontact::test_face_pressure {
namespace {

double pressure(int body, const Vec3& x) { return body == 0 ? 1 + 2 * x[0] - 3 * x[1] : 5 * x[0] * x[1]; }

/// Two bodies on the unit square at z = 3, n x n points each.
std::vector<ContactRow> square(int n, double shift) {
  std::vector<ContactRow> rows;
  for (int body = 0; body < 2; ++body)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        ContactRow row;
        row.body = body;
        row.x = Vec3((i + shift) / n, (j + shift) / n, 3);
        row.weight = 1.0 / (n * n);
        row.pressure_raw = row.pressure_spr = row.pressure_sprc = pressure(body, row.x);
        rows.push_back(row);
      }
  return rows;
}

TEST(SampledPressure, linear_pressure_is_met_exactly_between_the_points_and_beyond) {
  const SampledPressure fine(square(20, 0.5), 0.1);
  for (const Vec3& x : {Vec3(0.33, 0.71, 3), Vec3(0.5, 0.5, 3.001), Vec3(0, 1, 3)})
    EXPECT_NEAR(fine(0, x), pressure(0, x), 1e-10);
  EXPECT_NEAR(fine(1, {0.33, 0.71, 3}), pressure(1, {0.33, 0.71, 3}), 0.01) << "not linear";
}

TEST(SampledPressure, points_in_a_row_and_lonely_points) {
  std::vector<ContactRow> rows = square(20, 0.5);
  std::vector<ContactRow> line;
  for (const ContactRow& row : rows)
    if (row.body == 0 && std::abs(row.x[1] - 0.525) < 1e-9) line.push_back(row);
  EXPECT_NEAR(SampledPressure(line, 0.2)(0, {0.4, 0.525, 3}), pressure(0, {0.4, 0.525, 3}), 1e-10);
  EXPECT_EQ(SampledPressure({line[0]}, 0.2)(0, {0.4, 0.5, 3}), line[0].pressure_sprc) << "the nearest one";
}

TEST(SampledPressure, errors_against_it) {
  const SampledPressure fine(square(40, 0.5), 0.05);
  std::vector<ContactRow> coarse = square(7, 0.3);
  for (ContactRow& row : coarse) row.pressure_raw += 2;
  const auto errors = pressure_errors(coarse, [&](const ContactRow& row) { return fine(row.body, row.x); }, {});
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].zone, "whole");
  EXPECT_LT(errors[0].sprc, 1e-3);
  double norm = 0;
  for (const ContactRow& row : coarse) norm += row.weight * std::pow(pressure(row.body, row.x), 2);
  EXPECT_NEAR(errors[0].raw, std::sqrt(8 / norm), 1e-3);
}

/// Straight and round zones that end like a square root, points half a cell apart. Beyond a cell from the end a linear
/// fit to sqrt(d), d >= h = 1/20, is wrong by up to (h/2)^2 / (32 h^1.5) = 9e-4 of sqrt(1 m); measured: 6e-4 of the
/// norm. A linear fit up to the end: 0.010; one that smooths over a cell: 0.012.
TEST(SampledPressure, the_end_of_a_contact_zone_stays_steep) {
  const auto straight = [](const Vec3& x) { return std::sqrt(std::max(0.0, 0.6 - x[0])); };
  const auto round = [](const Vec3& x) { return std::sqrt(std::max(0.0, 0.4 - x.head<2>().squaredNorm())); };
  for (const auto& at : std::initializer_list<std::function<double(const Vec3&)>>{straight, round}) {
    std::vector<ContactRow> rows = square(40, 0.5);
    for (ContactRow& row : rows) row.pressure_sprc = at(row.x);
    const SampledPressure fine(rows, 0.05);
    double error = 0, norm = 0;
    for (const ContactRow& row : square(97, 0.5)) {
      error += std::pow(fine(row.body, row.x) - at(row.x), 2);
      norm += std::pow(at(row.x), 2);
    }
    EXPECT_LT(std::sqrt(error / norm), 9e-4 / std::sqrt(norm / (2 * 97 * 97)));
    const SampledPressure many_at_one_point(std::vector<ContactRow>(8, rows[0]), 0.05);
    EXPECT_EQ(many_at_one_point(0, rows[0].x), rows[0].pressure_sprc);
  }
}

/// The pressure grows towards the edge of a punch: nothing is extrapolated beyond it.
TEST(SampledPressure, the_edge_of_a_body_is_no_end_of_a_zone) {
  std::vector<ContactRow> rows = square(40, 0.5);
  double largest = 0;
  for (ContactRow& row : rows) {
    row.pressure_sprc = row.x[0] < 0.6 ? 1 / std::sqrt(0.61 - row.x[0]) : 0;
    largest = std::max(largest, row.pressure_sprc);
  }
  const SampledPressure fine(rows, 0.05);
  for (const ContactRow& row : square(97, 0.5)) {
    EXPECT_LE(fine(row.body, row.x), largest * (1 + 1e-12)) << row.x.transpose();
    EXPECT_TRUE(row.x[0] < 0.65 || fine(row.body, row.x) == 0) << row.x.transpose();
  }
}

/// What the program writes, also with the columns of friction and with names that need quotes.
TEST(SampledPressure, tables_are_read_back) {
  const std::string file =
      (std::filesystem::temp_directory_path() / ("cgcontact_rows_" + std::to_string(getpid()))).string();
  const char* const names[] = {"lower", "upper, \"outer\" ring"};
  Scene scene;
  Results results;
  for (const char* name : names) {
    scene.bodies.emplace_back().name = name;
    results.bodies.emplace_back().name = name;
  }
  results.pairs.emplace_back().name = "pair, of two";
  ContactRow written;
  written.body = 1;
  written.x = Vec3(1, 2, 3);
  written.weight = 0.5;
  written.gap = std::numeric_limits<double>::infinity();
  written.pressure_raw = 10;
  written.pressure_spr = 20;
  written.pressure_sprc = 30;
  results.contact_rows = {written};
  for (const bool friction : {false, true}) {
    if (friction) results.pairs[0].friction.emplace();
    write_contact_csv(results, file);
    const auto rows = read_contact_rows(file, scene);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].body, 1);
    EXPECT_EQ(rows[0].x, Vec3(1, 2, 3));
    EXPECT_EQ(rows[0].weight, 0.5);
    EXPECT_EQ(rows[0].pressure_raw, 10);
    EXPECT_EQ(rows[0].pressure_spr, 20);
    EXPECT_EQ(rows[0].pressure_sprc, 30);
  }
  const std::string columns = "body,x,y,z,weight,pressure_raw,pressure_spr,pressure_sprc\n";
  for (const std::string& text :
       {columns + "other,1,2,3,0.5,10,20,30\n", columns + "lower,1\n", std::string("names\nlower\n")}) {
    write_text(file, text);
    EXPECT_THROW(read_contact_rows(file, scene), InputError) << text;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace cgcontact::test_face_pressure
