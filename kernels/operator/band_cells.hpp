/// Cells that reach nodes outside of the stencil: cut cells, and full cells on faces that lie on grid planes.
///
/// Nothing but 27 moments is stored of a cut cell. In the basis 1, x, y, z, xy, yz, zx, xyz of the cell the strains are
/// coefficients of the displacement, so the stiffness is a set of products "moment times stress coefficient": 192
/// multiply-adds, as many as with a stored matrix of rank 18 (171 numbers), from a sixth of the memory. Support terms
/// have the same form with moments over the boundary.
///
/// Corners at stencil nodes have received the full cell's share already: a cut cell adds the difference there.
/// Batches hold one cell per lane. Cells come in chunks (slabs of at least two layers); chunks of one colour share no
/// node, and a chunk is walked in order by one thread, so the result does not depend on the number of threads.
#pragma once

#include <vector>

#include "kernels/operator/node_columns.hpp"
#include "kernels/operator/system.hpp"
#include "kernels/simd/lanes.hpp"

namespace cgcontact {

/// Slabs of cell layers along the longest direction of each body, in two colours.
struct SlabPartition {
  struct Body {
    int axis = 0;
    std::vector<int> slab_of_layer;
  };
  std::vector<Body> bodies;
  std::vector<int> colour_of_slab;  ///< all bodies
  int slab_of(int body, const Index3& cell) const { return bodies[body].slab_of_layer[cell[bodies[body].axis]]; }
};
SlabPartition make_slabs(const std::vector<const BodyMesh*>& level_meshes);

/// Interior cells, and cells on a face that lies on a grid plane: "cut" by name, with the full cell's moments.
bool counts_as_full(const CutCells& cut_cells, int active);

template <class Real>
struct BandCells {
  static constexpr int L = Lanes<Real>::count;
  using NodeBatches = Kokkos::View<int* [4][L], Kokkos::LayoutRight, MemSpace>;
  using MomentBatches = Kokkos::View<Real* [27][L], Kokkos::LayoutRight, MemSpace>;
  using PairBatches = Kokkos::View<Real* [27][L], Kokkos::LayoutRight, MemSpace>;

  struct Law {
    Real across, lambda;  ///< (lambda + 2 mu) / mu, lambda / mu, of the dilatation at points
    Real mean;            ///< lambda / mu of the mean dilatation
    Real full[3];         ///< mu times the full cell's moments 1, x x, x x y y
    int fold;             ///< plane strain: bit of the corners on the upper side, which are the lower ones; or 0
    bool ring;            ///< body of revolution: moments as in ring_moment
  };
  struct Batch {
    int body, count;       ///< cells in use: the first lanes
    int moments;           ///< index into moments; -1: full cells
    int pairs;             ///< first of the support pairs
    int pair_mask;         ///< which of xx, yy, zz, xy, yz, zx there are
    unsigned stencil_any;  ///< some corner of some cell is a stencil node
  };

  NodeBatches nodes;  ///< (batch, corner pair, lane): first of the two nodes along x
  Kokkos::View<int* [8], Kokkos::LayoutRight, MemSpace> stencil_lanes;  ///< (batch, corner): bit of each lane
  MomentBatches moments;
  PairBatches pairs;
  Kokkos::View<Batch*, MemSpace> batches;
  IntView chunk_begin;  ///< slab -> first batch
  Kokkos::View<Law*, MemSpace> laws;
  long long num_cut = 0, num_full = 0, num_supported = 0;
  bool far = false;  ///< vectors do not stay in the cache: values are fetched one batch ahead

