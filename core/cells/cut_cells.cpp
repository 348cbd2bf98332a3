#include "core/cells/cut_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors/errors.hpp"
#include "core/base/process/packing.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "core/cells/cell_sweep.hpp"

namespace cgcontact {

namespace {

/// A cell that a surface may cross. Its points are in the grid coordinates of its level.
struct Candidate : CellIntegrals {
  bool pruned = false;
  int level = 0;
};

/// Mean position and normal of the points of one surface in a cell.
struct FacetMean {
  int surface;
  double area = 0;
  Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
};

/// Cells: the least distance from an axis of revolution that points count with. Points on the axis keep a negligible
/// area.
constexpr double nearest_to_axis = 1e-9;

/// Points from a given one on: from the grid coordinates of a level to those of the body, their areas to those for
/// which its cells count.
void scale_points(const Grid& grid, BoundaryPoints& points, std::size_t first, int level) {
  if (level == 0 && !grid.is_quadtree()) return;
  const double length = std::ldexp(1.0, -level), thickness = grid.thickness_of_cell(level);
  for (std::size_t i = first; i < points.size(); ++i) {
    points.position[i] *= length;
    points.weight[i] *= thickness * length * length;
    if (grid.is_axisymmetric())
      points.weight[i] *= std::max(grid.ring(points.position[i]), nearest_to_axis * grid.cell_size / grid.unit_radius);
    if (!points.facet_position.empty()) points.facet_position[i] *= length;
  }
}

/// Points of a candidate (of one surface unless `surface` is negative) with their owner.
void append_points(const Grid& grid, const Candidate& from, int surface, int owner, BoundaryPoints& to) {
  const std::size_t first = to.size();
  for (std::size_t i = 0; i < from.points.size(); ++i)
    if (surface < 0 || from.points.surface[i] == surface) to.append(from.points, i, owner);
  scale_points(grid, to, first, from.level);
}

std::vector<Plane> planes_of_level(std::vector<Plane> planes, int level) {
  for (Plane& plane : planes)
    if (!plane.of_normals) plane.offset = std::ldexp(plane.offset, level);
  return planes;
}

std::vector<FacetMean> facet_means(const BoundaryPoints& points) {
  std::vector<FacetMean> means;
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
  for (FacetMean& m : means) {
    m.position /= m.area;
    m.normal /= m.area;
  }
  return means;
}

double distance_to_cell(const Vec3& x, const Index3& cell, double size = 1) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = std::max({0.0, size * cell[k] - x[k], x[k] - size * cell[k] - size});
    sum += d * d;
  }
  return std::sqrt(sum);
}

/// Returns the cell of a level that contains or is contained in the given one.
Index3 cell_on_level(const Index3& c, int from, int to) {
  if (to >= from) {  // a cell beside the grid may have negative numbers, which must not be shifted
    const int factor = 1 << (to - from);
    return {factor * c[0], factor * c[1], factor * c[2]};
  }
  return {c[0] >> (from - to), c[1] >> (from - to), c[2] >> (from - to)};
}

/// Cells of one level and which of them are leaves.
struct LevelOfGrid {
  Grid grid;  ///< with the level's size as its cell size
  Solid solid;
  std::vector<Plane> dividers;
  LeafLevel leaves;
  GridNumbers numbers;  ///< of the active cells
  int first = 0;        ///< number of the first of them in the body
};

class CutCellBuilder {
 public:
  CutCellBuilder(const Solid& solid, const Grid& grid, const std::vector<Plane>& face_dividers,
                 const GeometryOptions& options, const CellTree& tree)
      : options_(options), levels_(tree.num_levels()) {
    result_.solid = solid;
    result_.face_dividers = face_dividers;
    result_.grid = grid;
    for (int l = 0; l < num_levels(); ++l) {
      LevelOfGrid& level = levels_[l];
      level.grid = grid;
      level.grid.cell_size = grid.cell_size_of(l);
      level.grid.num_cells = cells_of_level(grid.num_cells, l);
      // powers of two: planes and cells lie as they do on the other levels, to the last bit
      level.solid = l == 0 ? solid : solid.on_level(l, tree);
      level.dividers = planes_of_level(face_dividers, l);
      level.leaves = LeafLevel{num_levels() > 1 ? &tree : nullptr, l, grid.is_quadtree() ? grid.plane_strain : -1};
    }
  }

