#include "kernels/operator/band_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/base/parallel.hpp"
#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {
namespace {

/// Moments of x^i y^j z^k, i, j, k <= 2, from those of Legendre products: x^2 = (2 L2 + L0) / 3.
void monomial_moments(const Moments& legendre, double out[27]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        double sum = 0;
        for (int a = i % 2; a <= i; a += 2)
          for (int b = j % 2; b <= j; b += 2)
            for (int c = k % 2; c <= k; c += 2) {
              auto share = [](int degree, int l) { return degree < 2 ? 1.0 : (l == 2 ? 2. / 3 : 1. / 3); };
              sum += share(i, a) * share(j, b) * share(k, c) *
                     legendre[(a * (moment_degree + 1) + b) * (moment_degree + 1) + c];
            }
        out[9 * i + 3 * j + k] = sum;
      }
}

/// Gradients per cell unit are twice those in cell coordinates, the volume is an eighth, the coefficients are eight
/// times those of the modes, on both sides.
double moment_scale(const BodyMesh& mesh, double h) { return mesh.modulus * h * mesh.law.mu * 4 / (8 * 64); }

/// Those of a cell of a body of revolution (band::ring_moment), 27 as of other cells, with the factor of the slice at
/// the radius.
void ring_moments(const BodyMesh& mesh, int cell, double out[27]) {
  constexpr int n = Gauss5::count;
  const CutCells& cc = *mesh.cut_cells;
  const Ring ring = mesh.ring_of(cell);
  const int along = cc.grid.axis_of_revolution();
  const double factor = 0.5 * cc.h(cell) / cc.grid.unit_radius;
  double weights[n * n * n];
  fitted_weights(cc.moments[cc.cut_of_active[cell]], n, weights);
  std::fill(out, out + 27, 0.0);
  for (int q = 0; q < n * n * n; ++q) {
    const double xi[3] = {Gauss5::point[q / (n * n)], Gauss5::point[q / n % n], Gauss5::point[q % n]};
    const double E = xi[along], G = xi[ring.radial], diameter = ring.diameter + G, w = factor * weights[q];
    const double plain[5] = {w, w * E, w * G, w * E * G, w * E * E};
    for (int k = 0; k < 5; ++k) {
      out[band::ring_moment::ring + k] += diameter * plain[k];
      out[band::ring_moment::plain + k] += plain[k];
    }
    out[band::ring_moment::ring + 5] += diameter * w * G * G;
    out[band::ring_moment::inverse] += w / diameter;
    out[band::ring_moment::inverse + 1] += w * E / diameter;
    out[band::ring_moment::inverse + 2] += w * E * E / diameter;
  }
  out[band::ring_moment::diameter] = ring.diameter;
}

/// Boundary moments of the support terms of one cell, per pair of components (xx, yy, zz, xy, yz, zx).
struct SupportMoments {
  double value[6][27] = {};
  void add(const SupportTerm& term) {
    for (int pair = 0; pair < 6; ++pair) {
      const int i = pair % 3, j = pair < 3 ? i : (i + 1) % 3;
      const double k = term.stiffness * term.direction[i] * term.direction[j] / 64;
      if (k == 0) continue;
      double x = k;
      for (int a = 0; a < 3; ++a, x *= term.xi[0]) {
        double y = x;
        for (int b = 0; b < 3; ++b, y *= term.xi[1]) {
          double z = y;
          for (int c = 0; c < 3; ++c, z *= term.xi[2]) value[pair][9 * a + 3 * b + c] += z;
        }
      }
    }
  }
  int mask() const {
    int bits = 0;
    for (int pair = 0; pair < 6; ++pair)
      for (double v : value[pair])
        if (v != 0) bits |= 1 << pair;
    return bits;
  }
};

