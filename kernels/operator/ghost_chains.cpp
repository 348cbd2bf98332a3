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

/// Bit of the axis of plane strain in a corner's number on a face: the lower tangential axis first.
int fold_of_face(const BodyMesh& mesh, int direction) {
  if (!mesh.is_one_layer()) return 0;
  return mesh.cut_cells->grid.plane_strain == (direction == 0 ? 1 : 0) ? 1 : 2;
}

}  // namespace

template <class Real>
GhostChains<Real> make_ghost_chains(const ElasticSystem& system, const SlabPartition& slabs) {
  using Chain = typename GhostChains<Real>::Chain;
  GhostChains<Real> result;
  struct Start {
    int slab, body, direction;
    Index3 lower;  ///< the first cell
    int faces, order;
  };
  std::vector<Start> starts;
  std::vector<double> factor;  // of each level
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t b = 0; b < levels.size(); ++b) {
    const BodyMesh& mesh = *levels[b];
    const CutCells& cc = *mesh.cut_cells;
    const int body = static_cast<int>(b);
    factor.push_back(system.ghost_penalty * (2 * mesh.law.mu + mesh.law.lambda_at_points()) * mesh.modulus *
                     mesh.thickness_of_level(0) / 36);
    if (system.ghost_penalty == 0) continue;
    const int alone = mesh.is_axisymmetric() ? cc.grid.radial_axis() : -1;  ///< faces that differ along a chain
    /// The cell across the upper face in direction d if that is a ghost face with forces that are needed, or -1.
    auto across = [&](int e, int d) {
      const int f = cc.find(next_in(cc.cells[e], d));
      return f >= 0 && is_ghost_face(mesh, e, f) && (system.needs_cell(mesh, e) || system.needs_cell(mesh, f)) ? f : -1;
    };
    for (int e = 0; e < static_cast<int>(cc.cells.size()); ++e)
      for (int d = 0; d < 3; ++d) {
        int f = across(e, d);
        if (f < 0) continue;
        const Index3& c = cc.cells[e];
        const int slab = slabs.slab_of(body, c);
        Index3 lower = c;
        --lower[d];
        const int before = cc.find(lower);
        const bool follows = before >= 0 && across(before, d) >= 0 && slabs.slab_of(body, lower) == slab;
        if (follows && d != alone) continue;
        // Chains side by side along x share nodes: even ones first, odd ones later.
        Start start{slab, body, d, c, 1, d == 0 ? c[2] : 2 * c[2] + (c[0] & 1)};
        while (d != alone && slabs.slab_of(body, cc.cells[f]) == slab && (f = across(f, d)) >= 0) ++start.faces;
        result.num_faces += start.faces;
        starts.push_back(start);
      }
    for (const LevelFace& face : mesh.level_faces) {
      const Index3& c = face.lower;
      starts.push_back({slabs.slab_of(body, cc.cells[face.cell]), body, face.direction, c, 1,
                        face.direction == 0 ? c[2] : 2 * c[2] + (c[0] & 1)});
      ++result.num_faces;
    }
  }
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return std::make_tuple(a.slab, a.direction, a.faces > 1, a.order) <
           std::make_tuple(b.slab, b.direction, b.faces > 1, b.order);
  });
  std::vector<Chain> chains;
  std::vector<int> row, chunk_begin(slabs.colour_of_slab.size() + 1, 0);
  for (const Start& s : starts) {
    const BodyMesh& mesh = *levels[s.body];
    chains.push_back({s.direction, s.faces, static_cast<int>(row.size()),
                      static_cast<Real>(factor[s.body] * mesh.ring_of_face(s.lower, s.direction)),
                      fold_of_face(mesh, s.direction)});
    ++chunk_begin[s.slab + 1];
    if (s.direction == 0) {
      for (int t = 0; t < 4; ++t)
        row.push_back(mesh.find_node({s.lower[0], s.lower[1] + (t & 1), s.lower[2] + (t >> 1)}));
      continue;
    }
    const int other = s.direction == 1 ? 2 : 1;
    Index3 position = s.lower;
    for (int layer = 0; layer < s.faces + 2; ++layer, ++position[s.direction])
      for (int t = 0; t < 2; ++t) {
        Index3 first = position;
        first[other] += t;
        row.push_back(mesh.find_node(first));
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
