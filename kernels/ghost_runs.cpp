#include "kernels/ghost_runs.hpp"

#include <algorithm>

#include "kernels/host_copy.hpp"

namespace cgcontact {

template <class Real>
GhostRuns<Real> make_ghost_runs(const ElasticSystem& system, const SlabPartition& slabs) {
  using Run = typename GhostRuns<Real>::Run;
  GhostRuns<Real> result;
  std::vector<std::vector<Run>> runs_of_slab(slabs.colour_of_slab.size());
  std::vector<Real> factor;
  for (std::size_t b = 0; b < system.meshes.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const CutCells& cc = *mesh.cut_cells;
    factor.push_back(static_cast<Real>(system.ghost_penalty * (2 * mesh.law.mu + mesh.law.lambda) * mesh.modulus *
                                       mesh.cell_size / 36));
    if (system.ghost_penalty == 0) continue;
    Run run{};
    int last = -2, slab = -1;
    for (int d = 0; d < 3; ++d) {
      last = -2;
      for (std::size_t e = 0; e < cc.cells.size(); ++e) {
        Index3 c = cc.cells[e];
        const int own_slab = slabs.slab_of(static_cast<int>(b), c);
        ++c[d];
        const int f = cc.find(c);
        if (f < 0 || (cc.cut_of_active[e] < 0 && cc.cut_of_active[f] < 0)) continue;
        ++result.num_faces;
        // Consecutive active cells of one row of the grid: the next face of the same run.
        const bool next = last == static_cast<int>(e) - 1 && own_slab == slab && run.faces < GhostRuns<Real>::longest &&
                          cc.cells[e][0] == cc.cells[e - 1][0] + 1 && cc.cells[e][1] == cc.cells[e - 1][1] &&
                          cc.cells[e][2] == cc.cells[e - 1][2];
        last = static_cast<int>(e);
        if (next) {
          ++runs_of_slab[slab].back().faces;
          ++run.faces;
          continue;
        }
        slab = own_slab;
        run.body = static_cast<int>(b);
        run.direction = d;
        run.faces = 1;
        const auto &lower = mesh.cell_nodes[e], &upper = mesh.cell_nodes[f];
        if (d == 0) {
          for (int t = 0; t < 4; ++t) run.row[t] = lower[2 * t];
          run.row[4] = run.row[5] = 0;
        } else {
          const int across = 1 << d, other = d == 1 ? 4 : 2;
          for (int t = 0; t < 2; ++t) {
            run.row[t] = lower[t * other];
            run.row[2 + t] = lower[across + t * other];
            run.row[4 + t] = upper[across + t * other];
          }
        }
        runs_of_slab[slab].push_back(run);
      }
    }
  }
  std::vector<Run> runs;
  std::vector<int> chunk_begin(1, 0);
  for (const auto& list : runs_of_slab) {
    runs.insert(runs.end(), list.begin(), list.end());
    chunk_begin.push_back(static_cast<int>(runs.size()));
  }
  using RunView = Kokkos::View<Run*, MemSpace>;
  using FactorView = Kokkos::View<Real*, MemSpace>;
  result.runs = copy_to_view<RunView>("cgcontact::ghost::runs", runs);
  result.chunk_begin = copy_to_view<IntView>("cgcontact::ghost::chunk_begin", chunk_begin);
  result.factor = copy_to_view<FactorView>("cgcontact::ghost::factor", factor);
  return result;
}

template GhostRuns<double> make_ghost_runs(const ElasticSystem&, const SlabPartition&);
template GhostRuns<float> make_ghost_runs(const ElasticSystem&, const SlabPartition&);

}  // namespace cgcontact
