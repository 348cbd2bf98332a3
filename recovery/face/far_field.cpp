#include "recovery/face/far_field.hpp"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <map>

namespace cgcontact {
namespace {

constexpr int order = 3;  ///< of the derivatives that are to be small
/// What splines that no patch sees are held with, part of what groups weigh.
constexpr double unseen = 1e-10;

/// Values of the four cubic B-splines that are not zero at f in [0, 1] of their knot interval, or a derivative of them.
std::array<double, 4> cubic(double f, int derivative) {
  const double g = 1 - f;
  switch (derivative) {
    case 0:
      return {g * g * g / 6, (3 * f * f * f - 6 * f * f + 4) / 6, (3 * g * g * g - 6 * g * g + 4) / 6, f * f * f / 6};
    case 1:
      return {-g * g / 2, (9 * f * f - 12 * f) / 6, (12 * g - 9 * g * g) / 6, f * f / 2};
    case 2:
      return {g, 3 * f - 2, 3 * g - 2, f};
    default:
      return {-1, 3, -3, 1};
  }
}

/// Knots along one axis: intervals, their length, and which splines are the same behind symmetry planes.
class Knots {
 public:
  Knots(const FaceGrid& grid, int axis, double h) : end_(grid.end[axis]), low_(grid.low[axis]) {
    const double length = grid.size[axis] * grid.spacing[axis];
    count_ = std::max(1, static_cast<int>(end_ == FaceEnd::period ? std::lround(length / h) : std::ceil(length / h)));
    spacing_ = end_ == FaceEnd::period ? length / count_ : h;
  }
  int count() const { return count_; }
  int num_splines() const { return count_ + 3; }
  double spacing() const { return spacing_; }
  int interval(double x) const {
    return std::clamp(static_cast<int>(std::floor((x - low_) / spacing_)), 0, count_ - 1);
  }
  double fraction(double x, int interval) const { return (x - low_) / spacing_ - interval; }
  int spline(int interval, int k) const {
    int j = interval + k;
    if (end_ != FaceEnd::free && j < 1) j = 2 - j;
    if (end_ == FaceEnd::period && j > count_ + 1) j = 2 * count_ + 2 - j;
    return std::clamp(j, 0, num_splines() - 1);
  }

 private:
  FaceEnd end_;
  double low_, spacing_ = 1;
  int count_ = 1;
};

class SplineFit {
 public:
  SplineFit(const FaceGrid& grid, double h) : grid_(grid), knots_{Knots(grid, 0, h), Knots(grid, 1, h)} {
    if (grid.plane_strain) axes_ = 1;
  }
  int num_splines() const { return (axes_ == 1 ? 1 : knots_[0].num_splines()) * knots_[1].num_splines(); }

  /// Splines at a patch and their derivatives there, per knot interval.
  template <class Use>
  void each(int patch, std::array<int, 2> derivative, const Use& use) const {
    const FacePlace x = grid_.centre(patch);
    const int j = knots_[1].interval(x[1]);
    const std::array<double, 4> along = cubic(knots_[1].fraction(x[1], j), derivative[1]);
    if (axes_ == 1) {
      for (int l = 0; l < 4; ++l) use(knots_[1].spline(j, l), along[l]);
      return;
    }
    const int i = knots_[0].interval(x[0]);
    const std::array<double, 4> across = cubic(knots_[0].fraction(x[0], i), derivative[0]);
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l)
        use(knots_[0].spline(i, k) * knots_[1].num_splines() + knots_[1].spline(j, l), across[k] * along[l]);
  }
  int interval(int patch) const {
    const FacePlace x = grid_.centre(patch);
    return (axes_ == 1 ? 0 : knots_[0].interval(x[0])) * knots_[1].count() + knots_[1].interval(x[1]);
  }
  int axes() const { return axes_; }
  double knot_spacing(int axis) const { return knots_[axis].spacing(); }

 private:
  const FaceGrid& grid_;
  std::array<Knots, 2> knots_;
  int axes_ = 2;
};

}  // namespace

std::vector<double> fit_far_field(const FaceGrid& grid, double h, double length, const std::vector<char>& inside,
                                  const std::vector<FarMean>& means) {
  const SplineFit fit(grid, h);
  const int n = fit.num_splines();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  double total = 0;
  for (const FarMean& mean : means) {
    if (!(mean.weight > 0) || mean.patches.empty()) continue;
    std::map<int, double> row;
    for (const auto& [patch, part] : mean.patches)
      fit.each(patch, {0, 0}, [&row, part = part](int j, double value) { row[j] += part * value; });
    for (const auto& [j, a] : row) {
      right[j] += mean.weight * a * mean.value;
      for (const auto& [k, b] : row) entries.emplace_back(j, k, mean.weight * a * b);
    }
    total += mean.weight;
  }
  // Patches of one interval have the same splines: their products are added there first.
  const double area = grid.area() / std::pow(h, fit.axes());
  std::map<int, std::pair<std::vector<int>, Eigen::MatrixXd>> of_interval;
  for (int patch = 0; patch < grid.num_patches(); ++patch) {
    if (!inside[patch]) continue;
    auto& [splines, products] = of_interval[fit.interval(patch)];
    for (int d = fit.axes() == 1 ? 0 : order; d >= 0; --d) {
      const std::array<int, 2> derivative{d, order - d};
      double factor = area * std::pow(length, 2 * order) * (d == 1 || d == 2 ? 3 : 1);
      for (int a = 0; a < 2; ++a) factor *= std::pow(h / fit.knot_spacing(a), 2 * derivative[a]);
      std::vector<int> list;
      std::vector<double> values;
      fit.each(patch, derivative, [&](int j, double value) {
        list.push_back(j);
        values.push_back(value);
      });
      const Eigen::Map<const Eigen::VectorXd> v(values.data(), static_cast<Eigen::Index>(values.size()));
      if (splines.empty()) {
        splines = list;
        products.setZero(v.size(), v.size());
      }
      products += factor * v * v.transpose();
    }
  }
  for (const auto& [interval, sums] : of_interval)
    for (std::size_t j = 0; j < sums.first.size(); ++j)
      for (std::size_t k = 0; k < sums.first.size(); ++k)
        entries.emplace_back(sums.first[j], sums.first[k], sums.second(j, k));
  for (int j = 0; j < n; ++j) entries.emplace_back(j, j, unseen * std::max(total, 1e-300));
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd coefficient = solver.solve(right);
  std::vector<double> field(grid.num_patches(), 0.0);
  for (int patch = 0; patch < grid.num_patches(); ++patch)
    fit.each(patch, {0, 0}, [&](int j, double value) { field[patch] += value * coefficient[j]; });
  return field;
}

}  // namespace cgcontact
