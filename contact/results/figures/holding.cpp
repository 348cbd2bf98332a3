#include "contact/results/figures/holding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "contact/checks/condition_checks.hpp"
#include "contact/model/around_axis.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/figures/postprocess.hpp"

namespace cgcontact {
namespace {

/// Force (N) and moment about the middle of the body (N m) of what holds it.
std::pair<Vec3, Vec3> holding_resultants(const SolvedState& state, int body) {
  const BodyModel& model = state.bodies[body];
  const Vec3 middle = 0.5 * (model.low + model.high);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t s = 0; s < state.supports.size(); ++s) {
    const SupportPoint& p = state.supports[s];
    if (p.support >= 0 || p.body != body) continue;
    const Vec3 f = p.weight * state.outer.support_stress[s] * p.direction;
    force += f;
    moment += (global_position(model.cut_cells, p.cell, p.xi) - middle).cross(f);
  }
  sum_around_axis(*model.spec, force, &moment);
  return {force, moment};
}

double largest_contact(const SolvedState& state, int body) {
  const std::vector<double> forces = normal_forces(state);
  double largest = 0;
  for (std::size_t k = 0; k < forces.size(); ++k)
    if (state.pairs[k].primary == body || state.pairs[k].secondary == body)
      largest = std::max(largest, std::abs(forces[k]));
  return largest;
}

std::string pair_fault(const SolvedState& state, const std::vector<BodyBalance>& balance, std::size_t k,
                       double normal) {
  const ContactPair& pair = state.pairs[k];
  double worst = 0;
  int body = pair.primary;
  for (const int b : {pair.primary, pair.secondary})
    if (const double here = imbalance(balance[b]); here > worst) {
      worst = here;
      body = b;
    }
  const double allowed = state.scene.results.largest_imbalance * std::abs(normal);
  const bool pulls = normal < 0;
  if (!pulls && worst <= allowed) return "";
  const double slices = state.bodies[pair.primary].slices;
  return fmt::format(
      "contact \"{}\": its force of {:.3g} N {}: the forces on \"{}\" balance to {:.3g} N only (solver.tolerance, "
      "solver.linear_tolerance); it carries next to nothing beside the other forces, or has been lost",
      pair.spec->name, slices * normal, pulls ? "pulls" : "is none that is known", state.scene.bodies[body].name,
      slices * worst);
}

}  // namespace

Vec3 holding_force(const SolvedState& state, int body) { return holding_resultants(state, body).first; }

double held_fraction(const SolvedState& state, int body) {
  const double contact = largest_contact(state, body);
  if (!(contact > 0)) return 0;
  const auto [force, moment] = holding_resultants(state, body);
  return std::max(force.norm(), 2 * moment.norm() / longest_extent(state.bodies[body])) / contact;
}

double held_fraction(const SolvedState& state, const ContactPair& pair) {
  return std::max(held_fraction(state, pair.primary), held_fraction(state, pair.secondary));
}

double held_force_fraction(const SolvedState& state, const std::vector<BodyBalance>& balance) {
  double most = 0;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    const double contact = largest_contact(state, b);
    if (contact > 0)
      most = std::max(most, std::abs(holding_force(state, b).dot(balance[b].contact.stableNormalized())) / contact);
  }
  return most;
}

std::string surface_hold_warning(const SolvedState& state) {
  std::set<int> held;
  for (const SupportPoint& p : state.supports)
    if (p.holds_along_surface) held.insert(p.body);
  if (held.empty()) return "";
  const auto fraction = [&](int b) { return held_fraction(state, b); };
  const int most = *std::max_element(held.begin(), held.end(), [&](int a, int b) { return fraction(a) < fraction(b); });
  return fmt::format(
      "{} held by contact alone would drift along the surfaces by many cells, unloaded: fixed there, which takes at "
      "most {:.2g} % of the largest contact force (body \"{}\"); smaller cells at the contact reduce it",
      held.size() == 1 ? "a body" : fmt::format("{} bodies", held.size()), 100 * fraction(most),
      state.bodies[most].spec->name);
}

double imbalance(const BodyBalance& balance) { return (balance.loads + balance.supports + balance.contact).norm(); }

bool contact_carries(const SolvedState& state) {
  const std::vector<PairFigures> pairs = pair_figures(state, {});
  return std::any_of(pairs.begin(), pairs.end(),
                     [](const PairFigures& pair) { return pair.force_on_first.norm() > 0; });
}

std::string contact_fault(const SolvedState& state) {
  const std::vector<PairFigures> pairs = pair_figures(state, {});
  const std::vector<BodyBalance> balance = balance_of_bodies(state, support_figures(state), pairs);
  const std::vector<double> forces = normal_forces(state);
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const double normal = forces[k];
    if (state.pairs[k].bonded() || !(pairs[k].force_on_first.norm() > 0)) continue;
    if (const std::string fault = pair_fault(state, balance, k, normal); !fault.empty()) return fault;
  }
  return "";
}

std::string held_contact(const SolvedState& state, const std::vector<ContactRow>& rows) {
  std::vector<double> closed(state.pairs.size(), 0.0), held(state.pairs.size(), 0.0);
  for (const ContactRow& row : rows) {
    if (!row.active || state.pairs[row.pair].bonded()) continue;
    closed[row.pair] += row.weight;
    if (!row.touching) held[row.pair] += row.weight;
  }
  for (std::size_t k = 0; k < state.pairs.size(); ++k)
    if (held[k] > rim * closed[k])
      return fmt::format(
          "contact \"{}\" acts on {:.3g} m2 whose normal a support holds: hold another face, or a part of this one "
          "away from the contact (faces = [{{.., box = {{..}}}}])",
          state.pairs[k].spec->name, state.bodies[state.pairs[k].primary].slices * held[k]);
  return "";
}

}  // namespace cgcontact
