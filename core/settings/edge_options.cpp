#include "core/settings/edge_options.hpp"

namespace cgcontact {

std::vector<Setting> EdgeOptions::settings() {
  const auto cells = [](const std::string& key, double& value) {
    return method_constant("edge." + key, value, Range::positive("cells"));
  };
  return {method_constant("edge.plateau", plateau, Range::not_negative("cells")),
          cells("nearer_end", nearer_end),
          cells("farther_end", farther_end),
          method_constant("edge.sums_deficit", sums_deficit, Range::from_to(-0.5, 0.5, "-0.5 to 0.5 cells")),
          method_constant("edge.rounds", rounds, Range::integers(1, 20)),
          method_constant("edge.moments_deficit", moments_deficit, Range::from_to(-0.5, 0.5, "-0.5 to 0.5 cells")),
          cells("largest_mismatch", largest_mismatch),
          method_constant("edge.hertzian_misfit", hertzian_misfit, Range::fraction()),
          method_constant("edge.narrowest", narrowest, Range::not_negative("cells")),
          cells("smoothing", smoothing),
          cells("place_scatter", place_scatter),
          cells("expected_slope", expected_slope),
          cells("expected_error", expected_error),
          method_constant("edge.term_reach", term_reach, Range::not_negative("cells")),
          cells("contradiction", contradiction),
          method_constant("edge.two_rings_within", two_rings_within, Range::not_negative("cells")),
          method_constant("edge.one_ring_below", one_ring_below, Range::not_negative("cells")),
          method_constant("edge.largest_misfit", largest_misfit, Range::fraction()),
          cells("misfit_width", misfit_width)};
}

}  // namespace cgcontact
