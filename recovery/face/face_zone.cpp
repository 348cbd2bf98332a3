#include "recovery/face/face_zone.hpp"

#include <algorithm>
#include <cmath>

#include "recovery/face/edge_continuation.hpp"
#include "recovery/face/far_field.hpp"
#include "recovery/face/patch_problem.hpp"

namespace cgcontact {
namespace {

/// Patches in a length along an axis, at least one.
int steps_in(const FaceGrid& grid, int axis, double length) {
  return std::max(1, static_cast<int>(std::lround(length / grid.spacing[axis])));
}

/// h^2 times the Laplacian of values at the patches, by differences over a cell; 0 along an axis where one is missing.
double curvature(const FaceGrid& grid, const std::vector<double>& values, double h, int patch) {
  double sum = 0;
  for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a) {
    const int step = steps_in(grid, a, h);
    const auto [before, after] = grid.beside(patch, a, step);
    if (before < 0 || after < 0) continue;
    const double ratio = h / (step * grid.spacing[a]);
    sum += ratio * ratio * (values[before] - 2 * values[patch] + values[after]);
    if (!grid.meridian) continue;  // around the axis: (dr / ds) / r du / ds
    const double radius = grid.ring(patch), widens = (grid.ring(after) - grid.ring(before)) / 2;
    const bool on_axis = before == patch || radius < std::abs(widens);  // its image behind the axis
    sum += ratio * ratio *
           (on_axis ? values[before] - 2 * values[patch] + values[after]
                    : 0.5 * widens / radius * (values[after] - values[before]));
  }
  return sum;
}

/// Fraction of a group's area that its patches may miss; those at the border of what is looked at miss more.
constexpr double cover = 0.1;
/// By which the details of the far field may be shorter as well, for the estimate (docs/recovery.md, "Error figures").
constexpr double other_details = 1.15;

/// Sums of what patches share of each group, patches, each with what it counts.
std::vector<double> sizes_of_groups(const FaceZone& zone) {
  std::vector<double> sizes(zone.groups.size(), 0.0);
  for (const FaceShare& share : zone.shares) sizes[share.group] += share.fraction * zone.grid.ring(share.patch);
  return sizes;
}

/// The forces as they act: even over each group, Pa. What groups without patches transmit goes to all.
std::vector<double> acting_pressure(const FaceZone& zone, const std::vector<double>& sizes) {
  std::vector<double> pressure(zone.grid.num_patches(), 0.0);
  double force = 0, kept = 0;
  for (std::size_t g = 0; g < zone.groups.size(); ++g) {
    force += zone.groups[g].force;
    if (sizes[g] > 0) kept += zone.groups[g].force;
  }
  for (const FaceShare& share : zone.shares)
    if (kept > 0)
      pressure[share.patch] +=
          force / kept * share.fraction * zone.groups[share.group].force / (sizes[share.group] * zone.grid.area());
  return pressure;
}

/// Computes the displacements of the half-spaces under the forces as they act, m.
std::vector<double> respond(const ExecSpace& exec, const FaceZone& zone, const std::vector<double>& pressure) {
  const FaceGrid& grid = zone.grid;
  const HalfSpace::Patches p("cgcontact::face_zone::acting", grid.size[0], grid.size[1]),
      u("cgcontact::face_zone::response", grid.size[0], grid.size[1]);
  const auto host = Kokkos::create_mirror_view(p);
  for (int n = 0; n < grid.num_patches(); ++n) host(n / grid.size[1], n % grid.size[1]) = pressure[n];
  Kokkos::deep_copy(p, host);
  HalfSpace(exec, grid, zone.modulus).apply(exec, p, u);
  exec.fence();
  const auto result = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u);
  std::vector<double> response(grid.num_patches());
  for (int n = 0; n < grid.num_patches(); ++n) response[n] = result(n / grid.size[1], n % grid.size[1]);
  return response;
}

/// Gives what the groups say of the far field: their mean gaps less what the half-spaces give way by.
std::vector<FarMean> far_means(const FaceZone& zone, const std::vector<double>& sizes,
                               const std::vector<double>& response, const FaceOptions& options) {
  const FaceGrid& grid = zone.grid;
  const double cell = grid.plane_strain ? zone.h : zone.h * zone.h;
  std::vector<FarMean> means(zone.groups.size());
  std::vector<double> bent(zone.groups.size(), 0.0);
  for (const FaceShare& share : zone.shares) {
    const double fraction = share.fraction * grid.ring(share.patch) / sizes[share.group];
    means[share.group].patches.emplace_back(share.patch, fraction);
    means[share.group].value -= fraction * response[share.patch];
    bent[share.group] += fraction * curvature(grid, response, zone.h, share.patch);
  }
  double squares = 0, weights = 0;
  for (std::size_t g = 0; g < zone.groups.size(); ++g) {
    const FaceGroup& group = zone.groups[g];
    const double away = group.away / (options.fall * zone.h);
    means[g].value += group.gap_change - options.cell_stiffness * bent[g];
    means[g].error = std::hypot(bent[g], zone.h * group.force / std::max(group.area, 1e-300) / zone.modulus);
    // The mean over an incomplete group is another one.
    const bool whole = std::abs(sizes[g] * grid.area() - group.area) < cover * group.area;
    means[g].weight = whole || group.force > 0 ? group.area / cell * std::exp(-0.5 * away * away) : 0;
    squares += means[g].weight * means[g].error * means[g].error;
    weights += means[g].weight;
  }
  // Errors at one group spread, to some extent, to those around it.
  for (FarMean& mean : means)
    mean.error = options.gap_error * std::hypot(mean.error, std::sqrt(squares / std::max(weights, 1e-300)));
  return means;
}

