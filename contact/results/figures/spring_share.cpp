#include "contact/results/figures/spring_share.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/errors/suggest.hpp"
#include "core/base/files/text.hpp"

namespace cgcontact {
namespace {

/// Pressing force of contact on a body that resists a push along `push` (unit), N.
double resisted_by_contact(const SolvedState& state, const Results& results, int body, const Vec3& push) {
  double resisted = 0;
  for (std::size_t k = 0; k < results.pairs.size(); ++k) {
    if (results.pairs[k].bonded) continue;
    const ContactSpec& spec = *state.pairs[k].spec;
    if (spec.first.body == body) resisted += std::max(0.0, -results.pairs[k].force_on_first.dot(push));
    if (spec.second.body == body) resisted += std::max(0.0, -results.pairs[k].force_on_second.dot(push));
  }
  return resisted;
}

double largest_contact(const SolvedState& state, const Results& results, int body) {
  double largest = 0;
  for (std::size_t k = 0; k < results.pairs.size(); ++k)
    if (state.pairs[k].spec->first.body == body || state.pairs[k].spec->second.body == body)
      largest = std::max(largest, results.pairs[k].force_on_first.norm());
  return largest;
}

/// "springs of the scene take 40 % of what presses body "ball" into its contact (20 N, on "ball.top")".
std::string describe(const SpringShare& share, const SolvedState& state) {
  const BodyModel& body = state.bodies[share.body];
  return fmt::format("springs of the scene take {} % of what presses body \"{}\" into its contact ({}, on {})",
                     percent_number(share.share), body.spec->name, scaled(body.slices * share.force, "N", 3),
                     join(share.faces));
}

}  // namespace

std::vector<SpringShare> spring_shares(const SolvedState& state, const Results& results) {
  std::vector<SpringShare> shares;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    SpringShare found;
    found.body = b;
    Vec3 force = Vec3::Zero();
    for (std::size_t s = 0; s < results.supports.size(); ++s) {
      const SupportSpec& support = state.scene.supports[s];
      if (support.face.body != b || !support.is_elastic()) continue;
      force += results.supports[s].force;
      found.faces.push_back('"' + results.supports[s].face + '"');
    }
    found.force = force.norm();
    const double allowed = state.scene.results.largest_imbalance;
    if (!(found.force > allowed * largest_contact(state, results, b))) continue;
    const double resisted = resisted_by_contact(state, results, b, -force.normalized());
    found.share = found.force / (found.force + resisted);
    if (resisted > 0 && found.share > allowed) shares.push_back(found);
  }
  return shares;
}

void report_spring_shares(const SolvedState& state, Results& results) {
  if (results.verdict.state == Verdict::State::not_converged) return;
  std::vector<SpringShare> shares = spring_shares(state, results);
  std::stable_sort(shares.begin(), shares.end(),
                   [](const SpringShare& a, const SpringShare& b) { return a.share > b.share; });
  for (std::size_t k = 0; k < shares.size(); ++k)
    if (k > 0)
      results.warnings.push_back(describe(shares[k], state));
    else
      results.verdict.text += "; " + describe(shares[k], state);
  if (!shares.empty() && shares.front().share > state.scene.results.largest_hold)
    results.verdict.spring_share = shares.front().share;
}

}  // namespace cgcontact
