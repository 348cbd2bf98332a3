/// The constrained least-squares fit of one patch: min |M-weighted a - a0| subject to C a = Lambda (paper, equation 3
/// and, with the auxiliary patch, equation 13), by whitening and a truncated pseudo-inverse instead of the KKT matrix.
#pragma once

#include <vector>

#include "recovery/patches.hpp"

namespace cgcontact {

struct ConstrainedFitStatus {
  int rows = 0;
  int truncated = 0;          ///< rows (singular values) dropped by the truncation: redundant or nearly so
  bool inconsistent = false;  ///< data that no polynomial meets: residual above 1 % of the patch's stress level
};

using MassMatrix = Eigen::Matrix<double, num_terms, num_terms>;

/// `mass`: one 4 x 4 matrix per body involved (1 or 2); a: their coefficients (24 each), unconstrained on entry,
/// constrained on return. C: rows x (24 or 48).
ConstrainedFitStatus constrain_fit(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C,
                                   const Eigen::VectorXd& lambda, double rank_tolerance, Eigen::VectorXd& a);

/// Plain reference: dense KKT matrix, solved by a rank-revealing complete orthogonal decomposition (least norm).
void constrain_fit_kkt(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C, const Eigen::VectorXd& lambda,
                       Eigen::VectorXd& a);

}  // namespace cgcontact
