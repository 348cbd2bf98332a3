#include "recovery/face/edge_continuation.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Mean of the root over a patch in which the square varies by +-half.
double mean_root(double square, double half) {
  half = std::max(half, 1e-9 * std::abs(square) + 1e-300);
  const double high = std::max(square + half, 0.0), low = std::max(square - half, 0.0);
  return (std::pow(high, 1.5) - std::pow(low, 1.5)) / (3 * half);
}

class EdgeContinuation {
 public:
  EdgeContinuation(const FaceGrid& grid, const std::vector<char>& inside, const std::vector<double>& pressure,
                   double force)
      : grid_(grid), inside_(inside), pressure_(pressure), force_(force) {
    for (int n = 0; n < grid_.num_patches(); ++n) {
      square_.push_back(pressure_[n] * pressure_[n]);
      to_open_.push_back(pressure_[n] > 0 ? nearest(n, false) : 0);
    }
  }

  std::vector<double> run() const {
    std::vector<double> result = square_;
    const double largest = *std::max_element(square_.begin(), square_.end());
    std::vector<char> counts(square_.size(), 0);
    for (int n = 0; n < grid_.num_patches(); ++n) {
      const bool closed = pressure_[n] > 0;
      counts[n] = closed;
      if (!inside_[n]) continue;
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
      if (counts[n]) total += grid_.ring(n) * mean_root(result[n], half_change(result, n));
    const double factor = total > 0 ? force_ / (total * grid_.area()) : 1;
    for (double& q : result) q *= factor * factor;
    return result;
  }

 private:
  /// Fraction of the largest square that stands negative where the zone is not.
  static constexpr double beyond_edge = 1e-3;
  static constexpr double skip = 2;  ///< patches at the edge that are replaced
  static constexpr int window = 6;   ///< patches around

  /// Calls use(patch, position) for the patches around in the window; position: relative position in patches.
  template <class Use>
  void each_around(int patch, const Use& use) const {
    const int reach = grid_.plane_strain ? 0 : window;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -window; j <= window; ++j) {
        const int n = grid_.beyond(patch, {i, j});
        if (n >= 0) use(n, FacePosition(i, j));
      }
  }
  /// Distance to the nearest patch that presses, or does not, in patches.
  double nearest(int patch, bool presses) const {
    double least = 1e300;
    each_around(patch, [&](int n, const FacePosition& position) {
      if (inside_[n] && (pressure_[n] > 0) == presses) least = std::min(least, position.norm());
    });
    return least;
  }
  bool continued(int patch, double& value) const {
    struct Sample {
      double distance;
      FacePosition position;
      double square;
    };
    std::vector<Sample> samples;
    each_around(patch, [&](int n, const FacePosition& position) {
      if (pressure_[n] > 0 && to_open_[n] > skip + 0.5) samples.push_back({position.norm(), position, square_[n]});
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
      const Eigen::Vector3d row(1, s.position[0], s.position[1]);
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
      const auto [before, after] = grid_.beside(patch, a);
      if (before >= 0 && after >= 0) sum += std::pow((square[after] - square[before]) / 2, 2);
    }
    return std::sqrt(sum) / 2;
  }

  const FaceGrid& grid_;
  const std::vector<char>& inside_;
  const std::vector<double>& pressure_;
  std::vector<double> square_, to_open_;
  double force_;
};

}  // namespace

std::vector<double> continue_to_edge(const FaceGrid& grid, const std::vector<char>& inside,
                                     const std::vector<double>& pressure, double force) {
  return EdgeContinuation(grid, inside, pressure, force).run();
}

}  // namespace cgcontact
