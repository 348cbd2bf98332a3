#include "recovery/face/patch_problem.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Patches along an axis that has enough of them to merge; boxes have a multiple of some.
constexpr int min_to_merge = 16, multiple = 8;

template <class View, class T>
void to_device(const FaceGrid& grid, const std::vector<T>& values, const View& view) {
  const auto host = Kokkos::create_mirror_view(view);
  for (int n = 0; n < grid.num_patches(); ++n) host(n / grid.size[1], n % grid.size[1]) = values[n];
  Kokkos::deep_copy(view, host);
}

/// The zone ends within two of the larger patches of where it ended.
void narrow(const CoarsePatches& coarse, const std::vector<double>& found, std::vector<char>& may_press) {
  std::vector<char> near(found.size(), 0);
  for (int n = 0; n < coarse.grid.num_patches(); ++n)
    for (int i = -2; i <= 2 && !near[n]; ++i)
      for (int j = -2; j <= 2; ++j) {
        const int other = coarse.grid.beyond(n, {i, j});
        near[n] = near[n] || (other >= 0 && found[other] > 0);
      }
  for (std::size_t n = 0; n < may_press.size(); ++n) may_press[n] = may_press[n] && near[coarse.parent[n]];
}

}  // namespace

/// Whole blocks of patches counted from the ends of the grid, whose mirror image has the mirrored box.
PatchBox box_of(const FaceGrid& grid, const std::vector<char>& may_press) {
  std::array<int, 2> first = grid.size, last{-1, -1};
  for (int n = 0; n < grid.num_patches(); ++n) {
    if (!may_press[n]) continue;
    const std::array<int, 2> at{n / grid.size[1], n % grid.size[1]};
    for (int a = 0; a < 2; ++a) {
      first[a] = std::min(first[a], at[a]);
      last[a] = std::max(last[a], at[a]);
    }
  }
  PatchBox box;
  for (int a = 0; a < 2; ++a) {
    const bool whole = last[a] < 0 || grid.end[a] == FaceEnd::period || grid.size[a] < min_to_merge;
    box.first[a] = whole || grid.end[a] == FaceEnd::mirror ? 0 : first[a] / multiple * multiple;
    box.size[a] = whole ? grid.size[a] : std::min((last[a] / multiple + 1) * multiple, grid.size[a]) - box.first[a];
  }
  return box;
}

std::vector<int> patches_of(const FaceGrid& grid, const PatchBox& box) {
  std::vector<int> patches;
  for (int i = 0; i < box.size[0]; ++i)
    for (int j = 0; j < box.size[1]; ++j) patches.push_back((box.first[0] + i) * grid.size[1] + box.first[1] + j);
  return patches;
}

PatchProblem cut_out(const PatchProblem& whole, const PatchBox& box) {
  PatchProblem region{whole.grid, whole.modulus, whole.force, {}, {}};
  for (int a = 0; a < 2; ++a) {
    region.grid.size[a] = box.size[a];
    region.grid.low[a] += box.first[a] * whole.grid.spacing[a];
  }
  for (const int n : patches_of(whole.grid, box)) {
    region.may_press.push_back(whole.may_press[n]);
    region.gap.push_back(whole.gap[n]);
  }
  return region;
}

CoarsePatches coarse_patches(const FaceGrid& grid) {
  CoarsePatches coarse;
  coarse.grid = grid;
  for (int a = 0; a < 2; ++a) {
    if (grid.size[a] % 2 == 0 && grid.size[a] >= min_to_merge) coarse.merged[a] = 2;
    coarse.grid.size[a] /= coarse.merged[a];
    coarse.grid.spacing[a] *= coarse.merged[a];
  }
  for (int n = 0; n < grid.num_patches(); ++n)
    coarse.parent.push_back(n / grid.size[1] / coarse.merged[0] * coarse.grid.size[1] +
                            n % grid.size[1] / coarse.merged[1]);
  return coarse;
}

std::vector<double> CoarsePatches::means(const std::vector<double>& values, const std::vector<char>& may_press) const {
  std::vector<double> sum(grid.num_patches(), 0.0), number(grid.num_patches(), 0.0);
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (!may_press[n]) continue;
    sum[parent[n]] += values[n];
    number[parent[n]] += 1;
  }
  for (std::size_t n = 0; n < sum.size(); ++n)
    if (number[n] > 0) sum[n] /= number[n];
  return sum;
}

PatchProblem coarsened(const PatchProblem& fine, const CoarsePatches& coarse) {
  PatchProblem problem{coarse.grid, fine.modulus, fine.force, {}, coarse.means(fine.gap, fine.may_press)};
  problem.may_press.assign(coarse.grid.num_patches(), 0);
  for (std::size_t n = 0; n < fine.may_press.size(); ++n)
    if (fine.may_press[n]) problem.may_press[coarse.parent[n]] = 1;
  return problem;
}

FaceSolution solve_nested(const ExecSpace& exec, const PatchProblem& problem, const FaceOptions& options,
                          std::vector<double>& p) {
  PatchProblem region = problem;
  PatchBox box{{0, 0}, problem.grid.size};
  if (const CoarsePatches coarse = coarse_patches(problem.grid); coarse.any()) {
    std::vector<double> found = coarse.means(p, problem.may_press);
    FaceOptions start = options;
    start.tolerance = std::sqrt(options.tolerance);
    solve_nested(exec, coarsened(problem, coarse), start, found);
    for (std::size_t n = 0; n < p.size(); ++n) p[n] = problem.may_press[n] ? found[coarse.parent[n]] : 0;
    narrow(coarse, found, region.may_press);
    box = box_of(region.grid, region.may_press);
    region = cut_out(region, box);
  }
  const FaceGrid& grid = region.grid;
  const std::vector<int> patches = patches_of(problem.grid, box);
  std::vector<double> start;
  for (const int n : patches) start.push_back(p[n]);
  const HalfSpace::Patches gap("cgcontact::patch_problem::gap", grid.size[0], grid.size[1]),
      pressure("cgcontact::patch_problem::pressure", grid.size[0], grid.size[1]);
  const HalfSpace::Marks marks("cgcontact::patch_problem::may_press", grid.size[0], grid.size[1]);
  to_device(grid, region.gap, gap);
  to_device(grid, start, pressure);
  to_device(grid, region.may_press, marks);
  const FaceSolution solution = solve_face_problem(exec, grid, HalfSpace(exec, grid, problem.modulus), gap, marks,
                                                   problem.force, options.tolerance, options.max_iterations, pressure);
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), pressure);
  std::fill(p.begin(), p.end(), 0.0);
  for (std::size_t k = 0; k < patches.size(); ++k) p[patches[k]] = host(k / grid.size[1], k % grid.size[1]);
  return solution;
}

}  // namespace cgcontact
