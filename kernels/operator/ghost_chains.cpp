#include "kernels/operator/ghost_chains.hpp"

#include <algorithm>
#include <tuple>

#include "kernels/mesh/host_copy.hpp"
#include "kernels/operator/element_matrices.hpp"

namespace cgcontact {

namespace {

Index3 next_in(Index3 c, int d) {
  ++c[d];
  return c;
}

}  // namespace

template <class Real>
GhostChains<Real> make_ghost_chains(const ElasticSystem& system, const SlabPartition& slabs) {
  using Chain = typename GhostChains<Real>::Chain;
  GhostChains<Real> result;
  struct Start {
    int slab, body, direction, cell, faces, place;
  };
  std::vector<Start> starts;
  std::vector<double> factor;  // of each body
  for (std::size_t b = 0; b < system.meshes.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const CutCells& cc = *mesh.cut_cells;
    const int body = static_cast<int>(b);
    factor.push_back(system.ghost_penalty * (2 * mesh.law.mu + mesh.law.lambda) * mesh.modulus * mesh.h_of_level(0) /
                     36);
    if (system.ghost_penalty == 0) continue;
    /// The cell across the upper face in direction d if that is a ghost face, or -1.
    auto across = [&](int e, int d) {
      const int f = cc.find(next_in(cc.cells[e], d));
      return f >= 0 && is_ghost_face(mesh, e, f) ? f : -1;
    };
    for (int e = 0; e < static_cast<int>(cc.cells.size()); ++e)
      for (int d = 0; d < 3; ++d) {
        int f = cc.find(next_in(cc.cells[e], d));
        if (f < 0 || !is_ghost_face(mesh, e, f)) continue;
        const Index3& c = cc.cells[e];
        const int slab = slabs.slab_of(body, c);
        Index3 lower = c;
        --lower[d];
        const int before = cc.find(lower);
        if (before >= 0 && across(before, d) >= 0 && slabs.slab_of(body, lower) == slab) continue;
        // Chains side by side along x share nodes: even ones first, odd ones later.
        Start start{slab, body, d, e, 1, d == 0 ? c[2] : 2 * c[2] + (c[0] & 1)};
        while (slabs.slab_of(body, cc.cells[f]) == slab && (f = across(f, d)) >= 0) ++start.faces;
        result.num_faces += start.faces;
        starts.push_back(start);
      }
  }
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return std::make_tuple(a.slab, a.direction, a.faces > 1, a.place) <
           std::make_tuple(b.slab, b.direction, b.faces > 1, b.place);
  });
  std::vector<Chain> chains;
  std::vector<int> row, chunk_begin(slabs.colour_of_slab.size() + 1, 0);
  for (const Start& s : starts) {
    const BodyMesh& mesh = system.meshes[s.body];
    const CutCells& cc = *mesh.cut_cells;
    chains.push_back({s.direction, s.faces, static_cast<int>(row.size()), static_cast<Real>(factor[s.body])});
    ++chunk_begin[s.slab + 1];
    if (s.direction == 0) {
      for (int t = 0; t < 4; ++t) row.push_back(mesh.cell_nodes[s.cell][2 * t]);
      continue;
    }
    const int across = 1 << s.direction, other = s.direction == 1 ? 4 : 2;
    Index3 c = cc.cells[s.cell];
    for (int layer = 0; layer < s.faces + 2; ++layer) {
      const int side = layer == s.faces + 1 ? across : 0;  // the last layer: upper nodes of the last cell
      const auto& nodes = mesh.cell_nodes[cc.find(c)];
      for (int t = 0; t < 2; ++t) row.push_back(nodes[side + t * other]);
      if (layer < s.faces) ++c[s.direction];
    }
  }
  for (std::size_t s = 1; s < chunk_begin.size(); ++s) chunk_begin[s] += chunk_begin[s - 1];
  using ChainView = Kokkos::View<Chain*, MemSpace>;
  result.chains = copy_to_view<ChainView>("cgcontact::ghost::chains", chains);
  result.row = copy_to_view<IntView>("cgcontact::ghost::row", row);
  result.chunk_begin = copy_to_view<IntView>("cgcontact::ghost::chunk_begin", chunk_begin);
  return result;
}

template GhostChains<double> make_ghost_chains(const ElasticSystem&, const SlabPartition&);
template GhostChains<float> make_ghost_chains(const ElasticSystem&, const SlabPartition&);

}  // namespace cgcontact
