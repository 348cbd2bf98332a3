#include "contact/adaptive/energy_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Half the diagonal of a cube over its side.
constexpr double half_diagonal = 0.87;
/// Cells change by no more than these factors at once: the estimate of a cell is one of its present surroundings.
constexpr double smallest_ratio = 0.125, largest_ratio = 2;
/// Halvings make cells up to twice as small as asked for: so they are too large as often as too small.
constexpr double rounding = 1.41;

/// How many times smaller a field asks cells of size h to be, in halvings.
double asked_ratio(const SizeField& zones, const Vec3& x, double h) {
  double ratio = 1;
  while (ratio > smallest_ratio && zones.asks_below(0.75 * ratio * h, x, 0)) ratio /= 2;
  return ratio;
}

}  // namespace

double expected_energy_error(const Results& results, const std::vector<std::unique_ptr<SizeField>>& zones) {
  double now = 0, expected = 0;
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    const BodyFields& body = results.bodies[b];
    for (int c = 0; c < static_cast<int>(body.error_of_cell.size()); ++c) {
      const double e = body.error_of_cell[c];
      now += e * e;
      expected += std::pow(
          e * asked_ratio(*zones[b], global_position(*body.cut_cells, c, Vec3::Zero()), body.cut_cells->h(c)), 2);
    }
  }
  return now > 0 ? results.estimated_error_relative * std::sqrt(expected / now) : 0;
}

std::vector<std::vector<SizedBall>> energy_sizes(const Results& results, double target,
                                                 const std::vector<double>& first_sizes) {
  double sum = 0;
  const int dimensions = results.bodies.front().cut_cells->grid.is_quadtree() ? 2 : 3;
  const double order = 1 + dimensions / 2.0;  // of error_of_cell in the size
  for (const BodyFields& body : results.bodies)
    for (const double e : body.error_of_cell) sum += std::pow(e, dimensions / order);
  std::vector<std::vector<SizedBall>> balls(results.bodies.size());
  if (!(results.estimated_error_relative > 0)) return balls;
  const double wanted = target * results.estimated_error / results.estimated_error_relative;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    const BodyFields& body = results.bodies[b];
    const CutCells& cells = *body.cut_cells;
    for (int c = 0; c < static_cast<int>(cells.cells.size()); ++c) {
      const double e = body.error_of_cell[c];
      if (!(e > 0)) continue;
      const double ratio = wanted * std::pow(e, -1 / order) / std::sqrt(sum), h = cells.h(c);
      const double size = rounding * h * std::clamp(ratio, smallest_ratio, largest_ratio);
      if (size < first_sizes[b]) balls[b].push_back({global_position(cells, c, Vec3::Zero()), half_diagonal * h, size});
    }
  }
  return balls;
}

}  // namespace cgcontact
