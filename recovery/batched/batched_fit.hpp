/// Constrained least-squares fits of many patches at once, one patch per SIMD lane: the fast path of SPR-C (plain
/// reference: tests/support/constrained_fit.hpp). Per patch: minimise sum_b |L_b^T (a_b - a0_b)|^2, m_b = L_b L_b^T,
/// subject to the interior rows of each body (recovery/patch/polynomials.hpp) and to `rows`, each sum_b weight_b :
/// sigma_b(position_b) = value.
///
/// How to use it, with one or two bodies and polynomials of degree 1 or 2:
///
///   std::vector<FitInput<1, 2>> patches(n);
///   std::vector<FitRow<2>> rows;               // of all patches; patches[i].rows points into it, so fill it first
///   std::vector<FitStatus> status(n);
///   fit_batch(exec, patches.data(), n, tolerance, status.data());
///
/// Some thousand patches at a time fill the lanes well: those that Cholesky's factorisation does not solve go into
/// batches of their own. A patch's result does not depend, to the last bit, on which others it comes with, on their
/// order or on the number of threads. The kernels are in recovery/batched/fit_dispatch.hpp, for any execution space.
#pragma once

#include "recovery/patch/polynomials.hpp"

namespace cgcontact {

/// Linear condition on the stresses at one point per body. Scale does not matter: rows are normalised.
template <int bodies>
struct FitRow {
  double weight[bodies][6];    ///< on xx, yy, zz, xy, yz, zx; zeros for a body that is not in it
  double position[bodies][3];  ///< from the centre of the body's polynomial, cell units
  double value;
};

/// Weights of the traction component e . sigma n. All in the body's grid axes.
inline void traction_weight(const double n[3], const double e[3], double weight[6]) {
  for (int i = 0; i < 3; ++i) {
    weight[i] = n[i] * e[i];
    const int j = (i + 1) % 3;
    weight[3 + i] = n[i] * e[j] + n[j] * e[i];
  }
}

template <int degree, int bodies>
struct FitInput {
  static constexpr int num_terms = Polynomial<degree>::num_terms;
  double mass[bodies][Polynomial<degree>::num_packed];        ///< m: lower triangle by rows, cell units
  double a[bodies][6][num_terms];                             ///< unconstrained on entry, constrained on return
  double interior[bodies][Polynomial<degree>::num_interior];  ///< right-hand sides: Polynomial::interior_values
  double poisson_ratio[bodies];                               ///< degree 2 only
  const FitRow<bodies>* rows;
  int num_rows;
};

struct FitStatus {
  /// False: an input is not finite, too large to be squared, or a mass matrix not (numerically) positive definite; `a`
  /// is left as it was, the other figures are zero.
  bool finite;
  int rows;       ///< all rows, interior ones included
  int truncated;  ///< singular values dropped: redundant rows or nearly so
  /// Largest |value - row a| of the normalised rows after the fit (norm of a row: that of C L^-T), over the patch's
  /// stress level sqrt(sum_b |L_b^T a_b|^2). Rounding if nothing was truncated or the data agree; design: above 0.01
  /// they do not.
  double residual;
};

/// Fits the patches on the threads of an execution space of the host. rank_tolerance: singular values of the normalised
/// rows up to this times the largest one are dropped.
template <class Exec, int degree, int bodies>
void fit_batch(const Exec& exec, FitInput<degree, bodies>* patches, int n, double rank_tolerance, FitStatus* status);

/// Returns the floating-point operations of one fit, from the loops of recovery/batched/batched_fit_kernel.hpp
/// (multiply-add: two).
double fit_flop(int degree, int bodies, int num_rows, bool truncated);

}  // namespace cgcontact
