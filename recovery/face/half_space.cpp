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
  const auto term = [](double u, double above, double below) { return u == 0 ? 0.0 : u * std::log(above / below); };
  return term(right, upper + upper_right, lower + lower_right) + term(upper, right + upper_right, left + upper_left) -
         term(left, upper + upper_left, lower + lower_left) - term(lower, right + lower_right, left + lower_left);
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
    // Those beyond as a line: far from the points, not from each other.
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
KOKKOS_FUNCTION double elliptic_integral(double complement) {
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

/// Points of an integral over a patch, by the distance of the ring that it is for.
constexpr int far_points = 2, near_points = 8;

/// Distance of points, of their ring's diameter, that counts for the same point: what is left of the logarithms there
/// is their limit up to this.
constexpr double same_place = 1e-15;

/// Rings of pressure around an axis of revolution.
struct Rings {
  struct Point {
    double radius, height, position;  ///< m; position: along the face
  };
  /// (patch, point): its centre, those for rings far away, those for rings nearby
  Kokkos::View<Point * [1 + far_points + near_points], Kokkos::LayoutRight, MemSpace> points;
  double half;  ///< m, of a patch
  double unit_radius, modulus;

  Rings(const FaceGrid& grid, double E)
      : points(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::half_space::ring_points"), grid.size[1]),
        half(0.5 * grid.spacing[1]),
        unit_radius(grid.meridian->unit_radius),
        modulus(E) {
    constexpr double near[near_points / 2] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                              0.96028985649753623};
    const auto host = Kokkos::create_mirror_view(points);
    for (int n = 0; n < grid.size[1]; ++n) {
      const double middle = grid.centre(n)[1];
      const auto point_at = [&](double position) {
        const Eigen::Vector2d x = grid.meridian->at(position);
        return Point{std::abs(x[0]), x[1], position};
      };
      int p = 0;
      host(n, p++) = point_at(middle);
      for (const int side : {-1, 1}) host(n, p++) = point_at(middle + side * half / std::sqrt(3.0));
      for (const double offset : near)
        for (const int side : {-1, 1}) host(n, p++) = point_at(middle + side * half * offset);
    }
    Kokkos::deep_copy(points, host);
  }

  /// Gives the displacement at x by a ring of unit pressure along the line through y, times pi E* and the radius at x:
  /// the same for both orders.
  KOKKOS_FUNCTION static double displacement(const Point& x, const Point& y) {
    const double near = x.radius - y.radius, far = x.radius + y.radius, height = x.height - y.height;
    const double longest = far * far + height * height, shortest = near * near + height * height;
    const double ratio = shortest / longest, least = same_place * same_place;
    return 4 * x.radius * y.radius / std::sqrt(longest) * elliptic_integral(ratio > least ? ratio : least);
  }

  /// Integrates ln|x - y| over two patches, m^2, their middles this far apart.
  KOKKOS_FUNCTION double integral_of_logarithm(double apart) const {
    const auto f = [](double t) { return t == 0 ? 0.0 : 0.5 * t * t * (std::log(std::abs(t)) - 1.5); };
    return f(apart + 2 * half) - 2 * f(apart) + f(apart - 2 * half);
  }

  /// Integrates displacement over both patches. It grows as the sum of the radii times the logarithm of the distance,
  /// which is integrated by itself: as if the radii were those of the middles, as their slopes cancel.
  KOKKOS_FUNCTION double integral(int i, int j) const {
    constexpr double weight[near_points / 2] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                                0.10122853629037626};
    double sum = 0;
    if (i - j > smooth_rings || j - i > smooth_rings) {
      for (int p = 0; p < far_points; ++p)
        for (int q = 0; q < far_points; ++q) sum += displacement(points(i, 1 + p), points(j, 1 + q));
      return half * half * sum;
    }
    for (int p = 0; p < near_points; ++p)
      for (int q = 0; q < near_points; ++q) {
        const Point &x = points(i, 1 + far_points + p), &y = points(j, 1 + far_points + q);
        const double distance = std::abs(x.position - y.position), radii = x.radius + y.radius;
        const double least = same_place * radii, logarithm = std::log(distance > least ? distance : least);
        sum += weight[p / 2] * weight[q / 2] * half * half * (displacement(x, y) + radii * logarithm);
      }
    const Point &x = points(i, 0), &y = points(j, 0);
    return sum - (x.radius + y.radius) * integral_of_logarithm(x.position - y.position);
  }

  KOKKOS_FUNCTION double ring(int patch) const { return points(patch, 0).radius / unit_radius; }

  /// Gives the work of one ring's unit pressure on another one, per width of a patch and unit_radius: over its area,
  /// not at its middle, so that S p is the mean displacement of a ring; that of a gap that grows as r^2 is the gap at
  /// its middle and the same constant for all.
  KOKKOS_FUNCTION double work(int i, int j) const { return integral(i, j) / (2 * half * unit_radius * pi * modulus); }
};

HalfSpace::Patches array(const char* label, int rows, int columns) {
  return HalfSpace::Patches(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), rows, columns);
}

}  // namespace

template <class Exec>
HalfSpace::HalfSpace(const Exec& exec, const FaceGrid& grid, double modulus) {
  static_assert(Kokkos::SpaceAccessibility<Exec, Memory>::accessible);
  if (grid.meridian) {
    const int size = grid.size[1];
    rings_ = array("cgcontact::half_space::rings", size, size);
    const Rings rings(grid, modulus);
    const auto influence = rings_;
    using Policy = Kokkos::RangePolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>;
    Kokkos::parallel_for(
        "cgcontact::half_space::influence_of_rings", Policy(exec, 0, size * size), KOKKOS_LAMBDA(const int n) {
          const int i = n / size, j = n % size;
          if (j > i) return;
          const double work = rings.work(i, j);
          influence(i, j) = work / rings.ring(i);
          influence(j, i) = work / rings.ring(j);
        });
    exec.fence();
    return;
  }
  const CosineAxis axis[2] = {CosineAxis(grid, 0), CosineAxis(grid, 1)};
  for (int a = 0; a < 2; ++a) cosines_[a] = CosineTransform(axis[a].size, axis[a].first, axis[a].cosines);
  const Lattice lattice(grid);
  const Patches table = array("cgcontact::half_space::table", axis[0].reach + 1, axis[1].reach + 1);
  const int columns = axis[1].reach + 1;
  Kokkos::parallel_for(
      "cgcontact::half_space::table", Kokkos::RangePolicy<Exec>(exec, 0, table.extent(0) * table.extent(1)),
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
      "cgcontact::half_space::scale", Kokkos::RangePolicy<Exec>(exec, 0, num[0]), KOKKOS_LAMBDA(const int k) {
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

#define CGCONTACT_INSTANTIATE(Exec)                                    \
  template HalfSpace::HalfSpace(const Exec&, const FaceGrid&, double); \
  template void HalfSpace::apply(const Exec&, const Patches&, const Patches&) const;

CGCONTACT_INSTANTIATE(ExecSpace)
#if defined(KOKKOS_ENABLE_SERIAL) && defined(KOKKOS_ENABLE_OPENMP)
CGCONTACT_INSTANTIATE(Kokkos::Serial)  // for the tests, where ExecSpace is the other one
#endif
#undef CGCONTACT_INSTANTIATE

}  // namespace cgcontact
