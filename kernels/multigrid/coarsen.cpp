#include "kernels/multigrid/coarsen.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace cgcontact {
namespace {

Index3 parent(const Index3& c) { return {c[0] / 2, c[1] / 2, c[2] / 2}; }

/// Lagrange polynomials of the three Gauss points.
void lagrange(double x, double value[3]) {
  const double g = Gauss3::point[2];
  value[0] = x * (x - g) / (2 * g * g);
  value[1] = 1 - x * x / (g * g);
  value[2] = x * (x + g) / (2 * g * g);
}

/// The same for d and -d.
std::array<double, 3> unsigned_direction(const Vec3& d) {
  const double sign = d[0] < 0 || (d[0] == 0 && (d[1] < 0 || (d[1] == 0 && d[2] < 0))) ? -1 : 1;
  return {sign * d[0] + 0.0, sign * d[1] + 0.0, sign * d[2] + 0.0};
}

/// Points of one cell and direction; more are merged.
constexpr int most_points = 27;

/// Points of one cell and direction become the 27 Gauss points with the same integrals of all products of shape
/// functions (some weights may be negative), so that coarse levels do not drag along all points of the finest.
void merge(std::vector<SupportTerm>& terms) {
  double weight[27] = {};
  for (const SupportTerm& t : terms) {
    double value[3][3];
    for (int d = 0; d < 3; ++d) lagrange(t.xi[d], value[d]);
    for (int q = 0; q < 27; ++q) weight[q] += t.stiffness * value[0][q / 9] * value[1][q / 3 % 3] * value[2][q % 3];
  }
  terms.resize(27);
  for (int q = 0; q < 27; ++q) {
    terms[q].xi = Vec3(Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]);
    terms[q].cell = terms[0].cell;
    terms[q].direction = terms[0].direction;
    terms[q].stiffness = weight[q];
  }
}

}  // namespace

CutCells coarse_cut_cells(const CutCells& fine) {
  CutCells coarse;
  coarse.grid = fine.grid;
  coarse.grid.cell_size *= 2;
  for (int& n : coarse.grid.num_cells) n = (n + 1) / 2;
  coarse.numbers = GridNumbers(coarse.grid.num_cells);
  for (const Index3& c : fine.cells) coarse.numbers.insert(parent(c));
  coarse.numbers.number();
  coarse.cells.reserve(coarse.numbers.size());
  coarse.numbers.each([&](const Index3& c) { coarse.cells.push_back(c); });
  coarse.cut_of_active.assign(coarse.cells.size(), -1);
  for (std::size_t e = 0; e < coarse.cells.size(); ++e) {
    bool full = true;
    for (int a = 0; a < 8 && full; ++a) {
      const Index3& c = coarse.cells[e];
      const int child = fine.find({2 * c[0] + (a & 1), 2 * c[1] + (a >> 1 & 1), 2 * c[2] + (a >> 2)});
      full = child >= 0 && fine.cut_of_active[child] < 0;
    }
    if (full) continue;
    coarse.cut_of_active[e] = static_cast<int>(coarse.active_of_cut.size());
    coarse.active_of_cut.push_back(static_cast<int>(e));
  }
  coarse.moments.resize(coarse.active_of_cut.size());
  Kokkos::parallel_for(
      "cgcontact::coarsen::moments", Kokkos::RangePolicy<Kokkos::DefaultHostExecutionSpace>(0, coarse.moments.size()),
      [&](const int cut) {
        const Index3& c = coarse.cells[coarse.active_of_cut[cut]];
        std::array<const Moments*, 8> children{};
        for (int a = 0; a < 8; ++a) {
          const int child = fine.find({2 * c[0] + (a & 1), 2 * c[1] + (a >> 1 & 1), 2 * c[2] + (a >> 2)});
          if (child < 0) continue;
          const int child_cut = fine.cut_of_active[child];
          children[a] = child_cut < 0 ? &full_cell_moments() : &fine.moments[child_cut];
        }
        coarse.moments[cut] = coarse_moments(children);
      });
  return coarse;
}

