#include "core/quadrature/point_compression.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cgcontact {

namespace {

/// Least relative size of a function beside those before it: less is taken for rounding, which would choose the points.
constexpr double rank_tolerance = 1e-8;
constexpr double accuracy = 1e-12;
constexpr double dependent = 1e-11;  // of a function's norm: what is left of it beside the others is rounding
/// Relative difference within which pivots and steps tie: the first one counts, so that rounding (of units, of a turn)
/// does not choose among points of symmetric rules. Rounding of functions that nearly depend on others is large.
constexpr double same_pivot = 1 + 1e-3, same_step = 1 + 1e-6;
constexpr double no_weight = 1e-13;  // of all: where steps tie several weights go at once, up to rounding
using Vector = std::vector<double>;

/// Tableau of all points in terms of a basis of points (as many as independent functions): row i, column p is the
/// weight of the i-th basis point in point p.
class Elimination {
 public:
  Elimination(const FunctionTable& functions, Vector& weights)
      : tableau_(functions),
        weights_(weights),
        num_points_(functions.num_points),
        negligible_(no_weight * std::accumulate(weights.begin(), weights.end(), 0.0)) {}

  /// Chooses a basis (Gauss-Jordan elimination); dependent functions are dropped.
  void choose_basis() {
    in_basis_.assign(num_points_, 0);
    for (int f = 0; f < tableau_.num_functions; ++f) {
      const double* row = tableau_[f];
      int best = 0;
      for (int p = 1; p < num_points_; ++p)
        if (std::abs(row[p]) > same_pivot * std::abs(row[best])) best = p;
      if (!(std::abs(row[best]) > rank_tolerance)) continue;
      const int kept = static_cast<int>(basis_.size());
      if (kept != f) std::copy_n(row, num_points_, tableau_[kept]);
      basis_.push_back(best);
      independent_.push_back(f);
      in_basis_[best] = 1;
      exchange(kept, best, kept + 1, f + 1);
    }
    tableau_.num_functions = static_cast<int>(basis_.size());
  }

  /// Takes the weight from all points outside of the basis, exchanging points of the basis where needed.
  void run() {
    for (int p = 0; p < num_points_; ++p)
      if (!in_basis_[p]) eliminate(p);
  }

  const std::vector<int>& basis() const { return basis_; }
  const std::vector<int>& independent_functions() const { return independent_; }

 private:
  /// Longest step x with weights of the basis + x sign (column p) >= 0; the basis point that reaches zero first.
  double longest_step(int p, double sign, int& leaving) const {
    double step = std::numeric_limits<double>::infinity();
    leaving = -1;
    for (int i = 0; i < tableau_.num_functions; ++i) {
      const double y = tableau_[i][p];
      if (sign * y >= -no_weight) continue;
      const double limit = weights_[basis_[i]] / std::abs(y);
      if (limit * same_step >= step) continue;  // and none below zero: move() keeps them
      step = limit;
      leaving = i;
    }
    return step;
  }

  void eliminate(int p) {
    int leaving = -1, leaving_other = -1;
    double step = longest_step(p, 1, leaving);
    if (weights_[p] <= step + negligible_) {  // the basis takes all of the weight
      move(p, weights_[p]);
      weights_[p] = 0;
      return;
    }
    const double step_other = longest_step(p, -1, leaving_other);
    if (leaving_other >= 0 && std::abs(tableau_[leaving_other][p]) > same_pivot * std::abs(tableau_[leaving][p])) {
      step = -step_other;
      leaving = leaving_other;
    }
    move(p, step);
    weights_[p] -= step;
    weights_[basis_[leaving]] = 0;
    basis_[leaving] = p;
    exchange(leaving, p, tableau_.num_functions, tableau_.num_functions);
  }

  void move(int p, double step) {
    for (int i = 0; i < tableau_.num_functions; ++i) {
      const double weight = weights_[basis_[i]] + step * tableau_[i][p];
      weights_[basis_[i]] = weight > negligible_ ? weight : 0.0;
    }
  }

