/// The pressure of a zone from what its groups know: forces that are right in sum only, and mean gaps.
#include <gtest/gtest.h>

#include <cmath>

#include "recovery/face/face_problem.hpp"
#include "recovery/face/face_zone.hpp"
#include "recovery/face/far_field.hpp"

namespace cgcontact::test_face_zone {
namespace {

/// A spline of three knots' smoothness follows a quadratic exactly, whatever its means are taken over.
TEST(FarField, Quadratic) {
  FaceGrid grid;
  grid.size = {40, 32};
  grid.spacing = {0.125, 0.125};
  grid.low = {-2.3, -1.9};
  const auto exact = [](const FacePosition& x) { return 1 + 2 * x[0] - x[1] + 0.3 * x[0] * x[0] - 0.7 * x[0] * x[1]; };
  std::vector<FarMean> means;
  for (int i = 0; i < 40; i += 8)
    for (int j = 0; j < 32; j += 8) {
      FarMean mean;
      for (int k = 0; k < 64; ++k) {
        mean.patches.emplace_back((i + k / 8) * 32 + j + k % 8, 1.0 / 64);
        mean.value += exact(grid.centre(mean.patches.back().first)) / 64;
      }
      mean.weight = 1;
      means.push_back(mean);
    }
  const std::vector<double> field = FarField(grid, 1, std::vector<char>(grid.num_patches(), 1), means).with_details(2);
  for (int n = 0; n < grid.num_patches(); ++n) EXPECT_NEAR(field[n], exact(grid.centre(n)), 1e-6);
}

/// Behind a symmetry plane the field is its own image: no slope there.
TEST(FarField, Mirror) {
  FaceGrid grid;
  grid.plane_strain = true;
  grid.size = {1, 64};
  grid.spacing = {1, 0.0625};
  grid.end[1] = FaceEnd::mirror;
  std::vector<FarMean> means;
  for (int j = 0; j < 64; j += 16) {
    FarMean mean;
    for (int k = 0; k < 16; ++k) {
      mean.patches.emplace_back(j + k, 1.0 / 16);
      mean.value += std::pow(grid.centre(j + k)[1], 2) / 16;
    }
    mean.weight = 1;
    means.push_back(mean);
  }
  const std::vector<double> field = FarField(grid, 1, std::vector<char>(64, 1), means).with_details(2);
  for (int j = 0; j < 64; ++j) EXPECT_NEAR(field[j], std::pow(grid.centre(j)[1], 2), 1e-6);
}

/// Twenty cells in a row of sixteen patches each, whose means are those of a wave; grid and knots have nothing in
/// common.
struct Wave {
  FaceGrid grid;
  std::vector<FarMean> means;
  std::vector<char> inside;