bool is_coarsest(const CutCells& cells) {
  const Index3& n = cells.grid.num_cells;
  return std::max({n[0], n[1], n[2]}) <= 2;
}

CutCells next_cut_cells(const CutCells& fine) {
  if (!is_coarsest(fine)) return coarse_cut_cells(fine);
  CutCells same;
  same.grid = fine.grid;
  same.cells = fine.cells;
  same.numbers = fine.numbers;
  same.cut_of_active = fine.cut_of_active;
  same.active_of_cut = fine.active_of_cut;
  same.moments = fine.moments;
  return same;
}

bool is_coarsened(const CutCells& fine, const CutCells& coarse) { return coarse.grid.cell_size > fine.grid.cell_size; }

std::vector<SupportTerm> coarse_supports(const CutCells& fine, const CutCells& coarse,
                                         const std::vector<SupportTerm>& terms) {
  if (!is_coarsened(fine, coarse)) return terms;
  std::vector<SupportTerm> moved = terms;
  std::vector<int> begin(coarse.cells.size() + 1, 0);
  for (SupportTerm& t : moved) {
    const Index3& c = fine.cells[t.cell];
    for (int d = 0; d < 3; ++d) t.xi[d] = 0.5 * (t.xi[d] + 2 * (c[d] % 2) - 1);
    t.cell = coarse.find(parent(c));
    t.stiffness *= 0.5;
    ++begin[t.cell + 1];
  }
  for (std::size_t e = 1; e < begin.size(); ++e) begin[e] += begin[e - 1];
  std::vector<int> order(moved.size()), position(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < moved.size(); ++t) order[position[moved[t].cell]++] = static_cast<int>(t);
  // What is merged comes last; the others keep their order.
  std::vector<SupportTerm> merged, same;
  std::vector<char> taken(moved.size(), 0);
  for (std::size_t e = 0; e + 1 < begin.size(); ++e) {
    if (begin[e + 1] - begin[e] <= most_points) continue;
    const auto first = order.begin() + begin[e], last = order.begin() + begin[e + 1];
    const auto axis = [&](int t) { return unsigned_direction(moved[t].direction); };
    std::stable_sort(first, last, [&](int a, int b) { return axis(a) < axis(b); });
    for (auto from = first, to = first; from != last; from = to) {
      while (to != last && axis(*to) == axis(*from)) ++to;
      if (to - from <= most_points) continue;
      same.clear();
      for (auto t = from; t != to; ++t) {
        taken[*t] = 1;
        same.push_back(moved[*t]);
      }
      merge(same);
      merged.insert(merged.end(), same.begin(), same.end());
    }
  }
  std::vector<SupportTerm> result;
  for (std::size_t t = 0; t < moved.size(); ++t)
    if (!taken[t]) result.push_back(moved[t]);
  result.insert(result.end(), merged.begin(), merged.end());
  return result;
}