  /// Point p becomes the `row`-th basis point; updates the rows before `kept` and from `pending` on.
  void exchange(int row, int p, int kept, int pending) {
    double* pivot_row = tableau_[row];
    const double pivot = pivot_row[p];
    for (int q = 0; q < num_points_; ++q) pivot_row[q] /= pivot;
    for (int i = 0; i < tableau_.num_functions; ++i) {
      if (i == row || (i >= kept && i < pending)) continue;
      double* other = tableau_[i];
      const double factor = other[p];
      for (int q = 0; q < num_points_; ++q) other[q] -= factor * pivot_row[q];
    }
  }

  FunctionTable tableau_;
  Vector& weights_;
  const int num_points_;
  const double negligible_;
  std::vector<int> basis_, independent_;
  std::vector<char> in_basis_;
};

/// Factors of a small square matrix (row-major) with partial pivoting.
class DenseSolver {
 public:
  explicit DenseSolver(Vector matrix, int n) : a_(std::move(matrix)), order_(n), n_(n) {
    for (int i = 0; i < n; ++i) order_[i] = i;
    for (int k = 0; k < n; ++k) {
      int best = k;
      for (int i = k + 1; i < n; ++i)
        if (std::abs(at(i, k)) > std::abs(at(best, k))) best = i;
      std::swap(order_[k], order_[best]);
      for (int j = 0; j < n; ++j) std::swap(at(k, j), at(best, j));
      for (int i = k + 1; i < n; ++i) {
        const double factor = at(i, k) /= at(k, k);
        for (int j = k + 1; j < n; ++j) at(i, j) -= factor * at(k, j);
      }
    }
  }

  Vector solve(const Vector& right_side) {
    Vector x(n_);
    for (int i = 0; i < n_; ++i) {
      x[i] = right_side[order_[i]];
      for (int j = 0; j < i; ++j) x[i] -= at(i, j) * x[j];
    }
    for (int i = n_ - 1; i >= 0; --i) {
      for (int j = i + 1; j < n_; ++j) x[i] -= at(i, j) * x[j];
      x[i] /= at(i, i);
    }
    return x;
  }

 private:
  double& at(int i, int j) { return a_[i * n_ + j]; }
  Vector a_;
  std::vector<int> order_;
  int n_;
};

/// Finds weights of the chosen points that reproduce the integrals of the chosen functions; false if these cannot be
/// non-negative.
bool final_weights(const FunctionTable& table, const std::vector<int>& functions, const std::vector<int>& points,
                   const Vector& weights, Vector& solution) {
  const int n = static_cast<int>(points.size());
  Vector matrix(n * n), integrals(n, 0.0), residual;
  double size = 0, error = 0;
  for (int f = 0; f < n; ++f) {
    const double* row = table[functions[f]];
    for (int p = 0; p < table.num_points; ++p) integrals[f] += weights[p] * row[p];
    for (int i = 0; i < n; ++i) matrix[f * n + i] = row[points[i]];
    size = std::max(size, std::abs(integrals[f]));
  }
  DenseSolver solver(matrix, n);
  residual = integrals;
  solution.assign(n, 0.0);
  for (int pass = 0; pass < 2; ++pass) {
    const Vector correction = solver.solve(residual);
    for (int i = 0; i < n; ++i) solution[i] += correction[i];
    if (pass == 1)
      for (double& w : solution) w = std::max(w, 0.0);
    for (int f = 0; f < n; ++f) {
      residual[f] = integrals[f];
      for (int i = 0; i < n; ++i) residual[f] -= matrix[f * n + i] * solution[i];
    }
  }
  for (double r : residual) error = std::max(error, std::abs(r));
  return error <= accuracy * size;
}

/// Functions that span the same, orthogonal with these weights (modified Gram-Schmidt, twice) and at most one; those
/// that depend on the others up to rounding go.
void orthogonalise(FunctionTable& functions, const Vector& weights) {
  const int n = functions.num_points;
  const auto product = [&](const double* a, const double* b) {
    double sum = 0;
    for (int p = 0; p < n; ++p) sum += weights[p] * a[p] * b[p];
    return sum;
  };
  int kept = 0;
  for (int f = 0; f < functions.num_functions; ++f) {
    double* const row = functions[kept];
    if (kept != f) std::copy_n(functions[f], n, row);
    const double before = product(row, row);
    for (int pass = 0; pass < 2; ++pass)
      for (int g = 0; g < kept; ++g) {
        const double* const other = functions[g];
        const double factor = product(row, other) / product(other, other);
        for (int p = 0; p < n; ++p) row[p] -= factor * other[p];
      }
    if (!(product(row, row) > dependent * dependent * before)) continue;
    double largest = 0;
    for (int p = 0; p < n; ++p) largest = std::max(largest, std::abs(row[p]));
    for (int p = 0; p < n; ++p) row[p] /= largest;
    ++kept;
  }
  functions.num_functions = kept;
}

}  // namespace

