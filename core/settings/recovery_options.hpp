/// Settings of the recovery of the stress. What each means stands in settings().
#pragma once

#include "core/settings/face_options.hpp"

namespace cgcontact {

/// Degree (1 or 2) of the recovered polynomials by class of patch; 0 at the contact: 2 where closed and both bodies
/// thick.
struct RecoveryDegree {
  int interior = 1;  ///< full cells only, no contact face
  int boundary = 1;  ///< neither interior nor contact
  int contact = 0;   ///< patches that hold points of a contact face, closed or open
};

/// Constants of the balance with the transmitted forces (docs/recovery.md, "Transmitted forces"), found on punches,
/// wedges and cones. Lengths in cells, the larger ones of both bodies there.
struct BalanceOptions {
  /// Scatter of the force of a node that has half a cell's face or more, relative to the pressure around: that of
  /// single groups. With less, by the root of the area more.
  double node_scatter = 0.05;
  /// Width (standard deviation) of the mean, what it may be off without any change, and from where on all of it is
  /// changed. Smooth contacts are within.
  double mean_width = 1, mean_exact = 0.03, mean_wrong = 0.06;
  /// Fraction of the force by which the total may be farther off than that of the plain recovery.
  double total_exact = 0.003;
};

/// Source of the contact pressure.
enum class PressureSource {
  stress,  ///< SPR-C: the normal traction of the recovered stress
  face     ///< a problem on the face of each zone that has one; of others the stress
};

struct RecoveryOptions {
  bool spr_c = true;
  double rank_tolerance = 0.1, auxiliary_depth = 0.5;
  bool contact_edge = true;
  PressureSource pressure = PressureSource::face;
  RecoveryDegree degree = {};
  int quadratic_rings = 0, points_per_face = 0;
  double patch_volume = 1;
  bool inverse_variance = true;

  // Constants of the method.

  /// Fraction of rank_tolerance for degree 2 and for bodies of revolution: the rows of the curvature of a traction, and
  /// those by which the stress turns about the axis, are weak ones although not redundant (docs/recovery.md).
  double weak_rank_fraction = 0.1;
  /// A patch counts as closed when at least this fraction of its contact area is (one of four equal cells: whatever the
  /// rounding). Paper's scene, mean over 7 grid offsets, error of the pressure at n = 8, 16, 32: any closed point .159
  /// .080 .038, a quarter .149 .067 .035, half .216 .097 .041.
  double closed_fraction = 0.25;
  /// Cells across both bodies from which on patches with closed contact are of degree 2 (docs/recovery.md, "Degree").
  int thick = 4;
  /// Least volume of an auxiliary patch, cells: less carries no linear polynomial of six components.
  double min_auxiliary_volume = 0.25;
  /// Largest ratio of the weights of both bodies' misfits in a coupled patch.
  double max_weight = 1e4;
  /// Residual of normalised rows over the stress level of the patch above which the data contradict each other.
  double conflict = 0.01;
  /// Patches whose contact face begins closer to the edge of a zone than that carry the edge's term, cells of the body.
  double term_reach = 2;
  /// Rank tolerance of the rows of open faces alone: they agree with each other (docs/recovery.md, "Truncation").
  double firm_tolerance = 1e-3;
  FaceOptions face = {};
  BalanceOptions balance = {};

  double rank_tolerance_of(int of_degree, bool of_revolution = false) const {
    return of_degree == 1 && !of_revolution ? rank_tolerance : weak_rank_fraction * rank_tolerance;
  }

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
