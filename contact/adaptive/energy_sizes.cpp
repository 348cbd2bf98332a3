#include "contact/adaptive/energy_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace cgcontact {
namespace {

/// Half the diagonal of a cube over its side.
constexpr double half_diagonal = 0.87;
/// Cells change by no more than these factors at once: the estimate of a cell is one of its present surroundings.
constexpr double min_ratio = 0.125, max_ratio = 2;
/// Halvings make cells up to twice as small as asked for: so they are too large as often as too small.
constexpr double between_halvings = 1.41;

/// Returns the ratio of h to the size that a field asks for, in halvings.
double asked_ratio(const SizeField& zones, const Vec3& x, double h) {
  double ratio = 1;
  while (ratio > min_ratio && zones.asks_below(0.75 * ratio * h, x, 0)) ratio /= 2;
  return ratio;
}

/// Squares of the body's error, now and when its cells are as small as `zones` ask.
struct ErrorSums {
  double now = 0, expected = 0;
};

void add(const BodyFields& body, const SizeField& zones, ErrorSums& sums) {
  for (int c = 0; c < static_cast<int>(body.error_of_cell.size()); ++c) {
    const double e = body.error_of_cell[c];
    sums.now += e * e;
    const Vec3 x = global_position(*body.cut_cells, c, Vec3::Zero());
    sums.expected += std::pow(e * asked_ratio(zones, x, body.cut_cells->h(c)), 2);
  }
}

int dimensions_of(const BodyFields& body) { return body.cut_cells->grid.is_quadtree() ? 2 : 3; }

/// Power of the size that a cell's error goes with.
double order_of(const BodyFields& body) { return 1 + dimensions_of(body) / 2.0; }

/// Sum of e^(6/5) over the body's cells, in plane strain of e.
double power_sum(const BodyFields& body) {
  double sum = 0;
  for (const double e : body.error_of_cell) sum += std::pow(e, dimensions_of(body) / order_of(body));
  return sum;
}

/// wanted: error, sqrt(J), of the cells that make up `sum`.
std::vector<SizedBall> sizes_for(const BodyFields& body, double wanted, double sum, double first_size) {
  std::vector<SizedBall> balls;
  const CutCells& cells = *body.cut_cells;
  for (int c = 0; c < static_cast<int>(cells.cells.size()); ++c) {
    const double e = body.error_of_cell[c];
    if (!(e > 0)) continue;
    const double ratio = wanted * std::pow(e, -1 / order_of(body)) / std::sqrt(sum), h = cells.h(c);
    const double size = between_halvings * h * std::clamp(ratio, min_ratio, max_ratio);
    if (size < first_size) balls.push_back({global_position(cells, c, Vec3::Zero()), half_diagonal * h, size});
  }
  return balls;
}

double energy_norm(const BodyFields& body) {
  double sum = 0;
  for (const double energy : body.energy_of_cell) sum += energy;
  return std::sqrt(sum);
}

/// Adds to the sizes of each body those of its partners' cells where they touch.
void add_sizes_of_partners(const Results& results, std::vector<std::vector<SizedBall>>& balls) {
  std::set<std::array<int, 3>> touching;  // body, cell, pair
  for (const ContactRow& row : results.contact_rows)
    if (row.touching) touching.insert({row.body, row.cell, row.pair});
  const std::vector<std::vector<SizedBall>> own = balls;
  for (std::size_t b = 0; b < own.size(); ++b) {
    const CutCells& cells = *results.bodies[b].cut_cells;
    const int body = static_cast<int>(b);
    for (const SizedBall& ball : own[b]) {
      const int cell = cells.locate(cells.grid.to_grid(ball.center));
      for (auto at = touching.lower_bound({body, cell, 0});
           at != touching.end() && (*at)[0] == body && (*at)[1] == cell; ++at) {
        const PairFigures& pair = results.pairs[(*at)[2]];
        for (std::size_t other = 0; other < own.size(); ++other) {
          const std::string& name = results.bodies[other].name;
          if (other != b && (name == pair.body_first || name == pair.body_second)) balls[other].push_back(ball);
        }
      }
    }
  }
}

}  // namespace

double energy_error_of_body(const BodyFields& body) {
  double sum = 0;
  for (const double e : body.error_of_cell) sum += e * e;
  const double norm = energy_norm(body);
  return norm > 0 ? std::sqrt(sum) / norm : 0;
}

double expected_energy_error(const Results& results, const std::vector<std::unique_ptr<SizeField>>& zones) {
  ErrorSums sums;
  for (std::size_t b = 0; b < results.bodies.size(); ++b) add(results.bodies[b], *zones[b], sums);
  return sums.now > 0 ? results.estimated_error_relative * std::sqrt(sums.expected / sums.now) : 0;
}

double expected_energy_error(const BodyFields& body, const SizeField& zones) {
  ErrorSums sums;
  add(body, zones, sums);
  return sums.now > 0 ? energy_error_of_body(body) * std::sqrt(sums.expected / sums.now) : 0;
}

std::vector<std::vector<SizedBall>> energy_sizes(const Results& results, double target,
                                                 const std::vector<double>& first_sizes) {
  double sum = 0;
  for (const BodyFields& body : results.bodies) sum += power_sum(body);
  std::vector<std::vector<SizedBall>> balls(results.bodies.size());
  if (!(results.estimated_error_relative > 0)) return balls;
  const double wanted = target * results.estimated_error / results.estimated_error_relative;
  for (std::size_t b = 0; b < balls.size(); ++b) balls[b] = sizes_for(results.bodies[b], wanted, sum, first_sizes[b]);
  add_sizes_of_partners(results, balls);
  return balls;
}

std::vector<SizedBall> energy_sizes(const BodyFields& body, double target, double first_size) {
  return sizes_for(body, target * energy_norm(body), power_sum(body), first_size);
}

}  // namespace cgcontact
