#include "recovery/face/half_space.hpp"

#include <cmath>

namespace cgcontact {
namespace {

constexpr double pi = 3.14159265358979323846;
/// Periods that are summed one by one at each end.
constexpr int num_periods = 12;

/// Neighbouring patches of a row that are summed side by side; the table is longer by as many, for the last ones.
constexpr int block = 16;

/// Integral of 1/r over the rectangle |xi| < a, |eta| < b seen from (x, y), m.
double rectangle(double x, double y, double a, double b) {
  const auto part = [](double u, double above, double below) {
    return u == 0 ? 0.0 : u * std::log((above + std::hypot(above, u)) / (below + std::hypot(below, u)));
  };
  x = std::abs(x);
  y = std::abs(y);
  return part(x + a, y + b, y - b) + part(y + b, x + a, x - a) - part(x - a, y + b, y - b) - part(y - b, x + a, x - a);
}

/// Minus twice the integral of ln|x - xi| over |xi| < a, m.
double strip(double x, double a) {
  const auto f = [](double t) { return t == 0 ? 0.0 : t * std::log(std::abs(t)) - t; };
  return -2 * (f(x + a) - f(x - a));
}

/// Sums the integrals at the offset (x, y) and all its periods, less what is the same everywhere.
double with_periods(const FaceGrid& grid, double x, double y) {
  const auto one = [&](double at_x, double at_y) {
    const double far = 2 * (grid.size[0] * grid.spacing[0] + grid.size[1] * grid.spacing[1]);
    if (const double r = std::hypot(at_x, at_y); !grid.plane_strain && r > far) return grid.area() / r;
    return grid.plane_strain ? strip(at_y, 0.5 * grid.spacing[1])
                             : rectangle(at_x, at_y, 0.5 * grid.spacing[0], 0.5 * grid.spacing[1]);
  };
  double period[2];
  int count[2];
  for (int a = 0; a < 2; ++a) {
    period[a] = 2 * grid.size[a] * grid.spacing[a];
    count[a] = grid.end[a] == FaceEnd::period ? num_periods : 0;
  }
  double sum = 0;
  for (int k = -count[0]; k <= count[0]; ++k)
    for (int l = -count[1]; l <= count[1]; ++l) {
      sum += one(x + k * period[0], y + l * period[1]);
      if (k != 0 || l != 0) sum -= one(k * period[0], l * period[1]);
    }
  // Those beyond as a line: far from the places, not from each other.
  for (int a = 0; a < 2 && count[0] * count[1] == 0 && !grid.plane_strain; ++a) {
    if (count[a] == 0) continue;
    const double begin = (num_periods + 0.5) * period[a], across = (a == 0 ? y : x) / begin;
    sum += 2 * grid.area() / period[a] * std::log(2 / (1 + std::sqrt(1 + across * across)));
  }
  return sum;
}

}  // namespace

HalfSpace::HalfSpace(const FaceGrid& grid, double modulus)
    : grid_(grid),
      table_(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::half_space::table"),
             grid.size[0] + grid.extended(0), 2 * (grid.size[1] + grid.extended(1)) - 1 + block),
      extended_("cgcontact::half_space::extended", grid.extended(0), grid.extended(1)),
      range_("cgcontact::half_space::range", grid.extended(0)) {
  const auto host = Kokkos::create_mirror_view(table_);
  const int middle = grid.size[1] + grid.extended(1) - 1;
  for (int i = 0; i < static_cast<int>(host.extent(0)); ++i)
    for (int j = 0; j <= middle; ++j) {
      const double value = with_periods(grid, i * grid.spacing[0], j * grid.spacing[1]) / (pi * modulus);
      host(i, middle + j) = host(i, middle - j) = value;
    }
  Kokkos::deep_copy(table_, host);
}

double HalfSpace::influence(int rows, int columns) const {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), table_);
  return host(std::abs(rows), grid_.size[1] + grid_.extended(1) - 1 + columns);
}

/// Blocks of neighbouring patches of a row sum side by side: each source adds to all of them from neighbouring entries
/// of the table.
template <class Exec>
void HalfSpace::apply(const Exec& exec, const Patches& p, const Marks& at, const Patches& u) const {
  static_assert(Kokkos::SpaceAccessibility<Exec, Memory>::accessible);
  const int rows = grid_.size[0], columns = grid_.size[1];
  const int first_row = grid_.extended(0) - rows, first_column = grid_.extended(1) - columns;
  const int middle = columns + grid_.extended(1) - 1;
  const auto table = table_;
  const auto all = extended_;
  const auto range = range_;
  const int all_rows = grid_.extended(0), all_columns = grid_.extended(1);
  Kokkos::parallel_for(
      "cgcontact::half_space::extend", Kokkos::RangePolicy<Exec>(exec, 0, all_rows), KOKKOS_LAMBDA(const int e) {
        const int i = e >= first_row ? e - first_row : first_row - 1 - e;
        int begin = all_columns, end = 0;
        for (int f = 0; f < all_columns; ++f) {
          const int j = f >= first_column ? f - first_column : first_column - 1 - f;
          all(e, f) = p(i, j);
          if (all(e, f) == 0) continue;
          begin = f < begin ? f : begin;
          end = f + 1;
        }
        range(e, 0) = begin;
        range(e, 1) = end;
      });
  const int blocks = (columns + block - 1) / block;
  using Policy = Kokkos::RangePolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>;
  Kokkos::parallel_for(
      "cgcontact::half_space::apply", Policy(exec, 0, rows * blocks), KOKKOS_LAMBDA(const int n) {
        const int i = n / blocks, begin = n % blocks * block;
        const int count = columns - begin < block ? columns - begin : block;
        bool wanted = false;
        for (int k = 0; k < count; ++k) wanted = wanted || at(i, begin + k) != 0;
        if (!wanted) return;
        double sum[block] = {};
        for (int e = 0; e < all_rows; ++e) {
          const int offset = i + first_row > e ? i + first_row - e : e - i - first_row;
          const double* near = &table(offset, middle + begin + first_column);
          const double* const source = &all(e, 0);
          for (int f = range(e, 0); f < range(e, 1); ++f)
            for (int k = 0; k < block; ++k) sum[k] += source[f] * near[k - f];
        }
        for (int k = 0; k < count; ++k) u(i, begin + k) = sum[k];
      });
}

template void HalfSpace::apply(const ExecSpace&, const Patches&, const Marks&, const Patches&) const;

}  // namespace cgcontact
