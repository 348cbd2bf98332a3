/// The constrained least-squares fit of one patch: min |M-weighted a - a0| subject to C a = Lambda (paper, equation 3
/// and, with the auxiliary patch, equation 13), by whitening and a truncated pseudo-inverse instead of the KKT matrix.
/// The plain reference of recovery/batched/batched_fit.hpp.
#pragma once

#include <vector>

#include "recovery/patch/patches.hpp"

namespace cgcontact::test {

struct ConstrainedFitStatus {
  int rows = 0;
  int truncated = 0;          ///< rows (singular values) dropped by the truncation: redundant or nearly so
  bool inconsistent = false;  ///< data that no polynomial meets: residual above 1 % of the patch's stress level
};

using MassMatrix = Eigen::Matrix<double, num_terms, num_terms>;

/// Number of 4-term blocks: six components per body.
constexpr int num_components = 6;

/// Component of (i, j) of a symmetric tensor: xx, yy, zz, xy, yz, zx.
constexpr int component_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// Traction R(n) P(d): row of the component along e of sigma n, at offset d from the polynomial's centre, on the
/// coefficients of linear polynomials (component, term).
Eigen::Matrix<double, 1, 6 * num_terms> traction_row(const Vec3& d, const Vec3& n, const Vec3& e);

/// Divergence rows (equation 4): row i is (div sigma)_i per cell unit; constant for linear polynomials.
Eigen::Matrix<double, 3, 6 * num_terms> divergence_rows();

/// `mass`: one 4 x 4 matrix per body involved (1 or 2); a: their coefficients (24 each), unconstrained on entry,
/// constrained on return. C: rows x (24 or 48).
ConstrainedFitStatus constrain_fit(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C,
                                   const Eigen::VectorXd& lambda, double rank_tolerance, Eigen::VectorXd& a);

/// Plain reference: dense KKT matrix, solved by a rank-revealing complete orthogonal decomposition (least norm).
void constrain_fit_kkt(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C, const Eigen::VectorXd& lambda,
                       Eigen::VectorXd& a);

}  // namespace cgcontact::test