  CutCells run() {
    for (int l = 0; l < num_levels(); ++l) integrate(l);
    number_cells();
    if (result_.cells.empty())
      throw InputError(
          "the body is empty: a difference takes all of it away, or parts of an intersection do not overlap");
    merge_slivers();
    collect();
    split_levels();
    return std::move(result_);
  }

 private:
  /// Results of one chunk of the sweep.
  struct Found {
    std::vector<Candidate> cut;
    std::vector<std::pair<Index3, int>> inside;  ///< first cell, number of cells along x
  };

  int num_levels() const { return static_cast<int>(levels_.size()); }

  void integrate(int l) {
    LevelOfGrid& level = levels_[l];
    const auto sweep =
        level.solid.geometry().sweep_cells(level.grid, level.dividers, options_.boundary_order, level.leaves);
    level.numbers = sweep->take_inside();
    std::vector<Found> found(sweep->num_chunks());
    // Interleaves the chunks over the ranks: neighbouring chunks cost about the same.
    const std::size_t ranks = num_ranks(), rank = this_rank();
    const std::size_t num_own = found.size() / ranks + (rank < found.size() % ranks);
    on_all_ranks([&] {
      parallel_for("cgcontact::cut_cells::integrate", num_own, 1, [&](std::size_t own) {
        const std::size_t chunk = own * ranks + rank;
        SweptCells swept;
        sweep->sweep(chunk, swept);
        for (CellIntegrals& cell : swept.crossed)
          if (level.leaves.has(cell.cell)) keep(std::move(cell), l, found[chunk]);
        for (auto& [first, number] : swept.inside)
          if (in_layer(level.leaves.across, first, number)) set_inside(first, number, l, found[chunk]);
      });
    });
    if (ranks > 1) exchange(found);
    collect_found(found, level);
  }

  /// Gives every rank the results of all.
  static void exchange(std::vector<Found>& found) {
    const std::size_t ranks = num_ranks();
    Packing own;
    std::size_t num_cut = 0;
    for (const Found& chunk : found) num_cut += chunk.cut.size();
    constexpr std::size_t some_points = 1024;
    own.reserve(num_cut * (sizeof(Candidate) + some_points));
    for (std::size_t chunk = this_rank(); chunk < found.size(); chunk += ranks) {
      own.put(found[chunk].cut.size());
      for (const Candidate& c : found[chunk].cut) {
        own.put(c.cell);
        own.put(c.moments);
        own.put(std::array<int, 3>{c.thin, c.pruned, c.level});
        c.points.pack(own);
      }
      own.put(found[chunk].inside.size());
      for (const auto& [first, number] : found[chunk].inside) {
        own.put(first);
        own.put(number);
      }
    }
    const std::vector<char> bytes = gather_bytes(own.bytes().data(), own.bytes().size());
    Unpacking all(bytes);
    for (std::size_t rank = 0; rank < ranks; ++rank) {
      if (rank == static_cast<std::size_t>(this_rank())) {
        all.skip(own.bytes().size());
        continue;
      }
      for (std::size_t chunk = rank; chunk < found.size(); chunk += ranks) {
        std::size_t size = 0;
        all.take(size);
        found[chunk].cut.resize(size);
        for (Candidate& c : found[chunk].cut) {
          std::array<int, 3> marks{};
          all.take(c.cell);
          all.take(c.moments);
          all.take(marks);
          c.thin = marks[0] != 0;
          c.pruned = marks[1] != 0;
          c.level = marks[2];
          c.points.unpack(all);
        }
        all.take(size);
        found[chunk].inside.resize(size);
        for (auto& [first, number] : found[chunk].inside) {
          all.take(first);
          all.take(number);
        }
      }
    }
  }

  /// Clips a row of cells along x to the one layer of a quadtree. False: nothing is left.
  static bool in_layer(int across, Index3& first, int& number) {
    if (across < 0) return true;
    if (across == 0 && first[0] <= 0 && first[0] + number > 0) {
      first[0] = 0;
      number = 1;
    }
    return first[across] == 0;
  }

  void collect_found(std::vector<Found>& found, LevelOfGrid& level) {
    std::size_t total = candidates_.size();
    for (const Found& chunk : found) total += chunk.cut.size();
    candidates_.reserve(total);
    for (Found& chunk : found) {
      for (const auto& [first, number] : chunk.inside) insert_leaves(first, number, level);
      std::move(chunk.cut.begin(), chunk.cut.end(), std::back_inserter(candidates_));
      chunk = {};
    }
  }

