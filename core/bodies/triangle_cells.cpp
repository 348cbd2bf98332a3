#include "core/bodies/triangle_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/base/errors/errors.hpp"
#include "core/bodies/clipped_triangles.hpp"
#include "core/cells/moments.hpp"
#include "core/quadrature/gauss_rules.hpp"

namespace cgcontact {

namespace {

constexpr int bits = 21;  // of a cell's index along one axis
constexpr int most = 1 << (bits - 1);
/// Tolerance of a face's projected area (4 in cell coordinates): a closed surface misses 0 or 1 by rounding only.
constexpr double closed_tolerance = 1e-6;

/// Integrals of n_x L_j(y) L_k(z) over facets.
using SectionIntegrals = std::array<double, num_legendre * num_legendre>;

long long code(const Index3& cell) {
  for (int k = 0; k < 3; ++k)
    if (cell[k] < -most || cell[k] >= most) throw InputError("the body sticks out of its grid");
  const auto shifted = [](int c) { return static_cast<long long>(c) + most; };
  return (shifted(cell[2]) << (2 * bits)) | (shifted(cell[1]) << bits) | shifted(cell[0]);
}

Index3 decode(long long code) {
  constexpr long long mask = (1LL << bits) - 1;
  return {static_cast<int>(code & mask) - most, static_cast<int>(code >> bits & mask) - most,
          static_cast<int>(code >> (2 * bits)) - most};
}

/// Degree of the polynomials that are integrated over a flat facet.
constexpr int full_degree = 3 * moment_degree + 1;

/// Degrees of the rules for a facet of a curved face: polynomials vary less on a facet smaller than its cell. Slivers
/// are a hundredth of a cell thick.
struct CurvedDegrees {
  int facet, sliver;
};

CurvedDegrees curved_degrees(const SurfacePolygon& polygon) {
  Vec3 min = polygon.x[0], max = polygon.x[0];
  for (int i = 1; i < polygon.n; ++i) {
    min = min.cwiseMin(polygon.x[i]);
    max = max.cwiseMax(polygon.x[i]);
  }
  const double size = (max - min).maxCoeff();  // cells
  if (size < 0.25) return {7, 5};
  if (size < 0.6) return {9, 6};
  return {full_degree, 8};
}

/// Adds up the integrals over the facets in one cell, several points at a time.
class FacetIntegrals {
 public:
  /// Without moments only the section is made.
  FacetIntegrals(const Vec3& corner, bool with_moments) : corner_(corner), with_moments_(with_moments) {
    for (auto& sum : sums_) sum.fill(0);
    for (auto& sum : section_) sum.fill(0);
  }

  void add(const SurfacePolygon& polygon, int degree) {
    const TriangleRule& rule = triangle_rule(degree);
    for (int k = 1; k + 1 < polygon.n; ++k) {
      const Vec3 u = polygon.x[k] - polygon.x[0], v = polygon.x[k + 1] - polygon.x[0];
      const double projection = 2 * (u[1] * v[2] - u[2] * v[1]);  // area in cell coordinates, times n_x
      if (projection == 0) continue;
      const Vec3 origin = 2 * (polygon.x[0] - corner_) - Vec3::Ones();
      for (std::size_t q = 0; q < rule.weight.size(); ++q) {
        for (int d = 0; d < 3; ++d) xi_[d][filled_] = origin[d] + 2 * (rule.a[q] * u[d] + rule.b[q] * v[d]);
        weight_[filled_] = projection * rule.weight[q];
        if (++filled_ == lanes) flush();
      }
    }
  }

  /// Adds the sums to the cell's moments and to the section of the cells before it.
  void finish(Moments& moments, SectionIntegrals& section) {
    for (int l = filled_; l < lanes; ++l) xi_[0][l] = xi_[1][l] = xi_[2][l] = weight_[l] = 0;
    flush();
    for (int q = 0; with_moments_ && q < num_moments; ++q)
      moments[q] += std::accumulate(sums_[q].begin(), sums_[q].end(), 0.0);
    for (int q = 0; q < num_legendre * num_legendre; ++q)
      section[q] += std::accumulate(section_[q].begin(), section_[q].end(), 0.0);
  }

