/// Legendre moments of the body in cells: basis, changes of cell, weights of Gauss points. Cell coordinates in
/// [-1,1]^3.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Highest degree per variable of the stored moments: 2 p for the stiffness of Q1, 4 for the energy of
/// (conjoint sigma* - sigma_h), which is of degree 2 per variable.
constexpr int moment_degree = 4;
/// Number of Legendre polynomials per variable.
constexpr int num_legendre = moment_degree + 1;
constexpr int num_moments = num_legendre * num_legendre * num_legendre;
/// Moments of L_i(x) L_j(y) L_k(z) (Legendre polynomials, cell coordinates in [-1,1]^3, so a full cell has
/// moment[0] = 8) over cell and body; index (i * (moment_degree+1) + j) * (moment_degree+1) + k.
using Moments = std::array<double, num_moments>;

/// Moments of cells in turn. Copies, slices and choices share what they stand for until one of them is changed.
class MomentList {
 public:
  class Iterator {
   public:
    Iterator(const MomentList& list, std::size_t i) : list_(list), i_(i) {}
    const Moments& operator*() const { return list_[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return i_ != other.i_; }

   private:
    const MomentList& list_;
    std::size_t i_;
  };

  MomentList() = default;
  explicit MomentList(std::vector<Moments> moments)
      : all_(std::make_shared<std::vector<Moments>>(std::move(moments))), size_(all_->size()) {}
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Moments& operator[](std::size_t i) const { return (*all_)[slot(i)]; }
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size_}; }
  MomentList slice(std::size_t first, std::size_t size) const {
    MomentList result = *this;
    if (chosen_)
      result.chosen_ =
          std::make_shared<const std::vector<int>>(chosen_->begin() + first, chosen_->begin() + first + size);
    else
      result.first_ += first;
    result.size_ = size;
    return result;
  }
  /// Selects those with these numbers.
  MomentList chosen(std::vector<int> numbers) const {
    for (int& number : numbers) number = static_cast<int>(slot(number));
    MomentList result;
    result.all_ = all_;
    result.size_ = numbers.size();
    result.chosen_ = std::make_shared<const std::vector<int>>(std::move(numbers));
    return result;
  }

  Moments& operator[](std::size_t i) { return own()[i]; }
  void push_back(const Moments& moments) {
    own().push_back(moments);
    ++size_;
  }
  void reserve(std::size_t size) { own().reserve(size); }
  void resize(std::size_t size) {
    own().resize(size);
    size_ = size;
  }

 private:
  std::size_t slot(std::size_t i) const { return chosen_ ? (*chosen_)[i] : first_ + i; }
  std::vector<Moments>& own() {
    if (!all_) all_ = std::make_shared<std::vector<Moments>>();
    if (all_.use_count() > 1 || size_ != all_->size() || chosen_) {
      std::vector<Moments> copy;
      copy.reserve(size_);
      for (const Moments& moments : *this) copy.push_back(moments);
      *this = MomentList(std::move(copy));
    }
    return *all_;
  }

  std::shared_ptr<std::vector<Moments>> all_;
  std::size_t first_ = 0, size_ = 0;
  std::shared_ptr<const std::vector<int>> chosen_;  ///< numbers in all_; none: those from first_ on
};

/// Computes L_0 .. L_4 at x.
inline void legendre_values(double x, double value[moment_degree + 1]) {
  value[0] = 1;
  value[1] = x;
  for (int k = 2; k <= moment_degree; ++k) value[k] = ((2 * k - 1) * x * value[k - 1] - (k - 1) * value[k - 2]) / k;
}

/// Integrals of L_0 .. L_4 from -1 to x.
inline void legendre_integrals(double x, double value[moment_degree + 1]) {
  double l[moment_degree + 2] = {1, x};
  for (int k = 2; k <= moment_degree + 1; ++k) l[k] = ((2 * k - 1) * x * l[k - 1] - (k - 1) * l[k - 2]) / k;
  value[0] = x + 1;
  for (int k = 1; k <= moment_degree; ++k) value[k] = (l[k + 1] - l[k - 1]) / (2 * k + 1);
}

/// Adds weight a_i b_j c_k to the moments.
inline void add_product(Moments& moments, double weight, const double* a, const double* b, const double* c) {
  constexpr int n = moment_degree + 1;
  double bc[n * n];
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < n; ++k) bc[j * n + k] = weight * b[j] * c[k];
  for (int i = 0; i < n; ++i)
    for (int q = 0; q < n * n; ++q) moments[i * n * n + q] += a[i] * bc[q];
}

/// Expresses the integrals in the coordinates of another cell: the old cell lies `offset` cells further (the old centre
/// has the coordinates 2 offset).
Moments shifted_moments(const Moments& moments, const Index3& offset);

/// Weights on the 27 or 125 Gauss points of the cell (n = 3 or 5 per direction, x slowest: q = (a * n + b) * n + c)
/// that integrate all products of polynomials of degree < n per variable exactly; closed form from the moments.
/// The weights of a full cell sum to 8.
void fitted_weights(const Moments& moments, int n, double* weights);

/// Sums the moments of the cell of twice the size from those of its children, re-centred; children[a + 2 b + 4 c] is
/// the child at offset (a, b, c), nullptr if it is empty. A full child is given by full_cell_moments().
Moments coarse_moments(const std::array<const Moments*, 8>& children);
const Moments& full_cell_moments();

}  // namespace cgcontact
