#include "recovery/face/far_field.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cgcontact {
namespace {

constexpr int order = 3;  ///< of the derivatives that are to be small
/// Fraction of the groups' weight that holds splines which no patch sees.
constexpr double unseen = 1e-10;
/// Halvings of the range in which the length of the details is sought: to a hundredth of a cell.
constexpr int range_halvings = 7;

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
    const double length = grid.size[axis] * grid.spacing[axis], intervals = length / h;
    count_ =
        std::max(1, static_cast<int>(end_ == FaceEnd::period ? std::lround(intervals) : std::ceil(intervals - 1e-9)));
    spacing_ = end_ == FaceEnd::period ? length / count_ : h;
    if (end_ == FaceEnd::free) low_ -= (count_ * spacing_ - length) / 2;
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

/// Integrals over a knot interval of products of two of its splines' derivatives, of the same order: Gauss' rule of
/// four points is exact.
Eigen::Matrix4d products_on_interval(int derivative) {
  constexpr std::array<double, 2> point{0.861136311594052575, 0.339981043584856265},
      weight{0.347854845137453857, 0.652145154862546143};
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (int k = 0; k < 2; ++k)
    for (const int side : {-1, 1}) {
      const auto values = cubic((1 + side * point[k]) / 2, derivative);
      const Eigen::Map<const Eigen::Vector4d> v(values.data());
      sum += weight[k] / 2 * v * v.transpose();
    }
  return sum;
}

/// Products of cubic splines along both axes of the face; in plane strain along axis 1 alone.
class FaceSplines {
 public:
  FaceSplines(const FaceGrid& grid, double h) : grid_(grid), knots_{Knots(grid, 0, h), Knots(grid, 1, h)} {
    if (grid.plane_strain) axes_ = 1;
  }
  int count() const { return (axes_ == 1 ? 1 : knots_[0].num_splines()) * knots_[1].num_splines(); }
  int num_intervals() const { return (axes_ == 1 ? 1 : knots_[0].count()) * knots_[1].count(); }

  /// Calls use(spline, value) for the splines that are not zero at a patch.
  template <class Use>
  void each(int patch, const Use& use) const {
    const FacePosition x = grid_.centre(patch);
    const int j = knots_[1].interval(x[1]);
    const std::array<double, 4> along = cubic(knots_[1].fraction(x[1], j), 0);
    if (axes_ == 1) {
      for (int l = 0; l < 4; ++l) use(knots_[1].spline(j, l), along[l]);
      return;
    }
    const int i = knots_[0].interval(x[0]);
    const std::array<double, 4> across = cubic(knots_[0].fraction(x[0], i), 0);
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) use(spline(i, j, k, l), across[k] * along[l]);
  }
  int interval(int patch) const {
    const FacePosition x = grid_.centre(patch);
    return (axes_ == 1 ? 0 : knots_[0].interval(x[0])) * knots_[1].count() + knots_[1].interval(x[1]);
  }

  /// Adds the integral of |D^3 r|^2 over a fraction of each interval to `entries`, in units of h.
  void add_bending(double h, const std::vector<double>& fractions, std::vector<Eigen::Triplet<double>>& entries) const {
    std::array<Eigen::Matrix4d, order + 1> along, across;
    for (int d = 0; d <= order; ++d) {
      across[d] = products_on_interval(d) * scale(0, h, d);
      along[d] = products_on_interval(d) * scale(1, h, d);
    }
    for (int interval = 0; interval < num_intervals(); ++interval) {
      if (!(fractions[interval] > 0)) continue;
      const int i = interval / knots_[1].count(), j = interval % knots_[1].count();
      if (axes_ == 1) {
        for (int l = 0; l < 4; ++l)
          for (int m = 0; m < 4; ++m)
            entries.emplace_back(knots_[1].spline(j, l), knots_[1].spline(j, m),
                                 fractions[interval] * along[order](l, m));
        continue;
      }
      for (int k = 0; k < 16; ++k)
        for (int l = 0; l < 16; ++l) {
          double sum = 0;
          for (int d = 0; d <= order; ++d)
            sum += (d == 0 || d == order ? 1 : order) * across[d](k / 4, l / 4) * along[order - d](k % 4, l % 4);
          entries.emplace_back(spline(i, j, k / 4, k % 4), spline(i, j, l / 4, l % 4), fractions[interval] * sum);
        }
    }
  }
  /// Area of an interval, m^2; in plane strain m.
  double interval_area() const { return (axes_ == 1 ? 1 : knots_[0].spacing()) * knots_[1].spacing(); }

