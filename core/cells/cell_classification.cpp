#include "core/cells/cell_classification.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

class Classifier {
 public:
  Classifier(const BodyGeometry& body, const Grid& grid, const LeafLevel& leaves)
      : body_(body), grid_(grid), leaves_(leaves) {
    classes_.inside = GridNumbers(grid.num_cells);
  }

  CellClasses run() {
    if (leaves_.level == 0)
      visit_all();
    else
      visit_children();
    std::sort(classes_.candidates.begin(), classes_.candidates.end(),
              [](const Index3& a, const Index3& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); });
    classes_.inside.number();
    return std::move(classes_);
  }

 private:
  void visit_all() {
    Index3 begin{-1, -1, -1}, end;
    for (int k = 0; k < 3; ++k) end[k] = grid_.num_cells[k] + 1;
    Vec3 min, max;
    if (body_.bounding_box(min, max))
      for (int k = 0; k < 3; ++k) {  // look far outside as well
        begin[k] = static_cast<int>(std::floor(std::clamp(min[k], -1e8, -1.0)));
        end[k] = static_cast<int>(std::ceil(std::clamp(max[k], end[k] + 0.0, 1e8)));
      }
    visit_layer(begin, end);
  }

  /// The children of all refined cells, at the border of the grid with one more layer: by rounding, a face in it may
  /// lie just outside.
  void visit_children() {
    leaves_.tree->refined(leaves_.level - 1).each([&](const Index3& parent) {
      Index3 begin, end;
      for (int d = 0; d < 3; ++d) {
        begin[d] = 2 * parent[d] - (parent[d] == 0);
        end[d] = 2 * parent[d] + 2 + (2 * parent[d] + 2 == grid_.num_cells[d]);
      }
      visit_layer(begin, end);
    });
  }

  /// The body goes on beyond the one layer of a quadtree.
  void visit_layer(Index3 begin, Index3 end) {
    if (leaves_.across >= 0) {
      begin[leaves_.across] = 0;
      end[leaves_.across] = 1;
    }
    visit(begin, end, std::vector<signed char>(body_.surfaces().size(), -1));
  }

  void visit(const Index3& begin, const Index3& end, std::vector<signed char> sides) {
    Vec3 centre, half;
    int longest = 0;
    for (int k = 0; k < 3; ++k) {
      centre[k] = 0.5 * (begin[k] + end[k]);
      half[k] = 0.5 * (end[k] - begin[k]);
      if (half[k] > half[longest]) longest = k;
    }
    const int value = body_.side_of_block(centre, half, sides);
    if (value == 0) return;
    if (value == 1) return fill(begin, end);
    if (half[longest] <= 0.5) {
      if (leaves_.has(begin)) classes_.candidates.push_back(begin);
      return;
    }
    Index3 middle_end = end, middle_begin = begin;
    middle_end[longest] = middle_begin[longest] = begin[longest] + (end[longest] - begin[longest]) / 2;
    visit(begin, middle_end, sides);
    visit(middle_begin, end, sides);
  }

  void fill(const Index3& begin, const Index3& end) {
    for (int k = 0; k < 3; ++k)
      if (begin[k] < 0 || end[k] > grid_.num_cells[k]) throw InputError("the body sticks out of its grid");
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j) {
        if (leaves_.all()) {
          classes_.inside.insert_row({begin[0], j, k}, end[0] - begin[0]);
          continue;
        }
        for (int i = begin[0]; i < end[0]; ++i)
          if (leaves_.has({i, j, k})) classes_.inside.insert({i, j, k});
      }
  }

  const BodyGeometry& body_;
  const Grid& grid_;
  const LeafLevel leaves_;
  CellClasses classes_;
};

/// Some point near its corners, the middles of its sides or its centre is inside, some outside: a surface does more
/// than touch it. With none inside, a coarse cell counts as empty, with all inside as full: a face that lies on its
/// side cuts a layer.
int inside_of(const BodyGeometry& body, const Index3& cell) {
  constexpr double offset[3] = {0.01, 0.5, 0.99};
  int inside = 0;
  for (int n = 0; n < 27; ++n)
    inside += body.contains(Vec3(cell[0] + offset[n % 3], cell[1] + offset[n / 3 % 3], cell[2] + offset[n / 9]));
  return inside;
}

}  // namespace

CellClasses classify_cells(const BodyGeometry& body, const Grid& grid, const LeafLevel& leaves) {
  return Classifier(body, grid, leaves).run();
}

/// Cells of a coarse cell that a surface crosses have the two longest of its three extents; of a plate of one or two
/// cells all are cut. Half of the cells of a coarse cell are in the body. Beside a cut cell half a layer of nodes comes
/// on top of one node by cell.
CellEstimate estimate_by_coarse_cells(const BodyGeometry& body, const Grid& grid, double max_cells) {
  const double num_cells = static_cast<double>(grid.num_cells[0]) * grid.num_cells[1] * grid.num_cells[2];
  int factor = 1;
  while (num_cells / std::pow(factor, 3) > max_cells) ++factor;
  Grid coarse = grid;
  coarse.cell_size *= factor;
  for (int& n : coarse.num_cells) n = (n + factor - 1) / factor;
  const auto placed =
      body.transformed(coarse.rotation.transpose(), -(coarse.rotation.transpose() * coarse.origin) / coarse.cell_size,
                       1 / coarse.cell_size);
  const CellClasses classes = classify_cells(*placed, coarse);
  CellEstimate estimate{static_cast<double>(classes.inside.size()) * std::pow(factor, 3), 0};
  const bool is_thin = *std::min_element(grid.num_cells.begin(), grid.num_cells.end()) <= 3;
  for (const Index3& c : classes.candidates) {
    double extent[3];
    for (int k = 0; k < 3; ++k) extent[k] = c[k] < 0 ? 0 : std::clamp(grid.num_cells[k] - c[k] * factor, 0, factor);
    const double all = extent[0] * extent[1] * extent[2];
    if (all == 0) continue;  // a body that sticks out of its grid is refused when its cells are made
    const int inside_points = inside_of(*placed, c);
    if (inside_points == 0) continue;
    const double across = std::min({extent[0], extent[1], extent[2]});
    const double cut = is_thin ? all : all / across;
    estimate.cut_cells += cut;
    estimate.nodes += inside_points == 27 ? all : std::max(cut, all / 2);
  }
  estimate.nodes += estimate.cut_cells / 2;
  return estimate;
}

}  // namespace cgcontact