void compress_weights(const FunctionTable& functions, std::vector<double>& weights) {
  Vector trial = weights, solution;
  Elimination elimination(functions, trial);
  elimination.choose_basis();
  const std::vector<int>& basis = elimination.basis();
  if (basis.size() >= weights.size()) return;
  elimination.run();
  if (!final_weights(functions, elimination.independent_functions(), basis, weights, solution)) return;
  std::fill(weights.begin(), weights.end(), 0.0);
  for (std::size_t i = 0; i < basis.size(); ++i) weights[basis[i]] = solution[i];
}

void compress_many_weights(FunctionTable functions, std::vector<double>& weights) {
  orthogonalise(functions, weights);
  const std::size_t n = weights.size(), batch = 2 * static_cast<std::size_t>(functions.num_functions);
  // Batches are from all over: the functions nearly depend on each other at adjacent points.
  const std::size_t stride = 1 + n / batch;
  std::vector<int> order;
  for (std::size_t first = 0; first < stride; ++first)
    for (std::size_t p = first; p < n; p += stride) order.push_back(static_cast<int>(p));
  std::vector<int> chosen;
  FunctionTable table;
  Vector chosen_weights;
  for (std::size_t next = 0; next < n;) {
    while (next < n && chosen.size() < batch) chosen.push_back(order[next++]);
    table.resize(functions.num_functions, static_cast<int>(chosen.size()));
    chosen_weights.resize(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen_weights[i] = weights[chosen[i]];
    for (int f = 0; f < functions.num_functions; ++f)
      for (std::size_t i = 0; i < chosen.size(); ++i) table[f][i] = functions[f][chosen[i]];
    compress_weights(table, chosen_weights);
    std::vector<int> left;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      weights[chosen[i]] = chosen_weights[i];
      if (chosen_weights[i] > 0) left.push_back(chosen[i]);
    }
    if (left.size() >= batch) left.clear();  // not to rounding accuracy: these stay as they are
    chosen.swap(left);
  }
}

