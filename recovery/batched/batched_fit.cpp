#include "recovery/batched/batched_fit.hpp"

#include "recovery/batched/fit_dispatch.hpp"

namespace cgcontact {

template <class Exec, int degree, int bodies>
void fit_batch(const Exec& exec, FitInput<degree, bodies>* patches, int n, double rank_tolerance, FitStatus* status) {
  dispatch_fits<Vector<double>>(exec, patches, n, rank_tolerance, status);
}

double fit_flop(int degree, int bodies, int num_rows, bool truncated) {
  const double T = degree == 1 ? 4 : 10, interior = degree == 1 ? 3 : 18, B = bodies, m = num_rows;
  const double n = B * interior + m;                                            // all rows
  const double product = degree == 1 ? 6 : 81, entries = degree == 1 ? 9 : 63;  // C a and entries of the interior rows
  const double mass = T * T * T;                                                // factor, its inverse, m^-1: 1/3 each
  const double terms = degree == 1 ? 0 : 6;
  // Terms, whitening, lengths, normalising; then L^-T y and products with the interior rows.
  const double rows = B * (terms + T * T + 2 * T + 12 + 7) + B * (T * T + 2 * product + interior);
  const double pairs = 0.5 * m * (m - 1) * B * (2 * 6 + 2 * T + 2) + B * (entries * 2 * T + interior * product);
  const double bound = 4 * n * n;
  // Residuals before and after, the correction, and what belongs to the bodies there.
  const double apply = m * B * (2 * (terms + 12 * T + 12) + terms + 13 * T);
  const double body = B * (2 * product + 2 * entries + 6 * (2 * T * T + T) + 6 * (T * T + 2 * T));
  // Two Cholesky factors, or one, the tridiagonal form and a quarter of n^2 rotations.
  const double solve = truncated ? 5 * n * n * n / 3 + 12 * n * n : 2 * n * n * n / 3 + 2 * n * n;
  return B * mass + m * rows + pairs + bound + apply + body + solve;
}

#define CGCONTACT_FIT(degree, bodies) \
  template void fit_batch(const Kokkos::DefaultHostExecutionSpace&, FitInput<degree, bodies>*, int, double, FitStatus*);
CGCONTACT_FIT(1, 1)
CGCONTACT_FIT(1, 2)
CGCONTACT_FIT(2, 1)
CGCONTACT_FIT(2, 2)
#undef CGCONTACT_FIT

}  // namespace cgcontact
