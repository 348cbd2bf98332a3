#include "recovery/face/face_zone.hpp"

#include <algorithm>
#include <cmath>

#include "recovery/face/face_problem.hpp"
#include "recovery/face/far_field.hpp"

namespace cgcontact {
namespace {

using Patches = HalfSpace::Patches;

Patches to_device(const FaceGrid& grid, const std::vector<double>& values, const char* label) {
  const Patches view(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), grid.size[0], grid.size[1]);
  const auto host = Kokkos::create_mirror_view(view);
  for (int n = 0; n < grid.num_patches(); ++n) host(n / grid.size[1], n % grid.size[1]) = values[n];
  Kokkos::deep_copy(view, host);
  return view;
}

HalfSpace::Marks marks_of(const FaceGrid& grid, const std::vector<char>& marked) {
  const HalfSpace::Marks marks("cgcontact::face_zone::marks", grid.size[0], grid.size[1]);
  const auto host = Kokkos::create_mirror_view(marks);
  for (int n = 0; n < grid.num_patches(); ++n) host(n / grid.size[1], n % grid.size[1]) = marked[n];
  Kokkos::deep_copy(marks, host);
  return marks;
}

std::vector<double> to_host(const Patches& view) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
  std::vector<double> values;
  for (std::size_t i = 0; i < host.extent(0); ++i)
    for (std::size_t j = 0; j < host.extent(1); ++j) values.push_back(host(i, j));
  return values;
}

/// Number of the patch `steps` beyond another one along an axis, in its image behind a symmetry plane too; -1: beyond a
/// free end.
int beyond(const FaceGrid& grid, int patch, std::array<int, 2> steps) {
  std::array<int, 2> at{patch / grid.size[1], patch % grid.size[1]};
  for (int a = 0; a < 2; ++a) {
    at[a] += steps[a];
    if (at[a] < 0 && grid.end[a] != FaceEnd::free) at[a] = -1 - at[a];
    if (at[a] >= grid.size[a] && grid.end[a] == FaceEnd::period) at[a] = 2 * grid.size[a] - 1 - at[a];
    if (at[a] < 0 || at[a] >= grid.size[a]) return -1;
  }
  return at[0] * grid.size[1] + at[1];
}

/// h^2 times the Laplacian of values at the patches, by differences over a cell; 0 along an axis where one is missing.
double curvature(const FaceGrid& grid, const std::vector<double>& values, double h, int patch) {
  double sum = 0;
  for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a) {
    const int step = std::max(1, static_cast<int>(std::lround(h / grid.spacing[a])));
    std::array<int, 2> forward{0, 0}, backward{0, 0};
    forward[a] = step;
    backward[a] = -step;
    const int before = beyond(grid, patch, backward), after = beyond(grid, patch, forward);
    if (before < 0 || after < 0) continue;
    const double part = h / (step * grid.spacing[a]);
    sum += part * part * (values[before] - 2 * values[patch] + values[after]);
  }
  return sum;
}

/// Part of a group's area that its patches may miss; those at the border of what is looked at miss more.
constexpr double cover = 0.1;

/// Sums of what patches share of each group, patches.
std::vector<double> sizes_of_groups(const FaceZone& zone) {
  std::vector<double> sizes(zone.groups.size(), 0.0);
  for (const FaceShare& share : zone.shares) sizes[share.group] += share.part;
  return sizes;
}

/// The forces as they act: even over each group, Pa. What groups without patches transmit goes to all.
std::vector<double> acting_pressure(const FaceZone& zone, const std::vector<double>& sizes) {
  std::vector<double> pressure(zone.grid.num_patches(), 0.0);
  double force = 0, kept = 0;
  for (std::size_t g = 0; g < zone.groups.size(); ++g) {
    force += zone.groups[g].force;
    if (sizes[g] > 0) kept += zone.groups[g].force;
  }
  for (const FaceShare& share : zone.shares)
    if (kept > 0)
      pressure[share.patch] +=
          force / kept * share.part * zone.groups[share.group].force / (sizes[share.group] * zone.grid.area());
  return pressure;
}

/// Patches of an axis that are one on the next coarser grid.
int merged(const FaceGrid& grid, int axis) { return grid.size[axis] % 2 == 0 && grid.size[axis] >= 16 ? 2 : 1; }

