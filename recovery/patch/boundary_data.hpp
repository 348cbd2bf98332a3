/// Data of one body's boundary for the constrained recovery.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/base/numbers/cell_lists.hpp"
#include "core/cells/cut_cells.hpp"

namespace cgcontact {

/// Traction known on a region of the boundary. Directions that a support holds are unknown (no row there).
struct TractionCondition {
  bool normal_held = false;                                 ///< symmetry plane or frictionless normal support
  std::array<bool, 3> component_held{false, false, false};  ///< prescribed displacement components, global axes
  /// Other directions in which supports or springs act at x (m) with outward normal n, unit, global axes; empty: none.
  /// Thread-safe.
  std::function<std::vector<Vec3>(const Vec3& x, const Vec3& n)> held;
  /// Prescribed traction in global axes, Pa, at x (m) with outward normal n (global axes); empty: zero. Thread-safe.
  std::function<Vec3(const Vec3& x, const Vec3& n)> traction;

  bool is_support() const { return normal_held || component_held[0] || component_held[1] || component_held[2] || held; }
  /// Returns whether a support acts along the normal, or along a direction whose cosine with it is more than `cosine`.
  bool holds_normal(const Vec3& x, const Vec3& n, double cosine) const {
    bool any = normal_held;
    for (int i = 0; i < 3; ++i) any = any || (component_held[i] && std::abs(n[i]) > cosine);
    if (held && !any)
      for (const Vec3& direction : held(x, n)) any = any || std::abs(direction.dot(n)) > cosine;
    return any;
  }
};

/// Least cosine between the normals of faces that look the same way: on one side of a body.
constexpr double same_side = 0.5;

/// Contact quadrature point seen from one body.
struct ContactLink {
  int cell = -1;  ///< active cell of this body
  int pair = -1;
  Vec3 position;      ///< grid coordinates of this body
  Vec3 normal;        ///< outward, grid axes of this body
  double weight = 0;  ///< area, m^2
  int other_body = -1;
  int other_cell = -1;
  Vec3 other_position;     ///< grid coordinates of the other body
  double larger_cell = 0;  ///< m, size of the larger one of the two cells
  double distance = 0;     ///< m, from this point along the outward normal to the other body
  bool active = false;
  double pressure = 0;           ///< Pa, what the solution transmits here: constant over the closed points of a group
  double spread_pressure = 0;    ///< Pa, the same force over all points of the group: so it acts on the bodies
  bool primary = false;          ///< the points of the pair are made on this body
  Vec3 traction = Vec3::Zero();  ///< Pa, of bonded pairs: what acts on this body, grid axes; constant over a group
  Vec3 shear = Vec3::Zero();     ///< Pa, what friction acts with on this body, grid axes
  Vec3 slip = Vec3::Zero();      ///< m, of this body against the other one, grid axes
  double travelled = 0;          ///< m, length of all slip
  double wear = 0;               ///< Pa m, pressure times slip, of all steps
  bool slips = false;            ///< friction carries no more here
};

/// Boundary of one body: its default quadrature points with what is known there.
struct BoundaryData {
  std::vector<TractionCondition> conditions;
  std::vector<int> condition_of_point;  ///< per point of CutCells::boundary
  std::vector<int> pair_of_point;       ///< contact pair that the point has an opposite surface in, or -1
  std::vector<char> bonded;             ///< of each contact pair; empty: none is
  std::vector<double> friction;         ///< of each contact pair, the coefficient; empty: none has any
  std::vector<ContactLink> links;
  CellLists links_of_cell;                           ///< active cell -> contact links
  std::function<Vec3(const Vec3& x)> body_force_at;  ///< N/m^3, global axes; empty: zero. May be called by any thread.

  /// Returns whether the pair carries tension and shear; pair -1: none.
  bool is_bonded(int pair) const { return pair >= 0 && !bonded.empty() && bonded[pair]; }
  double friction_of(int pair) const { return pair >= 0 && !friction.empty() ? friction[pair] : 0; }
};

}  // namespace cgcontact
