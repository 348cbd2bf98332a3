#include "core/cells/cell_classification.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/errors.hpp"
#include "core/cells/local_solid.hpp"

namespace cgcontact {

namespace {

class Classifier {
 public:
  Classifier(const Solid& solid, const Grid& grid) : solid_(solid), grid_(grid) {
    classes_.inside = GridNumbers(grid.num_cells);
  }

  CellClasses run() {
    Index3 begin{-1, -1, -1}, end;
    for (int k = 0; k < 3; ++k) end[k] = grid_.num_cells[k] + 1;
    Vec3 min, max;
    if (solid_.bounding_box(min, max))
      for (int k = 0; k < 3; ++k) {  // look for parts of the body far outside as well
        begin[k] = static_cast<int>(std::floor(std::clamp(min[k], -1e8, -1.0)));
        end[k] = static_cast<int>(std::ceil(std::clamp(max[k], end[k] + 0.0, 1e8)));
      }
    visit(begin, end, std::vector<signed char>(solid_.surfaces().size(), -1));
    std::sort(classes_.candidates.begin(), classes_.candidates.end(),
              [](const Index3& a, const Index3& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); });
    classes_.inside.number();
    return std::move(classes_);
  }

 private:
  void visit(const Index3& begin, const Index3& end, std::vector<signed char> sides) {
    Vec3 centre, half;
    int longest = 0;
    for (int k = 0; k < 3; ++k) {
      centre[k] = 0.5 * (begin[k] + end[k]);
      half[k] = 0.5 * (end[k] - begin[k]);
      if (half[k] > half[longest]) longest = k;
    }
    for (std::size_t i = 0; i < sides.size(); ++i)
      if (sides[i] < 0) sides[i] = static_cast<signed char>(side_of_box(solid_.surfaces()[i], centre, half));
    const int value = solid_.evaluate_partial(sides);
    if (value == 0) return;
    if (value == 1) return fill(begin, end);
    if (half[longest] <= 0.5) {
      classes_.candidates.push_back(begin);
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
      for (int j = begin[1]; j < end[1]; ++j) classes_.inside.insert_row({begin[0], j, k}, end[0] - begin[0]);
  }

  const Solid& solid_;
  const Grid& grid_;
  CellClasses classes_;
};

}  // namespace

CellClasses classify_cells(const Solid& solid, const Grid& grid) { return Classifier(solid, grid).run(); }

}  // namespace cgcontact