  std::size_t bytes() const;
};

template <class Real>
BandCells<Real> make_band_cells(const ElasticSystem& system, const std::vector<char>& by_stencil,
                                const SlabPartition& slabs);

namespace band {

/// Position of a mode's exponents in the table of moments; sums for products of modes.
constexpr int moment_index(int mode) { return 9 * (mode & 1) + 3 * (mode >> 1 & 1) + (mode >> 2 & 1); }

/// Eight corner values -> coefficients of 8 x modes.
template <class V>
inline void to_modes(V u[8]) {
#pragma GCC unroll 3
  for (int s = 1; s < 8; s *= 2)
#pragma GCC unroll 8
    for (int a = 0; a < 8; ++a)
      if (!(a & s)) {
        const V low = u[a], high = u[a + s];
        u[a] = high + low;
        u[a + s] = high - low;
      }
}

/// The transpose of to_modes: modal forces -> corner forces.
template <class V>
inline void to_corners(V f[8]) {
#pragma GCC unroll 3
  for (int s = 1; s < 8; s *= 2)
#pragma GCC unroll 8
    for (int a = 0; a < 8; ++a)
      if (!(a & s)) {
        const V mean = f[a], slope = f[a + s];
        f[a] = mean - slope;
        f[a + s] = mean + slope;
      }
}

/// Modal forces of the full cell.
template <class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void full_forces(const typename BandCells<Real>::Law& law, const V c[3][8], V f[3][8]) {
  const Real m0 = law.full[0], m1 = law.full[1], m2 = law.full[2];
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, g = (d + 2) % 3, D = 1 << d, E = 1 << e, G = 1 << g;
    const V xx0 = c[d][D], yy0 = c[e][E], zz0 = c[g][G];
    // Normal stress along d tested with 1, E, G, EG; shear of d with e and with g tested with the derivatives of u_d.
    f[d][0] = V{};
    f[d][D] = m0 * ((law.across + law.mean) * xx0 + (law.lambda + law.mean) * (yy0 + zz0));
    f[d][E] = m0 * (c[d][E] + c[e][D]);
    f[d][G] = m0 * (c[d][G] + c[g][D]);
    f[d][D | E] = m1 * (law.across * c[d][D | E] + law.lambda * c[g][G | E] + c[d][D | E]);
    f[d][D | G] = m1 * (law.across * c[d][D | G] + law.lambda * c[e][E | G] + c[d][D | G]);
    f[d][E | G] = m1 * ((c[d][E | G] + c[e][D | G]) + (c[d][E | G] + c[g][D | E]));
    f[d][7] = m2 * (law.across + 2) * c[d][7];
  }
}

/// Adds the modal forces of the mean dilatation over a cut cell's part in the body. Reads modes with normal strains
/// only.
template <class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void add_mean_forces(const Real mean, const V* m, const V c[3][8], V f[3][8]) {
  constexpr int num = 4;
  V dilatation = {};
  const auto each_mode = [&](const auto& use) {
    for (int d = 0; d < 3; ++d) {
      const int D = 1 << d, E = 1 << (d + 1) % 3, G = 1 << (d + 2) % 3;
      const int other[num] = {0, E, G, E | G};
      for (int t = 0; t < num; ++t) use(d, other[t] | D, m[moment_index(other[t])]);
    }
  };
  each_mode([&](int d, int mode, const V& moment) { dilatation += moment * c[d][mode]; });
  const V pressure = mean * dilatation / m[0];
  each_mode([&](int d, int mode, const V& moment) { f[d][mode] += moment * pressure; });
}

/// Modal forces from the moments of a cut cell.
template <class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void cut_forces(const typename BandCells<Real>::Law& law, const Real* moments,
                                            const V c[3][8], V f[3][8]) {
  constexpr int L = Lanes<Real>::count;
  const V* m = reinterpret_cast<const V*>(moments);
  static_assert(sizeof(V) == L * sizeof(Real));
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d)
#pragma GCC unroll 8
    for (int a = 0; a < 8; ++a) f[d][a] = V{};
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, g = (d + 2) % 3, D = 1 << d, E = 1 << e, G = 1 << g;
    // Stress dd: modes without D from the strain dd, those without E and without G from the others.
    V s[8];
    s[0] = law.across * c[d][D] + law.lambda * (c[e][E] + c[g][G]);
    s[E] = law.across * c[d][D | E] + law.lambda * c[g][G | E];
    s[G] = law.across * c[d][D | G] + law.lambda * c[e][E | G];
    s[E | G] = law.across * c[d][7];
    s[D] = law.lambda * (c[e][D | E] + c[g][D | G]);
    s[D | G] = law.lambda * c[e][7];
    s[D | E] = law.lambda * c[g][7];
    const int test[4] = {0, E, G, E | G}, trial[7] = {0, E, G, E | G, D, D | G, D | E};
#pragma GCC unroll 4
    for (int t = 0; t < 4; ++t) {
      V sum = m[moment_index(test[t]) + moment_index(trial[0])] * s[trial[0]];
#pragma GCC unroll 6
      for (int n = 1; n < 7; ++n) sum += m[moment_index(test[t]) + moment_index(trial[n])] * s[trial[n]];
      f[d][test[t] | D] += sum;
    }
    // Shear de: all modes but those with D and E.
    V h[6];
    const int mode[6] = {0, D, E, G, D | G, E | G};
    h[0] = c[d][E] + c[e][D];
    h[1] = c[d][D | E];
    h[2] = c[e][D | E];
    h[3] = c[d][E | G] + c[e][D | G];
    h[4] = c[d][7];
    h[5] = c[e][7];
#pragma GCC unroll 6
    for (int t = 0; t < 6; ++t) {
      V sum = m[moment_index(mode[t]) + moment_index(mode[0])] * h[0];
#pragma GCC unroll 6
      for (int n = 1; n < 6; ++n) sum += m[moment_index(mode[t]) + moment_index(mode[n])] * h[n];
      if (!(mode[t] & E)) f[d][mode[t] | E] += sum;
      if (!(mode[t] & D)) f[e][mode[t] | D] += sum;
    }
  }
  if (law.mean > 0) add_mean_forces(law.mean, m, c, f);
}

