#include "kernels/operator/band_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/process/parallel.hpp"
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
  int pair_mask;  ///< of its support terms, or full_cell
  int parity;     ///< neighbours along x are kept apart: the one stores what the other loads
};
constexpr int full_cell = 64;  // no mask of six pairs

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

namespace {

/// Returns the material of a level's cells, in units of mu.
template <class Real>
typename BandCells<Real>::Law law_of(const BodyMesh& mesh) {
  typename BandCells<Real>::Law law;
  law.lambda = static_cast<Real>(mesh.law.lambda_at_points() / mesh.law.mu);
  law.across = static_cast<Real>(mesh.law.lambda_at_points() / mesh.law.mu + 2);
  law.mean = static_cast<Real>(mesh.law.lambda_of_mean / mesh.law.mu);
  for (int p = 0; p < 3; ++p)
    law.full[p] = static_cast<Real>(moment_scale(mesh, mesh.thickness_of_level(0)) * 8 / std::pow(3, p));
  law.fold = mesh.is_one_layer() ? 1 << mesh.cut_cells->grid.plane_strain : 0;
  law.ring = mesh.is_axisymmetric();
  return law;
}

/// Makes the cells of the band in three steps: a list of the cells in order, batches of them, what a batch stores.
template <class Real>
class BandMaker {
 public:
  BandMaker(const ElasticSystem& system, const std::vector<char>& by_stencil, const SlabPartition& slabs)
      : system_(system), by_stencil_(by_stencil), slabs_(slabs), levels_(system.level_meshes()) {}

  BandCells<Real> make() {
    constexpr std::size_t cache = 16 << 20;
    result_.far = sizeof(Real) * system_.num_dofs() > cache;
    for (std::size_t b = 0; b < levels_.size(); ++b) list_cells(static_cast<int>(b));
    std::stable_sort(list_.begin(), list_.end(), [](const BandCell& a, const BandCell& b) {
      return std::tie(a.slab, a.pair_mask, a.parity) < std::tie(b.slab, b.pair_mask, b.parity);
    });
    count_cells();
    make_batches();
    store_batches();
    std::vector<typename BandCells<Real>::Law> laws;
    for (const BodyMesh* mesh : levels_) laws.push_back(law_of<Real>(*mesh));
    result_.laws = copy_to_view<decltype(result_.laws)>("cgcontact::band::laws", laws);
    return std::move(result_);
  }

 private:
  using Batch = typename BandCells<Real>::Batch;
  static constexpr int L = BandCells<Real>::L;
  enum class Kind : char { by_stencil_alone, full, cut };

  std::vector<Kind> kinds_of_cells(const BodyMesh& mesh, const SupportedCells& supported) const {
    std::vector<Kind> kinds(mesh.cut_cells->cells.size());
    parallel_for("cgcontact::band::kind", kinds.size(), grain_of_medium, [&](const std::size_t e) {
      const auto& n = mesh.cell_nodes[e];
      const bool inside =
          std::all_of(n.begin(), n.end(), [&](const int node) { return by_stencil_[node] || !system_.needs(node); });
      const bool is_cut = mesh.is_axisymmetric() || supported.find(e) || !counts_as_full(*mesh.cut_cells, e);
      kinds[e] = is_cut ? Kind::cut : inside ? Kind::by_stencil_alone : Kind::full;
    });
    return kinds;
  }

  /// Appends the cells of a level that the band has.
  void list_cells(int level) {
    const BodyMesh& mesh = *levels_[level];
    const CutCells& cc = *mesh.cut_cells;
    const SupportedCells& supported = supports_.emplace_back(system_.supports[level], cc.cells.size());
    const std::vector<Kind> kinds = kinds_of_cells(mesh, supported);
    for (std::size_t e = 0; e < cc.cells.size(); ++e) {
      if (kinds[e] == Kind::by_stencil_alone || !system_.needs_cell(mesh, static_cast<int>(e))) continue;
      const Index3& c = cc.cells[e];
      BandCell cell{level, static_cast<int>(e), slabs_.slab_of(level, c), 0, 2 * c[2] + (c[0] & 1)};
      const SupportMoments* const support = supported.find(e);
      cell.pair_mask = kinds[e] == Kind::full ? full_cell : support ? support->mask() : 0;
      list_.push_back(cell);
    }
  }

  void count_cells() {
    for (const BandCell& cell : list_) {
      const bool full = cell.pair_mask == full_cell;
      ++(full ? result_.num_full : result_.num_cut);
      result_.num_supported += !full && cell.pair_mask;
    }
  }

  /// Divides the list into batches of one slab and mask each.
  void make_batches() {
    chunk_begin_.assign(slabs_.colour_of_slab.size() + 1, 0);
    for (std::size_t p = 0; p < list_.size();) {
      std::size_t end = p;
      while (end < list_.size() && end < p + L && list_[end].slab == list_[p].slab &&
             list_[end].pair_mask == list_[p].pair_mask)
        ++end;
      Batch batch{};
      batch.body = list_[p].body;
      batch.count = static_cast<int>(end - p);
      const bool full = list_[p].pair_mask == full_cell;
      batch.moments = full ? -1 : num_moments_++;
      batch.pairs = num_pairs_;
      batch.pair_mask = full ? 0 : list_[p].pair_mask;
      for (int bit = 0; bit < 6; ++bit) num_pairs_ += batch.pair_mask >> bit & 1;
      ++chunk_begin_[list_[p].slab + 1];
      batches_.push_back(batch);
      first_cell_.push_back(p);
      p = end;
    }
    std::partial_sum(chunk_begin_.begin(), chunk_begin_.end(), chunk_begin_.begin());
  }