 private:
  int spline(int i, int j, int k, int l) const {
    return knots_[0].spline(i, k) * knots_[1].num_splines() + knots_[1].spline(j, l);
  }
  /// Gives the factor of an integral along an axis from knot intervals to lengths in h.
  double scale(int axis, double h, int derivative) const {
    return std::pow(knots_[axis].spacing() / h, 1 - 2 * derivative);
  }

  const FaceGrid& grid_;
  std::array<Knots, 2> knots_;
  int axes_ = 2;
};

Eigen::SparseMatrix<double> matrix_of(int size, const std::vector<Eigen::Triplet<double>>& entries) {
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

FarField::FarField(const FaceGrid& grid, double h, const std::vector<char>& inside, const std::vector<FarMean>& means)
    : grid_(grid), h_(h), values_(means.size()), weights_(means.size()) {
  const FaceSplines splines(grid, h);
  std::vector<Eigen::Triplet<double>> entries;
  double total = 0;
  for (std::size_t m = 0; m < means.size(); ++m) {
    const FarMean& mean = means[m];
    const auto row = static_cast<Eigen::Index>(m);
    const double weight = mean.patches.empty() ? 0 : mean.weight;
    weights_[row] = weight / (mean.error * mean.error);
    values_[row] = mean.value;
    total += weight;
    std::map<int, double> of_spline;
    for (const auto& [patch, fraction] : mean.patches)
      splines.each(patch, [&of_spline, fraction = fraction](int j, double value) { of_spline[j] += fraction * value; });
    for (const auto& [j, value] : of_spline) entries.emplace_back(static_cast<int>(m), j, value);
  }
  const double square = total > 0 ? total / weights_.sum() : 0;
  weights_ *= square;
  allowed_ = square * total;
  rows_.resize(static_cast<Eigen::Index>(means.size()), splines.count());
  rows_.setFromTriplets(entries.begin(), entries.end());
  known_ = rows_.transpose() * weights_.asDiagonal() * rows_;
  std::vector<double> fractions(splines.num_intervals(), 0.0);
  for (int patch = 0; patch < grid.num_patches(); ++patch)
    if (inside[patch]) fractions[splines.interval(patch)] += grid.area() / splines.interval_area();
  entries.clear();
  splines.add_bending(h, fractions, entries);
  for (int j = 0; j < splines.count(); ++j) entries.emplace_back(j, j, 0.0);
  bent_ = matrix_of(splines.count(), entries);
}

Eigen::VectorXd FarField::coefficients(double length) const {
  Eigen::SparseMatrix<double> matrix = known_ + std::pow(length, 2 * order) * bent_;
  const double held = unseen * std::max(weights_.sum(), 1e-300);
  for (Eigen::Index j = 0; j < matrix.rows(); ++j) matrix.coeffRef(j, j) += held;
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(rows_.transpose() *
                                                                          weights_.cwiseProduct(values_));
}

std::vector<double> FarField::with_details(double length) const {
  const FaceSplines splines(grid_, h_);
  const Eigen::VectorXd coefficient = coefficients(length);
  std::vector<double> field(grid_.num_patches(), 0.0);
  for (int patch = 0; patch < grid_.num_patches(); ++patch)
    splines.each(patch, [&](int j, double value) { field[patch] += value * coefficient[j]; });
  return field;
}

double FarField::longest_details(double shortest, double longest) const {
  const auto meets = [&](double length) {
    return (rows_ * coefficients(length) - values_).cwiseAbs2().dot(weights_) <= allowed_;
  };
  if (meets(longest)) return longest;
  double low = shortest, high = longest;
  for (int k = 0; k < range_halvings; ++k) (meets((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

}  // namespace cgcontact