/// Adds the support terms: modal forces from boundary moments of each pair of components.
template <class Real, class V>
inline void add_support_forces(const BandCells<Real>& cells, const typename BandCells<Real>::Batch& batch,
                               const V c[3][8], V f[3][8]) {
  int slot = batch.pairs;
  for (int pair = 0; pair < 6; ++pair) {
    if (!(batch.pair_mask >> pair & 1)) continue;
    const V* m = reinterpret_cast<const V*>(&cells.pairs(slot++, 0, 0));
    const int i = pair % 3, j = pair < 3 ? i : (i + 1) % 3;
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) {
        const V& w = m[moment_index(a) + moment_index(b)];
        f[i][a] += w * c[j][b];
        if (pair >= 3) f[j][a] += w * c[i][b];
      }
  }
}

/// Keeps the lanes whose bit is set (or not set).
template <class Real>
inline Vector<Real> lanes_where(int bits, const Vector<Real>& v) {
#ifdef __AVX512F__
  if constexpr (sizeof(Real) == 8)
    return _mm512_maskz_mov_pd(static_cast<__mmask8>(bits), v);
  else
    return _mm512_maskz_mov_ps(static_cast<__mmask16>(bits), v);
#else
  Vector<Real> r = {};
  for (int l = 0; l < Lanes<Real>::count; ++l)
    if (bits >> l & 1) r[l] = v[l];
  return r;
#endif
}

/// Corner forces of a batch from its corner displacements, in place.
template <class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void batch_forces(const BandCells<Real>& cells, int b, V u[3][8]) {
  const auto& batch = cells.batches(b);
  const auto& law = cells.laws(batch.body);
  V f[3][8];
  for (int i = 0; i < 3; ++i) to_modes(u[i]);
  if (batch.moments < 0) {
    full_forces<Real>(law, u, f);
    for (int i = 0; i < 3; ++i) {
      to_corners(f[i]);
      for (int a = 0; a < 8; ++a) u[i][a] = lanes_where<Real>(~cells.stencil_lanes(b, a), f[i][a]);
    }
    return;
  }
  const Real* moments = &cells.moments(batch.moments, 0, 0);
  cut_forces<Real>(law, moments, u, f);
  if (batch.pair_mask) add_support_forces(cells, batch, u, f);
  for (int i = 0; i < 3; ++i) to_corners(f[i]);
  if (!batch.stencil_any) {
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 8; ++a) u[i][a] = f[i][a];
    return;
  }
  V full[3][8];
  full_forces<Real>(law, u, full);
  for (int i = 0; i < 3; ++i) {
    to_corners(full[i]);
    for (int a = 0; a < 8; ++a) u[i][a] = f[i][a] - lanes_where<Real>(cells.stencil_lanes(b, a), full[i][a]);
  }
}

