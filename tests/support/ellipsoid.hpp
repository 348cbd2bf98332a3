/// An ellipsoid: a kind of body that the program does not have, as an example of BodyGeometry and to prove that nothing
/// outside asks of which kind a body is. Integrals over cells by lines along the axes: relative errors of some 1e-4.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/cells/cell_sweep.hpp"
#include "core/cells/grid.hpp"
#include "core/geometry/solid.hpp"
#include "core/quadrature/gauss_rules.hpp"

namespace cgcontact::test {

/// centre + axes y, |y| <= 1; the columns of `axes` are at right angles.
struct EllipsoidShape {
  Vec3 centre;
  Mat3 axes;

  Vec3 to_unit(const Vec3& x) const { return axes.inverse() * (x - centre); }
  Vec3 normal(const Vec3& x) const { return (axes.inverse().transpose() * to_unit(x)).normalized(); }
  double smallest() const { return axes.colwise().norm().minCoeff(); }

  /// By Newton's method for the multiplier t of x = p + t D p, D = diag(1 / a^2) in the own axes.
  Vec3 nearest(const Vec3& x) const {
    const Vec3 a = axes.colwise().norm();
    const Vec3 local = (axes * a.cwiseInverse().asDiagonal()).transpose() * (x - centre), squares = a.cwiseAbs2();
    double t = (a.cwiseProduct(local.cwiseAbs()) - squares).maxCoeff();
    t = std::max(t, -squares.minCoeff() * (1 - 1e-12));
    // The function falls and is convex, and one of its terms is 1 here: from the left Newton's steps never pass the
    // root.
    for (int pass = 0; pass < 60; ++pass) {
      double value = -1, slope = 0;
      for (int k = 0; k < 3; ++k) {
        const double q = a[k] * local[k] / (squares[k] + t);
        value += q * q;
        slope -= 2 * q * q / (squares[k] + t);
      }
      if (value < 1e-14) break;
      t -= value / slope;
    }
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = squares[k] * local[k] / (squares[k] + t);
    return centre + axes * a.cwiseInverse().asDiagonal() * p;
  }

  /// Parameters of x + t d on the surface; false if the line misses it.
  bool meets(const Vec3& x, const Vec3& d, double& t0, double& t1) const {
    const Vec3 y = to_unit(x), e = axes.inverse() * d;
    const double a = e.squaredNorm(), b = y.dot(e), c = y.squaredNorm() - 1, root = b * b - a * c;
    if (root <= 0) return false;
    t0 = (-b - std::sqrt(root)) / a;
    t1 = (-b + std::sqrt(root)) / a;
    return true;
  }
};

class EllipsoidSurface final : public SurfacePatch {
 public:
  explicit EllipsoidSurface(const EllipsoidShape& shape) : shape_(shape) {}
  Surface near(const Vec3& x) const override {
    Surface plane;
    plane.point = shape_.nearest(x);
    plane.direction = shape_.normal(plane.point);
    return plane;
  }
  Vec3 normal(const Vec3& x) const override { return shape_.normal(shape_.nearest(x)); }

 private:
  EllipsoidShape shape_;
};

class Ellipsoid final : public BodyGeometry {
 public:
  Ellipsoid(const EllipsoidShape& shape, const std::string& face) : shape_(shape), face_(face) {
    Surface surface;
    surface.kind = Surface::Kind::patch;
    surface.names = {face};
    surface.patch = std::make_shared<EllipsoidSurface>(shape);
    surfaces_ = {surface};
  }

  std::shared_ptr<const BodyGeometry> transformed(const Mat3& rotation, const Vec3& translation,
                                                  double scale) const override {
    const EllipsoidShape image{scale * (rotation * shape_.centre) + translation, scale * rotation * shape_.axes};
    return std::make_shared<Ellipsoid>(image, face_);
  }
  std::shared_ptr<const BodyGeometry> stretched(int, double, double) const override {
    throw InputError(std::string("an ellipsoid is no prism"));
  }
  bool bounding_box(Vec3& min, Vec3& max) const override {
    const Vec3 half = shape_.axes.rowwise().norm();
    min = shape_.centre - half;
    max = shape_.centre + half;
    return true;
  }
  bool contains(const Vec3& x) const override { return shape_.to_unit(x).squaredNorm() <= 1; }
  double distance_to_surfaces(const Vec3& x) const override { return (x - shape_.nearest(x)).norm(); }
  int surface_at(const Vec3&, const Vec3&) const override { return 0; }
  void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const override {
    double t[2];
    if (!shape_.meets(x, d, t[0], t[1])) return;
    for (const double each : t)
      if (std::abs(each) <= reach) found.push_back({each, 0, shape_.normal(x + each * d)});
  }

