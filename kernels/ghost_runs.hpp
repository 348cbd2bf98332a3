/// Ghost penalty of runs of faces along x: the jump (1,-2,1) across the face times the tangential mass matrices, on
/// rows of interleaved components (the term is the same for the three of them). Chunks as in band_cells.hpp.
#pragma once

#include <vector>

#include "kernels/band_cells.hpp"

namespace cgcontact {

template <class Real>
struct GhostRuns {
  static constexpr int longest = 20;  ///< faces of one run
  struct Run {
    int body, direction, faces;
    int row[6];  ///< first nodes; direction 0: rows (y, z) of the faces' corners, starting at the lower cells' far
                 ///< nodes. Otherwise (layer, second tangential corner), one node more than faces along x
  };
  Kokkos::View<Run*, MemSpace> runs;
  IntView chunk_begin;                   ///< slab -> first run
  Kokkos::View<Real*, MemSpace> factor;  ///< per body: gamma (2 mu + lambda) h / 36
  long long num_faces = 0;

  std::size_t bytes() const { return runs.size() * sizeof(Run); }
};

template <class Real>
GhostRuns<Real> make_ghost_runs(const ElasticSystem& system, const SlabPartition& slabs);

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace ghost {

template <class Real>
inline void add_first(Real* to, const Vector<Real>& v, int n) {
  store_first(to, Vector<Real>(load_first(to, n) + v), n);
}

/// Faces across y or z. The rows of one layer are next to each other in the buffer, after three zeros.
template <class Real>
inline void apply_across_rows(const typename GhostRuns<Real>::Run& run, Real factor, const Real* x, Real* y) {
  using V = Vector<Real>;
  constexpr int L = Lanes<Real>::count, size = 3 * (GhostRuns<Real>::longest + 1) + 3 * L;
  const int n = 3 * (run.faces + 1);
  alignas(64) Real buffer[2][size];
  const Real* in[6];
  Real* out[6];
  for (int r = 0; r < 6; ++r) {
    in[r] = x + 3 * static_cast<std::size_t>(run.row[r]);
    out[r] = y + 3 * static_cast<std::size_t>(run.row[r]);
  }
  for (int t = 0; t < 2; ++t) store(buffer[t], V{});
  for (int i = 0; i < n; i += L) {
    const int m = n - i < L ? n - i : L;
    V jump[2];
    for (int t = 0; t < 2; ++t)
      jump[t] = load_first(in[t] + i, m) + load_first(in[4 + t] + i, m) - Real(2) * load_first(in[2 + t] + i, m);
    for (int t = 0; t < 2; ++t) store(buffer[t] + L + i, V(factor * (Real(2) * jump[t] + jump[1 - t])));
    for (int t = 0; t < 2; ++t) store(buffer[t] + 2 * L + i, V{});
  }
  for (int t = 0; t < 2; ++t) {
    const Real* h = buffer[t] + L;
    for (int i = 0; i < n; i += L) {
      const int m = n - i < L ? n - i : L;
      V at = Real(4) * load(h + i);
      if (i == 0) at -= Real(2) * load_first(h, 3);
      V p = at + (load(h + i - 3) + load(h + i + 3));
      // The last node of the run has one face only.
      const int last = n - 3 - i;
      if (last > -3 && last < L) {
        alignas(64) Real minus[L + 6] = {};
        for (int c = 0; c < 3; ++c)
          if (last + c >= 0) minus[last + c] = Real(2) * h[i + last + c];
        p -= load(minus);
      }
      add_first(out[t] + i, p, m);
      add_first(out[2 + t] + i, V(Real(-2) * p), m);
      add_first(out[4 + t] + i, p, m);
    }
  }
}

/// Faces across x: four rows.
template <class Real>
inline void apply_along_rows(const typename GhostRuns<Real>::Run& run, Real factor, const Real* x, Real* y) {
  using V = Vector<Real>;
  constexpr int L = Lanes<Real>::count, size = 3 * (GhostRuns<Real>::longest + 2) + 3 * L;
  const int n = 3 * run.faces;
  alignas(64) Real buffer[4][size];
  for (int i = 0; i < n; i += L) {
    const int m = n - i < L ? n - i : L;
    V g[4];
    for (int r = 0; r < 4; ++r) {
      const Real* in = x + 3 * static_cast<std::size_t>(run.row[r]) + i;
      g[r] = load_first(in, m) + load_first(in + 6, m) - Real(2) * load_first(in + 3, m);
    }
    const V h[4] = {Real(2) * g[0] + g[1], Real(2) * g[1] + g[0], Real(2) * g[2] + g[3], Real(2) * g[3] + g[2]};
    for (int r = 0; r < 4; ++r) store(buffer[r] + L + i, V(factor * (Real(2) * h[r] + h[(r + 2) % 4])));
  }
  for (int r = 0; r < 4; ++r) {
    Real* h = buffer[r] + L;
    store(buffer[r], V{});
    store(h + n, V{});
    for (int i = 0; i < n + 6; i += L) {
      const int m = n + 6 - i < L ? n + 6 - i : L;
      const V p = load(h + i) + load(h + i - 6) - Real(2) * load(h + i - 3);
      add_first(y + 3 * static_cast<std::size_t>(run.row[r]) + i, p, m);
    }
  }
}

template <bool subtract, class Real>
inline void apply_chunk(const GhostRuns<Real>& ghosts, int chunk, const Real* x, Real* y) {
  for (int e = ghosts.chunk_begin(chunk); e < ghosts.chunk_begin(chunk + 1); ++e) {
    const auto& run = ghosts.runs(e);
    const Real factor = subtract ? -ghosts.factor(run.body) : ghosts.factor(run.body);
    if (run.direction == 0)
      apply_along_rows(run, factor, x, y);
    else
      apply_across_rows(run, factor, x, y);
  }
}

template <class Real, class Blocks>
inline void add_diagonal_blocks(const GhostRuns<Real>& ghosts, int chunk, const Blocks& blocks) {
  for (int e = ghosts.chunk_begin(chunk); e < ghosts.chunk_begin(chunk + 1); ++e) {
    const auto& run = ghosts.runs(e);
    const Real mass = 4 * ghosts.factor(run.body);  // of one corner of one face
    auto add = [&](int node, Real value) {
      for (int i = 0; i < 3; ++i) blocks(node, i) += value;
    };
    for (int f = 0; f < run.faces; ++f)
      for (int layer = 0; layer < 3; ++layer)
        for (int corner = 0; corner < 4; ++corner)
          add(run.direction == 0 ? run.row[corner] + f + layer : run.row[2 * layer + corner / 2] + f + corner % 2,
              layer == 1 ? 4 * mass : mass);
  }
}

}  // namespace ghost

#pragma GCC diagnostic pop

}  // namespace cgcontact
