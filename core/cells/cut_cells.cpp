#include "core/cells/cut_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.hpp"
#include "core/base/parallel.hpp"
#include "core/cells/cell_sweep.hpp"

namespace cgcontact {

namespace {

/// A cell that a surface may cross.
struct Candidate : CellIntegrals {
  bool pruned = false;
};

/// Mean position and normal of the points of one surface in a cell.
struct PieceMean {
  int surface;
  double area = 0;
  Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
};

void append_points(const BoundaryPoints& from, int surface, int owner, BoundaryPoints& to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    if (surface < 0 || from.surface[i] == surface) to.append(from, i, owner);
}

std::vector<PieceMean> piece_means(const BoundaryPoints& points) {
  std::vector<PieceMean> means;
  for (std::size_t i = 0; i < points.size(); ++i) {
    auto mean = std::find_if(means.begin(), means.end(), [&](const auto& m) { return m.surface == points.surface[i]; });
    if (mean == means.end()) {
      means.push_back({points.surface[i]});
      mean = means.end() - 1;
    }
    mean->area += points.weight[i];
    mean->position += points.weight[i] * points.position[i];
    mean->normal += points.weight[i] * points.normal[i];
  }
  for (PieceMean& m : means) {
    m.position /= m.area;
    m.normal /= m.area;
  }
  return means;
}

double distance_to_cell(const Vec3& x, const Index3& cell) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = std::max({0.0, cell[k] - x[k], x[k] - cell[k] - 1});
    sum += d * d;
  }
  return std::sqrt(sum);
}

class CutCellBuilder {
 public:
  CutCellBuilder(const Solid& solid, const Grid& grid, const std::vector<Plane>& face_dividers,
                 const GeometryOptions& options)
      : options_(options) {
    result_.solid = solid;
    result_.face_dividers = face_dividers;
    result_.grid = grid;
  }

  CutCells run() {
    integrate();
    number_cells();
    if (result_.cells.empty()) throw InputError("the body is empty");
    adopt_pruned();
    collect();
    return std::move(result_);
  }

 private:
  /// What one part of the sweep finds.
  struct Found {
    std::vector<Candidate> cut;
    std::vector<std::pair<Index3, int>> inside;  ///< first cell, number of cells along x
  };

  void integrate() {
    const auto sweep =
        result_.solid.geometry().sweep_cells(result_.grid, result_.face_dividers, options_.boundary_order);
    result_.numbers = sweep->take_inside();
    std::vector<Found> found(sweep->num_parts());
    parallel_for("cgcontact::cut_cells::integrate", found.size(), 1, [&](std::size_t part) {
      SweptCells swept;
      sweep->sweep(part, swept);
      for (CellIntegrals& cell : swept.crossed) keep(std::move(cell), found[part]);
      for (const auto& [first, number] : swept.inside) set_inside(first, number, found[part]);
    });
    collect_found(found);
  }

  void collect_found(std::vector<Found>& found) {
    std::size_t total = 0;
    for (const Found& part : found) total += part.cut.size();
    candidates_.reserve(total);
    for (Found& part : found) {
      for (const auto& [first, number] : part.inside) result_.numbers.insert_row(first, number);
      std::move(part.cut.begin(), part.cut.end(), std::back_inserter(candidates_));
      part = {};
    }
  }

  /// Adds the cell to what is cut or inside unless it turns out to be empty.
  void keep(CellIntegrals&& integrals, Found& found) {
    Candidate candidate{std::move(integrals)};
    candidate.pruned = candidate.moments[0] < 8 * options_.prune_fraction;
    if (!candidate.pruned) {
      if (!in_grid(candidate.cell)) throw InputError("the body sticks out of its grid");
      double difference = 0;
      for (int q = 0; q < num_moments; ++q)
        difference = std::max(difference, std::abs(candidate.moments[q] - full_cell_moments()[q]));
      const bool full = difference < 8 * options_.full_tolerance;
      if (full) candidate.moments = full_cell_moments();
      if (full && candidate.points.size() == 0) return set_inside(candidate.cell, 1, found);
    } else if (candidate.points.size() == 0) {
      return;
    }
    found.cut.push_back(std::move(candidate));
  }

  bool in_grid(const Index3& c) const {
    for (int k = 0; k < 3; ++k)
      if (c[k] < 0 || c[k] >= result_.grid.num_cells[k]) return false;
    return true;
  }