 private:
  static constexpr int lanes = 8;
  using Lanes = std::array<double, lanes>;

  void flush() {
    Lanes ax[num_legendre], ly[num_legendre], lz[num_legendre];
    for (int l = 0; l < lanes; ++l) {
      double a[num_legendre], b[num_legendre], c[num_legendre];
      if (with_moments_) legendre_integrals(xi_[0][l], a);
      legendre_values(xi_[1][l], b);
      legendre_values(xi_[2][l], c);
      for (int i = 0; i < num_legendre; ++i) {
        if (with_moments_) ax[i][l] = a[i];
        ly[i][l] = weight_[l] * b[i];
        lz[i][l] = c[i];
      }
    }
    for (int j = 0; j < num_legendre; ++j)
      for (int k = 0; k < num_legendre; ++k) {
        Lanes product;
        for (int l = 0; l < lanes; ++l) product[l] = ly[j][l] * lz[k][l];
        for (int l = 0; l < lanes; ++l) section_[j * num_legendre + k][l] += product[l];
        for (int i = 0; with_moments_ && i < num_legendre; ++i)
          for (int l = 0; l < lanes; ++l) sums_[(i * num_legendre + j) * num_legendre + k][l] += ax[i][l] * product[l];
      }
    filled_ = 0;
  }

  const Vec3 corner_;
  const bool with_moments_;
  int filled_ = 0;
  Lanes xi_[3], weight_;
  std::array<Lanes, num_moments> sums_;
  std::array<Lanes, num_legendre * num_legendre> section_;
};

/// Adds up the integrals over what lies between the facets in one cell and their images, several points at a time.
class SliverIntegrals {
 public:
  SliverIntegrals(const TriangleSurface& surface, const CurvedTriangles& curved, const Vec3& corner)
      : surface_(surface), curved_(curved), corner_(corner) {
    for (auto& sum : sums_) sum.fill(0);
  }

  void add(int triangle, const SurfacePolygon& polygon, int degree) {
    any_ = true;
    static thread_local std::vector<TrianglePoint> points;
    points.clear();
    add_clipped_rule(surface_, triangle, polygon, degree, points);
    const GaussRule& across = gauss_rule(sliver_points_across);
    const Vec3& x0 = surface_.corner(triangle, 0);
    const Vec3 u = surface_.corner(triangle, 1) - x0, v = surface_.corner(triangle, 2) - x0;
    for (const TrianglePoint& at : points) {
      const CurvedPoint image = curved_.point_at(triangle, at.a, at.b);
      const Vec3 flat = x0 + at.a * u + at.b * v, off = image.x - flat;
      const Vec3 du = image.along_a - u, dv = image.along_b - v;
      for (std::size_t q = 0; q < across.node.size(); ++q) {
        const double t = across.node[q];
        const Vec3 xi = 2 * (flat + t * off - corner_) - Vec3::Ones();
        const double volume = 8 * at.weight * across.weight[q] * (u + t * du).cross(v + t * dv).dot(off);
        for (int d = 0; d < 3; ++d) xi_[d][filled_] = xi[d];
        weight_[filled_] = volume;
        removed_ -= std::min(volume, 0.0);
        if (++filled_ == lanes) flush();
      }
    }
  }

  /// Adds the sums to the cell's moments; true if what is left is too thin.
  bool finish(Moments& moments) {
    if (!any_) return false;
    for (int l = filled_; l < lanes; ++l) xi_[0][l] = xi_[1][l] = xi_[2][l] = weight_[l] = 0;
    flush();
    for (int q = 0; q < num_moments; ++q) moments[q] += std::accumulate(sums_[q].begin(), sums_[q].end(), 0.0);
    return moments[0] < thin * removed_;
  }

