#include "kernels/operator/stencil_tiles.hpp"

#include <algorithm>

#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {
namespace {

/// Divides a range into chunks of about equal size, at most `largest` each.
std::vector<std::array<int, 2>> chunks(int begin, int end, int largest) {
  std::vector<std::array<int, 2>> result;
  const int n = (end - begin + largest - 1) / largest;
  for (int p = 0; p < n; ++p)
    result.push_back({begin + static_cast<int>((end - begin) * static_cast<long long>(p) / n),
                      begin + static_cast<int>((end - begin) * static_cast<long long>(p + 1) / n)});
  return result;
}

struct Records {
  std::vector<int> tile_plane, tile_body, copy_begin, run_begin;
  std::vector<std::array<int, 3>> copies;
  std::vector<std::array<int, 4>> runs;
};

/// Tiles of one body. Every node next to a stencil node is active, so consecutive grid nodes have consecutive numbers.
template <class Real>
class TileMaker {
 public:
  TileMaker(const BodyMesh& mesh, const std::vector<char>& by_stencil, Records& out)
      : mesh_(mesh), grid_(mesh.cut_cells->grid), by_stencil_(by_stencil), out_(out) {}

  void run(int body) {
    // Long tiles read fewer planes twice; short ones keep several threads busy on a small body.
    const int columns = static_cast<int>(chunks(1, grid_.num_cells[1], StencilRing<Real>::rows).size() *
                                         chunks(1, grid_.num_cells[0], StencilRing<Real>::block).size());
    const int planes =
        static_cast<int>(std::clamp(static_cast<long long>(grid_.num_cells[2]) * columns / 48, 8LL, 32LL));
    const auto x = chunks(1, grid_.num_cells[0], StencilRing<Real>::block),
               y = chunks(1, grid_.num_cells[1], StencilRing<Real>::rows), z = chunks(1, grid_.num_cells[2], planes);
    for (const auto& [k, j, i] : tiles_with_nodes(x, y, z)) add(body, x[i], y[j], z[k]);
  }

 private:
  using Chunks = std::vector<std::array<int, 2>>;

  /// Returns the chunk that an index lies in, -1: none.
  static int chunk_of(const Chunks& chunks, int index) {
    if (chunks.empty() || index < chunks.front()[0] || index >= chunks.back()[1]) return -1;
    const auto after = std::upper_bound(chunks.begin(), chunks.end(), index,
                                        [](int p, const std::array<int, 2>& chunk) { return p < chunk[0]; });
    return static_cast<int>(after - chunks.begin()) - 1;
  }

  /// Returns (z, y, x) of the chunks with nodes in them, ascending: most of a grid may be empty.
  std::vector<Index3> tiles_with_nodes(const Chunks& x, const Chunks& y, const Chunks& z) const {
    std::vector<Index3> tiles;
    mesh_.node_numbers.each_word([&](const Index3& first, std::uint64_t bits, int) {
      const int j = chunk_of(y, first[1]), k = chunk_of(z, first[2]);
      if (j < 0 || k < 0) return;
      for (int i = 0; i < static_cast<int>(x.size()); ++i) {
        const int begin = std::max(x[i][0] - first[0], 0), end = std::min(x[i][1] - first[0], 64);
        if (begin < end && bits >> begin << begin << (64 - end) != 0 &&
            (tiles.empty() || tiles.back() != Index3{k, j, i}))
          tiles.push_back({k, j, i});
      }
    });
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    return tiles;
  }

  void add(int body, const std::array<int, 2>& x, const std::array<int, 2>& y, const std::array<int, 2>& z) {
    using Ring = StencilRing<Real>;
    const int nx = x[1] - x[0], ny = y[1] - y[0];
    const std::size_t num_runs = out_.runs.size();
    // need[plane][row slot][position]: read by a run of one of the three planes around it; made with the first run.
    std::vector<char> need;
    auto mark = [&](int plane, int row) {
      return &need[(static_cast<std::size_t>(plane) * (ny + 2) + row) * (nx + 2)];
    };
    std::vector<int> run_begin;
    for (int k = z[0] - 1; k <= z[1]; ++k) {
      run_begin.push_back(static_cast<int>(out_.runs.size()));
      if (k < z[0] || k == z[1]) continue;
      for (int j = y[0]; j < y[1]; ++j) {
        mesh_.node_numbers.find_row({x[0], j, k}, nx, numbers_.data());
        const auto stencil = [&](int p) { return numbers_[p] >= 0 && by_stencil_[mesh_.first_node + numbers_[p]]; };
        for (int p = 0; p < nx; ++p) {
          if (!stencil(p)) continue;
          const int start = p;
          while (p < nx && stencil(p)) ++p;
          out_.runs.push_back({mesh_.first_node + numbers_[start], j - y[0] + 1, start + 1, p - start});
          if (need.empty()) need.assign((z[1] - z[0] + 2) * static_cast<std::size_t>(ny + 2) * (nx + 2), 0);
          for (int dz = 0; dz < 3; ++dz)
            for (int dy = 0; dy < 3; ++dy) {
              char* row = mark(k - z[0] + dz, j - y[0] + dy);
              std::fill(row + start, row + p + 2, 1);
            }
        }
      }
    }
    if (out_.runs.size() == num_runs) return;
    for (int k = z[0] - 1; k <= z[1]; ++k) {
      out_.copy_begin.push_back(static_cast<int>(out_.copies.size()));
      for (int j = y[0] - 1; j <= y[1]; ++j) {
        const char* row = mark(k - z[0] + 1, j - y[0] + 1);
        for (int p = 0; p < nx + 2; ++p) {
          if (!row[p]) continue;
          const int start = p;
          while (p < nx + 2 && row[p]) ++p;
          out_.copies.push_back(
              {mesh_.find_node({x[0] - 1 + start, j, k}), (j - y[0] + 1) * Ring::row_stride + start, p - start});
        }
      }
    }
    out_.copy_begin.push_back(static_cast<int>(out_.copies.size()));
    out_.run_begin.insert(out_.run_begin.end(), run_begin.begin(), run_begin.end());
    out_.run_begin.push_back(static_cast<int>(out_.runs.size()));
    out_.tile_plane.push_back(static_cast<int>(out_.run_begin.size()));
    out_.tile_body.push_back(body);
  }