  Wave(double length, double error) : inside(322, 1) {
    grid.plane_strain = true;
    grid.size = {1, 322};
    grid.spacing = {1, 0.0625};
    for (int j = 1; j < 321; j += 16) {
      FarMean mean;
      for (int k = 0; k < 16; ++k) {
        mean.patches.emplace_back(j + k, 1.0 / 16);
        mean.value += std::cos(2 * pi * grid.centre(j + k)[1] / length) / 16;
      }
      mean.weight = 1;
      mean.error = error;
      means.push_back(mean);
    }
  }
  double misfit(double details) const {
    const std::vector<double> field = FarField(grid, 1, inside, means).with_details(details);
    double sum = 0;
    for (const FarMean& mean : means) {
      double value = -mean.value;
      for (const auto& [patch, fraction] : mean.patches) value += fraction * field[patch];
      sum += value * value;
    }
    return std::sqrt(sum / static_cast<double>(means.size()));
  }
};

/// The discrepancy principle: details as long as the errors of the means allow. What allows nothing, or everything, has
/// the bounds; between, the means are met as well as they are known, up to the hundredth of a cell to which lengths are
/// sought.
TEST(FarField, LongestDetails) {
  for (const double error : {0.01, 0.03, 0.1}) {
    const Wave wave(4, error);
    const double found = FarField(wave.grid, 1, wave.inside, wave.means).longest_details(0.1, 2);
    EXPECT_GT(found, 0.2) << error;
    EXPECT_LT(found, 1.9) << error;
    EXPECT_LE(wave.misfit(found), error);
    EXPECT_GT(wave.misfit(found + 0.02), error);
  }
  const Wave exact(4, 1e-12), any(4, 10);
  EXPECT_NEAR(FarField(exact.grid, 1, exact.inside, exact.means).longest_details(0.5, 1.5), 0.5, 1e-12);
  EXPECT_NEAR(FarField(any.grid, 1, any.inside, any.means).longest_details(0.5, 1.5), 1.5, 1e-12);
}

/// Means that are known better count more: with an error a thousand times as large a wrong one changes nothing.
TEST(FarField, BetterMeansCountMore) {
  Wave wave(40, 0.01), spoilt(40, 0.01);
  spoilt.means[9].value += 1;
  spoilt.means[9].error = 10;
  const std::vector<double> field = FarField(wave.grid, 1, wave.inside, wave.means).with_details(1),
                            other = FarField(spoilt.grid, 1, spoilt.inside, spoilt.means).with_details(1);
  for (std::size_t n = 0; n < field.size(); ++n) EXPECT_NEAR(field[n], other[n], 1e-3);
}

/// The mirror image of the means has the mirrored field, to rounding.
TEST(FarField, MirroredFace) {
  Wave wave(7, 0.01), mirrored(7, 0.01);
  const int last = wave.grid.size[1] - 1;
  for (FarMean& mean : mirrored.means)
    for (auto& [patch, fraction] : mean.patches) patch = last - patch;
  const std::vector<double> field = FarField(wave.grid, 1, wave.inside, wave.means).with_details(1),
                            other = FarField(mirrored.grid, 1, mirrored.inside, mirrored.means).with_details(1);
  for (int n = 0; n <= last; ++n) EXPECT_NEAR(field[n], other[last - n], 1e-9);
}

/// Hertz's ball on cells of half the zone's radius and less: groups that close as wholes with the force of the exact
/// pressure, the half-space's mean gaps, and a far field that bends. The pressure is within 1.5 % although no group at
/// the border carries what it should: half of the border cells' force has gone to their neighbours inside.
TEST(FaceZone, Ball) {
  for (const double cells : {2.0, 3.3})
    for (const double offset : {0.1, 0.45}) {
      const double h = 1 / cells, largest = 2 / pi;  // radius 1, E* = 1: p0 = 2 a / (pi R)
      const int per_cell = 12, side = static_cast<int>(std::ceil(cells + 3)) + 1;
      FaceZone zone;
      zone.h = h;
      zone.modulus = 1;
      for (int a = 0; a < 2; ++a) {
        zone.grid.size[a] = 2 * side * per_cell;
        zone.grid.spacing[a] = h / per_cell;
        zone.grid.low[a] = (-side - offset) * h;
      }
      const auto exact = [&](const FacePosition& x) { return largest * std::sqrt(std::max(1 - x.squaredNorm(), 0.0)); };
      const HalfSpace half_space(ExecSpace(), zone.grid, 1);
      const HalfSpace::Patches p("p", zone.grid.size[0], zone.grid.size[1]),
          u("u", zone.grid.size[0], zone.grid.size[1]);
      const auto host = Kokkos::create_mirror_view(p);
      for (int n = 0; n < zone.grid.num_patches(); ++n)
        host(n / zone.grid.size[1], n % zone.grid.size[1]) = exact(zone.grid.centre(n));
      Kokkos::deep_copy(p, host);
      half_space.apply(ExecSpace(), p, u);
      const auto response = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u);
      const auto far = [](const FacePosition& x) { return 0.02 * x[0] + 0.01 * x[1] * x[1]; };
      zone.groups.resize(static_cast<std::size_t>(4 * side * side));
      std::vector<double> force(zone.groups.size(), 0.0);
      for (int n = 0; n < zone.grid.num_patches(); ++n) {
        const int i = n / zone.grid.size[1], j = n % zone.grid.size[1], g = i / per_cell * 2 * side + j / per_cell;
        const FacePosition x = zone.grid.centre(n);
        zone.shares.push_back({n, g, 1});
        zone.inside.push_back(1);
        zone.may_press.push_back(x.norm() < 1 + 1.25 * h);
        zone.distance.push_back(x.squaredNorm() / 2 - far(x));
        zone.groups[g].area += zone.grid.area();
        zone.groups[g].gap_change += (response(i, j) + far(x)) / (per_cell * per_cell);
        force[g] += exact(x) * zone.grid.area();
      }
      // Cells whose centre is outside the circle are open; their force acts in the cell next to them on the way
      // inwards.
      const auto centre = [&](int g) {
        return FacePosition((g / (2 * side) - side - offset + 0.5) * h, (g % (2 * side) - side - offset + 0.5) * h);
      };
      const auto closed = [&](int g) { return centre(g).norm() < 1; };
      for (int g = 0; g < static_cast<int>(force.size()); ++g) {
        int to = g;
        while (!closed(to)) {
          int axis = 0;
          centre(to).cwiseAbs().maxCoeff(&axis);
          to += (centre(to)[axis] > 0 ? -1 : 1) * (axis == 0 ? 2 * side : 1);
        }
        zone.groups[to].force += force[g];
      }
      for (int g = 0; g < static_cast<int>(force.size()); ++g) {
        double away = closed(g) ? 0 : 1e300;
        for (int k = 0; k < static_cast<int>(force.size()) && away > 0; ++k)
          if (closed(k)) away = std::min(away, (centre(k) - centre(g)).norm());
        zone.groups[g].away = away;
      }
      FaceOptions options;
      options.cell_stiffness = 0;  // these gaps lack nothing
      const FacePressure pressure = solve_face_zone(ExecSpace(), zone, options);
      double error = 0, norm = 0;
      for (double x = -1.2; x < 1.2; x += 0.0237)
        for (double y = -1.2; y < 1.2; y += 0.0311) {
          error += std::pow(pressure.at({x, y}) - exact({x, y}), 2);
          norm += std::pow(exact({x, y}), 2);
        }
      EXPECT_LT(std::sqrt(error / norm), 0.015) << cells << " " << offset;
      EXPECT_TRUE(pressure.solution.converged);
      EXPECT_LT(pressure.solution.iterations, 100);
    }
}

}  // namespace
}  // namespace cgcontact::test_face_zone