/// Gap at the patches without their pressure: the distance and the far field.
std::vector<double> gap_without_pressure(const FaceZone& zone, const FarField& far, double details) {
  std::vector<double> gap = far.with_details(details);
  for (int n = 0; n < zone.grid.num_patches(); ++n) gap[n] = zone.inside[n] ? gap[n] + zone.distance[n] : 0;
  return gap;
}

/// Calls use(m) for the patches less than a distance away along an axis, m, the patch itself too.
template <class Use>
void each_near(const FaceGrid& grid, double distance, int axis, int patch, const Use& use) {
  const int reach = static_cast<int>(std::ceil(distance / grid.spacing[axis])) - 1;
  for (int k = -reach; k <= reach; ++k) {
    std::array<int, 2> steps{0, 0};
    steps[axis] = k;
    if (const int m = grid.beyond(patch, steps); m >= 0) use(m);
  }
}

/// Changes of the gap's curvature along the axes within a cell of each patch: of fillets and other faces that end; of
/// balls and cylinders the fraction is small.
struct CurvatureChanges {
  std::vector<double> change;    ///< times a cell
  std::vector<double> fraction;  ///< of the largest curvature around, at most 1
};

CurvatureChanges changes_of_curvature(const FaceZone& zone) {
  const FaceGrid& grid = zone.grid;
  CurvatureChanges changes{std::vector<double>(grid.num_patches(), 0.0), std::vector<double>(grid.num_patches(), 0.0)};
  for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a) {
    const int step = steps_in(grid, a, 0.25 * zone.h);
    const double length = step * grid.spacing[a];
    std::vector<double> curvature(grid.num_patches(), 0.0);
    std::vector<char> known(grid.num_patches(), 0);
    for (int n = 0; n < grid.num_patches(); ++n) {
      const auto [before, after] = grid.beside(n, a, step);
      if (before < 0 || after < 0 || !zone.inside[n] || !zone.inside[before] || !zone.inside[after]) continue;
      known[n] = 1;
      curvature[n] = (zone.distance[before] - 2 * zone.distance[n] + zone.distance[after]) * zone.h / (length * length);
    }
    for (int n = 0; n < grid.num_patches(); ++n) {
      double least = 1e300, most = -1e300;
      each_near(grid, zone.h, a, n, [&](int m) {
        if (known[m]) least = std::min(least, curvature[m]), most = std::max(most, curvature[m]);
      });
      if (!(most - least > changes.change[n])) continue;  // none where nothing is known
      changes.change[n] = most - least;
      changes.fraction[n] = std::min(1.0, (most - least) / std::max(std::abs(most), std::abs(least)));
    }
  }
  return changes;
}

/// Returns what a change of the gap's curvature k makes of the difference of the pressure from its mean over a cell,
/// Pa, at the patches: that fraction, times how much narrower than a cell it is, about p / (E* k). The cells, which
/// give the far field, do not see it, nor whether the body is a half-space there.
std::vector<double> error_within_cell(const FaceZone& zone, const std::vector<double>& square) {
  const FaceGrid& grid = zone.grid;
  std::vector<double> pressure(square.size());
  for (std::size_t n = 0; n < square.size(); ++n) pressure[n] = std::sqrt(std::max(square[n], 0.0));
  std::vector<double> mean = pressure;
  for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a) {
    const std::vector<double> at = mean;
    for (int n = 0; n < grid.num_patches(); ++n) {
      double sum = 0;
      int count = 0;
      each_near(grid, 0.5 * zone.h, a, n, [&](int m) { sum += at[m], ++count; });
      mean[n] = sum / count;
    }
  }
  const CurvatureChanges changes = changes_of_curvature(zone);
  std::vector<double> error(square.size(), 0.0);
  for (std::size_t n = 0; n < error.size(); ++n)
    if (mean[n] > 0)
      error[n] = changes.fraction[n] * std::min(changes.change[n] * zone.modulus / mean[n], 1.0) *
                 std::abs(pressure[n] - mean[n]);
  return error;
}

/// Returns the fraction of the pressure that means over cells may hide around an axis of revolution: a narrow zone has
/// two or three of them, and no variant of the far field shows that they are means. Within a cell a profile as wide as
/// the zone is off by (h / half width)^2 / 24.
double fraction_within_means(const FaceZone& zone, const std::vector<double>& square) {
  const FaceGrid& grid = zone.grid;
  if (!grid.meridian) return 0;
  const auto pressed = std::count_if(square.begin(), square.end(), [](double value) { return value > 0; });
  const double width = static_cast<double>(pressed) * grid.spacing[1];
  const double half = grid.end[1] == FaceEnd::mirror && square.front() > 0 ? width : width / 2;
  return half > 0 ? zone.h * zone.h / (half * half) / 24 : 0;
}