  void store_batches() {
    result_.nodes = decltype(result_.nodes)("cgcontact::band::nodes", batches_.size());
    result_.stencil_lanes = decltype(result_.stencil_lanes)("cgcontact::band::stencil_lanes", batches_.size());
    result_.moments = decltype(result_.moments)("cgcontact::band::moments", num_moments_);
    result_.pairs = decltype(result_.pairs)("cgcontact::band::pairs", num_pairs_);
    nodes_ = Kokkos::create_mirror_view(result_.nodes);
    stencil_lanes_ = Kokkos::create_mirror_view(result_.stencil_lanes);
    moments_ = Kokkos::create_mirror_view(result_.moments);
    pairs_ = Kokkos::create_mirror_view(result_.pairs);
    parallel_for("cgcontact::band::setup", batches_.size(), grain_of_heavy, [&](const std::size_t b) {
      for (int l = 0; l < L; ++l) set_nodes(b, l);
      for (int l = 0; l < batches_[b].count; ++l) {  // the moments of the other lanes stay zero
        set_stencil_lane(b, l);
        if (batches_[b].moments < 0) continue;
        set_moments(b, l);
        set_pairs(b, l);
      }
    });
    Kokkos::deep_copy(result_.nodes, nodes_);
    Kokkos::deep_copy(result_.stencil_lanes, stencil_lanes_);
    Kokkos::deep_copy(result_.moments, moments_);
    Kokkos::deep_copy(result_.pairs, pairs_);
    result_.batches = copy_to_view<decltype(result_.batches)>("cgcontact::band::batches", batches_);
    result_.chunk_begin = copy_to_view<IntView>("cgcontact::band::chunk_begin", chunk_begin_);
  }

  /// Sets those of the lane's cell; of the first one where there is none, whose forces are dropped.
  void set_nodes(std::size_t b, int l) {
    const BandCell& cell = list_[first_cell_[b] + (l < batches_[b].count ? l : 0)];
    const auto& corners = levels_[cell.body]->cell_nodes[cell.cell];
    for (int pair = 0; pair < 4; ++pair) nodes_(b, pair, l) = corners[2 * pair];
  }

  void set_stencil_lane(std::size_t b, int l) {
    const BandCell& cell = list_[first_cell_[b] + l];
    const auto& corners = levels_[cell.body]->cell_nodes[cell.cell];
    for (int a = 0; a < 8; ++a)
      if (by_stencil_[corners[a]]) {
        stencil_lanes_(b, a) |= 1 << l;
        batches_[b].stencil_any = 1;
      }
  }

  void set_moments(std::size_t b, int l) {
    const BandCell& cell = list_[first_cell_[b] + l];
    const BodyMesh& mesh = *levels_[cell.body];
    const CutCells& cc = *mesh.cut_cells;
    const double scale = moment_scale(mesh, mesh.thickness_of_level(cc.level(cell.cell)));
    double m[27];
    if (mesh.is_axisymmetric())
      ring_moments(mesh, cell.cell, m);
    else
      monomial_moments(cc.moments[cc.cut_of_active[cell.cell]], m);
    const int row = batches_[b].moments;
    for (int e = 0; e < 27; ++e) moments_(row, e, l) = static_cast<Real>(scale * m[e]);
    constexpr int diameter = band::ring_moment::diameter;
    if (mesh.is_axisymmetric()) moments_(row, diameter, l) = static_cast<Real>(m[diameter]);
  }

  void set_pairs(std::size_t b, int l) {
    const BandCell& cell = list_[first_cell_[b] + l];
    int slot = batches_[b].pairs;
    for (int bit = 0; bit < 6; ++bit) {
      if (!(batches_[b].pair_mask >> bit & 1)) continue;
      const SupportMoments& s = *supports_[cell.body].find(cell.cell);
      for (int e = 0; e < 27; ++e) pairs_(slot, e, l) = static_cast<Real>(s.value[bit][e]);
      ++slot;
    }
  }

  const ElasticSystem& system_;
  const std::vector<char>& by_stencil_;
  const SlabPartition& slabs_;
  const std::vector<const BodyMesh*> levels_;
  std::vector<SupportedCells> supports_;  ///< of each level
  std::vector<BandCell> list_;
  std::vector<Batch> batches_;
  std::vector<std::size_t> first_cell_;  ///< of each batch, in the list
  std::vector<int> chunk_begin_;
  int num_moments_ = 0, num_pairs_ = 0;  ///< of all batches
  // What kernels read, on the host.
  typename BandCells<Real>::NodeBatches::HostMirror nodes_;
  typename decltype(BandCells<Real>::stencil_lanes)::HostMirror stencil_lanes_;
  typename BandCells<Real>::MomentBatches::HostMirror moments_;
  typename BandCells<Real>::PairBatches::HostMirror pairs_;
  BandCells<Real> result_;
};

}  // namespace

template <class Real>
BandCells<Real> make_band_cells(const ElasticSystem& system, const std::vector<char>& by_stencil,
                                const SlabPartition& slabs) {
  return BandMaker<Real>(system, by_stencil, slabs).make();
}

template struct BandCells<double>;
template struct BandCells<float>;
template BandCells<double> make_band_cells(const ElasticSystem&, const std::vector<char>&, const SlabPartition&);
template BandCells<float> make_band_cells(const ElasticSystem&, const std::vector<char>&, const SlabPartition&);

}  // namespace cgcontact
