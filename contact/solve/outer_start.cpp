#include "contact/solve/outer_start.hpp"

#include <algorithm>

#include "contact/solve/iterate.hpp"
#include "contact/solve/solved_state.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

/// Fraction of a pair's largest pressure below which a point is not closed. SPR-C leaves none outside of the zone.
constexpr double presses = 1e-3;

/// Returns n . sigma* . d of the earlier solution at a point of a body, Pa; 0 beyond its cells.
double earlier_traction(const SolvedState& earlier, int body, const Vec3& x, const Vec3& n, const Vec3& d) {
  const CutCells& cells = earlier.bodies[body].cut_cells;
  const Vec3 position = cells.grid.to_grid(x);
  const int cell = cells.locate(position);
  if (cell < 0) return 0;
  const Sym3 stress =
      recovered_stress(earlier, earlier.sprc[body], body, cell, cell_coordinates(cells, cell, position));
  return n.dot(tensor(stress) * d);
}

/// Lagged pressure of a pair's points, Pa: that of both bodies, or of the elastic one.
std::vector<double> earlier_pressure(const SolvedState& earlier, const ContactPair& pair) {
  std::vector<double> pressure(pair.points.size());
  parallel_for("cgcontact::outer_start::contact", pressure.size(), grain_of_medium, [&](std::size_t q) {
    const ContactPoint point = pair.points[q];
    double sum = 0;
    int elastic = 0;
    for (const int body : {pair.primary, pair.secondary}) {
      if (earlier.bodies[body].spec->rigid()) continue;
      sum -= earlier_traction(earlier, body, point.x, point.normal, point.direction);
      ++elastic;
    }
    pressure[q] = sum / elastic;
  });
  return pressure;
}

}  // namespace

bool start_from(const SolvedState& earlier, Iterate& iterate) {
  const OuterProblem& problem = iterate.problem;
  std::vector<std::vector<double>> pressures;
  bool any = false;
  for (const ContactPair& pair : problem.pairs) {
    pressures.push_back(earlier_pressure(earlier, pair));
    const auto largest = std::max_element(pressures.back().begin(), pressures.back().end());
    any |= pair.bonded() || (largest != pressures.back().end() && *largest > 0);
  }
  if (!any) return false;
  const auto contact_stress = iterate.contact_stress.h_view, support_stress = iterate.support_stress.h_view;
  iterate.contact_stress.modify_host();
  iterate.support_stress.modify_host();
  std::size_t point = 0;
  for (std::size_t k = 0; k < problem.pairs.size(); ++k) {
    ContactPair& pair = problem.pairs[k];
    const double largest = *std::max_element(pressures[k].begin(), pressures[k].end());
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      pair.points.set_active(q, pair.bonded() || pressures[k][q] > presses * std::max(largest, 0.0));
      contact_stress(point++) = pressures[k][q] / problem.scales.stress;
    }
  }
  parallel_for("cgcontact::outer_start::supports", problem.supports.size(), grain_of_medium, [&](std::size_t s) {
    const SupportPoint& p = problem.supports[s];
    if (p.support < 0 || p.spring > 0) return;
    const Vec3 x = global_position(problem.bodies[p.body].cut_cells, p.cell, p.xi);
    support_stress(s) = earlier_traction(earlier, p.body, x, p.normal, p.direction) / problem.scales.stress;
  });
  for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
    const BodyMotion& motion = earlier.outer.body_motions[b];
    iterate.body_motions.move(b, motion.translation, motion.rotation, motion.centre);
  }
  return true;
}

}  // namespace cgcontact
