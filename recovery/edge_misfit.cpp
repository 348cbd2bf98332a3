#include "recovery/edge_misfit.hpp"

namespace cgcontact {

EdgeMisfit::EdgeMisfit(const Side& own, const Side& other, const PatchProblem& problem,
                       const std::vector<PatchRow>& rows, const RealView& u, double rank_tolerance)
    : other_(other.body),
      quadrature_{{*own.body->mesh, own.cells, own.num_cells, problem.fit[0].centre, u},
                  {*other.body->mesh, other.cells, other.num_cells, problem.fit[1].centre, u}} {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 + problem.num_rows, 2 * num_unknowns);
  C.block<3, num_unknowns>(0, 0) = divergence_rows();
  C.block<3, num_unknowns>(3, num_unknowns) = divergence_rows();
  for (int b = 0; b < 2; ++b) {
    factor_[b].compute(problem.fit[b].mass);
    for (int r = 0; r < problem.num_rows; ++r)
      C.block<1, num_unknowns>(6 + r, num_unknowns * b) = full_row(rows[problem.first_row + r], b);
    for (int k = 0; k < 6; ++k) {
      auto columns = C.middleCols<num_terms>(num_unknowns * b + num_terms * k);
      columns = factor_[b].matrixL().solve(columns.transpose()).transpose().eval();
      free_.segment<num_terms>(num_unknowns * b + num_terms * k) =
          factor_[b].matrixL().transpose() * problem.fit[b].a.segment<num_terms>(num_terms * k);
    }
  }
  for (Eigen::Index r = 0; r < C.rows(); ++r)
    if (C.row(r).norm() > 0) C.row(r).normalize();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(C * C.transpose());
  const double threshold = rank_tolerance * rank_tolerance * eigen.eigenvalues().maxCoeff();
  Eigen::Index dropped = 0;
  while (dropped < C.rows() && !(eigen.eigenvalues()[dropped] > threshold)) ++dropped;
  const Eigen::Index rank = C.rows() - dropped;
  basis_ = C.transpose() * eigen.eigenvectors().rightCols(rank) *
           eigen.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  free_ -= basis_ * (basis_.transpose() * free_);
}

/// With the projector Q onto the polynomials that the rows leave, the term's part beside them is W - Q W; its factor is
/// the projection of sigma_h on that.
EdgeFit EdgeMisfit::at(const ContactEdge& own, const ContactEdge& other) const {
  const ContactEdge* edge[2] = {&own, &other};
  Unknowns h;
  double square = 0, product = 0;
  for (int b = 0; b < 2; ++b) {
    const EdgeMoments<1> moments = quadrature_[b].moments(*edge[b]);
    square += moments.square;
    product += moments.with_stress;
    for (int k = 0; k < 6; ++k)
      h.segment<num_terms>(num_unknowns * b + num_terms * k) =
          factor_[b].matrixL().solve(moments.with_polynomials.segment<num_terms>(num_terms * k));
  }
  EdgeFit fit;
  fit.weight = square - h.squaredNorm() + (basis_.transpose() * h).squaredNorm();
  product -= free_.dot(h);
  fit.factor = product / fit.weight;
  fit.misfit = -product * fit.factor;
  return fit;
}

}  // namespace cgcontact