/// The solution on patches of twice the size, recursively, is where the solver starts: p is set.
FaceSolution solve_from_coarse(const ExecSpace& exec, const FaceGrid& grid, const HalfSpace& half_space, double modulus,
                               const std::vector<double>& gap, std::vector<char> may_press, double force,
                               const FaceOptions& options, const Patches& p) {
  const std::array<int, 2> by{merged(grid, 0), merged(grid, 1)};
  if (by[0] * by[1] > 1) {
    FaceGrid coarse = grid;
    for (int a = 0; a < 2; ++a) {
      coarse.size[a] /= by[a];
      coarse.spacing[a] *= by[a];
    }
    const auto parent = [&](int n) { return n / grid.size[1] / by[0] * coarse.size[1] + n % grid.size[1] / by[1]; };
    const int count = coarse.num_patches();
    std::vector<double> sum(count, 0.0), number(count, 0.0), start(count, 0.0);
    std::vector<char> may(count, 0);
    const std::vector<double> before = to_host(p);
    for (int n = 0; n < grid.num_patches(); ++n) {
      if (!may_press[n]) continue;
      may[parent(n)] = 1;
      sum[parent(n)] += gap[n];
      number[parent(n)] += 1;
      start[parent(n)] += before[n] / (by[0] * by[1]);
    }
    for (int n = 0; n < count; ++n)
      if (number[n] > 0) sum[n] /= number[n];
    const Patches coarse_p = to_device(coarse, start, "cgcontact::face_zone::coarse_pressure");
    solve_from_coarse(exec, coarse, HalfSpace(coarse, modulus), modulus, sum, may, force, options, coarse_p);
    const std::vector<double> found = to_host(coarse_p);
    std::vector<double> fine(grid.num_patches(), 0.0);
    for (int n = 0; n < grid.num_patches(); ++n)
      if (may_press[n]) fine[n] = found[parent(n)];
    Kokkos::deep_copy(p, to_device(grid, fine, "cgcontact::face_zone::start"));
    // The zone ends within two of the larger patches of where it ended.
    for (int n = 0; n < grid.num_patches(); ++n) {
      bool near = false;
      for (int i = -2; i <= 2 && may_press[n] && !near; ++i)
        for (int j = -2; j <= 2; ++j) {
          const int other = beyond(coarse, parent(n), {i, j});
          near = near || (other >= 0 && found[other] > 0);
        }
      may_press[n] = near;
    }
  }
  return solve_face_problem(exec, grid, half_space, to_device(grid, gap, "cgcontact::face_zone::gap"),
                            marks_of(grid, may_press), force, options.tolerance, options.max_iterations, p);
}

/// Mean of the root over a patch in which the square varies by +-half.
double mean_root(double square, double half) {
  half = std::max(half, 1e-9 * std::abs(square) + 1e-300);
  const double high = std::max(square + half, 0.0), low = std::max(square - half, 0.0);
  return (std::pow(high, 1.5) - std::pow(low, 1.5)) / (3 * half);
}

/// Patches at the edge are whole, as groups are: those carry what belongs beyond it. So the square of the pressure is
/// continued linearly from patches farther inside, to the edge and a little beyond; then the force is set again.
class EdgeContinuation {
 public:
  EdgeContinuation(const FaceZone& zone, std::vector<double> pressure, double force)
      : zone_(zone), grid_(zone.grid), pressure_(std::move(pressure)), force_(force) {
    for (int n = 0; n < grid_.num_patches(); ++n) {
      square_.push_back(pressure_[n] * pressure_[n]);
      to_open_.push_back(pressure_[n] > 0 ? nearest(n, false) : 0);
    }
  }

  std::vector<double> run() {
    std::vector<double> result = square_;
    const double largest = *std::max_element(square_.begin(), square_.end());
    std::vector<char> counts(square_.size(), 0);
    for (int n = 0; n < grid_.num_patches(); ++n) {
      const bool closed = pressure_[n] > 0;
      counts[n] = closed;
      if (!zone_.inside[n]) continue;
      const double other = closed ? to_open_[n] : nearest(n, true);
      if (closed ? other <= skip + 0.5 : other <= skip) {
        double value = 0;
        if (!continued(n, value)) continue;
        result[n] = value;
        counts[n] = 1;
      } else if (!closed) {
        result[n] = -beyond_edge * largest;
      }
    }
    double total = 0;
    for (int n = 0; n < grid_.num_patches(); ++n)
      if (counts[n]) total += mean_root(result[n], half_change(result, n));
    const double factor = total > 0 ? force_ / (total * grid_.area()) : 1;
    for (double& q : result) q *= factor * factor;
    return result;
  }

 private:
  /// Part of the largest square that stands negative where the zone is not.
  static constexpr double beyond_edge = 1e-3;
  static constexpr double skip = 2;  ///< patches at the edge that are replaced
  static constexpr int window = 6;   ///< patches around