  void set_inside(const Index3& first, int number, Found& found) const {
    if (!in_grid(first) || first[0] + number > result_.grid.num_cells[0])
      throw InputError("the body sticks out of its grid");
    found.inside.emplace_back(first, number);
  }

  void number_cells() {
    for (const Candidate& candidate : candidates_)
      if (!candidate.pruned) result_.numbers.insert(candidate.cell);
    result_.numbers.number();
    result_.cells.reserve(result_.numbers.size());
    result_.numbers.each([&](const Index3& cell) { result_.cells.push_back(cell); });
    candidate_of_active_.assign(result_.cells.size(), -1);
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (!candidates_[c].pruned) candidate_of_active_[result_.find(candidates_[c].cell)] = static_cast<int>(c);
  }

  double fraction(int active) const {
    const int candidate = candidate_of_active_[active];
    return candidate < 0 ? 1.0 : candidates_[candidate].moments[0] / 8;
  }

  /// Active cell near `cell` that takes a piece: the one nearest to a place just inside the body, then the fullest.
  int find_owner(const Index3& cell, const PieceMean& piece) const {
    const Vec3 inside = piece.position - 1e-3 * piece.normal;
    int best = -1;
    double best_distance = std::numeric_limits<double>::max();
    for (int reach = 1; reach <= 2 && best < 0; ++reach)
      for (int n = 0; n < 125; ++n) {
        const Index3 other{cell[0] + n % 5 - 2, cell[1] + n / 5 % 5 - 2, cell[2] + n / 25 - 2};
        if (std::max({std::abs(n % 5 - 2), std::abs(n / 5 % 5 - 2), std::abs(n / 25 - 2)}) > reach) continue;
        const int active = result_.find(other);
        if (active < 0) continue;
        const double distance = distance_to_cell(inside, other);
        const bool tie = std::abs(distance - best_distance) < 1e-9;
        if (tie ? fraction(active) <= fraction(best) : distance > best_distance) continue;
        best = active;
        best_distance = distance;
      }
    return best;
  }

  void adopt_pruned() {
    for (const Candidate& candidate : candidates_) {
      if (!candidate.pruned) continue;
      ++result_.num_pruned;
      int heir = -1;
      double largest = 0;
      for (const PieceMean& piece : piece_means(candidate.points)) {
        const int owner = find_owner(candidate.cell, piece);
        if (owner < 0) continue;
        result_.adoptions.push_back({owner, candidate.cell, piece.surface});
        donors_.push_back(static_cast<int>(&candidate - candidates_.data()));
        if (piece.area > largest) heir = owner;
        largest = std::max(largest, piece.area);
      }
      if (heir >= 0 && candidate.moments[0] > 0) pass_moments(candidate, heir);
    }
    std::vector<int> order(donors_.size()), donors = donors_;
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    auto adoptions = result_.adoptions;
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return adoptions[a].active < adoptions[b].active; });
    for (std::size_t i = 0; i < order.size(); ++i) {
      result_.adoptions[i] = adoptions[order[i]];
      donors_[i] = donors[order[i]];
    }
  }

  /// The volume below the threshold goes to the cell that takes the largest piece.
  void pass_moments(const Candidate& candidate, int heir) {
    const Index3& to = result_.cells[heir];
    const Index3 offset{candidate.cell[0] - to[0], candidate.cell[1] - to[1], candidate.cell[2] - to[2]};
    extra_.push_back({heir, {}});
    Moments& extra = extra_.back().second;
    if (std::abs(offset[0]) + std::abs(offset[1]) + std::abs(offset[2]) == 1) {
      extra = shifted_moments(candidate.moments, offset);
      return;
    }
    // farther away the change of coordinates amplifies rounding: concentrate the volume at one point
    const PieceMean mean = piece_means(candidate.points)[0];
    double l[3][moment_degree + 1];
    for (int k = 0; k < 3; ++k) legendre_values(2 * (mean.position[k] - to[k]) - 1, l[k]);
    add_product(extra, candidate.moments[0], l[0], l[1], l[2]);
  }

  void collect() {
    const int num_active = static_cast<int>(result_.cells.size());
    std::vector<char> is_cut(num_active, 0);
    for (int a = 0; a < num_active; ++a) is_cut[a] = candidate_of_active_[a] >= 0;
    for (const Adoption& adoption : result_.adoptions) is_cut[adoption.active] = 1;
    result_.cut_of_active.assign(num_active, -1);
    const std::size_t num_cut = std::count(is_cut.begin(), is_cut.end(), char{1});
    result_.active_of_cut.reserve(num_cut);
    result_.moments.reserve(num_cut);
    std::size_t num_points = 0, adopted = 0;
    for (const Candidate& candidate : candidates_) num_points += candidate.points.size();
    result_.boundary.reserve(num_points);
    for (int a = 0; a < num_active; ++a) {
      if (!is_cut[a]) continue;
      const int candidate = candidate_of_active_[a];
      result_.cut_of_active[a] = static_cast<int>(result_.moments.size());
      result_.active_of_cut.push_back(a);
      result_.moments.push_back(candidate >= 0 ? candidates_[candidate].moments : full_cell_moments());
      if (candidate >= 0) {
        append_points(candidates_[candidate].points, -1, a, result_.boundary);
        candidates_[candidate].points = {};
      }
      for (; adopted < donors_.size() && result_.adoptions[adopted].active == a; ++adopted)
        append_points(candidates_[donors_[adopted]].points, result_.adoptions[adopted].surface, a, result_.boundary);
    }
    for (const auto& [heir, extra] : extra_)
      for (int q = 0; q < num_moments; ++q) result_.moments[result_.cut_of_active[heir]][q] += extra[q];
  }

  const GeometryOptions options_;
  CutCells result_;
  std::vector<Candidate> candidates_;
  std::vector<int> candidate_of_active_;
  std::vector<int> donors_;  ///< candidate of every adoption
  std::vector<std::pair<int, Moments>> extra_;
};

}  // namespace

