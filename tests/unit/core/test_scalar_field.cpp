#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <utility>

#include "core/drawing/extremes.hpp"

namespace cgcontact::test_scalar_field {
namespace {

/// In turned axes.
Sym3 turned(const Vec3& principal) {
  const Mat3 r = (Eigen::AngleAxisd(0.7, Vec3(1, -2, 3).normalized()) * Eigen::AngleAxisd(1.1, Vec3::UnitX())).matrix();
  return voigt(r * principal.asDiagonal() * r.transpose());
}

// Known invariants: uniaxial stress, pure shear (von Mises sqrt(3) tau, Tresca 2 tau), pressure (zero), and a general
// state, in any axes.
TEST(scalar_field, invariants_of_known_stresses) {
  EXPECT_NEAR(von_mises(turned({7, 0, 0})), 7, 1e-14);
  EXPECT_NEAR(tresca(turned({0, -7, 0})), 7, 1e-14);
  Sym3 shear;
  shear << 0, 0, 0, 2, 0, 0;
  EXPECT_NEAR(von_mises(shear), 2 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(tresca(shear), 4, 1e-14);
  EXPECT_NEAR(tresca(turned({-3, -3, -3})), 0, 1e-14);
  EXPECT_LT((principal_stresses(turned({-3, 5, 1})) - Vec3(5, 1, -3)).norm(), 1e-14);
  EXPECT_NEAR(von_mises(turned({-3, 5, 1})), std::sqrt((64 + 16 + 16) / 2.0), 1e-14);
}

// Every name gives its own component.
TEST(scalar_field, values_by_name) {
  const Vec3 u(3, -4, 12);
  Sym3 s;
  s << 1, 2, 3, 4, 5, 6;
  EXPECT_EQ(value_of(ScalarField::displacement, u, s), 13);
  EXPECT_EQ(value_of(ScalarField::displacement_y, u, s), -4);
  EXPECT_EQ(value_of(ScalarField::stress_zx, u, s), 6);
  EXPECT_EQ(value_of(ScalarField::stress_xy, u, s), 4);
  EXPECT_EQ(value_of(ScalarField::principal_2, u, s), principal_stresses(s)[1]);
  EXPECT_TRUE(std::isnan(value_of(ScalarField::pressure, u, s)));
  EXPECT_EQ(scalar_field_names().size(), static_cast<std::size_t>(ScalarField::pressure) + 1);
  EXPECT_EQ(name_of(ScalarField::principal_3), "principal_3");
}

/// A box of 4 x 3 x 2 cells of 1 m, from (0.3, 0.6, 0.4) in its grid, with sxx = 10 x - 20, u = (0, y, 0).
struct Bent {
  Grid grid;
  CutCells cells;
  Results results;
  Scene scene;
  Bent() {
    grid.num_cells = {5, 4, 3};
    cells = make_cut_cells(Solid::box({0.3, 0.6, 0.4}, {4.3, 3.6, 2.4}, "box"), grid);
    BodyFields fields;
    fields.name = "bent";
    fields.cut_cells = &cells;
    fields.material.yield_stress = 92;
    const auto x = [this](int cell, const Vec3& xi) { return global_position(cells, cell, xi); };
    fields.stress_recovered = [x](int cell, const Vec3& xi) {
      Sym3 s = Sym3::Zero();
      s[0] = 10 * x(cell, xi)[0] - 20;
      return s;
    };
    fields.displacement = [x](int cell, const Vec3& xi) { return Vec3(0, x(cell, xi)[1], 0); };
    results.bodies.push_back(fields);
    scene.bodies.resize(1);
    FaceSpec left, tiny;
    left.name = "left";
    left.surfaces = {"box.x-"};
    tiny.name = "tiny";  // holds no corner of a cell
    tiny.surfaces = {"box.z+"};
    tiny.box = std::make_pair(Vec3(2.1, 1.1, 2.4), Vec3(2.9, 1.9, 2.4));
    scene.bodies[0].faces = {left, tiny};
  }
};

// Linear fields have their extremes in the corners of the box, exactly; of a face in its own corners, and of one
// smaller than a cell at its points.
TEST(extremes, of_linear_fields_are_exact) {
  const Bent bent;
  const std::vector<DrawnBody> drawn{draw_body(bent.results.bodies[0])};
  const std::vector<BodyExtremes> extremes = extremes_of(bent.results, bent.scene, drawn);
  ASSERT_EQ(extremes.size(), 1U);
  const Extremes& whole = extremes[0].body;
  EXPECT_NEAR(whole.von_mises.value, 23, 1e-13);
  EXPECT_NEAR(whole.von_mises.at[0], 4.3, 1e-13);
  EXPECT_NEAR(whole.tresca.value, 23, 1e-13);
  EXPECT_NEAR(whole.tension.value, 23, 1e-13);
  EXPECT_NEAR(whole.compression.value, -17, 1e-13);
  EXPECT_NEAR(whole.compression.at[0], 0.3, 1e-13);
  EXPECT_NEAR(whole.displacement.value, 3.6, 1e-13);
  EXPECT_NEAR(whole.displacement.at[1], 3.6, 1e-13);
  EXPECT_NEAR(whole.safety_factor.value(), 4, 1e-12);
  EXPECT_FALSE(whole.pressure.has_value());
  ASSERT_EQ(extremes[0].faces.size(), 2U);
  const Extremes& left = extremes[0].faces[0].second;
  EXPECT_NEAR(left.von_mises.value, 17, 1e-13);
  EXPECT_NEAR(left.tension.value, 0, 1e-13);
  EXPECT_NEAR(left.compression.value, -17, 1e-13);
  const Extremes& tiny = extremes[0].faces[1].second;
  EXPECT_GT(tiny.von_mises.value, 0);
  EXPECT_NEAR(tiny.von_mises.value, std::abs(10 * tiny.von_mises.at[0] - 20), 1e-12);
  EXPECT_LE(tiny.von_mises.at[0], 2.9);
  EXPECT_EQ(body_with_largest(extremes, &Extremes::von_mises), 0);
  EXPECT_EQ(body_with_smallest({}, &Extremes::compression), -1);
}

// Inside of a body, where nothing is stored, too: a peak at a node that no cell at the boundary has, by single values
// and by those of many corners.
TEST(extremes, inside_of_a_body) {
  Grid grid;
  grid.num_cells = {8, 8, 8};
  const CutCells cells = make_cut_cells(Solid::box(Vec3::Constant(0.3), Vec3::Constant(7.4), "box"), grid);
  const Vec3 peak(4, 3, 5);
  const auto stress_at = [&](int cell, const Vec3& xi) {
    Sym3 s = Sym3::Zero();
    s[0] = 1 / (1 + (global_position(cells, cell, xi) - peak).squaredNorm());
    return s;
  };
  for (const bool by_corners : {false, true}) {
    Results results;
    BodyFields fields;
    fields.cut_cells = &cells;
    fields.stress_recovered = stress_at;
    int asked = 0;
    if (by_corners)
      fields.stress_at_corners = [&](const std::vector<int>& of, const std::vector<signed char>& corners) {
        std::vector<Sym3> stress;
        for (std::size_t i = 0; i < of.size(); ++i)
          stress.push_back(
              stress_at(of[i], Vec3(corners[i] & 1 ? 1 : -1, corners[i] & 2 ? 1 : -1, corners[i] & 4 ? 1 : -1)));
        asked += static_cast<int>(of.size());
        return stress;
      };
    results.bodies.push_back(fields);
    const Extreme most = extremes_of(results, {}, {draw_body(results.bodies[0])})[0].body.von_mises;
    EXPECT_NEAR(most.value, 1, 1e-15);
    EXPECT_EQ(most.at, peak);
    EXPECT_EQ(asked > 0, by_corners);
  }
}

// Principal stresses are solved where they can be the largest only: the same extremes, to the last bit, as those of all
// points, also where two or all three are nearly equal.
TEST(extremes, leave_out_no_point) {
  for (const double split : {1.0, 1e-6, 1e-9, 1e-14, 0.0}) {
    const Bent bent;
    std::vector<DrawnBody> drawn{draw_body(bent.results.bodies[0])};
    std::minstd_rand random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    Extreme tension, compression, tresca;
    tension.value = -1e300;
    compression.value = 1e300;
    std::vector<Sym3>& stresses = drawn[0].stress;
    ASSERT_GT(stresses.size(), 100U);
    for (std::size_t p = 0; p < stresses.size(); ++p) {
      const double mean = any(random), level = any(random);
      const Vec3 principal =
          Vec3::Constant(mean) + Vec3(level, level + split * any(random), p % 3 ? -2 * level : level);
      const Mat3 axes = Eigen::Quaterniond(any(random), any(random), any(random), any(random)).normalized().matrix();
      stresses[p] = voigt(axes * principal.asDiagonal() * axes.transpose());
      const Vec3 exact = principal_stresses(stresses[p]);
      if (exact[0] > tension.value) tension = {exact[0], drawn[0].position[p]};
      if (exact[2] < compression.value) compression = {exact[2], drawn[0].position[p]};
      if (exact[0] - exact[2] > tresca.value) tresca = {exact[0] - exact[2], drawn[0].position[p]};
    }
    const Extremes found = extremes_of(bent.results, bent.scene, drawn)[0].body;
    for (const auto& [a, b] :
         {std::pair{found.tension, tension}, {found.compression, compression}, {found.tresca, tresca}}) {
      EXPECT_EQ(a.value, b.value) << split;
      EXPECT_EQ(a.at, b.at) << split;
    }
  }
}

// Where a contact face is, its largest pressure is that of its touching rows.
TEST(extremes, of_the_contact_pressure) {
  Bent bent;
  for (const double x : {1.0, 2.0, 3.0}) {
    ContactRow row;
    row.x = Vec3(x, 2, 2.4);
    row.normal = Vec3::UnitZ();
    row.pressure_sprc = 5 * x;
    row.touching = x < 2.5;
    bent.results.contact_rows.push_back(row);
  }
  const auto extremes = extremes_of(bent.results, bent.scene, {draw_body(bent.results.bodies[0])});
  ASSERT_TRUE(extremes[0].body.pressure.has_value());
  EXPECT_EQ(extremes[0].body.pressure->value, 10);
  EXPECT_EQ(extremes[0].body.pressure->at, Vec3(2, 2, 2.4));
  EXPECT_FALSE(extremes[0].faces[0].second.pressure.has_value());
}

}  // namespace
}  // namespace cgcontact::test_scalar_field