/// Gives the modes 1, E, G, EG of a component from its lower corners along d, both layers being one: twice those of
/// one.
template <int d, class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void to_plane_modes(const V v[8], V c[4]) {
  constexpr int E = 1 << (d + 1) % 3, G = 1 << (d + 2) % 3;
  const V low = v[E] - v[0], high = v[E | G] - v[G];
  c[0] = Real(2) * ((v[E | G] + v[G]) + (v[E] + v[0]));
  c[1] = Real(2) * (high + low);
  c[2] = Real(2) * ((v[E | G] + v[G]) - (v[E] + v[0]));
  c[3] = Real(2) * (high - low);
}

/// Turns modal forces into corner forces of both layers, the transpose of to_plane_modes; mode 1 is left out unless
/// `mean`.
template <int d, bool mean, class V>
KOKKOS_FORCEINLINE_FUNCTION void to_plane_corners(const V f[4], V v[8]) {
  constexpr int D = 1 << d, E = 1 << (d + 1) % 3, G = 1 << (d + 2) % 3;
  const auto with_mean = [&](const V& force) { return mean ? f[0] + force : force; };
  v[0] = v[D] = with_mean(f[3]) - f[1] - f[2];
  v[E] = v[D | E] = with_mean(f[1]) - f[2] - f[3];
  v[G] = v[D | G] = with_mean(f[2]) - f[1] - f[3];
  v[E | G] = v[7] = with_mean(f[1]) + f[2] + f[3];
}

/// Corner forces of a cell in plane strain along d, in place: stresses and forces in the plane alone, from the lower
/// corners' displacements; both corners that are one have the force that each would have. moments: nullptr: full.
template <int d, class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void plane_forces(const typename BandCells<Real>::Law& law, const Real* moments,
                                              V u[3][8]) {
  constexpr int e = (d + 1) % 3, g = (d + 2) % 3, E = 1 << e, G = 1 << g;
  const V* m = reinterpret_cast<const V*>(moments);
  const V m0 = moments ? m[0] : V{} + law.full[0], none = {};
  const V mE = moments ? m[moment_index(E)] : none, mG = moments ? m[moment_index(G)] : none;
  const V mEG = moments ? m[moment_index(E) + moment_index(G)] : none;
  const V mEE = moments ? m[2 * moment_index(E)] : V{} + law.full[1];
  const V mGG = moments ? m[2 * moment_index(G)] : V{} + law.full[1];
  V c[2][4];  // of u_e and u_g
  to_plane_modes<d, Real>(u[e], c[0]);
  to_plane_modes<d, Real>(u[g], c[1]);
  const V &p = c[0][3], &q = c[1][3];
  const V ee = law.across * c[0][1] + law.lambda * c[1][2], gg = law.across * c[1][2] + law.lambda * c[0][1];
  const V eg = c[0][2] + c[1][1], across_p = law.across * p, across_q = law.across * q;
  const V lambda_p = law.lambda * p, lambda_q = law.lambda * q;
  const V shear = m0 * eg + mE * p + mG * q;
  V f[2][4] = {{none, m0 * ee + mG * across_p + mE * lambda_q, shear,
                mG * ee + mGG * across_p + mEG * lambda_q + mE * eg + mEE * p + mEG * q},
               {none, shear, m0 * gg + mE * across_q + mG * lambda_p,
                mE * gg + mEE * across_q + mEG * lambda_p + mG * eg + mEG * p + mGG * q}};
  if (law.mean > 0) {
    const V pressure = law.mean * (c[0][1] + c[1][2] + (mG * p + mE * q) / m0);
    f[0][1] += m0 * pressure;
    f[0][3] += mG * pressure;
    f[1][2] += m0 * pressure;
    f[1][3] += mE * pressure;
  }
  to_plane_corners<d, false>(f[0], u[e]);
  to_plane_corners<d, false>(f[1], u[g]);
  for (int a = 0; a < 8; ++a) u[d][a] = none;
}