Transfer make_transfer(const ElasticSystem& fine, const ElasticSystem& coarse) {
  Transfer transfer;
  transfer.parents = decltype(transfer.parents)("cgcontact::coarsen::parents", fine.num_nodes);
  transfer.children = decltype(transfer.children)("cgcontact::coarsen::children", coarse.num_nodes);
  auto parents = Kokkos::create_mirror_view(transfer.parents);
  auto children = Kokkos::create_mirror_view(transfer.children);
  for (std::size_t b = 0; b < fine.meshes.size(); ++b) {
    const BodyMesh &f = fine.meshes[b], &c = coarse.meshes[b];
    if (!is_coarsened(*f.cut_cells, *c.cut_cells)) {
      for (int n = 0; n < f.num_nodes; ++n) {
        for (int a = 0; a < 8; ++a) parents(f.first_node + n, a) = c.first_node + n;
        for (int a = 0; a < 27; ++a) children(c.first_node + n, a) = a == 13 ? f.first_node + n : -1;
      }
      continue;
    }
    Kokkos::parallel_for("cgcontact::coarsen::parents",
                         Kokkos::RangePolicy<Kokkos::DefaultHostExecutionSpace>(0, f.num_nodes), [&](const int n) {
                           const Index3& x = f.nodes[n];
                           const int along = x[0] % 2;  // parents along x follow each other, or are one
                           for (int a = 0; a < 8; a += 2) {
                             const Index3 p{x[0] / 2, (x[1] + (a >> 1 & 1)) / 2, (x[2] + (a >> 2)) / 2};
                             parents(f.first_node + n, a) = c.find_node(p);
                             parents(f.first_node + n, a + 1) = parents(f.first_node + n, a) + along;
                           }
                         });
    Kokkos::parallel_for(
        "cgcontact::coarsen::children", Kokkos::RangePolicy<Kokkos::DefaultHostExecutionSpace>(0, c.num_nodes),
        [&](const int n) {
          const Index3& x = c.nodes[n];
          for (int row = 0; row < 9; ++row) {
            int numbers[3];
            f.node_numbers.find_row({2 * x[0] - 1, 2 * x[1] + row / 3 - 1, 2 * x[2] + row % 3 - 1}, 3, numbers);
            for (int i = 0; i < 3; ++i)
              children(c.first_node + n, 9 * i + row) = numbers[i] < 0 ? -1 : f.first_node + numbers[i];
          }
        });
  }
  Kokkos::deep_copy(transfer.parents, parents);
  Kokkos::deep_copy(transfer.children, children);
  return transfer;
}

CoarseRows coarse_rows(const ElasticSystem& fine, const ElasticSystem& coarse, const Transfer& transfer,
                       const std::vector<GroupRow>& rows, const std::vector<double>& stiffness,
                       const std::vector<double>& full_stiffness) {
  CoarseRows result;
  auto parents = Kokkos::create_mirror_view(transfer.parents);
  Kokkos::deep_copy(parents, transfer.parents);
  // Members of one coarse row: same body, coarse cell and family, in order of first appearance.
  std::map<std::tuple<int, int, int>, int> index;
  std::vector<std::vector<int>> members;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const CutCells &from = *fine.meshes[rows[r].body].cut_cells, &to = *coarse.meshes[rows[r].body].cut_cells;
    const bool larger = is_coarsened(from, to);
    const int cell = larger ? to.find(parent(from.cells[rows[r].cell])) : rows[r].cell;
    const double factor = larger ? 0.5 : 1.0;
    const auto [entry, is_new] =
        index.emplace(std::make_tuple(rows[r].body, cell, rows[r].family), static_cast<int>(members.size()));
    if (is_new) {
      members.emplace_back();
      result.rows.push_back({{}, rows[r].body, cell, rows[r].family});
      result.stiffness.push_back(0);
      result.full_stiffness.push_back(0);
    }
    members[entry->second].push_back(static_cast<int>(r));
    result.stiffness[entry->second] += factor * stiffness[r];
    result.full_stiffness[entry->second] += factor * full_stiffness[r];
  }
  std::vector<std::pair<int, double>> entries;
  for (std::size_t c = 0; c < members.size(); ++c) {
    const bool closed = result.stiffness[c] > 0;
    double sum = 0;
    for (int r : members[c]) sum += closed ? stiffness[r] : full_stiffness[r];
    entries.clear();
    for (int r : members[c]) {
      const double weight = (closed ? stiffness[r] : full_stiffness[r]) / sum;
      if (weight == 0) continue;
      for (const auto& [dof, value] : rows[r].entries)
        for (int a = 0; a < 8; ++a)
          entries.emplace_back(dof_of(parents(node_of_dof(dof), a), component_of_dof(dof)), 0.125 * weight * value);
    }
    std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [dof, value] : entries) {
      auto& merged = result.rows[c].entries;
      if (!merged.empty() && merged.back().first == dof)
        merged.back().second += value;
      else
        merged.emplace_back(dof, value);
    }
  }
  return result;
}

}  // namespace cgcontact
