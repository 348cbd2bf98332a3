/// Ghost penalty: the jump (1,-2,1) across a face times the tangential mass matrices, the same for every component.
///
/// Faces that follow each other in their own direction form a chain of m faces on m + 2 layers of four nodes, walked
/// with three layers in registers: every node is read and written once per chain (1.7 instead of 3 layers per face at
/// a curved surface). Two nodes along x, or the same node of two rows, share a vector. Chunks as in band_cells.hpp.
#pragma once

#include <vector>

#include "kernels/operator/band_cells.hpp"

namespace cgcontact {

template <class Real>
struct GhostChains {
  struct Chain {
    int direction, faces;
    int rows;     ///< first entry in `row`
    Real factor;  ///< gamma (2 mu + lambda at points) h / 36, softer where a body is thinner than a cell
    int fold;     ///< plane strain: bit of the corners of a face on the upper side, which are the lower ones; or 0
  };
  Kokkos::View<Chain*, MemSpace> chains;
  /// Direction x: the first nodes of the four rows (y, z). Otherwise (layer, second tangential corner): the first of
  /// two nodes along x.
  IntView row;
  IntView chunk_begin;  ///< slab -> first chain
  long long num_faces = 0;

  std::size_t bytes() const { return chains.size() * sizeof(Chain) + row.size() * sizeof(int); }
};

template <class Real>
GhostChains<Real> make_ghost_chains(const ElasticSystem& system, const SlabPartition& slabs);

namespace ghost {

/// Two nodes along x, in the first six entries.
struct NodePair {
  template <class Real>
  static Eight<Real> load(const Real* a, const Real*) {
    return load_six(a);
  }
  template <class Real>
  static void add(Real* a, Real*, const Eight<Real>& v) {
    add_six<false>(a, reinterpret_cast<const Real*>(&v));
  }
  template <class V>
  static V swapped(const V& v) {
    return __builtin_shufflevector(v, v, 3, 4, 5, 0, 1, 2, 6, 7);
  }
};

/// The same node of two rows, in entries 0 to 2 and 4 to 6.
struct TwoRows {
  template <class Real>
  static Eight<Real> load(const Real* a, const Real* b) {
    return load_three_and_three(a, b);
  }
  template <class Real>
  static void add(Real* a, Real* b, const Eight<Real>& v) {
    const Real* p = reinterpret_cast<const Real*>(&v);
    add_three(a, p);
    add_three(b, p + 4);
  }
  template <class V>
  static V swapped(const V& v) {
    return __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3);
  }
};

/// Forces on the face from the jump of its four nodes: factor times the tangential mass matrix.
template <class Half, class Real, class V>
inline void face_forces(Real factor, const V jump[2], V p[2]) {
  for (int t = 0; t < 2; ++t) {
    const V h = Real(2) * jump[t] + jump[1 - t];
    p[t] = factor * (Real(2) * h + Half::swapped(h));
  }
}

/// Chain of one face in direction x: the three nodes of each row follow each other. row: the first DoF of four rows.
template <class Real>
inline void apply_face_along_x(Real factor, const Real* x, Real* y, const std::size_t row[4]) {
  using V = Eight<Real>;
  V jump[2], p[2];
  for (int t = 0; t < 2; ++t) {
    const Real *a = x + row[2 * t], *b = x + row[2 * t + 1];
    jump[t] =
        load_three_and_three(a, b) + load_three_and_three(a + 6, b + 6) - Real(2) * load_three_and_three(a + 3, b + 3);
  }
  face_forces<TwoRows>(factor, jump, p);
  constexpr V weights = {1, 1, 1, -2, -2, -2, 1, 1};
  for (int t = 0; t < 2; ++t) {
    const V rows[2] = {weights * __builtin_shufflevector(p[t], p[t], 0, 1, 2, 0, 1, 2, 0, 1),
                       weights * __builtin_shufflevector(p[t], p[t], 4, 5, 6, 4, 5, 6, 4, 5)};
    for (int side = 0; side < 2; ++side) {
      Real* to = y + row[2 * t + side];
      add_eight(to, reinterpret_cast<const Real*>(&rows[side]));
      to[8] += p[t][4 * side + 2];
    }
  }
}

/// Chain of one face: half of all chains and more. `at` as in apply_chain.
template <class Half, class Real, class At>
inline void apply_face(Real factor, const Real* x, Real* y, const At& at) {
  using V = Eight<Real>;
  V jump[2], p[2];
  for (int t = 0; t < 2; ++t)
    jump[t] = Half::load(x + at(0, t, 0), x + at(0, t, 1)) + Half::load(x + at(2, t, 0), x + at(2, t, 1)) -
              Real(2) * Half::load(x + at(1, t, 0), x + at(1, t, 1));
  face_forces<Half>(factor, jump, p);
  for (int t = 0; t < 2; ++t) {
    Half::add(y + at(0, t, 0), y + at(0, t, 1), p[t]);
    Half::add(y + at(1, t, 0), y + at(1, t, 1), V(Real(-2) * p[t]));
    Half::add(y + at(2, t, 0), y + at(2, t, 1), p[t]);
  }
}

/// One chain. `at(layer, t, side)`: first DoF of half t, for two rows also of its second row (side 1).
template <class Half, class Real, class At>
inline void apply_chain(int faces, Real factor, const Real* x, Real* y, const At& at) {
  using V = Eight<Real>;
  if (faces == 1) return apply_face<Half>(factor, x, y, at);
  V below[2], middle[2], last[2] = {V{}, V{}}, last_but_one[2] = {V{}, V{}};
  for (int t = 0; t < 2; ++t) {
    below[t] = Half::load(x + at(0, t, 0), x + at(0, t, 1));
    middle[t] = Half::load(x + at(1, t, 0), x + at(1, t, 1));
  }
  auto add = [&](int layer, const V(&p)[2]) {
    for (int t = 0; t < 2; ++t) {
      Half::add(y + at(layer, t, 0), y + at(layer, t, 1), V(p[t] + last_but_one[t] - Real(2) * last[t]));
      last_but_one[t] = last[t];
      last[t] = p[t];
    }
  };
  for (int layer = 0; layer < faces; ++layer) {
    V above[2], jump[2], p[2];
    for (int t = 0; t < 2; ++t) {
      above[t] = Half::load(x + at(layer + 2, t, 0), x + at(layer + 2, t, 1));
      jump[t] = below[t] + above[t] - Real(2) * middle[t];
      below[t] = middle[t];
      middle[t] = above[t];
    }
    face_forces<Half>(factor, jump, p);
    add(layer, p);
  }
  const V none[2] = {V{}, V{}};
  add(faces, none);
  add(faces + 1, none);
}

template <bool subtract, class Real>
inline void apply_chunk(const GhostChains<Real>& ghosts, int chunk, const Real* x, Real* y) {
  for (int e = ghosts.chunk_begin(chunk); e < ghosts.chunk_begin(chunk + 1); ++e) {
    const auto& chain = ghosts.chains(e);
    const Real factor = subtract ? -chain.factor : chain.factor;
    const int* row = &ghosts.row(chain.rows);
    if (chain.direction == 0 && chain.faces == 1) {
      std::size_t rows[4];
      for (int t = 0; t < 4; ++t) rows[t] = dof_offset(row[t]);
      apply_face_along_x(factor, x, y, rows);
    } else if (chain.direction == 0)
      apply_chain<TwoRows>(chain.faces, factor, x, y,
                           [row](int layer, int t, int side) { return dof_offset(row[2 * t + side] + layer); });
    else
      apply_chain<NodePair>(chain.faces, factor, x, y,
                            [row](int layer, int t, int) { return dof_offset(row[2 * layer + t]); });
  }
}

/// Node blocks, and the blocks between different nodes of a column. In plane strain two corners are one, at the lower
/// one: the sum of their masses 1, 1/2, 1/2, 1 is three.
template <class Real, class Blocks>
inline void add_diagonal_blocks(const GhostChains<Real>& ghosts, int chunk, const Blocks& blocks,
                                const NodeColumns<Real>& columns) {
  for (int e = ghosts.chunk_begin(chunk); e < ghosts.chunk_begin(chunk + 1); ++e) {
    const auto& chain = ghosts.chains(e);
    const Real mass = (chain.fold ? 3 : 1) * 4 * chain.factor;  // of one corner of one face
    const int* row = &ghosts.row(chain.rows);
    const Real jump[3] = {1, -2, 1};
    for (int f = 0; f < chain.faces; ++f) {
      int nodes[3][4];
      for (int layer = 0; layer < 3; ++layer)
        for (int corner = 0; corner < 4; ++corner)
          nodes[layer][corner] =
              chain.direction == 0 ? row[corner] + f + layer : row[2 * (f + layer) + corner / 2] + corner % 2;
      for (int n = 0; n < 12; ++n) {
        const int layer = n / 4, corner = n % 4, node = nodes[layer][corner];
        if (corner & chain.fold) continue;
        for (int i = 0; i < 3; ++i) blocks(node, i) += layer == 1 ? 4 * mass : mass;
        const int c = columns.column_of_node(node);
        if (c < 0) continue;
        const auto& column = columns.columns(c);
        const int slot = columns.slot(column, node);
        for (int k = 0; k < 12; ++k) {
          const int other = nodes[k / 4][k % 4];
          if (other == node || (k & chain.fold) || columns.column_of_node(other) != c) continue;
          const int across = corner ^ k % 4;  // mass: a half per tangential direction in which the corners differ
          const Real value = jump[layer] * jump[k / 4] * mass *
                             (across == 0   ? Real(1)
                              : across == 3 ? Real(0.25)
                                            : Real(0.5));
          const int at = columns.slot(column, other);
          for (int i = 0; i < 3; ++i) columns.matrices(column.entry(dof_of(slot, i), dof_of(at, i))) += value;
        }
      }
    }
  }
}

}  // namespace ghost

}  // namespace cgcontact