/// What is known of a cell of a body of revolution, instead of its moments: integrals of powers of its coordinates
/// E along the axis and G away from it, times the diameter 2 r (in cells: diameter of the middle + G), plain, and over
/// the diameter.
namespace ring_moment {
constexpr int ring = 0;      ///< 1, E, G, E G, E^2, G^2
constexpr int plain = 6;     ///< 1, E, G, E G, E^2
constexpr int inverse = 11;  ///< 1, E, E^2
constexpr int diameter = 14;
}  // namespace ring_moment

/// Corner forces of a cell of a body of revolution, in place, as plane_forces: strain u_r / r around the axis, volume
/// in proportion to r. With u_r = r slope + b, where slope is the strain along r and b does not depend on r, all that
/// is no polynomial is b^2 / r (docs/theory.md, "Bodies of revolution").
template <int d, class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void ring_forces(const typename BandCells<Real>::Law& law, const Real* moments, V u[3][8]) {
  constexpr int e = (d + 1) % 3, g = (d + 2) % 3;
  const V* m = reinterpret_cast<const V*>(moments);
  const V *r = m + ring_moment::ring, *n = m + ring_moment::plain, *w = m + ring_moment::inverse;
  const V& diameter = m[ring_moment::diameter];
  V c[2][4];  // of u_e and u_g
  to_plane_modes<d, Real>(u[e], c[0]);
  to_plane_modes<d, Real>(u[g], c[1]);
  // Strains: ee = c01 + c03 G, gg = c12 + c13 E, around = gg + (b0 + b1 E) / diameter,
  // shear = c02 + c11 + c03 E + c13 G.
  const V &p = c[0][3], &q = c[1][3], &ee = c[0][1], &gg = c[1][2];
  const V b0 = c[1][0] - diameter * gg, b1 = c[1][1] - diameter * q;
  const V shear = c[0][2] + c[1][1];
  const Real A = law.across, L = law.lambda, both = Real(2) * (A + L), twice = Real(2) * L;
  // Stresses times the diameter, tested with ee (1, G), gg (1, E), shear (1, E, G) and b (1, E).
  const V f_ee = r[0] * (A * ee + twice * gg) + A * r[2] * p + twice * r[1] * q + L * (n[0] * b0 + n[1] * b1);
  const V f_p = r[2] * (A * ee + twice * gg) + A * r[5] * p + twice * r[3] * q + L * (n[2] * b0 + n[3] * b1) +
                r[1] * shear + r[4] * p + r[3] * q;
  const V f_gg =
      r[0] * (both * gg + twice * ee) + both * r[1] * q + twice * r[2] * p + (A + L) * (n[0] * b0 + n[1] * b1);
  const V f_q = r[1] * (both * gg + twice * ee) + both * r[4] * q + twice * r[3] * p +
                (A + L) * (n[1] * b0 + n[4] * b1) + r[2] * shear + r[3] * p + r[5] * q;
  const V f_shear = r[0] * shear + r[1] * p + r[2] * q;
  const V sum = A * gg + L * (ee + gg), sum_E = (A + L) * q;  // around without b: sum + sum_E E + L p G
  const V f_b0 = n[0] * sum + n[1] * sum_E + L * n[2] * p + A * (w[0] * b0 + w[1] * b1);
  const V f_b1 = n[1] * sum + n[4] * sum_E + L * n[3] * p + A * (w[1] * b0 + w[2] * b1);
  V f[2][4] = {{V{}, f_ee, f_shear, f_p}, {f_b0, f_shear + f_b1, f_gg - diameter * f_b0, f_q - diameter * f_b1}};
  if (law.mean > 0) {  // of what is integrated: (ee + 2 gg) (2 r) + b0 + ...
    const V dilatation = r[0] * (ee + Real(2) * gg) + r[2] * p + Real(2) * r[1] * q + n[0] * b0 + n[1] * b1;
    const V pressure = law.mean * dilatation / r[0];
    f[0][1] += r[0] * pressure;
    f[0][3] += r[2] * pressure;
    f[1][0] += n[0] * pressure;
    f[1][1] += n[1] * pressure;
    f[1][2] += (Real(2) * r[0] - diameter * n[0]) * pressure;
    f[1][3] += (Real(2) * r[1] - diameter * n[1]) * pressure;
  }
  to_plane_corners<d, false>(f[0], u[e]);
  to_plane_corners<d, true>(f[1], u[g]);
  for (int a = 0; a < 8; ++a) u[d][a] = V{};
}

