/// Bodies and scenes the benchmarks work on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/simulation.hpp"
#include "core/cut_cells.hpp"
#include "kernels/system.hpp"

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
  Preparation parts;
  Scales scales;
  ElasticSystem system;
  std::vector<PatchSet> patches;
  /// Scene of the repository (path from its root) with overrides.
  SceneProblem(const std::string& file, const std::vector<std::string>& overrides);
};

/// The mesh with its interior cells only, or its cut ones only; nodes and everything else stay.
BodyMesh only_cells(const BodyMesh& mesh, bool interior);

/// Nodes that the mesh's cells (as the kernels see them) touch.
int count_nodes(const BodyMesh& mesh);

RealView random_vector(int size, unsigned seed);

}  // namespace cgcontact::perf
