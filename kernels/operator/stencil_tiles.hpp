/// The operator at nodes whose eight cells are all active: the assembled 27-point stencil of the full cell, factorised.
///
/// With the one-dimensional mass M = (1,4,1)/6, stiffness S = (-1,2,-1) and derivative D = (-1,0,1)/2,
///   K_xx = (lambda + 2 mu) Sx My Mz + mu (Mx Sy Mz + Mx My Sz),   K_xy = -(lambda + mu) Dx Dy Mz   (and cyclic);
/// the mean dilatation adds lambda Sx Ay Az and -lambda Dx Dy Az with A = (1,2,1)/4.
/// The y- and z-factors of all nine blocks are combinations of three corner sums, two edge sums and the middle of the
/// nine rows around a node: about 25 vector operations per unknown instead of 162 flop.
///
/// Nodes are walked in tiles (at most 126 nodes of a row, 16 rows, some planes): each tile keeps three planes of its
/// rows, split into components, in a ring that fits the L2 cache, so x is read from memory about once.
#pragma once

#include <vector>

#include "kernels/mesh/dofs.hpp"
#include "kernels/mesh/mesh.hpp"
#include "kernels/simd/lanes.hpp"

namespace cgcontact {

/// Shape of a tile's ring of split rows.
template <class Real>
struct StencilRing {
  static constexpr int block = 126;                             ///< nodes of a row in one tile
  static constexpr int width = block + 2 + Lanes<Real>::count;  ///< not a power of two: cache sets
  static constexpr int rows = 16;                               ///< rows of nodes in one tile
  static constexpr int row_stride = 3 * width;
  static constexpr int plane_stride = (rows + 2) * row_stride;
  static constexpr int size = 3 * plane_stride + 9 * width;  ///< the ring, and the rows of partial sums
};

/// Coefficients of the factorised stencil; negated for a residual.
template <class Real>
struct StencilCoefficients {
  // Sums of component c at x -+ 1 (outer) and x (inner): corner sum, sum over y +- 1, sum over z +- 1, middle.
  Real outer[3][4], inner[3][4];
  Real cross_outer, cross_inner;  ///< of Dy Dz
  Real cross_x;                   ///< of Dx times the sums DyMz + DzMy, corners
  Real cross_edge;                ///< of the edges of these sums, relative to cross_x

  StencilCoefficients() = default;
  StencilCoefficients(const BodyMesh& mesh, double sign);
  /// Returns the three equal entries of the stencil's diagonal 3x3 block, which is diagonal.
  static double diagonal(const BodyMesh& mesh);
};

/// Rows to be split into the ring, and runs of nodes to be computed, of every plane of every tile.
template <class Real>
struct StencilTiles {
  using Copies = Kokkos::View<int* [3], Kokkos::LayoutRight, MemSpace>;  // first node, offset in the plane, length
  using Runs = Kokkos::View<int* [4], Kokkos::LayoutRight, MemSpace>;    // first node, row slot, position, length
  IntView tile_plane;  ///< tile -> first entry of copy_begin and run_begin; (tiles + 1)
  IntView tile_body;
  IntView copy_begin, run_begin;  ///< (tile, plane) -> records, planes from one below to one above; an end per tile
  Copies copies;
  Runs runs;
  Kokkos::View<StencilCoefficients<Real>*, MemSpace> plus, minus;  ///< per body
  long long num_nodes = 0;