/// The same of a batch, with supports.
template <class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void ring_batch_forces(const BandCells<Real>& cells, int b, V u[3][8]) {
  const auto& batch = cells.batches(b);
  const auto& law = cells.laws(batch.body);
  const Real* moments = &cells.moments(batch.moments, 0, 0);
  V held[3][8] = {};
  if (batch.pair_mask) {
    V modes[3][8];
    for (int i = 0; i < 3; ++i) {
      for (int a = 0; a < 8; ++a) modes[i][a] = u[i][a];
      to_modes(modes[i]);
    }
    add_support_forces(cells, batch, modes, held);
    for (int i = 0; i < 3; ++i) to_corners(held[i]);
  }
  if (law.fold == 1)
    ring_forces<0>(law, moments, u);
  else if (law.fold == 2)
    ring_forces<1>(law, moments, u);
  else
    ring_forces<2>(law, moments, u);
  for (int i = 0; i < 3 && batch.pair_mask; ++i)
    for (int a = 0; a < 8; ++a) u[i][a] += held[i][a];
}

/// The same of a batch without supports. No node of a single layer is the stencil's.
template <class Real, class V>
KOKKOS_FORCEINLINE_FUNCTION void plane_batch_forces(const BandCells<Real>& cells, int b, V u[3][8]) {
  const auto& batch = cells.batches(b);
  const auto& law = cells.laws(batch.body);
  const Real* moments = batch.moments < 0 ? nullptr : &cells.moments(batch.moments, 0, 0);
  if (law.fold == 1) return plane_forces<0>(law, moments, u);
  if (law.fold == 2) return plane_forces<1>(law, moments, u);
  plane_forces<2>(law, moments, u);
}

/// Corner values of a batch: u[component][corner].
template <class Real, class V>
inline void gather(const BandCells<Real>& cells, int b, const Real* x, V u[3][8]) {
  constexpr int L = Lanes<Real>::count;
  for (int pair = 0; pair < 4; ++pair) {
    const int* nodes = &cells.nodes(b, pair, 0);
    V r[8];
    for (int l = 0; l < 8; ++l) {
      r[l] = load_first(x + dof_offset(nodes[l]), 6);
      if constexpr (L == 16) {
        const V second = load_first(x + dof_offset(nodes[l + 8]), 6);
        r[l] = join_halves(r[l], second);
      }
    }
    transpose8<Real>(r);
    for (int i = 0; i < 3; ++i) {
      u[i][2 * pair] = r[i];
      u[i][2 * pair + 1] = r[3 + i];
    }
  }
}

