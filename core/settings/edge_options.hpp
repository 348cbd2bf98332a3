/// Constants of the edge of contact zones: how it is found, and what of it patches take. Lengths in cells, the larger
/// ones of both bodies there. `build/serial/perf/edge_calibration` prints what each does (docs/recovery.md, "Constants
/// of the edge: an ablation").
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct EdgeOptions {
  // First estimate: sums of the transmitted forces along the edge (recovery/zone_edge/edge_fit.hpp).

  /// The sums have weight 1 from outside to `plateau` inside the edge, where the groups' own zone and the true one
  /// differ, and fall to 0 at the two ends.
  double plateau = 1, nearer_end = 3, farther_end = 4;
  /// They put the edge that much too far inside: 0.02 to 0.05 on the paper's scene in plane strain, for all ratios of
  /// the cells (0.65 to 2.6), kappa (5 to 30) and n (8 to 64) tried.
  double sums_deficit = 0.035;
  /// Times that all places are looked for: from the border of the closed points the second one is within 0.01 cells.
  int rounds = 3;

  // Second estimate: moments of the forces of a round zone as a whole (recovery/zone_edge/narrow_zone.hpp).

  /// The edges come out that much too far inside; mean of hertz.toml on one and a half to four cells over the radius.
  double moments_deficit = 0.05;
  /// Mean distance between the fitted edge and the border of the closed points; contact groups are whole cells.
  double largest_mismatch = 0.35;
  /// Where the profile of a round zone is no more Hertz's the place of the edge is a guess, and the term worse than
  /// none: part of the fourth moment; the misfit of Hertz's own grows with the cells beside that.
  double hertzian_misfit = 0.008;
  /// Nothing is said about the edges of zones narrower than that.
  double narrowest = 1.5;

  // The edge between the places found.

  /// Samples count with exp(-(distance / smoothing)^2 / 2).
  double smoothing = 1.5;
  /// Scatter of the places that the sums give; what slope and curvature against the mean direction are expected to be.
  double place_scatter = 0.02, expected_slope = 0.2;
  /// What the place of an edge may be off that the sums give.
  double expected_error = 0.015;

  // What patches take of it.

  /// Closed patches whose contact face begins closer than this to the edge (own cells) carry its term as well.
  double term_reach = 2;
  /// The edge is about half a cell off the border of the closed points; if by more than this it is not that of the
  /// patch.
  double contradiction = 0.75;
  /// Within so many own cells of an edge, two rings of cells for polynomials of degree 2; farther inside one is enough,
  /// and so it must be where the edge has a radius of less than so many.
  double two_rings_within = 3, one_ring_below = 14;
  /// Of the forces around the edges of a zone, in the mean over misfit_width, that the pressure may miss in size or
  /// place. Where it misses more the edges are not where they were found, or the pressure there does not end like a
  /// square root: it is recovered without (docs/recovery.md, "Transmitted forces").
  double largest_misfit = 0.04, misfit_width = 1.5;

  /// Beyond which forces do not count in the sums, whose edge may lie up to a cell off.
  double reach_of_sums() const { return farther_end + 1; }
  /// Where an edge has a smaller radius the sums reach across the zone, which is taken as a whole then.
  double round_below() const { return 2 * farther_end; }

  std::vector<Setting> settings();
};

}  // namespace cgcontact
