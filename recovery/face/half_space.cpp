#include "recovery/face/half_space.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Periods that are summed one by one at each end.
constexpr int num_periods = 12;

/// Integral of 1/r over the rectangle |xi| < a, |eta| < b seen from (x, y), m.
KOKKOS_FUNCTION double rectangle(double x, double y, double a, double b) {
  const double right = std::abs(x) + a, left = std::abs(x) - a, upper = std::abs(y) + b, lower = std::abs(y) - b;
  const auto length = [](double u, double v) { return std::sqrt(u * u + v * v); };
  const double upper_right = length(upper, right), upper_left = length(upper, left), lower_right = length(lower, right),
               lower_left = length(lower, left);
  const auto part = [](double u, double above, double below) { return u == 0 ? 0.0 : u * std::log(above / below); };
  return part(right, upper + upper_right, lower + lower_right) + part(upper, right + upper_right, left + upper_left) -
         part(left, upper + upper_left, lower + lower_left) - part(lower, right + lower_right, left + lower_left);
}

/// Minus twice the integral of ln|x - xi| over |xi| < a, m.
KOKKOS_FUNCTION double strip(double x, double a) {
  const auto f = [](double t) { return t == 0 ? 0.0 : t * std::log(std::abs(t)) - t; };
  return -2 * (f(x + a) - f(x - a));
}

/// Longer sides of a patch: from so many on the first two terms of the integral's series are right to 1e-8
/// (HalfSpace.LongPatchesFarAway), and differences of logarithms lose digits.
constexpr double far_away = 100;

/// The same for a rectangle that is far away: its area at its centre, and the second moments.
KOKKOS_FUNCTION double far_rectangle(double x, double y, double a, double b) {
  const double squared = x * x + y * y, r = std::sqrt(squared);
  return 4 * a * b / r *
         (1 + ((3 * x * x - squared) * a * a + (3 * y * y - squared) * b * b) / (6 * squared * squared));
}

/// Spacings and periods that with_periods needs of a grid. It depends on the length of an axis where that is a period
/// alone.
struct Lattice {
  double spacing[2], period[2], area, far;
  int num_periods[2];
  bool plane_strain;

  explicit Lattice(const FaceGrid& grid)
      : area(grid.area()), far(far_away * std::max(grid.spacing[0], grid.spacing[1])), plane_strain(grid.plane_strain) {
    for (int a = 0; a < 2; ++a) {
      spacing[a] = grid.spacing[a];
      period[a] = 2 * grid.size[a] * grid.spacing[a];
      num_periods[a] = grid.end[a] == FaceEnd::period ? cgcontact::num_periods : 0;
    }
  }

  KOKKOS_FUNCTION double one(double x, double y) const {
    if (plane_strain) return strip(y, 0.5 * spacing[1]);
    const double a = 0.5 * spacing[0], b = 0.5 * spacing[1];
    return x * x + y * y > far * far ? far_rectangle(x, y, a, b) : rectangle(x, y, a, b);
  }

  /// Sums the integrals at the offset (x, y) and all its periods, less what is the same everywhere.
  KOKKOS_FUNCTION double with_periods(double x, double y) const {
    double sum = 0;
    for (int k = -num_periods[0]; k <= num_periods[0]; ++k)
      for (int l = -num_periods[1]; l <= num_periods[1]; ++l) {
        sum += one(x + k * period[0], y + l * period[1]);
        if (k != 0 || l != 0) sum -= one(k * period[0], l * period[1]);
      }
    // Those beyond as a line: far from the places, not from each other.
    for (int a = 0; a < 2 && num_periods[0] * num_periods[1] == 0 && !plane_strain; ++a) {
      if (num_periods[a] == 0) continue;
      const double begin = (num_periods[a] + 0.5) * period[a], across = (a == 0 ? y : x) / begin;
      sum += 2 * area / period[a] * std::log(2 / (1 + std::sqrt(1 + across * across)));
    }
    return sum;
  }
};

/// Cosines of an axis, offsets whose influence counts, and where its patches stand among those that the cosines mirror.
struct CosineAxis {
  int size, cosines, reach, first;

  CosineAxis(const FaceGrid& grid, int a) : size(grid.size[a]) {
    const FaceEnd end = grid.end[a];
    const bool alone = size == 1 && end == FaceEnd::free;
    cosines = end == FaceEnd::period || alone ? size : Fourier::fast_length(2 * size);
    reach = end == FaceEnd::period ? size : end == FaceEnd::mirror ? 2 * size - 1 : size - 1;
    first = end == FaceEnd::free ? size / 2 : 0;
    if (alone) first = 0;
  }
};

/// K(k) from 1 - k^2, to 2e-8 (Abramowitz and Stegun 1964, 17.3.34).
double elliptic_integral(double complement) {
  constexpr double a[5] = {1.38629436112, 0.09666344259, 0.03590092383, 0.03742563713, 0.01451196212};
  constexpr double b[5] = {0.5, 0.12498593597, 0.06880248576, 0.03328355346, 0.00441787012};
  double of_one = 0, of_logarithm = 0;
  for (int i = 4; i >= 0; --i) {
    of_one = of_one * complement + a[i];
    of_logarithm = of_logarithm * complement + b[i];
  }
  return of_one - of_logarithm * std::log(complement);
}

/// Patches away from which a ring's influence on another one is smooth enough for two points.
constexpr int smooth_rings = 6;