  static void insert_leaves(const Index3& first, int number, LevelOfGrid& level) {
    if (level.leaves.all()) return level.numbers.insert_row(first, number);
    for (Index3 c = first; c[0] < first[0] + number; ++c[0])
      if (level.leaves.has(c)) level.numbers.insert(c);
  }

  /// Adds the cell to what is cut or inside unless it turns out to be empty.
  void keep(CellIntegrals&& integrals, int level, Found& found) {
    Candidate candidate{std::move(integrals)};
    candidate.level = level;
    candidate.pruned = candidate.thin || candidate.moments[0] < 8 * options_.prune_fraction;
    if (!candidate.pruned) {
      if (!in_grid(candidate.cell, level)) throw InputError("the body sticks out of its grid");
      double difference = 0;
      for (int q = 0; q < num_moments; ++q)
        difference = std::max(difference, std::abs(candidate.moments[q] - full_cell_moments()[q]));
      const bool full = difference < 8 * options_.full_tolerance;
      if (full) candidate.moments = full_cell_moments();
      if (full && candidate.points.size() == 0) return set_inside(candidate.cell, 1, level, found);
    } else if (candidate.points.size() == 0) {
      return;
    }
    found.cut.push_back(std::move(candidate));
  }

  bool in_grid(const Index3& c, int level) const {
    for (int k = 0; k < 3; ++k)
      if (c[k] < 0 || c[k] >= levels_[level].grid.num_cells[k]) return false;
    return true;
  }

  void set_inside(const Index3& first, int number, int level, Found& found) const {
    if (!in_grid(first, level) || first[0] + number > levels_[level].grid.num_cells[0])
      throw InputError("the body sticks out of its grid");
    found.inside.emplace_back(first, number);
  }

  void number_cells() {
    for (const Candidate& candidate : candidates_)
      if (!candidate.pruned) levels_[candidate.level].numbers.insert(candidate.cell);
    for (LevelOfGrid& level : levels_) {
      level.first = static_cast<int>(result_.cells.size());
      level.numbers.number();
      result_.cells.reserve(result_.cells.size() + level.numbers.size());
      level.numbers.each([&](const Index3& cell) { result_.cells.push_back(cell); });
    }
    candidate_of_active_.assign(result_.cells.size(), -1);
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (!candidates_[c].pruned)
        candidate_of_active_[find(candidates_[c].level, candidates_[c].cell)] = static_cast<int>(c);
  }

  /// Returns the active cell at a position of a level, or -1.
  int find(int level, const Index3& c) const {
    const int cell = levels_[level].numbers.find(c);
    return cell < 0 ? -1 : levels_[level].first + cell;
  }

  int level_of(int active) const {
    int l = num_levels() - 1;
    while (active < levels_[l].first) --l;
    return l;
  }

  double fraction(int active) const {
    const int candidate = candidate_of_active_[active];
    return candidate < 0 ? 1.0 : candidates_[candidate].moments[0] / 8;
  }

  /// Finds the active cell that takes a facet near a cell of a level: the one nearest to a point just inside the body,
  /// then the fullest. Lengths in cells of that level.
  int find_owner(const Index3& cell, int level, const FacetMean& facet) const {
    const Vec3 inside = facet.position - 1e-3 * facet.normal;
    int best = -1;
    double best_distance = std::numeric_limits<double>::max();
    for (int reach = 1; reach <= 2 && best < 0; ++reach)
      for (int l = std::max(0, level - 1); l <= std::min(level + 1, num_levels() - 1); ++l) {
        const int width = l > level ? 2 : 1, across = 2 * reach + width;  // cells of level l
        const Index3 from = cell_on_level(cell, level, l);
        const double size = std::ldexp(1.0, level - l);
        for (int n = 0; n < across * across * across; ++n) {
          const Index3 other{from[0] + n % across - reach, from[1] + n / across % across - reach,
                             from[2] + n / (across * across) - reach};
          const int active = find(l, other);
          if (active < 0) continue;
          const double distance = distance_to_cell(inside, other, size);
          const bool tie = std::abs(distance - best_distance) < 1e-9;
          if (tie ? fraction(active) <= fraction(best) : distance > best_distance) continue;
          best = active;
          best_distance = distance;
        }
      }
    return best;
  }