 private:
  static constexpr int lanes = 8;
  static constexpr int sliver_points_across = 2;  // polynomials of degree 4 hardly vary across a sliver
  /// Ratio of a cell to what its slivers take away below which it is thin: what they take outside of the cell may be a
  /// twentieth of the rest.
  static constexpr double thin = 5;
  using Lanes = std::array<double, lanes>;

  void flush() {
    Lanes lx[num_legendre], ly[num_legendre], lz[num_legendre];
    for (int l = 0; l < lanes; ++l) {
      double a[num_legendre], b[num_legendre], c[num_legendre];
      legendre_values(xi_[0][l], a);
      legendre_values(xi_[1][l], b);
      legendre_values(xi_[2][l], c);
      for (int i = 0; i < num_legendre; ++i) {
        lx[i][l] = a[i];
        ly[i][l] = weight_[l] * b[i];
        lz[i][l] = c[i];
      }
    }
    for (int j = 0; j < num_legendre; ++j)
      for (int k = 0; k < num_legendre; ++k) {
        Lanes product;
        for (int l = 0; l < lanes; ++l) product[l] = ly[j][l] * lz[k][l];
        for (int i = 0; i < num_legendre; ++i)
          for (int l = 0; l < lanes; ++l) sums_[(i * num_legendre + j) * num_legendre + k][l] += lx[i][l] * product[l];
      }
    filled_ = 0;
  }

  const TriangleSurface& surface_;
  const CurvedTriangles& curved_;
  const Vec3 corner_;
  bool any_ = false;
  double removed_ = 0;
  int filled_ = 0;
  Lanes xi_[3], weight_;
  std::array<Lanes, num_moments> sums_;
};

[[noreturn]] void refuse_row(const Index3& cell) {
  throw InputError("the triangle surface is not closed, or crosses itself, in the row of cells j = " +
                   std::to_string(cell[1]) + ", k = " + std::to_string(cell[2]) + " of the body's grid");
}

/// Returns whether the cells before those swept are inside. Removes the rounding from the section.
bool settle(SectionIntegrals& section, const Index3& cell) {
  SectionIntegrals exact{};
  exact[0] = section[0] > 2 ? 4 : 0;
  for (int q = 0; q < num_legendre * num_legendre; ++q)
    if (std::abs(section[q] - exact[q]) > closed_tolerance) refuse_row(cell);
  section = exact;
  return exact[0] > 0;
}

/// Finds rows of cells along x with leaves of a level, in divided cells of the level before; of the coarsest level all
/// rows.
class RowsOfLeaves {
 public:
  RowsOfLeaves(const LeafLevel& leaves, const Index3& num_cells)
      : all_(!leaves.tree || leaves.level == 0), layers_(all_ ? 0 : num_cells[2] / 2) {
    if (all_) return;
    last_ = num_cells[1] / 2 - 1;
    leaves.tree->refined(leaves.level - 1).each([&](const Index3& divided) {
      std::vector<int>& rows = layers_[divided[2]];
      if (rows.empty() || rows.back() != divided[1]) rows.push_back(divided[1]);
    });
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      std::sort(layers_[k].begin(), layers_[k].end());
      layers_[k].erase(std::unique(layers_[k].begin(), layers_[k].end()), layers_[k].end());
      if (!layers_[k].empty()) filled_.push_back(static_cast<int>(k));
    }
  }

  /// As each_cell_of_triangle asks for it. Cells outside of the grid count as the nearest one inside.
  int next(int axis, const Index3& cell) const {
    if (all_ || axis == 0) return cell[axis];
    const int last_layer = static_cast<int>(layers_.size()) - 1;
    if (axis == 2) return first_from(cell[2], last_layer, filled_);
    return first_from(cell[1], last_, layers_[std::clamp(cell[2] >> 1, 0, last_layer)]);
  }