/// Integral over a patch of the displacement by rings of unit pressure, times pi E*, m: K(k) grows as the logarithm of
/// the distance, which is integrated by itself.
double ring_influence(const FaceGrid& grid, int at, int from) {
  constexpr double point[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623};
  constexpr double weight[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626};
  const Meridian& meridian = *grid.meridian;
  const double half = 0.5 * grid.spacing[1], middle = grid.centre(from)[1], place = grid.centre(at)[1];
  const Eigen::Vector2d x = meridian.at(place);
  const auto ring_at = [&](double other) {
    const Eigen::Vector2d y = meridian.at(other);
    const double near = std::abs(x[0]) - std::abs(y[0]), far = std::abs(x[0]) + std::abs(y[0]), height = x[1] - y[1];
    const double longest = far * far + height * height, shortest = near * near + height * height;
    return 4 * std::abs(y[0]) / std::sqrt(longest) * elliptic_integral(std::max(shortest / longest, 1e-30));
  };
  double sum = 0;
  if (std::abs(at - from) > smooth_rings) {
    for (const int side : {-1, 1}) sum += half * ring_at(middle + side * half / std::sqrt(3.0));
    return sum;
  }
  for (int q = 0; q < 4; ++q)
    for (const int side : {-1, 1}) {
      const double other = middle + side * half * point[q];
      sum += weight[q] * half * (ring_at(other) + 2 * std::log(std::max(std::abs(place - other), 1e-12 * half)));
    }
  return sum + strip(place - middle, half);
}

HalfSpace::Patches array(const char* label, int rows, int columns) {
  return HalfSpace::Patches(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), rows, columns);
}

}  // namespace

HalfSpace::HalfSpace(const ExecSpace& exec, const FaceGrid& grid, double modulus) {
  if (grid.meridian) {
    rings_ = array("cgcontact::half_space::rings", grid.size[1], grid.size[1]);
    const auto host = Kokkos::create_mirror_view(rings_);
    // The work of one ring's pressure on the other's is that of the other's on the one's; at centres of patches it is
    // so up to their size only, which conjugate gradients do not bear where a zone is one or two patches wide.
    for (int i = 0; i < grid.size[1]; ++i)
      for (int j = 0; j <= i; ++j) {
        const double work = (grid.ring(i) * ring_influence(grid, i, j) + grid.ring(j) * ring_influence(grid, j, i)) /
                            (2 * pi * modulus);
        host(i, j) = work / grid.ring(i);
        host(j, i) = work / grid.ring(j);
      }
    Kokkos::deep_copy(rings_, host);
    return;
  }
  const CosineAxis axis[2] = {CosineAxis(grid, 0), CosineAxis(grid, 1)};
  for (int a = 0; a < 2; ++a) cosines_[a] = CosineTransform(axis[a].size, axis[a].first, axis[a].cosines);
  const Lattice lattice(grid);
  const Patches table = array("cgcontact::half_space::table", axis[0].reach + 1, axis[1].reach + 1);
  const int columns = axis[1].reach + 1;
  Kokkos::parallel_for(
      "cgcontact::half_space::table", Kokkos::RangePolicy<ExecSpace>(exec, 0, table.extent(0) * table.extent(1)),
      KOKKOS_LAMBDA(const int n) {
        const int i = n / columns, j = n % columns;
        table(i, j) = lattice.with_periods(i * lattice.spacing[0], j * lattice.spacing[1]) / (pi * modulus);
      });
  // Eigenvalues: the influences are even.
  const int num[2] = {axis[0].cosines, axis[1].cosines};
  const Patches half = array("cgcontact::half_space::half", columns, num[0]);
  even_spectrum(exec, num[0], table, half);
  spectrum_ = array("cgcontact::half_space::spectrum", num[0], num[1]);
  even_spectrum(exec, num[1], half, spectrum_);
  const auto spectrum = spectrum_;
  const int num_columns = num[1];
  const double all = static_cast<double>(num[0]) * num[1];
  Kokkos::parallel_for(
      "cgcontact::half_space::scale", Kokkos::RangePolicy<ExecSpace>(exec, 0, num[0]), KOKKOS_LAMBDA(const int k) {
        for (int l = 0; l < num_columns; ++l) spectrum(k, l) *= (k > 0 ? 2 : 1) * (l > 0 ? 2 : 1) / all;
      });
  along_ = array("cgcontact::half_space::along", axis[1].size, num[0]);
  both_ = array("cgcontact::half_space::both", num[0], num[1]);
  exec.fence();
}

double HalfSpace::influence(const FaceGrid& grid, double modulus, int rows, int columns) {
  return Lattice(grid).with_periods(rows * grid.spacing[0], columns * grid.spacing[1]) / (pi * modulus);
}

template <class Exec>
void HalfSpace::apply(const Exec& exec, const Patches& p, const Patches& u) const {
  static_assert(Kokkos::SpaceAccessibility<Exec, Memory>::accessible);
  if (rings_.extent(0) > 0) {
    const auto rings = rings_;
    const int size = static_cast<int>(rings.extent(0));
    Kokkos::parallel_for(
        "cgcontact::half_space::rings", Kokkos::RangePolicy<Exec>(exec, 0, size), KOKKOS_LAMBDA(const int i) {
          double sum = 0;
          for (int j = 0; j < size; ++j) sum += rings(i, j) * p(0, j);
          u(0, i) = sum;
        });
    return;
  }
  cosines_[0].forward(exec, p, Patches(), along_);
  cosines_[1].forward(exec, along_, spectrum_, both_);
  cosines_[1].backward(exec, both_, along_);
  cosines_[0].backward(exec, along_, u);
}

template void HalfSpace::apply(const ExecSpace&, const Patches&, const Patches&) const;

}  // namespace cgcontact
