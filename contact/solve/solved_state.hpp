/// A solved scene: the bodies on their grids, what joins them, the solution and what was recovered from it. Simulation
/// (contact/simulation.hpp) fills it; results, error estimates and output only read it.
#pragma once

#include <vector>

#include "contact/face/face_pressures.hpp"
#include "contact/model/contact_pairs.hpp"
#include "contact/motions/free_motion.hpp"
#include "contact/solve/outer_loop.hpp"
#include "recovery/constrained/recover_stress.hpp"

namespace cgcontact {

struct SolvedState {
  explicit SolvedState(const Scene& s) : scene(s) {}
  SolvedState(const SolvedState&) = delete;

  const Scene& scene;
  Scales scales;
  std::vector<BodyModel> bodies;
  std::vector<ContactPair> pairs;
  std::vector<SupportPoint> supports;
  ElasticSystem system;
  OuterResult outer;                 ///< displacements, forces, iterations; set by take()
  std::vector<Approach> approaches;  ///< of pairs whose force depends on how stiff the bodies are
  /// By body, of each active cell, per cell unit: enters its stress in nearly incompressible bodies; empty in others.
  std::vector<std::vector<double>> mean_dilatations;
  std::vector<RecoveredField> spr;   ///< by body: near the contact faces, where it is shown
  std::vector<RecoveredField> sprc;  ///< by body: everywhere (SPR where the scene does not want SPR-C)
  FacePressures faces;               ///< zones whose pressure was solved for on the face
  RecoveryCounts recovery_counts;
  std::vector<PatchStates> patch_states;  ///< by body; empty without SPR-C
  ReferenceSpec reference;                ///< what the results are compared with

  /// Makes the scales and the system of the present supports and pairs. exec: what makes the rows of the groups.
  void make_system(const ExecSpace& exec);
  /// Takes a solution over: sets outer and mean_dilatations.
  void take(OuterResult solution);
  /// Forgets what the fields do not need and the figures have been made of: moments of the cells, points of supports.
  void release_assembly_data();
};

/// Returns the unit of OuterResult::group_force, N.
inline double force_unit(const SolvedState& state) {
  return state.scales.stress * state.scales.length * state.scales.length;
}

// Fields at a point of a body: active cell and cell coordinates; global axes.

/// Returns m.
Vec3 displacement(const SolvedState& state, int body, int cell, const Vec3& xi);
/// Evaluates the stress of the displacements, Pa.
Sym3 raw_stress(const SolvedState& state, int body, int cell, const Vec3& xi);
/// Evaluates one of the recovered fields of the body, Pa.
Sym3 recovered_stress(const SolvedState& state, const RecoveredField& field, int body, int cell, const Vec3& xi);
/// Evaluates the same at corners (bits x, y, z) of many cells; nodes that the field does not store are fitted side by
/// side.
std::vector<Sym3> recovered_stress_at_corners(const SolvedState& state, const RecoveredField& field, int body,
                                              const std::vector<int>& cells, const std::vector<signed char>& corners);

}  // namespace cgcontact