/// Cells of a level that have support terms, and their boundary moments.
class SupportedCells {
 public:
  SupportedCells(const std::vector<SupportTerm>& terms, std::size_t num_cells) : number_(num_cells, -1) {
    std::vector<int> begin{0};
    for (const SupportTerm& t : terms) {
      int& number = number_[t.cell];
      if (number < 0) {
        number = static_cast<int>(begin.size()) - 1;
        begin.push_back(0);
      }
      ++begin[number + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<int> position(begin.begin(), begin.end() - 1), order(terms.size());
    for (std::size_t t = 0; t < terms.size(); ++t) order[position[number_[terms[t].cell]]++] = static_cast<int>(t);
    moments_.resize(begin.size() - 1);
    parallel_for("cgcontact::band::supports", moments_.size(), grain_of_heavy, [&](const std::size_t n) {
      for (int t = begin[n]; t < begin[n + 1]; ++t) moments_[n].add(terms[order[t]]);
    });
  }
  /// nullptr: no support.
  const SupportMoments* find(std::size_t cell) const { return number_[cell] < 0 ? nullptr : &moments_[number_[cell]]; }

 private:
  std::vector<int> number_;  ///< of each active cell, -1: no support
  std::vector<SupportMoments> moments_;
};

/// Cell of the band, with what decides its position.
struct BandCell {
  int body, cell, slab;
  int pair_mask;  ///< 64: full cell; 128 + axis: soft
  int parity;     ///< neighbours along x are kept apart: the one stores what the other loads
};

}  // namespace

bool counts_as_full(const CutCells& cut_cells, int active) {
  const int cut = cut_cells.cut_of_active[active];
  if (cut < 0) return true;
  constexpr int n = moment_degree + 1;
  const Moments &m = cut_cells.moments[cut], &full = full_cell_moments();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        if (std::abs(m[(i * n + j) * n + k] - full[(i * n + j) * n + k]) > 1e-14 * full[0]) return false;
  return true;
}

SlabPartition make_slabs(const std::vector<const BodyMesh*>& level_meshes) {
  constexpr int max_slabs = 32;
  SlabPartition result;
  for (const BodyMesh* mesh : level_meshes) {
    const CutCells& cc = *mesh->cut_cells;
    SlabPartition::Body body;
    Index3 low = cc.grid.num_cells, high = {0, 0, 0};
    for (const Index3& c : cc.cells)
      for (int d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], c[d]);
        high[d] = std::max(high[d], c[d] + 1);
      }
    for (int d = 1; d < 3; ++d)
      if (high[d] - low[d] >= high[body.axis] - low[body.axis]) body.axis = d;
    // Chunks of about equal numbers of cut cells, at least two layers: a ghost face reaches over one layer more, one
    // towards larger cells in both directions.
    const int min_layers = mesh->level_faces.empty() ? 2 : 3;
    std::vector<double> weight(cc.grid.num_cells[body.axis], 0.0);
    double total = 0;
    for (std::size_t e = 0; e < cc.cells.size(); ++e) {
      const double w = cc.cut_of_active[e] < 0 ? 0.01 : 1;
      weight[cc.cells[e][body.axis]] += w;
      total += w;
    }
    body.slab_of_layer.assign(weight.size(), 0);
    int slab = static_cast<int>(result.colour_of_slab.size());
    int layers = 0, colour = 0;
    double sum = 0, share = total / max_slabs;
    for (int layer = low[body.axis]; layer < high[body.axis]; ++layer) {
      if (layers >= min_layers && sum >= share && high[body.axis] - layer >= min_layers) {
        result.colour_of_slab.push_back(colour);
        ++slab;
        colour = 1 - colour;
        layers = 0;
        sum = 0;
      }
      body.slab_of_layer[layer] = slab;
      ++layers;
      sum += weight[layer];
    }
    result.colour_of_slab.push_back(colour);
    result.bodies.push_back(std::move(body));
  }
  return result;
}

template <class Real>
std::size_t BandCells<Real>::bytes() const {
  return nodes.size() * sizeof(int) + stencil_lanes.size() * sizeof(int) +
         (moments.size() + pairs.size()) * sizeof(Real) + batches.size() * sizeof(Batch);
}