int CutCells::locate(const Vec3& x) const {
  const Index3 cell{static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                    static_cast<int>(std::floor(x[2]))};
  int best = find(cell);
  if (best >= 0) return best;
  double best_distance = 1;
  for (int n = 0; n < 27; ++n) {
    const Index3 other{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
    const int active = find(other);
    if (active < 0) continue;
    const double distance = distance_to_cell(x, other);
    if (distance > best_distance || (distance == best_distance && best >= 0)) continue;
    best = active;
    best_distance = distance;
  }
  return best;
}

Vec3 cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& x) {
  const Index3& c = cut_cells.cells[active_cell];
  return 2 * (x - Vec3(c[0], c[1], c[2])) - Vec3::Ones();
}

Vec3 grid_position(const CutCells& cut_cells, int active_cell, const Vec3& xi) {
  const Index3& c = cut_cells.cells[active_cell];
  return Vec3(c[0], c[1], c[2]) + 0.5 * (xi + Vec3::Ones());
}

Vec3 global_position(const CutCells& cut_cells, int active_cell, const Vec3& xi) {
  return cut_cells.grid.to_global(grid_position(cut_cells, active_cell, xi));
}

CutCells make_cut_cells(const Solid& solid_in_grid_coordinates, const Grid& grid,
                        const std::vector<Plane>& face_dividers, const GeometryOptions& options) {
  for (int k = 0; k < 3; ++k)
    if (grid.num_cells[k] < 1) throw InputError("the grid has no cells");
  return CutCellBuilder(solid_in_grid_coordinates, grid, face_dividers, options).run();
}

void boundary_points_of_cell(const CutCells& cut_cells, int active_cell, const std::vector<int>& surfaces,
                             const std::vector<Plane>& dividers, int order, BoundaryPoints& points) {
  if (cut_cells.cut_of_active[active_cell] < 0) return;
  const Solid& solid = cut_cells.solid;
  std::vector<char> selected(solid.surfaces().size(), 0), adopted;
  for (int s : surfaces) selected[s] = 1;
  std::vector<Plane> all = dividers;
  all.insert(all.end(), cut_cells.face_dividers.begin(), cut_cells.face_dividers.end());
  const auto add_cell = [&](const Index3& cell, const std::vector<char>& wanted) {
    solid.geometry().boundary_points(cell, wanted, all, order, active_cell, points);
  };
  add_cell(cut_cells.cells[active_cell], selected);
  auto adoption = std::lower_bound(cut_cells.adoptions.begin(), cut_cells.adoptions.end(), active_cell,
                                   [](const Adoption& a, int cell) { return a.active < cell; });
  for (; adoption != cut_cells.adoptions.end() && adoption->active == active_cell; ++adoption) {
    if (!selected[adoption->surface]) continue;
    adopted.assign(selected.size(), 0);
    adopted[adoption->surface] = 1;
    add_cell(adoption->donor, adopted);
  }
}

}  // namespace cgcontact
