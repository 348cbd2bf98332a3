#include "contact/pressure_estimate.hpp"

#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "core/parallel.hpp"

namespace cgcontact {
namespace {

/// Width of the Gaussian of the local mean, cells of the coarser body of the pair; beyond three widths nothing counts.
constexpr double mean_width = 1, mean_reach = 3;

/// Uncertainty of the place of an edge, cells of the coarser body. Calibrated: over 50 runs with an
/// edge (paper's scene in 2D and 3D, Hertz, several sizes and offsets) the ratio of estimated and true error then has a
/// geometric mean of 1.05.
constexpr double edge_shift = 0.05;

/// The mean of transmitted less recovered pressure around a place. The rows of a cell count as one, at their centroid.
class LocalMean {
 public:
  /// width: m.
  LocalMean(const std::vector<ContactRow>& rows, int pair, double width) : width_(width) {
    std::map<std::tuple<int, int>, Source> cells;
    for (const ContactRow& r : rows) {
      if (r.pair != pair || !std::isfinite(r.pressure_transmitted)) continue;
      Source& s = cells[{r.body, r.cell}];
      s.area += r.weight;
      s.centroid += r.weight * r.x;
      s.force += r.weight * (r.pressure_transmitted - r.pressure_sprc);
    }
    for (auto& [cell, s] : cells) {
      s.centroid /= s.area;
      buckets_[bucket(s.centroid)].push_back(s);
    }
  }

  /// Pa.
  double at(const Vec3& x) const {
    double sum = 0, total = 0;
    const Bucket centre = bucket(x);
    for (int n = 0; n < 27; ++n) {
      const auto found = buckets_.find({centre[0] + n % 3 - 1, centre[1] + n / 3 % 3 - 1, centre[2] + n / 9 - 1});
      if (found == buckets_.end()) continue;
      for (const Source& s : found->second) {
        const double weight = std::exp(-0.5 * (s.centroid - x).squaredNorm() / (width_ * width_));
        sum += weight * s.force;
        total += weight * s.area;
      }
    }
    return total > 0 ? sum / total : 0;
  }

 private:
  struct Source {
    double area = 0, force = 0;
    Vec3 centroid = Vec3::Zero();
  };
  using Bucket = std::array<long long, 3>;
  Bucket bucket(const Vec3& x) const {
    Bucket key;
    for (int d = 0; d < 3; ++d) key[d] = static_cast<long long>(std::floor(x[d] / (mean_reach * width_)));
    return key;
  }

  double width_;
  std::map<Bucket, std::vector<Source>> buckets_;
};

/// What moving the edge by `shift` (m) outwards does to the terms around a row, Pa.
double edge_change(const Simulation& sim, const ContactRow& row, double shift) {
  const RecoveredField& field = sim.sprc[row.body];
  if (!field.edge) return 0;
  const BodyMesh& mesh = sim.system.meshes[row.body];
  const CutCells& cc = sim.bodies[row.body].cut_cells;
  const Vec3 position = cc.grid.to_grid(row.x), xi = cell_coordinates(cc, row.cell, position);
  double N[8], change = 0;
  hex_shape(xi.data(), N);
  for (int a = 0; a < 8; ++a) {
    const EdgeTerms::Term* term = field.edge->of_node(mesh.cell_nodes[row.cell][a] - mesh.first_node);
    if (!term) continue;
    const double s = term->edge.inside(position), moved = s + shift / cc.grid.cell_size * term->edge.scale;
    change += N[a] * std::abs(term->factor) * (std::sqrt(std::max(moved, 0.0)) - std::sqrt(std::max(s, 0.0)));
  }
  return change * sim.scales.stress;
}

}  // namespace

void estimate_contact_errors(const Simulation& sim, Results& results) {
  std::vector<ContactRow>& rows = results.contact_rows;
  for (std::size_t p = 0; p < sim.pairs.size(); ++p) {
    const ContactPair& pair = sim.pairs[p];
    const double h = sim.bodies[pair.primary].cut_cells.grid.cell_size;  // the coarser body
    const LocalMean mean(rows, static_cast<int>(p), mean_width * h);
    parallel_for(rows.size(), 128, [&](std::size_t i) {
      ContactRow& row = rows[i];
      if (row.pair != static_cast<int>(p)) return;
      const double jump = std::isfinite(row.pressure_opposite) ? row.pressure_opposite - row.pressure_sprc : 0;
      row.pressure_error = std::hypot(jump / 2, mean.at(row.x), edge_change(sim, row, edge_shift * h));
    });
    double error = 0, norm = 0;
    for (const ContactRow& row : rows) {
      if (row.pair != static_cast<int>(p)) continue;
      error += row.weight * row.pressure_error * row.pressure_error;
      norm += row.weight * row.pressure_sprc * row.pressure_sprc;
    }
    PairFigures& figures = results.pairs[p];
    figures.pressure_error_estimate = norm > 0 ? std::sqrt(error / norm) : 0;
    figures.force_error_estimate = std::pow(results.estimated_error_relative, 2);
  }
}

}  // namespace cgcontact
