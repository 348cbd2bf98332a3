/// Bodies and scenes the benchmarks work on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/simulation.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact::perf {

/// A block of `size` cells along each edge on a grid shifted by irrational fractions: 6 size^2 cut cells, sliver
/// fractions as they come. Dimensionless: h = 1, E = 1, nu = 0.3.
struct BlockProblem {
  CutCells cut_cells;
  ElasticSystem system;
  explicit BlockProblem(int size);
};

/// A scene on its grids up to the linear system, unsolved; all contact points closed.
struct SceneProblem {
  Scene scene;
  Simulation simulation;
  ElasticSystem& system;  ///< the simulation's
  /// Scene of the repository (path from its root) with overrides.
  SceneProblem(const std::string& file, const std::vector<std::string>& overrides);
};

RealView random_vector(int size, unsigned seed);

}  // namespace cgcontact::perf