template <class Real>
BandCells<Real> make_band_cells(const ElasticSystem& system, const std::vector<char>& by_stencil,
                                const SlabPartition& slabs) {
  constexpr int L = Lanes<Real>::count;
  constexpr std::size_t cache = 16 << 20;
  BandCells<Real> result;
  result.far = sizeof(Real) * system.num_dofs() > cache;
  std::vector<BandCell> list;
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  std::vector<SupportedCells> supports;
  std::vector<typename BandCells<Real>::Law> laws;
  for (std::size_t b = 0; b < levels.size(); ++b) {
    const BodyMesh& mesh = *levels[b];
    const CutCells& cc = *mesh.cut_cells;
    typename BandCells<Real>::Law law;
    law.lambda = static_cast<Real>(mesh.law.lambda / mesh.law.mu);
    law.across = static_cast<Real>(mesh.law.lambda / mesh.law.mu + 2);
    for (int p = 0; p < 3; ++p)
      law.full[p] = static_cast<Real>(moment_scale(mesh, mesh.thickness_of_level(0)) * 8 / std::pow(3, p));
    law.fold = mesh.is_one_layer() ? 1 << cc.grid.plane_strain : 0;
    law.ring = mesh.is_axisymmetric();
    laws.push_back(law);
    enum Kind : char { by_stencil_alone, full, cut };
    std::vector<Kind> kind(cc.cells.size());
    const SupportedCells& supported = supports.emplace_back(system.supports[b], cc.cells.size());
    parallel_for("cgcontact::band::kind", kind.size(), grain_of_medium, [&](const std::size_t e) {
      const auto& n = mesh.cell_nodes[e];
      const bool inside =
          std::all_of(n.begin(), n.end(), [&](const int node) { return by_stencil[node] || !system.needs(node); });
      kind[e] = law.ring || supported.find(e) || !counts_as_full(cc, e) ? cut : inside ? by_stencil_alone : full;
    });
    for (std::size_t e = 0; e < cc.cells.size(); ++e) {
      if (kind[e] == by_stencil_alone || !system.needs_cell(mesh, static_cast<int>(e))) continue;
      BandCell cell{static_cast<int>(b), static_cast<int>(e), slabs.slab_of(static_cast<int>(b), cc.cells[e]), 0, 0};
      const Index3& c = cc.cells[e];
      cell.parity = 2 * c[2] + (c[0] & 1);
      if (kind[e] == full) {
        cell.pair_mask = 64;
        ++result.num_full;
      } else {
        if (const SupportMoments* s = supported.find(e)) cell.pair_mask = s->mask();
        ++result.num_cut;
        if (cell.pair_mask) ++result.num_supported;
      }
      list.push_back(cell);
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const BandCell& a, const BandCell& b) {
    return std::tie(a.slab, a.pair_mask, a.parity) < std::tie(b.slab, b.pair_mask, b.parity);
  });

  std::vector<typename BandCells<Real>::Batch> batches;
  std::vector<std::size_t> first_cell;
  std::vector<int> chunk_begin(slabs.colour_of_slab.size() + 1, 0);
  int num_moments_batches = 0, num_pairs = 0;
  for (std::size_t p = 0; p < list.size();) {
    std::size_t end = p;
    while (end < list.size() && end < p + L && list[end].slab == list[p].slab &&
           list[end].pair_mask == list[p].pair_mask)
      ++end;
    typename BandCells<Real>::Batch batch{};
    batch.body = list[p].body;
    batch.count = static_cast<int>(end - p);
    const bool full = list[p].pair_mask == 64;
    batch.moments = full ? -1 : num_moments_batches++;
    batch.pairs = num_pairs;
    batch.pair_mask = full ? 0 : list[p].pair_mask;
    for (int bit = 0; bit < 6; ++bit) num_pairs += batch.pair_mask >> bit & 1;
    ++chunk_begin[list[p].slab + 1];
    batches.push_back(batch);
    first_cell.push_back(p);
    p = end;
  }
  for (std::size_t s = 1; s < chunk_begin.size(); ++s) chunk_begin[s] += chunk_begin[s - 1];

  result.nodes = typename BandCells<Real>::NodeBatches("cgcontact::band::nodes", batches.size());
  result.stencil_lanes = decltype(result.stencil_lanes)("cgcontact::band::stencil_lanes", batches.size());
  result.moments = typename BandCells<Real>::MomentBatches("cgcontact::band::moments", num_moments_batches);
  result.pairs = typename BandCells<Real>::PairBatches("cgcontact::band::pairs", num_pairs);
  auto nodes = Kokkos::create_mirror_view(result.nodes);
  auto stencil_lanes = Kokkos::create_mirror_view(result.stencil_lanes);
  auto moments = Kokkos::create_mirror_view(result.moments);
  auto pairs = Kokkos::create_mirror_view(result.pairs);
  parallel_for("cgcontact::band::setup", batches.size(), grain_of_heavy, [&](const std::size_t b) {
    auto& batch = batches[b];
    for (int l = 0; l < L; ++l) {
      const bool used = l < batch.count;
      const BandCell& cell = list[first_cell[b] + (used ? l : 0)];
      const BodyMesh& mesh = *levels[cell.body];
      for (int pair = 0; pair < 4; ++pair) nodes(b, pair, l) = mesh.cell_nodes[cell.cell][2 * pair];
      if (!used) continue;  // its moments stay zero, its forces are dropped
      for (int a = 0; a < 8; ++a)
        if (by_stencil[mesh.cell_nodes[cell.cell][a]]) {
          stencil_lanes(b, a) |= 1 << l;
          batch.stencil_any = 1;
        }
      if (batch.moments < 0) continue;
      double m[27];
      const double scale = moment_scale(mesh, mesh.thickness_of_level(mesh.cut_cells->level(cell.cell)));
      if (mesh.is_axisymmetric())
        ring_moments(mesh, cell.cell, m);
      else
        monomial_moments(mesh.cut_cells->moments[mesh.cut_cells->cut_of_active[cell.cell]], m);
      for (int e = 0; e < 27; ++e) moments(batch.moments, e, l) = static_cast<Real>(scale * m[e]);
      if (mesh.is_axisymmetric()) moments(batch.moments, band::ring_moment::diameter, l) = static_cast<Real>(m[14]);
      int slot = batch.pairs;
      for (int bit = 0; bit < 6; ++bit) {
        if (!(batch.pair_mask >> bit & 1)) continue;
        const SupportMoments& s = *supports[cell.body].find(cell.cell);
        for (int e = 0; e < 27; ++e) pairs(slot, e, l) = static_cast<Real>(s.value[bit][e]);
        ++slot;
      }
    }
  });
  Kokkos::deep_copy(result.nodes, nodes);
  Kokkos::deep_copy(result.stencil_lanes, stencil_lanes);
  Kokkos::deep_copy(result.moments, moments);
  Kokkos::deep_copy(result.pairs, pairs);
  using BatchView = Kokkos::View<typename BandCells<Real>::Batch*, MemSpace>;
  using LawView = Kokkos::View<typename BandCells<Real>::Law*, MemSpace>;
  result.batches = copy_to_view<BatchView>("cgcontact::band::batches", batches);
  result.laws = copy_to_view<LawView>("cgcontact::band::laws", laws);
  result.chunk_begin = copy_to_view<IntView>("cgcontact::band::chunk_begin", chunk_begin);
  return result;
}

template struct BandCells<double>;
template struct BandCells<float>;
template BandCells<double> make_band_cells(const ElasticSystem&, const std::vector<char>&, const SlabPartition&);
template BandCells<float> make_band_cells(const ElasticSystem&, const std::vector<char>&, const SlabPartition&);

}  // namespace cgcontact
