/// Bodies and scenes the benchmarks work on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/simulation.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact::perf {

/// A block of `size` cells along each edge on a grid shifted by irrational fractions: 6 size^2 cut cells, sliver
/// fractions as they come. With more than one level: coarsest cells of twice the size, refined towards the middle of
/// the upper face so that all finer levels have about as many cells, together with the coarsest about as many as the
/// block of one level has. Dimensionless: h = 1 (of the coarsest cells), E = 1, nu = 0.3.
struct BlockProblem {
  CutCells cut_cells;
  ElasticSystem system;
  explicit BlockProblem(int size, int levels = 1);
  BlockProblem(const BlockProblem&) = delete;  // the system refers to the cells
  /// Holds the lower face in all directions, by weak supports of 10 E/h.
  void hold_lower_face();
};

/// A quarter of a disc beside the axis of revolution: half a ball, or the disc in plane strain. Its radius is `size` of
/// the coarsest cells, 6 levels, refined towards the ball's pole. Dimensionless as the block.
struct DiscProblem {
  CutCells cut_cells;
  ElasticSystem system;
  DiscProblem(int size, bool of_revolution);
  DiscProblem(const DiscProblem&) = delete;  // the system refers to the cells
};

/// A scene on its grids up to the linear system, unsolved; all contact points closed.
struct SceneProblem {
  Scene scene;
  Simulation simulation;
  ElasticSystem& system;          ///< the simulation's
  std::vector<PatchSet> patches;  ///< of each body
  /// Scene of the repository (path from its root) with overrides.
  SceneProblem(const std::string& file, const std::vector<std::string>& overrides);
};

RealView random_vector(int size, unsigned seed);

}  // namespace cgcontact::perf