  void merge_slivers() {
    for (std::size_t c = 0; c < candidates_.size(); ++c) {  // more may be appended
      if (!candidates_[c].pruned) continue;
      const std::vector<FacetMean> facets = facet_means(candidates_[c].points);
      std::vector<int> owners;
      bool smaller = false;
      for (const FacetMean& facet : facets) {
        owners.push_back(find_owner(candidates_[c].cell, candidates_[c].level, facet));
        smaller = smaller || (owners.back() >= 0 && level_of(owners.back()) > candidates_[c].level);
      }
      if (smaller) {
        divide(c);
        continue;
      }
      const Candidate& candidate = candidates_[c];
      if (!candidate.thin) ++result_.num_pruned;
      int heir = -1;
      double largest = 0;
      for (std::size_t p = 0; p < facets.size(); ++p) {
        const FacetMean& facet = facets[p];
        const int owner = owners[p];
        if (owner < 0) continue;
        result_.adoptions.push_back({owner, candidate.cell, facet.surface, candidate.level});
        donors_.push_back(static_cast<int>(c));
        if (facet.area > largest) heir = owner;
        largest = std::max(largest, facet.area);
      }
      if (heir >= 0 && (candidate.thin || candidate.moments[0] > 0)) pass_moments(candidate, heir);
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

  /// Divides a pruned cell beside smaller active cells into its eight children, so that each of its facets is no larger
  /// than the cell that takes it. Its volume goes with one of them.
  void divide(std::size_t c) {
    const int level = candidates_[c].level + 1;
    const LevelOfGrid& finer = levels_[level];
    bool has_volume = candidates_[c].thin || candidates_[c].moments[0] > 0;
    for (int a = 0; a < 8; ++a) {
      const Index3& cell = candidates_[c].cell;
      Candidate child;
      child.cell = {2 * cell[0] + (a & 1), 2 * cell[1] + (a >> 1 & 1), 2 * cell[2] + (a >> 2)};
      if (finer.leaves.across >= 0 && child.cell[finer.leaves.across] != 0) continue;
      child.level = level;
      child.pruned = true;
      child.thin = has_volume && candidates_[c].thin;
      child.moments = {};
      finer.solid.geometry().boundary_points(child.cell, {}, finer.dividers, options_.boundary_order, 0, child.points);
      if (child.points.size() == 0) continue;
      if (has_volume) child.moments[0] = 8 * candidates_[c].moments[0];
      has_volume = false;
      candidates_.push_back(std::move(child));
    }
    candidates_[c].points = {};
  }

  /// Passes the volume below the threshold to the cell that takes the largest facet.
  void pass_moments(const Candidate& candidate, int heir) {
    const Index3& to = result_.cells[heir];
    const int level = level_of(heir);
    extra_.push_back({heir, {}});
    Moments& extra = extra_.back().second;
    if (level == candidate.level) {
      const Index3 offset{candidate.cell[0] - to[0], candidate.cell[1] - to[1], candidate.cell[2] - to[2]};
      const int steps = std::abs(offset[0]) + std::abs(offset[1]) + std::abs(offset[2]);
      if (steps == 1 || (candidate.thin && steps <= 3)) {
        extra = shifted_moments(candidate.moments, offset);
        return;
      }
    }
    // farther away the change of coordinates amplifies rounding: concentrate the volume at one point
    const FacetMean mean = facet_means(candidate.points)[0];
    const double size = std::ldexp(1.0, level - candidate.level);  // of the candidate's cells in those of the heir
    double l[3][moment_degree + 1];
    for (int k = 0; k < 3; ++k) legendre_values(2 * (size * mean.position[k] - to[k]) - 1, l[k]);
    add_product(extra, size * size * size * candidate.moments[0], l[0], l[1], l[2]);
  }

  void collect() {
    const int num_active = static_cast<int>(result_.cells.size());
    std::vector<char> is_cut(num_active, 0);
    for (int a = 0; a < num_active; ++a) is_cut[a] = candidate_of_active_[a] >= 0;
    for (const MergedSliver& adoption : result_.adoptions) is_cut[adoption.active] = 1;
    if (result_.grid.is_axisymmetric()) std::fill(is_cut.begin(), is_cut.end(), char{1});
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
        append_points(result_.grid, candidates_[candidate], -1, a, result_.boundary);
        candidates_[candidate].points = {};
      }
      for (; adopted < donors_.size() && result_.adoptions[adopted].active == a; ++adopted)
        append_points(result_.grid, candidates_[donors_[adopted]], result_.adoptions[adopted].surface, a,
                      result_.boundary);
    }
    for (const auto& [heir, extra] : extra_)
      for (int q = 0; q < num_moments; ++q) result_.moments[result_.cut_of_active[heir]][q] += extra[q];
  }

