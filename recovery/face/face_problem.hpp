/// Pressure on the patches as a convex problem: of all pressures p >= 0 with the given force the one that minimises
///   1/2 p.S p + p.gap
/// (Kalker's variational form of frictionless contact), by projected conjugate gradients (Polonsky and Keer 1999).
#pragma once

#include "recovery/face/half_space.hpp"

namespace cgcontact {

struct FaceSolution {
  int iterations = 0;
  double change = 0;       ///< of the last iteration: sum of |change of p| over the sum of p
  bool converged = false;  ///< the change fell to the tolerance, or no gap was left to close
};

/// Solves the problem of a face. p: Pa, the start on entry, which may be zero; the solution on return. gap: m, of the
/// faces without these pressures up to a constant; where `seen` is 0 there is no pressure. force: N, in plane strain
/// N/m. Throws InputError if no patch is seen. Results do not depend on the number of threads.
template <class Exec>
FaceSolution solve_face_problem(const Exec& exec, const FaceGrid& grid, const HalfSpace& half_space,
                                const HalfSpace::Patches& gap, const HalfSpace::Marks& seen, double force,
                                double tolerance, int max_iterations, const HalfSpace::Patches& p);

}  // namespace cgcontact
