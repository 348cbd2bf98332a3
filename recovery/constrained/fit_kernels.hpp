/// The fits of patches before constraints, from integrals over cells straight into the input of the batched fits
/// (recovery/batched/batched_fit.hpp). For any Kokkos execution space; all arrays in memory that it reaches.
#pragma once

#include "recovery/batched/batched_fit.hpp"
#include "recovery/patch/flat_lists.hpp"
#include "recovery/spr/sum_kernels.hpp"

namespace cgcontact {

/// Least fraction of its diagonal entry that a pivot of the mass matrix of a linear polynomial must keep.
constexpr double min_linear_pivot = 1e-14;

/// Least fraction of its square that every term of a quadratic polynomial must keep when the terms before it are taken
/// out: a plate 0.4 cells thick beside the node has 1e-3.
constexpr double min_quadratic_pivot = 1e-3;

/// Fraction of the square of a stress that rounding may leave of a good fit.
constexpr double min_misfit = 1e-8;

/// Centres, units and cells of the polynomials of some patches, by patch.
template <class Memory>
struct FitCells {
  template <class T>
  using Array = Kokkos::View<T, Kokkos::LayoutRight, Memory>;
  Array<const double* [3]> centre;  ///< grid coordinates
  Array<const double*> unit;        ///< grid coordinates
  Array<const int*> begin, cells;

  KOKKOS_FORCEINLINE_FUNCTION const int* list(int patch) const { return cells.data() + begin(patch); }
  KOKKOS_FORCEINLINE_FUNCTION int count(int patch) const { return begin(patch + 1) - begin(patch); }
};

/// Returns those on the host: the lists themselves.
inline FitCells<Kokkos::HostSpace> host_arrays(const std::vector<Vec3>& centre, const std::vector<double>& unit,
                                               const FlatLists<int>& cells) {
  using Cells = FitCells<Kokkos::HostSpace>;
  return {rows_of<decltype(Cells::centre)>(centre), view_of<decltype(Cells::unit)>(unit),
          view_of<decltype(Cells::begin)>(cells.begin), view_of<decltype(Cells::cells)>(cells.items)};
}

/// Patches of one class, entry by entry.
template <class Memory, int degree, int bodies>
struct ClassArrays {
  template <class T>
  using Array = Kokkos::View<T, Kokkos::LayoutRight, Memory>;
  Array<const int*> patch;  ///< in the lists that the class is of
  Array<FitInput<degree, bodies>*> inputs;
  Array<char* [2]> regular;     ///< whether the cells carry the polynomial of the body, the auxiliary one
  Array<double* [2]> variance;  ///< mean square of what these leave of sigma_h; 0: not known
};

/// Computes the mass matrix (lower triangle by rows) of the cells that were summed, and the coefficients (component,
/// term) of the polynomials nearest to their stress. variance: mean square of what those leave of it, at least that of
/// rounding. False, without coefficients, if the cells do not carry the polynomial.
template <int degree>
KOKKOS_INLINE_FUNCTION bool fit_polynomial(const CellSums& sums, double* mass, double* a, double& variance) {
  constexpr int T = Polynomial<degree>::num_terms;
  constexpr double min_pivot = degree == 1 ? min_linear_pivot : min_quadratic_pivot;
  double factor[T][T];
  for (int i = 0, entry = 0; i < T; ++i)
    for (int j = 0; j <= i; ++j) mass[entry++] = factor[i][j] = sums.moments[index_of_product(i, j)];
  for (int i = 0; i < T; ++i) {
    const double own = factor[i][i];
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k) factor[i][j] -= factor[i][k] * factor[j][k];
      factor[i][j] /= factor[j][j];
      factor[i][i] -= factor[i][j] * factor[i][j];
    }
    if (!(factor[i][i] > min_pivot * own)) return false;
    factor[i][i] = sqrt(factor[i][i]);
  }
  double fitted = 0;
  for (int k = 0; k < 6; ++k) {
    double* x = a + T * k;
    for (int i = 0; i < T; ++i) {
      x[i] = sums.stress[i][k];
      for (int j = 0; j < i; ++j) x[i] -= factor[i][j] * x[j];
      x[i] /= factor[i][i];
      fitted += x[i] * x[i];
    }
    for (int i = T - 1; i >= 0; --i) {
      for (int j = i + 1; j < T; ++j) x[i] -= factor[j][i] * x[j];
      x[i] /= factor[i][i];
    }
  }
  const double misfit = sums.square - fitted, rounding = min_misfit * sums.square;
  variance = (misfit > rounding ? misfit : rounding) / sums.moments[0];
  return true;
}

