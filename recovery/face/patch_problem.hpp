/// Problem of a zone on the host: patches, gaps and the force; coarser copies of it, from which its solution starts.
#pragma once

#include "core/settings/face_options.hpp"
#include "kernels/mesh/views.hpp"
#include "recovery/face/face_grid.hpp"
#include "recovery/face/face_problem.hpp"

namespace cgcontact {

struct PatchProblem {
  FaceGrid grid;
  double modulus = 1;           ///< E* of both bodies, Pa
  double force = 0;             ///< N, in plane strain N/m
  std::vector<char> may_press;  ///< 1 at patches where the pressure is sought
  std::vector<double> gap;      ///< m, at the patches, without their pressure; up to a constant
};

/// Window of a problem around the patches that may press; `first` and `size` say which, along both axes.
struct PatchBox {
  std::array<int, 2> first{0, 0}, size{0, 0};
};
PatchBox box_of(const FaceGrid& grid, const std::vector<char>& may_press);
PatchProblem cut_out(const PatchProblem& whole, const PatchBox& box);

/// Returns the numbers of the whole grid's patches in a box, in the order of the box's own.
std::vector<int> patches_of(const FaceGrid& grid, const PatchBox& box);

/// Patches of twice the size, where the grid has enough along an axis.
struct CoarsePatches {
  std::array<int, 2> merged{1, 1};  ///< patches along each axis that become one
  FaceGrid grid;
  std::vector<int> parent;  ///< of every patch
  bool any() const { return merged[0] * merged[1] > 1; }
  /// Averages over the patches of each coarse one that may press.
  std::vector<double> means(const std::vector<double>& values, const std::vector<char>& may_press) const;
};
CoarsePatches coarse_patches(const FaceGrid& grid);
PatchProblem coarsened(const PatchProblem& fine, const CoarsePatches& coarse);

/// Solves for the pressure at the patches, Pa, from the solution on coarser patches, recursively. p: the start on
/// entry, which may be zero. Coarse solutions are starts only.
FaceSolution solve_nested(const ExecSpace& exec, const PatchProblem& problem, const FaceOptions& options,
                          std::vector<double>& p);

}  // namespace cgcontact