  int num_tiles() const { return static_cast<int>(tile_body.extent(0)); }
  std::size_t bytes() const;
};

/// Makes the tiles; one flag per node of all bodies: computed by the stencil.
template <class Real>
StencilTiles<Real> make_stencil_tiles(const std::vector<const BodyMesh*>& level_meshes,
                                      const std::vector<char>& by_stencil);

namespace stencil {

/// Splits `length` nodes at x into the three rows at `to`.
template <class Real>
inline void split_row(const Real* __restrict x, Real* __restrict to, int length) {
  using V = Vector<Real>;
  constexpr int L = Lanes<Real>::count, W = StencilRing<Real>::width;
  auto split = [&](int i) {
    const V v[3] = {load(x + dof_of(i)), load(x + dof_of(i) + L), load(x + dof_of(i) + 2 * L)};
    V u[3];
    split_components<Real>(v, u);
    for (int c = 0; c < 3; ++c) store(to + c * W + i, u[c]);
  };
  int i = 0;
  for (; i + L <= length; i += L) split(i);
  if (i == length) return;
  if (length >= L)
    split(length - L);
  else
    for (; i < length; ++i)
      for (int c = 0; c < 3; ++c) to[c * W + i] = x[dof_of(i, c)];
}

/// Computes y = (base +) stencil on `length` nodes at position p of the ring's rows below, at and above (z), middle row
/// given.
template <bool with_base, class Real>
inline void apply_run(const StencilCoefficients<Real>& k, const Real* below, const Real* middle, const Real* above,
                      Real* __restrict sums, int p, int length, const Real* base, Real* __restrict y) {
  using V = Vector<Real>;
  constexpr int L = Lanes<Real>::count, W = StencilRing<Real>::width, R = StencilRing<Real>::row_stride;
  Real* __restrict lower = sums, * __restrict upper = sums + 3 * W, * __restrict centre = sums + 6 * W;
  for (int i = (p - 1) & ~(L - 1); i <= p + length; i += L) {
    V out[3], in[3], dy[3], dz[3], dydz[3];
    for (int c = 0; c < 3; ++c) {
      const int o = c * W + i;
      const V ym_zm = load(below - R + o), y0_zm = load(below + o), yp_zm = load(below + R + o);
      const V ym_z0 = load(middle - R + o), y0_z0 = load(middle + o), yp_z0 = load(middle + R + o);
      const V ym_zp = load(above - R + o), y0_zp = load(above + o), yp_zp = load(above + R + o);
      const V tp = yp_zp + yp_zm, tm = ym_zp + ym_zm;
      const V corners = tp + tm, ey = yp_z0 + ym_z0, ez = y0_zp + y0_zm;
      out[c] = k.outer[c][0] * corners + k.outer[c][1] * ey + k.outer[c][2] * ez + k.outer[c][3] * y0_z0;
      in[c] = k.inner[c][0] * corners + k.inner[c][1] * ey + k.inner[c][2] * ez + k.inner[c][3] * y0_z0;
      if (c != 2) dy[c] = (tp - tm) + k.cross_edge * (yp_z0 - ym_z0);
      const V rp = yp_zp - yp_zm, rm = ym_zp - ym_zm;
      if (c != 1) dz[c] = (rp + rm) + k.cross_edge * (y0_zp - y0_zm);
      dydz[c] = rp - rm;
    }
    out[1] += k.cross_outer * dydz[2];
    in[1] += k.cross_inner * dydz[2];
    out[2] += k.cross_outer * dydz[1];
    in[2] += k.cross_inner * dydz[1];
    const V dx[3] = {dy[1] + dz[2], dy[0], dz[0]};
    for (int c = 0; c < 3; ++c) {
      store(lower + c * W + i, V(out[c] + k.cross_x * dx[c]));
      store(upper + c * W + i, V(out[c] - k.cross_x * dx[c]));
      store(centre + c * W + i, in[c]);
    }
  }
  auto value = [&](int c, int i) {
    return load(upper + c * W + p + i + 1) + (load(lower + c * W + p + i - 1) + load(centre + c * W + p + i));
  };
  auto finish = [&](int i) {
    const V u[3] = {value(0, i), value(1, i), value(2, i)};
    V v[3];
    join_components<Real>(u, v);
    for (int c = 0; c < 3; ++c) {
      if (with_base) v[c] += load(base + dof_of(i) + c * L);
      store(y + dof_of(i) + c * L, v[c]);
    }
  };
  int i = 0;
  for (; i + L <= length; i += L) finish(i);
  if (i == length) return;
  const V u[3] = {value(0, i), value(1, i), value(2, i)};
  V v[3];
  join_components<Real>(u, v);
  for (int c = 0; c < 3; ++c) {
    const int begin = dof_of(i) + c * L, left = dof_of(length) - begin, n = left < 0 ? 0 : left > L ? L : left;
    if (with_base) v[c] += load_first(base + begin, n);
    store_first(y + begin, v[c], n);
  }
}

/// Computes all planes of one tile. y = A x, or y = base + (A with the sign of the coefficients) x.
template <bool with_base, class Real>
inline void apply_tile(const StencilTiles<Real>& t, int tile, const Real* x, const Real* base, Real* y, Real* ring) {
  using Ring = StencilRing<Real>;
  const int first = t.tile_plane(tile), planes = t.tile_plane(tile + 1) - first - 1;
  const StencilCoefficients<Real>& k = with_base ? t.minus(t.tile_body(tile)) : t.plus(t.tile_body(tile));
  Real* sums = ring + 3 * Ring::plane_stride;
  for (int plane = 0; plane < planes; ++plane) {
    Real* to = ring + plane % 3 * Ring::plane_stride;
    for (int e = t.copy_begin(first + plane); e < t.copy_begin(first + plane + 1); ++e)
      split_row(x + dof_offset(t.copies(e, 0)), to + t.copies(e, 1), t.copies(e, 2));
    if (plane < 2) continue;
    const Real* below = ring + (plane - 2) % 3 * Ring::plane_stride;
    const Real* middle = ring + (plane - 1) % 3 * Ring::plane_stride;
    int next = t.copy_begin(first + plane + 1);
    const int next_end = plane + 1 < planes ? t.copy_begin(first + plane + 2) : next;
    for (int e = t.run_begin(first + plane - 1); e < t.run_begin(first + plane); ++e) {
      if (next < next_end) {  // fetch the next plane while this one is computed
        const Real* row_begin = x + dof_offset(t.copies(next, 0));
        const Real* row_end = row_begin + dof_of(t.copies(next, 2));
        for (const Real* p = row_begin; p < row_end; p += 64 / sizeof(Real)) __builtin_prefetch(p, 0, 2);
        ++next;
      }
      const std::size_t dof = dof_offset(t.runs(e, 0));
      const int row = t.runs(e, 1) * Ring::row_stride;
      apply_run<with_base>(k, below + row, middle + row, to + row, sums, t.runs(e, 2), t.runs(e, 3),
                           with_base ? base + dof : nullptr, y + dof);
    }
  }
}

}  // namespace stencil

}  // namespace cgcontact