  const BodyMesh& mesh_;
  const Grid& grid_;
  const std::vector<char>& by_stencil_;
  std::array<int, StencilRing<Real>::block> numbers_;  ///< of the row in work
  Records& out_;
};

}  // namespace

template <class Real>
StencilCoefficients<Real>::StencilCoefficients(const BodyMesh& mesh, double sign) {
  const double scale = sign * mesh.modulus * mesh.thickness_of_level(0);
  const double mu = mesh.law.mu, lambda = mesh.law.lambda_at_points(), mean = mesh.law.lambda_of_mean;
  const double across = lambda + 2 * mu, mixed = lambda + mu;
  // S along c times A along both others at a node that is or is not beside the middle one in x, y, z.
  const auto of_mean = [mean](int c, const std::array<bool, 3>& beside) {
    double product = mean;
    for (int k = 0; k < 3; ++k) product *= k == c ? (beside[k] ? -1 : 2) : (beside[k] ? 0.25 : 0.5);
    return product;
  };
  for (int c = 0; c < 3; ++c) {
    const double a = c == 0 ? across : mu;                            // of Sx My Mz
    const double b = c == 1 ? across : mu, d = c == 2 ? across : mu;  // of Mx Sy Mz, Mx My Sz
    const double mass[4] = {1. / 36, 4. / 36, 4. / 36, 16. / 36};
    const double stiff[4] = {-(b + d) / 6, (-4 * b + 2 * d) / 6, (2 * b - 4 * d) / 6, 8 * (b + d) / 6};
    for (int e = 0; e < 4; ++e) {
      outer[c][e] = static_cast<Real>(scale * (stiff[e] / 6 - a * mass[e] + of_mean(c, {1, e < 2, e % 2 == 0})));
      inner[c][e] =
          static_cast<Real>(scale * (4 * stiff[e] / 6 + 2 * a * mass[e] + of_mean(c, {0, e < 2, e % 2 == 0})));
    }
  }
  const double corner = scale * mixed / 24 + scale * mean / 16, edge = scale * mixed / 6 + scale * mean / 8;
  cross_outer = static_cast<Real>(-corner);
  cross_inner = static_cast<Real>(-edge);
  cross_x = static_cast<Real>(corner);
  cross_edge = static_cast<Real>(edge / corner);
}

template <class Real>
double StencilCoefficients<Real>::diagonal(const BodyMesh& mesh) {
  return StencilCoefficients<double>(mesh, 1).inner[0][3];
}

template <class Real>
std::size_t StencilTiles<Real>::bytes() const {
  return sizeof(int) *
         (tile_plane.size() + tile_body.size() + copy_begin.size() + run_begin.size() + copies.size() + runs.size());
}

template <class Real>
StencilTiles<Real> make_stencil_tiles(const std::vector<const BodyMesh*>& level_meshes,
                                      const std::vector<char>& by_stencil) {
  Records records;
  records.tile_plane.push_back(0);
  std::vector<StencilCoefficients<Real>> plus, minus;
  for (std::size_t b = 0; b < level_meshes.size(); ++b) {
    TileMaker<Real>(*level_meshes[b], by_stencil, records).run(static_cast<int>(b));
    plus.emplace_back(*level_meshes[b], 1.0);
    minus.emplace_back(*level_meshes[b], -1.0);
  }
  StencilTiles<Real> tiles;
  for (const auto& run : records.runs) tiles.num_nodes += run[3];
  tiles.tile_plane = copy_to_view<IntView>("cgcontact::stencil::tile_plane", records.tile_plane);
  tiles.tile_body = copy_to_view<IntView>("cgcontact::stencil::tile_body", records.tile_body);
  tiles.copy_begin = copy_to_view<IntView>("cgcontact::stencil::copy_begin", records.copy_begin);
  tiles.run_begin = copy_to_view<IntView>("cgcontact::stencil::run_begin", records.run_begin);
  tiles.copies = copy_rows_to_view<typename StencilTiles<Real>::Copies>("cgcontact::stencil::copies", records.copies);
  tiles.runs = copy_rows_to_view<typename StencilTiles<Real>::Runs>("cgcontact::stencil::runs", records.runs);
  using Coefficients = Kokkos::View<StencilCoefficients<Real>*, MemSpace>;
  tiles.plus = copy_to_view<Coefficients>("cgcontact::stencil::plus", plus);
  tiles.minus = copy_to_view<Coefficients>("cgcontact::stencil::minus", minus);
  return tiles;
}

template struct StencilCoefficients<double>;
template struct StencilCoefficients<float>;
template struct StencilTiles<double>;
template struct StencilTiles<float>;
template StencilTiles<double> make_stencil_tiles(const std::vector<const BodyMesh*>&, const std::vector<char>&);
template StencilTiles<float> make_stencil_tiles(const std::vector<const BodyMesh*>&, const std::vector<char>&);

}  // namespace cgcontact