/// The pressure of a problem as the root of what is continued to the edge, Pa.
std::vector<double> pressure_to_edge(const ExecSpace& exec, const PatchProblem& problem, const FaceOptions& options,
                                     const std::vector<double>& start) {
  std::vector<double> p = start;
  solve_nested(exec, problem, options, p);
  std::vector<double> pressure = continue_to_edge(problem.grid, problem.may_press, p, problem.force);
  for (double& value : pressure) value = std::sqrt(std::max(value, 0.0));
  return pressure;
}

}  // namespace

double FacePressure::at(const FacePosition& position) const { return std::sqrt(std::max(square_at(position), 0.0)); }

double FacePressure::square_at(const FacePosition& position) const {
  const FacePosition x = grid.folded(position);
  int cell[2];
  double fraction[2];
  for (int a = 0; a < 2; ++a) {
    const double t = (x[a] - grid.low[a]) / grid.spacing[a] - 0.5;
    cell[a] = static_cast<int>(std::floor(t));
    fraction[a] = t - cell[a];
    if (grid.plane_strain && a == 0) cell[a] = 0, fraction[a] = 0;
  }
  double sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const double weight = (i == 0 ? 1 - fraction[0] : fraction[0]) * (j == 0 ? 1 - fraction[1] : fraction[1]);
      if (weight == 0) continue;
      int at[2] = {cell[0] + i, cell[1] + j};
      for (int a = 0; a < 2; ++a) {
        if (at[a] < 0 && grid.end[a] != FaceEnd::free) at[a] = 0;
        if (at[a] >= grid.size[a] && grid.end[a] == FaceEnd::period) at[a] = grid.size[a] - 1;
        if (at[a] < -1 || at[a] > grid.size[a]) return 0;
        at[a] = std::clamp(at[a], 0, grid.size[a] - 1);
      }
      sum += weight * square[at[0] * grid.size[1] + at[1]];
    }
  return sum;
}

FacePressure solve_face_zone(const ExecSpace& exec, const FaceZone& zone, const FaceOptions& options) {
  const FaceGrid& grid = zone.grid;
  const std::vector<double> sizes = sizes_of_groups(zone);
  const std::vector<double> acting = acting_pressure(zone, sizes);
  const std::vector<double> response = respond(exec, zone, acting);
  PatchProblem whole{grid, zone.modulus, 0, zone.may_press, {}};
  for (const FaceGroup& group : zone.groups) whole.force += group.force;
  const PatchBox box = box_of(grid, zone.may_press);
  const std::vector<int> patches = patches_of(grid, box);
  const auto problem_with = [&](const FarField& far, double details) {
    whole.gap = gap_without_pressure(zone, far, details);
    return cut_out(whole, box);
  };
  const FarField far(grid, zone.h, zone.inside, far_means(zone, sizes, response, options));
  const double details = far.longest_details(options.shortest_details, options.longest_details);

  const PatchProblem problem = problem_with(far, details);
  std::vector<double> p;
  for (const int n : patches) p.push_back(acting[n]);
  FacePressure result{grid, std::vector<double>(grid.num_patches(), 0.0), {}, {}};
  result.solution = solve_nested(exec, problem, options, p);
  for (std::size_t k = 0; k < patches.size(); ++k) result.square[patches[k]] = p[k];
  result.square = continue_to_edge(grid, zone.inside, result.square, whole.force);

  // Differences are seen on coarser patches as well.
  CoarsePatches coarse = coarse_patches(problem.grid);
  const std::vector<double> start = coarse.means(p, problem.may_press);
  const auto pressure_of = [&](const PatchProblem& fine) {
    return pressure_to_edge(exec, coarsened(fine, coarse), options, start);
  };
  FaceOptions softer = options;
  softer.cell_stiffness /= 2;
  const FarField of_softer(grid, zone.h, zone.inside, far_means(zone, sizes, response, softer));
  const std::vector<double> base = pressure_of(problem);
  result.error = error_within_cell(zone, result.square);
  if (const double fraction = fraction_within_means(zone, result.square); fraction > 0)
    for (std::size_t n = 0; n < result.error.size(); ++n)
      result.error[n] = std::hypot(result.error[n], fraction * std::sqrt(std::max(result.square[n], 0.0)));
  for (const PatchProblem& variant : {problem_with(far, details / other_details), problem_with(of_softer, details)}) {
    const std::vector<double> other = pressure_of(variant);
    for (std::size_t k = 0; k < patches.size(); ++k) {
      double& error = result.error[patches[k]];
      error = std::hypot(error, other[coarse.parent[k]] - base[coarse.parent[k]]);
    }
  }
  return result;
}

}  // namespace cgcontact