  void split_levels() {
    if (num_levels() == 1) {
      result_.numbers = std::move(levels_[0].numbers);
      return;
    }
    result_.grid.num_levels = num_levels();
    result_.tree = std::make_shared<const CellTree>(*levels_[0].leaves.tree);
    result_.levels.resize(result_.cells.size());
    for (int l = 0; l < num_levels(); ++l) {
      const int first = levels_[l].first, size = static_cast<int>(levels_[l].numbers.size());
      const auto cut_before = [&](int active) {
        return std::lower_bound(result_.active_of_cut.begin(), result_.active_of_cut.end(), active) -
               result_.active_of_cut.begin();
      };
      const std::ptrdiff_t first_cut = cut_before(first), end_cut = cut_before(first + size);
      CutCells of_level;
      of_level.grid = levels_[l].grid;
      of_level.cells.assign(result_.cells.begin() + first, result_.cells.begin() + first + size);
      of_level.numbers = std::move(levels_[l].numbers);
      of_level.cut_of_active.assign(result_.cut_of_active.begin() + first,
                                    result_.cut_of_active.begin() + first + size);
      for (int& cut : of_level.cut_of_active)
        if (cut >= 0) cut -= static_cast<int>(first_cut);
      of_level.active_of_cut.assign(result_.active_of_cut.begin() + first_cut, result_.active_of_cut.begin() + end_cut);
      for (int& active : of_level.active_of_cut) active -= first;
      of_level.moments = result_.moments.slice(first_cut, end_cut - first_cut);
      std::fill(result_.levels.begin() + first, result_.levels.begin() + first + size, static_cast<signed char>(l));
      result_.first_of_level.push_back(first);
      result_.level_cells.push_back(std::move(of_level));
      result_.level_solids.push_back(levels_[l].solid);
    }
    result_.first_of_level.push_back(static_cast<int>(result_.cells.size()));
  }

  const GeometryOptions options_;
  CutCells result_;
  std::vector<LevelOfGrid> levels_;
  std::vector<Candidate> candidates_;
  std::vector<int> candidate_of_active_;
  std::vector<int> donors_;  ///< candidate of every adoption
  std::vector<std::pair<int, Moments>> extra_;
};

}  // namespace

double CutCells::radius(int active) const {
  const int cut = cut_of_active[active];
  return radii.empty() ? grid.radius(grid_position(*this, active, centroid(*this, active))) : radii[cut];
}

void CutCells::drop_moments() {
  if (fractions.empty())
    for (const Moments& m : moments) fractions.push_back(m[0] / 8);
  if (grid.is_axisymmetric() && radii.empty()) {
    std::vector<double> all;  // as long as there are none they follow from the moments
    for (const int active : active_of_cut) all.push_back(radius(active));
    radii = std::move(all);
  }
  moments = {};
  for (CutCells& of_level : level_cells) of_level.drop_moments();
}

void CutCells::keep_own_moments() {
  if (num_ranks() == 1 || !fractions.empty()) return;
  const auto [begin, end] = share_out(moments.size());
  std::vector<Moments> own;
  own.reserve(end - begin);
  for (std::size_t cut = begin; cut < end; ++cut) own.push_back(moments[cut]);
  drop_moments();
  moments = MomentList(std::move(own));
}

void CutCells::gather_moments() {
  if (num_ranks() == 1 || fractions.empty()) return;
  const std::size_t begin = share_out(fractions.size()).first;
  std::vector<Moments> all(fractions.size());
  for (std::size_t i = 0; i < moments.size(); ++i) all[begin + i] = moments[i];
  moments = {};
  put_together(all);
  moments = MomentList(std::move(all));
  fractions = {};
  radii = {};
  std::size_t first = 0;
  for (CutCells& of_level : level_cells) {
    of_level.fractions = of_level.radii = {};
    of_level.moments = moments.slice(first, of_level.active_of_cut.size());
    first += of_level.active_of_cut.size();
  }
}