/// Fits over the cells of `of`, those of the body (b = 0) or of the auxiliary patches (1), of some entries of a class.
template <class Exec, class Memory, int degree, int bodies>
void fit_sums(const Exec& exec, const IntegralArrays<Memory>& integrals, const FitCells<Memory>& of,
              const SubsetArrays<Memory>& entries, int b, const ClassArrays<Memory, degree, bodies>& fits) {
  using Policy = Kokkos::RangePolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>;
  Kokkos::parallel_for(
      "cgcontact::fit_kernels::sums", Policy(exec, 0, entries.size, Kokkos::ChunkSize(16)), KOKKOS_LAMBDA(const int e) {
        const int entry = entries.number(e), i = fits.patch(entry);
        const double centre[3] = {of.centre(i, 0), of.centre(i, 1), of.centre(i, 2)};
        FitInput<degree, bodies>& input = fits.inputs(entry);
        const CellSums sums = integrals.sum(of.list(i), of.count(i), centre, of.unit(i));
        fits.regular(entry, b) = fit_polynomial<degree>(sums, input.mass[b], input.a[b][0], fits.variance(entry, b));
      });
}

/// Masses of linear polynomials of the body; the coefficients are those of the plain fit: values(row of node,
/// component, term). node: of each patch.
template <class Exec, class Memory, int bodies, class Values>
void take_plain_fits(const Exec& exec, const PatchArrays<Memory>& body, const FitCells<Memory>& of,
                     const Kokkos::View<const int*, Kokkos::LayoutRight, Memory>& node,
                     const SubsetArrays<Memory>& rows, const Values& values,
                     const ClassArrays<Memory, 1, bodies>& fits) {
  Kokkos::parallel_for(
      "cgcontact::fit_kernels::plain", Kokkos::RangePolicy<Exec>(exec, 0, fits.inputs.extent(0)),
      KOKKOS_LAMBDA(const int entry) {
        const int i = fits.patch(entry), n = node(i), row = rows.row(n);
        FitInput<1, bodies>& input = fits.inputs(entry);
        double centre[3], m[num_terms][num_terms];
        for (int d = 0; d < 3; ++d) centre[d] = of.centre(i, d) / of.unit(i);
        gather_mass(body, of.list(i), of.count(i), centre, m, body.level_of(n));
        for (int s = 0, at = 0; s < num_terms; ++s)
          for (int t = 0; t <= s; ++t) input.mass[0][at++] = m[s][t];
        for (int k = 0; k < 6; ++k)
          for (int t = 0; t < num_terms; ++t) input.a[0][k][t] = values(row, k, t);
        fits.regular(entry, 0) = cholesky(m);
        fits.variance(entry, 0) = 0;
      });
}

/// Variances of the plain fits of coupled patches.
template <class Exec, class Memory>
void find_plain_variances(const Exec& exec, const IntegralArrays<Memory>& integrals, const FitCells<Memory>& of,
                          const ClassArrays<Memory, 1, 2>& fits) {
  Kokkos::parallel_for(
      "cgcontact::fit_kernels::variances", Kokkos::RangePolicy<Exec>(exec, 0, fits.inputs.extent(0)),
      KOKKOS_LAMBDA(const int entry) {
        const int i = fits.patch(entry);
        const FitInput<1, 2>& input = fits.inputs(entry);
        double square = 0, volume = 0, fitted = 0;
        for (int c = 0; c < of.count(i); ++c) {
          const int cell = of.list(i)[c];
          if (!integrals.hold(cell)) return;
          square += integrals.square(integrals.subset.row(cell));
          volume += integrals.volume(cell);
        }
        for (int k = 0; k < 6; ++k)
          for (int s = 0, at = 0; s < num_terms; ++s)
            for (int t = 0; t <= s; ++t, ++at)
              fitted += (s == t ? 1 : 2) * input.mass[0][at] * input.a[0][k][s] * input.a[0][k][t];
        const double misfit = square - fitted, rounding = min_misfit * square;
        fits.variance(entry, 0) = (misfit > rounding ? misfit : rounding) / volume;
      });
}

/// Weighs the misfit of the auxiliary body with the inverse variances: a body whose stress the polynomials follow well
/// is not spoilt by the other one (docs/recovery.md).
template <class Exec, class Memory, int degree>
void weigh_auxiliary(const Exec& exec, double max_weight, const ClassArrays<Memory, degree, 2>& fits) {
  Kokkos::parallel_for(
      "cgcontact::fit_kernels::weigh", Kokkos::RangePolicy<Exec>(exec, 0, fits.inputs.extent(0)),
      KOKKOS_LAMBDA(const int entry) {
        const double own = fits.variance(entry, 0), other = fits.variance(entry, 1);
        if (!(own > 0 && other > 0)) return;
        double weight = own / other;
        weight = weight > max_weight ? max_weight : weight < 1 / max_weight ? 1 / max_weight : weight;
        for (double& m : fits.inputs(entry).mass[1]) m *= weight;
      });
}

}  // namespace cgcontact
