/// How well polynomials and the square-root term of a contact edge fit sigma_h in one patch and its auxiliary patch, as
/// a function of where the edge runs.
#pragma once

#include "recovery/edge_moments.hpp"
#include "recovery/patch_assembly.hpp"

namespace cgcontact {

struct EdgeFit {
  double misfit = 0;  ///< square of the L2 misfit, less what it is without the term
  double factor = 0;  ///< of the term that fits best
  double weight = 0;  ///< square of the part of the term that polynomials do not carry
};

class EdgeMisfit {
 public:
  struct Side {
    const RecoveryBody* body;
    const int* cells;
    int num_cells;
  };
  /// `problem`: from PatchAssembly::assemble_at_edge, with an auxiliary patch.
  EdgeMisfit(const Side& own, const Side& other, const PatchProblem& problem, const std::vector<PatchRow>& rows,
             const RealView& u, double rank_tolerance);

  /// The edge seen from both bodies, in one unit of length.
  EdgeFit at(const ContactEdge& own, const ContactEdge& other) const;
  const RecoveryBody& other() const { return *other_; }

 private:
  static constexpr int num_unknowns = 6 * num_terms;
  using Unknowns = Eigen::Matrix<double, 2 * num_unknowns, 1>;

  const RecoveryBody* other_;
  EdgeQuadrature<1> quadrature_[2];
  Eigen::LLT<Eigen::Matrix<double, num_terms, num_terms>> factor_[2];
  Eigen::Matrix<double, 2 * num_unknowns, Eigen::Dynamic> basis_;  ///< orthonormal, of the whitened rows that count
  Unknowns free_;                                                  ///< whitened polynomials of sigma_h, without them
};

}  // namespace cgcontact