/// y += (or -=) the corner forces, one cell after the other: cells of a batch may share nodes.
template <bool subtract, class Real, class V>
inline void scatter(const BandCells<Real>& cells, int b, const V u[3][8], Real* y) {
  constexpr int L = Lanes<Real>::count;
  const int count = cells.batches(b).count;
  for (int pair = 0; pair < 4; ++pair) {
    const int* nodes = &cells.nodes(b, pair, 0);
    V r[8] = {u[0][2 * pair],     u[1][2 * pair],     u[2][2 * pair],     u[0][2 * pair + 1],
              u[1][2 * pair + 1], u[2][2 * pair + 1], u[0][2 * pair + 1], u[0][2 * pair + 1]};
    transpose8<Real>(r);
    const Real* rows = reinterpret_cast<const Real*>(r);
    for (int l = 0; l < count; ++l) add_six<subtract>(y + dof_offset(nodes[l]), rows + (l % 8) * L + l / 8 * 8);
  }
}

/// Fetches the corner values of a batch.
template <class Real>
inline void prefetch(const BandCells<Real>& cells, int b, const Real* x) {
  const int* nodes = &cells.nodes(b, 0, 0);
  for (int i = 0; i < 4 * BandCells<Real>::L; ++i) __builtin_prefetch(x + dof_offset(nodes[i]));
}

template <bool subtract, class Real>
inline void apply_chunk(const BandCells<Real>& cells, int chunk, const Real* x, Real* y) {
  const int end = cells.chunk_begin(chunk + 1);
  for (int b = cells.chunk_begin(chunk); b < end; ++b) {
    if (cells.far) {
      prefetch(cells, b, y);
      if (b + 1 < end) prefetch(cells, b + 1, x);
    }
    Vector<Real> u[3][8];
    gather(cells, b, x, u);
    if (cells.laws(cells.batches(b).body).ring)
      ring_batch_forces(cells, b, u);
    else if (cells.laws(cells.batches(b).body).fold && !cells.batches(b).pair_mask)
      plane_batch_forces(cells, b, u);
    else
      batch_forces(cells, b, u);
    scatter<subtract>(cells, b, u, y);
  }
}

/// Node blocks (xx, yy, zz, xy, yz, zx) and the blocks between different nodes of a column, from unit displacements of
/// every corner; in plane strain of both corners that are one, at the lower one.
template <class Real, class Blocks>
inline void add_diagonal_blocks(const BandCells<Real>& cells, int chunk, const Blocks& blocks,
                                const NodeColumns<Real>& columns) {
  for (int b = cells.chunk_begin(chunk); b < cells.chunk_begin(chunk + 1); ++b)
    for (int a = 0; a < 8; ++a)
      for (int j = 0; j < 3; ++j) {
        const int fold = cells.laws(cells.batches(b).body).fold;
        if (a & fold) continue;
        Vector<Real> u[3][8] = {};
        u[j][a] += Real(1);
        if (fold) u[j][a | fold] += Real(1);
        if (cells.laws(cells.batches(b).body).ring) {
          ring_batch_forces(cells, b, u);
          if (fold == 1 << j)  // zero across: anything positive
            u[j][a] += *reinterpret_cast<const Vector<Real>*>(&cells.moments(cells.batches(b).moments, 0, 0));
        } else {
          batch_forces(cells, b, u);
        }
        for (int i = 0; i < 3 && fold; ++i)
          for (int c = 0; c < 8; ++c)
            if (!(c & fold)) u[i][c] += u[i][c | fold];
        for (int l = 0; l < cells.batches(b).count; ++l) {
          const int node = cells.nodes(b, a / 2, l) + a % 2;
          blocks(node, j) += u[j][a][l];
          blocks(node, 3 + j) += u[(j + 1) % 3][a][l];
          const int c = columns.column_of_node(node);
          if (c < 0) continue;
          const auto& column = columns.columns(c);
          const int across = a ^ 1 << column.axis, other = cells.nodes(b, across / 2, l) + across % 2;
          const int slot = columns.slot(column, node), row = slot + (a >> column.axis & 1 ? -1 : 1);
          if (row < 0 || row >= column.size || columns.nodes(column.first + row) != other) continue;
          for (int i = 0; i < 3; ++i)
            columns.matrices(column.entry(dof_of(row, i), dof_of(slot, j))) += u[i][across][l];
        }
      }
}

}  // namespace band

}  // namespace cgcontact