  int side_of_block(const Vec3& centre, const Vec3& half_size, std::vector<signed char>&) const override {
    const double distance = shape_.to_unit(centre).norm(), reach = half_size.norm() / shape_.smallest();
    return distance + reach < 1 ? 1 : distance - reach > 1 ? 0 : -1;
  }
  std::unique_ptr<CellSweep> sweep_cells(const Grid& grid, const std::vector<Plane>&, int,
                                         const LeafLevel& leaves) const override {
    return std::make_unique<CellByCell>(*this, grid, leaves, [this](const Index3& cell, SweptCells& found) {
      found.crossed.push_back({cell, moments(cell), {}});
      add_points(cell, {}, 0, found.crossed.back().points);
    });
  }
  /// Points lie on one side of each divider; each divides as it happens to.
  void boundary_points(const Index3& cell, const std::vector<char>& selected, const std::vector<Plane>&, int, int owner,
                       BoundaryPoints& points) const override {
    add_points(cell, selected, owner, points);
  }
  CellEstimate estimate_cells(const Grid& grid, double max_cells) const override {
    return estimate_by_coarse_cells(*this, grid, max_cells);
  }

 private:
  static constexpr int divisions = 8;  ///< of a cell, per direction

  /// Calls use(x, weight) for lines along an axis through a cell: where they enter it, area across.
  template <class Use>
  static void each_line(const Index3& cell, int axis, const Use& use) {
    const GaussRule& rule = gauss_rule(2);
    const int s = (axis + 1) % 3, t = (axis + 2) % 3;
    for (int n = 0; n < 4 * divisions * divisions; ++n) {
      const int i = n % (2 * divisions), j = n / (2 * divisions);
      Vec3 x(cell[0], cell[1], cell[2]);
      x[s] += (i / 2 + rule.node[i % 2]) / divisions;
      x[t] += (j / 2 + rule.node[j % 2]) / divisions;
      use(x, rule.weight[i % 2] * rule.weight[j % 2] / (divisions * divisions));
    }
  }

  Moments moments(const Index3& cell) const {
    Moments result{};
    each_line(cell, 0, [&](const Vec3& x, double weight) {
      double t0 = 0, t1 = 0;
      if (!shape_.meets(x, Vec3::UnitX(), t0, t1)) return;
      constexpr int n = moment_degree + 1;
      double low[n], high[n], ly[n], lz[n];
      legendre_integrals(2 * std::clamp(t0, 0.0, 1.0) - 1, low);
      legendre_integrals(2 * std::clamp(t1, 0.0, 1.0) - 1, high);
      for (int k = 0; k < n; ++k) high[k] -= low[k];
      legendre_values(2 * (x[1] - cell[1]) - 1, ly);
      legendre_values(2 * (x[2] - cell[2]) - 1, lz);
      add_product(result, 4 * weight, high, ly, lz);
    });
    return result;
  }

  /// An area dA is dA |n_k| across axis k; of each axis n_k^2 dA is taken, together dA.
  void add_points(const Index3& cell, const std::vector<char>& selected, int owner, BoundaryPoints& points) const {
    if (!selected.empty() && !selected[0]) return;
    for (int axis = 0; axis < 3; ++axis)
      each_line(cell, axis, [&](const Vec3& x, double weight) {
        double t[2];
        if (!shape_.meets(x, Vec3::Unit(axis), t[0], t[1])) return;
        for (const double each : t) {
          if (each < 0 || each >= 1) continue;
          const Vec3 y = x + each * Vec3::Unit(axis), n = shape_.normal(y);
          points.append(y, n, weight * std::abs(n[axis]), owner, 0);
        }
      });
  }

  EllipsoidShape shape_;
  std::string face_;
};

/// Semi-axes in m along the columns of a rotation.
inline Solid ellipsoid(const Vec3& centre, const Vec3& semi_axes, const Mat3& rotation, const std::string& face) {
  return Solid(std::make_shared<Ellipsoid>(EllipsoidShape{centre, rotation * semi_axes.asDiagonal()}, face));
}

}  // namespace cgcontact::test
