#include "kernels/multigrid/find_soft_cells.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/multigrid/coarsen.hpp"

namespace cgcontact {
namespace {

/// Is one of the cells that share a face with this one not thin? A knife edge ends in thin cells, but does not bend as
/// a plate does.
bool beside_thick_one(const CutCells& cells, std::size_t e, const std::vector<char>& is_thin) {
  for (int face = 0; face < 6; ++face) {
    Index3 c = cells.cells[e];
    c[face / 2] += face % 2 == 0 ? -1 : 1;
    const int other = cells.find(c);
    if (other >= 0 && !is_thin[other]) return true;
  }
  return false;
}

}  // namespace

template <class Real>
SoftCells make_soft_cells(const ElasticSystem& system, const NodeColumns<Real>& columns, const ElasticSystem* finer,
                          const SoftCells* of_finer) {
  constexpr double thin = 0.75;       // cells
  constexpr double sliver = 1e-5;     // cells: thinner than any plate on its coarsest level
  constexpr double free_part = 0.25;  // of the thin cells: held ones do not bend
  constexpr int most_halvings = 6;
  SoftCells soft;
  std::vector<char> counted(columns.num_columns(), 0);
  for (std::size_t b = 0; b < system.meshes.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const CutCells& cc = *mesh.cut_cells;
    std::vector<signed char> axis(cc.cells.size(), -1);
    std::vector<int> all_thin;
    std::vector<char> is_thin(cc.cells.size(), 1);
    if (finer) {
      const CutCells& from = *finer->meshes[b].cut_cells;
      const int factor = is_coarsened(from, cc) ? 2 : 1;
      for (std::size_t e = 0; e < from.cells.size(); ++e) {
        const Index3& c = from.cells[e];
        if (!of_finer->thin[b][e]) is_thin[cc.find({c[0] / factor, c[1] / factor, c[2] / factor})] = 0;
      }
    }
    std::vector<char> supported(cc.cells.size(), 0);
    for (const SupportTerm& t : system.supports[b]) supported[t.cell] = 1;
    double volume = 0;  // cells
    int lines = 0, soft_cells = 0;
    for (std::size_t e = 0; e < cc.cells.size(); ++e) {
      const auto& nodes = mesh.cell_nodes[e];
      const int first = columns.column_of_node(nodes[0]);
      const int d = first < 0 ? -1 : columns.columns(first).axis;
      is_thin[e] &= std::all_of(nodes.begin(), nodes.end(), [&](const int n) {
        const int c = columns.column_of_node(n);
        return c >= 0 && columns.columns(c).axis == d;
      });
    }
    for (std::size_t e = 0; e < cc.cells.size(); ++e) {
      if (!is_thin[e] || cc.volume_fraction(static_cast<int>(e)) < sliver || beside_thick_one(cc, e, is_thin)) continue;
      const int first = columns.column_of_node(mesh.cell_nodes[e][0]);
      const int d = columns.columns(first).axis;
      all_thin.push_back(static_cast<int>(e));
      volume += cc.volume_fraction(static_cast<int>(e));
      lines += !counted[first];  // cells across the body have their first corner in the same column
      counted[first] = 1;
      if (supported[e] || cc.cut_of_active[e] < 0) continue;
      ++soft_cells;
      axis[e] = static_cast<signed char>(d);
    }
    const double thickness = lines > 0 ? volume / lines : 1;
    if (thickness < thin && soft_cells >= free_part * static_cast<double>(all_thin.size()))
      soft.halvings =
          std::max(soft.halvings, std::min(most_halvings, static_cast<int>(std::lround(-std::log2(thickness)))));
    else
      std::fill(axis.begin(), axis.end(), static_cast<signed char>(-1));
    std::vector<double> full_volume;
    if (thickness < thin) {
      full_volume.assign(cc.cells.size(), 1.0);
      for (const int e : all_thin) full_volume[e] = thickness;
    }
    soft.thin.push_back(std::move(is_thin));
    soft.full_volume.push_back(std::move(full_volume));
    soft.axis.push_back(std::move(axis));
  }
  return soft;
}

template SoftCells make_soft_cells(const ElasticSystem&, const NodeColumns<float>&, const ElasticSystem*,
                                   const SoftCells*);
template SoftCells make_soft_cells(const ElasticSystem&, const NodeColumns<double>&, const ElasticSystem*,
                                   const SoftCells*);

}  // namespace cgcontact