  /// Calls use(patch, place) for the patches around in the window; place: in patches, relative.
  template <class Use>
  void each_around(int patch, const Use& use) const {
    const int reach = grid_.plane_strain ? 0 : window;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -window; j <= window; ++j) {
        const int n = beyond(grid_, patch, {i, j});
        if (n >= 0) use(n, FacePlace(i, j));
      }
  }
  /// Distance to the nearest patch that presses, or does not, in patches.
  double nearest(int patch, bool presses) const {
    double least = 1e300;
    each_around(patch, [&](int n, const FacePlace& place) {
      if (zone_.inside[n] && (pressure_[n] > 0) == presses) least = std::min(least, place.norm());
    });
    return least;
  }
  bool continued(int patch, double& value) const {
    struct Sample {
      double distance;
      FacePlace place;
      double square;
    };
    std::vector<Sample> samples;
    each_around(patch, [&](int n, const FacePlace& place) {
      if (pressure_[n] > 0 && to_open_[n] > skip + 0.5) samples.push_back({place.norm(), place, square_[n]});
    });
    const std::size_t count = grid_.plane_strain ? 3 : 9;
    if (samples.size() < count) return false;
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.distance < b.distance - 1e-9; });
    // Those as near as the last one count as well: mirror images see the same.
    const double last = samples[count - 1].distance + 1e-9;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Sample& s : samples) {
      if (s.distance > last) break;
      const Eigen::Vector3d row(1, s.place[0], s.place[1]);
      normal += row * row.transpose();
      right += row * s.square;
    }
    if (grid_.plane_strain) normal(1, 1) = 1;
    value = normal.ldlt().solve(right)[0];
    return true;
  }
  /// Half of what the square changes by across a patch.
  double half_change(const std::vector<double>& square, int patch) const {
    double sum = 0;
    for (int a = grid_.plane_strain ? 1 : 0; a < 2; ++a) {
      std::array<int, 2> step{0, 0};
      step[a] = 1;
      const int after = beyond(grid_, patch, step);
      step[a] = -1;
      const int before = beyond(grid_, patch, step);
      if (before >= 0 && after >= 0) sum += std::pow((square[after] - square[before]) / 2, 2);
    }
    return std::sqrt(sum) / 2;
  }

  const FaceZone& zone_;
  const FaceGrid& grid_;
  std::vector<double> pressure_, square_, to_open_;
  double force_;
};

}  // namespace

double FacePressure::at(const FacePlace& place) const {
  const FacePlace x = grid.folded(place);
  int cell[2];
  double part[2];
  for (int a = 0; a < 2; ++a) {
    const double t = (x[a] - grid.low[a]) / grid.spacing[a] - 0.5;
    cell[a] = static_cast<int>(std::floor(t));
    part[a] = t - cell[a];
    if (grid.plane_strain && a == 0) cell[a] = 0, part[a] = 0;
  }
  double sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const double weight = (i == 0 ? 1 - part[0] : part[0]) * (j == 0 ? 1 - part[1] : part[1]);
      if (weight == 0) continue;
      int at[2] = {cell[0] + i, cell[1] + j};
      for (int a = 0; a < 2; ++a) {
        if (at[a] < 0 && grid.end[a] != FaceEnd::free) at[a] = 0;
        if (at[a] >= grid.size[a] && grid.end[a] == FaceEnd::period) at[a] = grid.size[a] - 1;
        if (at[a] < -1 || at[a] > grid.size[a]) return 0;
        at[a] = std::clamp(at[a], 0, grid.size[a] - 1);
      }
      sum += weight * square[at[0] * grid.size[1] + at[1]];
    }
  return std::sqrt(std::max(sum, 0.0));
}

FacePressure solve_face_zone(const ExecSpace& exec, const FaceZone& zone, const FaceOptions& options) {
  const FaceGrid& grid = zone.grid;
  const std::vector<double> sizes = sizes_of_groups(zone);
  const std::vector<double> acting = acting_pressure(zone, sizes);
  const HalfSpace half_space(grid, zone.modulus);
  const Patches p = to_device(grid, acting, "cgcontact::face_zone::pressure");
  const Patches u("cgcontact::face_zone::displacement", grid.size[0], grid.size[1]);
  half_space.apply(exec, p, marks_of(grid, zone.inside), u);
  exec.fence();
  const std::vector<double> response = to_host(u);

  const double cell = grid.plane_strain ? zone.h : zone.h * zone.h;
  std::vector<FarMean> means(zone.groups.size());
  for (const FaceShare& share : zone.shares) {
    FarMean& mean = means[share.group];
    const double part = share.part / sizes[share.group];
    mean.patches.emplace_back(share.patch, part);
    mean.value -=
        part * (response[share.patch] + options.cell_stiffness * curvature(grid, response, zone.h, share.patch));
  }
  double force = 0;
  for (std::size_t g = 0; g < zone.groups.size(); ++g) {
    const FaceGroup& group = zone.groups[g];
    force += group.force;
    const double away = group.away / (options.fall * zone.h);
    means[g].value += group.gap_change;
    // The mean over a part of a group is another one.
    const bool whole = std::abs(sizes[g] * grid.area() - group.area) < cover * group.area;
    means[g].weight = whole || group.force > 0 ? group.area / cell * std::exp(-0.5 * away * away) : 0;
  }
  std::vector<double> gap = fit_far_field(grid, zone.h, options.smooth_length, zone.inside, means);
  for (int n = 0; n < grid.num_patches(); ++n) gap[n] = zone.inside[n] ? gap[n] + zone.distance[n] : 0;

  const FaceSolution solution =
      solve_from_coarse(exec, grid, half_space, zone.modulus, gap, zone.may_press, force, options, p);
  return {grid, EdgeContinuation(zone, to_host(p), force).run(), solution.iterations};
}

}  // namespace cgcontact