/// The least change in the sense of sum (change^2 / weight): weights times a combination of the functions, by
/// Cholesky's factors of their products.
bool take_integrals(const FunctionTable& functions, const std::vector<double>& others, std::vector<double>& weights) {
  constexpr double min_pivot = 1e-8;    // of a function's square: what is left of it beside the others is rounding
  constexpr double good_enough = 1e-6;  // of the largest integral: functions that nearly depend on others
  const int m = functions.num_functions, n = static_cast<int>(weights.size()), all = functions.num_points;
  Vector wanted(m, 0.0), factor(static_cast<std::size_t>(m) * m, 0.0), trial = weights;
  double size = 0;
  for (int f = 0; f < m; ++f) {
    for (int p = n; p < all; ++p) wanted[f] += others[p - n] * functions[f][p];
    size = std::max(size, std::abs(wanted[f]));
  }
  std::vector<char> independent(m, 1);
  Vector row(n);
  for (int f = 0; f < m; ++f) {
    double* const own = &factor[static_cast<std::size_t>(f) * m];
    for (int p = 0; p < n; ++p) row[p] = weights[p] * functions[f][p];
    for (int g = 0; g <= f; ++g) {
      const double* const other = functions[g];
      for (int p = 0; p < n; ++p) own[g] += row[p] * other[p];
    }
    const double square = own[f];
    for (int g = 0; g < f; ++g) {
      if (!independent[g]) {
        own[g] = 0;
        continue;
      }
      const double* const before = &factor[static_cast<std::size_t>(g) * m];
      for (int k = 0; k < g; ++k) own[g] -= own[k] * before[k];
      own[g] /= before[g];
      own[f] -= own[g] * own[g];
    }
    independent[f] = own[f] > min_pivot * square;
    own[f] = independent[f] ? std::sqrt(own[f]) : 1;
  }
  double error = 0;
  Vector missing(m);
  for (int pass = 0; pass < 4; ++pass) {
    error = 0;
    for (int f = 0; f < m; ++f) {
      missing[f] = wanted[f];
      for (int p = 0; p < n; ++p) missing[f] -= trial[p] * functions[f][p];
      error = std::max(error, std::abs(missing[f]));
    }
    if (pass == 3 || error <= accuracy * size) break;
    for (int f = 0; f < m; ++f) {
      for (int g = 0; g < f; ++g) missing[f] -= factor[static_cast<std::size_t>(f) * m + g] * missing[g];
      missing[f] = independent[f] ? missing[f] / factor[static_cast<std::size_t>(f) * m + f] : 0;
    }
    for (int f = m - 1; f >= 0; --f) {
      for (int g = f + 1; g < m; ++g) missing[f] -= factor[static_cast<std::size_t>(g) * m + f] * missing[g];
      missing[f] = independent[f] ? missing[f] / factor[static_cast<std::size_t>(f) * m + f] : 0;
    }
    for (int f = 0; f < m; ++f)
      for (int p = 0; p < n; ++p) trial[p] += missing[f] * weights[p] * functions[f][p];
  }
  if (!(error <= good_enough * size) || std::any_of(trial.begin(), trial.end(), [](double w) { return !(w > 0); }))
    return false;
  weights = trial;
  return true;
}

FunctionTable surface_polynomials(std::vector<double> (&points)[3], int degree, bool curved) {
  const int n = static_cast<int>(points[0].size());
  double wider = 0;  // of s and t
  for (Vector& x : points) {
    const auto [min, max] = std::minmax_element(x.begin(), x.end());
    const double centre = 0.5 * (*min + *max), size = 0.5 * (*max - *min);
    // Heights are measured by the extent along the face: those beside the polynomials of a nearly flat face are
    // rounding.
    const double unit = &x == &points[2] ? std::max(size, wider) : size;
    wider = std::max(wider, size);
    for (double& value : x) value = (value - centre) * (unit > 0 ? 1 / unit : 1.0);
  }
  const int plane = (degree + 1) * (degree + 2) / 2;
  FunctionTable table;
  table.resize(plane + (curved ? degree * (degree + 1) / 2 : 0), n);
  auto multiply = [&](int target, int source, int variable) {
    for (int p = 0; p < n; ++p) table[target][p] = table[source][p] * points[variable][p];
  };
  std::fill_n(table[0], n, 1.0);
  int f = 1;
  for (int total = 1; total <= degree; ++total)  // s^total, s^(total-1) t, ..., t^total
    for (int j = 0; j <= total; ++j, ++f) multiply(f, j < total ? f - total : f - total - 1, j < total ? 0 : 1);
  for (int low = 0; f < table.num_functions; ++low, ++f) multiply(f, low, 2);
  return table;
}

}  // namespace cgcontact