 private:
  /// wanted: of the level before, ascending, at most `last`.
  static int first_from(int begin, int last, const std::vector<int>& wanted) {
    const int divided = std::clamp(begin >> 1, 0, last);
    const auto found = std::lower_bound(wanted.begin(), wanted.end(), divided);
    if (found == wanted.end()) return std::numeric_limits<int>::max();
    return *found == divided ? begin : 2 * *found;
  }

  bool all_;
  int last_ = 0;                          ///< row of the level before
  std::vector<std::vector<int>> layers_;  ///< divided cells of the level before: j by k, ascending
  std::vector<int> filled_;               ///< the layers that have some
};

}  // namespace

TriangleCells::TriangleCells(const TriangleSurface& surface, const CurvedTriangles* curved, const Index3& num_cells,
                             const std::vector<Plane>& dividers, int order, const LeafLevel& leaves)
    : surface_(surface), curved_(curved), num_cells_(num_cells), dividers_(dividers), order_(order), leaves_(leaves) {
  const int n = static_cast<int>(surface.triangles().size());
  const RowsOfLeaves rows(leaves, num_cells);
  for (int t = 0; t < n; ++t)
    each_cell_of_triangle(
        surface, t, [&](int axis, const Index3& cell) { return rows.next(axis, cell); },
        [&](const Index3& cell, const SurfacePolygon&) {
          entries_.push_back({code(cell), t});
        });
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return std::tie(a.cell, a.triangle) < std::tie(b.cell, b.triangle); });
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (i == 0 || entries_[i].cell >> bits != entries_[i - 1].cell >> bits) row_begin_.push_back(i);
  row_begin_.push_back(entries_.size());
}

void TriangleCells::sweep(std::size_t row, SweptCells& found) const {
  std::vector<CellIntegrals>& cells = found.crossed;
  static thread_local std::vector<int> triangles;
  const std::size_t first = cells.size();
  SectionIntegrals section{};  // of all facets farther along the row
  std::size_t begin;
  for (std::size_t end = row_begin_[row + 1]; end > row_begin_[row]; end = begin) {
    const Index3 cell = decode(entries_[end - 1].cell);
    const Vec3 corner(cell[0], cell[1], cell[2]);
    if (cells.size() > first) {
      const int gap = cells.back().cell[0] - cell[0] - 1;
      if (gap > 0 && settle(section, cell)) found.inside.push_back({{cell[0] + 1, cell[1], cell[2]}, gap});
    }
    cells.push_back({cell, {}, {}, false});
    Moments& moments = cells.back().moments;
    for (int q = 0; q < num_legendre * num_legendre; ++q) moments[q] = 2 * section[q];
    triangles.clear();
    const bool leaf = leaves_.has(cell);
    FacetIntegrals integrals(corner, leaf);
    std::optional<SliverIntegrals> slivers;
    if (curved_ && leaf) slivers.emplace(surface_, *curved_, corner);
    for (begin = end; begin > row_begin_[row] && entries_[begin - 1].cell == entries_[end - 1].cell; --begin) {
      triangles.push_back(entries_[begin - 1].triangle);
      const SurfacePolygon polygon = clipped_to_cell(surface_, triangles.back(), cell);
      if (polygon.n < 3) continue;
      if (!slivers || curved_->is_plane(triangles.back())) {
        integrals.add(polygon, full_degree);
      } else {
        const CurvedDegrees degrees = curved_degrees(polygon);
        integrals.add(polygon, degrees.facet);
        slivers->add(triangles.back(), polygon,
                     degrees.sliver + (curved_->is_bent(triangles.back()) ? bend_degrees : 0));
      }
    }
    integrals.finish(moments, section);
    if (slivers) cells.back().thin = slivers->finish(moments);
    if (!leaf) continue;
    std::reverse(triangles.begin(), triangles.end());
    triangle_boundary_points(surface_, curved_, triangles, cell, {}, dividers_, order_, 0, cells.back().points);
  }
  if (settle(section, cells.back().cell)) refuse_row(cells.back().cell);
  std::reverse(cells.begin() + static_cast<std::ptrdiff_t>(first), cells.end());
}

}  // namespace cgcontact