int CutCells::locate(const Vec3& position) const {
  const auto cell_at = [&](int l) {
    const Vec3 x = std::ldexp(1.0, l) * position;
    return Index3{static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                  static_cast<int>(std::floor(x[2]))};
  };
  int best = -1;
  for (int l = num_levels() - 1; l >= 0 && best < 0; --l) best = find(l, cell_at(l));
  if (best >= 0) return best;
  double best_distance = 1;  // in cells of the level: smaller ones first
  for (int l = num_levels() - 1; l >= 0 && best < 0; --l) {
    const Index3 cell = cell_at(l);
    const Vec3 x = std::ldexp(1.0, l) * position;
    for (int n = 0; n < 27; ++n) {
      const Index3 other{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
      const int active = find(l, other);
      if (active < 0) continue;
      const double distance = distance_to_cell(x, other);
      if (distance > best_distance || (distance == best_distance && best >= 0)) continue;
      best = active;
      best_distance = distance;
    }
  }
  return best;
}

Vec3 cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& x) {
  const Index3& c = cut_cells.cells[active_cell];
  return 2 * (std::ldexp(1.0, cut_cells.level(active_cell)) * x - Vec3(c[0], c[1], c[2])) - Vec3::Ones();
}

Vec3 grid_position(const CutCells& cut_cells, int active_cell, const Vec3& xi) {
  const Index3& c = cut_cells.cells[active_cell];
  return cut_cells.size(active_cell) * (Vec3(c[0], c[1], c[2]) + 0.5 * (xi + Vec3::Ones()));
}

Vec3 global_position(const CutCells& cut_cells, int active_cell, const Vec3& xi) {
  return cut_cells.grid.to_global(grid_position(cut_cells, active_cell, xi));
}

Vec3 centroid(const CutCells& cut_cells, int active_cell) {
  const int cut = cut_cells.cut_of_active[active_cell];
  if (cut < 0) return Vec3::Zero();
  constexpr int n = moment_degree + 1;
  const Moments& m = cut_cells.moments[cut];
  return Vec3(m[n * n], m[n], m[1]) / m[0];
}

CutCells make_cut_cells(const Solid& solid_in_grid_coordinates, const Grid& grid,
                        const std::vector<Plane>& face_dividers, const GeometryOptions& options, const CellTree& tree) {
  for (int k = 0; k < 3; ++k)
    if (grid.num_cells[k] < 1) throw InputError("the grid has no cells");
  return CutCellBuilder(solid_in_grid_coordinates, grid, face_dividers, options, tree).run();
}

void boundary_points_of_cell(const CutCells& cut_cells, int active_cell, const std::vector<int>& surfaces,
                             const std::vector<Plane>& dividers, int order, BoundaryPoints& points) {
  if (cut_cells.cut_of_active[active_cell] < 0) return;
  std::vector<char> selected(cut_cells.solid.surfaces().size(), 0), adopted;
  for (int s : surfaces) selected[s] = 1;
  std::vector<Plane> all = dividers;
  all.insert(all.end(), cut_cells.face_dividers.begin(), cut_cells.face_dividers.end());
  const auto add_cell = [&](const Index3& cell, int level, const std::vector<char>& wanted) {
    const std::size_t first = points.size();
    const Solid& solid = level == 0 ? cut_cells.solid : cut_cells.level_solids[level];
    solid.geometry().boundary_points(cell, wanted, level == 0 ? all : planes_of_level(all, level), order, active_cell,
                                     points);
    scale_points(cut_cells.grid, points, first, level);
  };
  add_cell(cut_cells.cells[active_cell], cut_cells.level(active_cell), selected);
  auto adoption = std::lower_bound(cut_cells.adoptions.begin(), cut_cells.adoptions.end(), active_cell,
                                   [](const MergedSliver& a, int cell) { return a.active < cell; });
  for (; adoption != cut_cells.adoptions.end() && adoption->active == active_cell; ++adoption) {
    if (!selected[adoption->surface]) continue;
    adopted.assign(selected.size(), 0);
    adopted[adoption->surface] = 1;
    add_cell(adoption->donor, adoption->level, adopted);
  }
}

}  // namespace cgcontact
