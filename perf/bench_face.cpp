/// The contact pressure on the face: the half-space's product by cosine transforms beside the plain sum over all pairs
/// of patches, and a whole problem against Hertz.
///
/// Sizes: patches along both axes.
#include <algorithm>
#include <cmath>
#include <memory>

#include "perf/harness.hpp"
#include "recovery/face/face_problem.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

/// Patches over a zone of radius 1 and what lies around it; no symmetry planes.
FaceGrid grid_of(int size) {
  FaceGrid grid;
  for (int a = 0; a < 2; ++a) {
    grid.size[a] = size;
    grid.spacing[a] = 3.0 / size;
    grid.low[a] = -1.5;
  }
  return grid;
}

HalfSpace::Patches patches(const FaceGrid& grid, double (*value)(const FacePosition&)) {
  const HalfSpace::Patches view("cgcontact::perf::patches", grid.size[0], grid.size[1]);
  const auto host = Kokkos::create_mirror_view(view);
  for (int n = 0; n < grid.num_patches(); ++n) host(n / grid.size[1], n % grid.size[1]) = value(grid.centre(n));
  Kokkos::deep_copy(view, host);
  return view;
}

double hertz(const FacePosition& x) { return std::sqrt(std::max(1 - x.squaredNorm(), 0.0)) * 2 / pi; }

/// The plain sum, from a table of influences.
void sum_all(const FaceGrid& grid, const HalfSpace::Patches& table, const HalfSpace::Patches& p,
             const HalfSpace::Patches& u) {
  const int rows = grid.size[0], columns = grid.size[1];
  Kokkos::parallel_for(
      "cgcontact::perf::sum_all", Kokkos::RangePolicy<ExecSpace>(0, rows * columns), KOKKOS_LAMBDA(const int n) {
        const int i = n / columns, j = n % columns;
        double sum = 0;
        for (int k = 0; k < rows; ++k)
          for (int l = 0; l < columns; ++l) sum += table(i < k ? k - i : i - k, j < l ? l - j : j - l) * p(k, l);
        u(i, j) = sum;
      });
}

Kernel make_product(int size) {
  const FaceGrid grid = grid_of(size);
  const auto half_space = std::make_shared<HalfSpace>(ExecSpace(), grid, 1.0);
  const HalfSpace::Patches p = patches(grid, hertz), u("cgcontact::perf::u", size, size),
                           plain("cgcontact::perf::plain", size, size), table("cgcontact::perf::table", size, size);
  const auto host = Kokkos::create_mirror_view(table);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) host(i, j) = HalfSpace::influence(grid, 1.0, i, j);
  Kokkos::deep_copy(table, host);
  half_space->apply(ExecSpace(), p, u);
  sum_all(grid, table, p, plain);
  Kokkos::fence();
  const auto found = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u),
             exact = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), plain);
  double difference = 0, largest = 0;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      difference = std::max(difference, std::abs(found(i, j) - exact(i, j)));
      largest = std::max(largest, std::abs(exact(i, j)));
    }
  Kernel k;
  k.unit = "patches";
  k.items = grid.num_patches();
  // The patches' columns, then all cosines of the first axis: there and back, each with its sorting.
  const Fourier fourier(Fourier::fast_length(2 * size));
  const double n = size, count = fourier.length();
  k.cost = {2 * (n + count) * (fourier.flop() / Fourier::columns + 5 * count), 8 * (2 * n * n + 2 * count * count)};
  k.error = difference / largest;
  k.tolerance = 1e-12;
  k.against = "sum over all pairs";
  k.run = [=] {
    half_space->apply(ExecSpace(), p, u);
    Kokkos::fence();
  };
  k.baseline = [=] {
    sum_all(grid, table, p, plain);
    Kokkos::fence();
  };
  return k;
}

Kernel make_problem(int size) {
  const FaceGrid grid = grid_of(size);
  const auto half_space = std::make_shared<HalfSpace>(ExecSpace(), grid, 1.0);
  const HalfSpace::Patches gap = patches(grid, [](const FacePosition&x) { return x.squaredNorm() / 2; }),
                           p("cgcontact::perf::pressure", size, size);
  const HalfSpace::Marks all("cgcontact::perf::all", size, size);
  Kokkos::deep_copy(all, char{1});
  const double force = 4.0 / 3, tolerance = 1e-5;
  const auto solve = [=] {
    Kokkos::deep_copy(p, 0.0);
    return solve_face_problem(ExecSpace(), grid, *half_space, gap, all, force, tolerance, 500, p);
  };
  const FaceSolution solution = solve();
  const auto found = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), p);
  double difference = 0, norm = 0;
  for (int n = 0; n < grid.num_patches(); ++n) {
    const double exact = hertz(grid.centre(n));
    difference += std::pow(found(n / size, n % size) - exact, 2);
    norm += exact * exact;
  }
  Kernel k;
  k.unit = "patches";
  k.items = grid.num_patches();
  k.error = std::sqrt(difference / norm);
  k.tolerance = 1.5 / size;  // patches at the edge are whole: 0.01 to 0.02 at 100 patches over three radii
  k.against = "Hertz";
  k.figures = {{"iterations", solution.iterations}};
  k.run = [=] { solve(); };
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("half_space/product", make_product, {{16}, {64, 96, 144}});
    add("face_problem/solve", make_problem, {{32}, {64, 96, 144}});
  });
}
