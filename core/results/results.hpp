/// Results of a run for the output: fields as functions, contact rows, figures. SI units, global axes.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/cells/cut_cells.hpp"
#include "core/results/friction_figures.hpp"
#include "core/results/zone_figures.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// How a rigid body has moved, and the moments on it.
struct RigidFigures {
  Vec3 centre = Vec3::Zero();                                                  ///< m, centroid of its volume
  Vec3 displacement = Vec3::Zero();                                            ///< m, there
  Vec3 rotation = Vec3::Zero();                                                ///< rad, small: axis times angle
  Vec3 loads = Vec3::Zero(), supports = Vec3::Zero(), contact = Vec3::Zero();  ///< N m, moments about the centre
};

/// Fields of one body; `cell` is an active cell, xi the cell coordinates in [-1,1]^3.
struct BodyFields {
  std::string name;
  const CutCells* cut_cells = nullptr;
  Material material;
  std::optional<RigidFigures> rigid;                               ///< of a rigid body
  std::function<Vec3(int cell, const Vec3& xi)> displacement;      ///< m
  std::function<Sym3(int cell, const Vec3& xi)> stress_raw;        ///< Pa, sigma_h
  std::function<Sym3(int cell, const Vec3& xi)> stress_recovered;  ///< Pa, sigma*
  /// The same at corners of many cells, which is faster than one by one: bits x, y, z of each corner. May be empty.
  std::function<std::vector<Sym3>(const std::vector<int>& cells, const std::vector<signed char>& corners)>
      stress_at_corners;
  std::vector<double> error_of_cell;   ///< estimated error, energy norm per active cell, sqrt(J)
  std::vector<double> energy_of_cell;  ///< of the solution: square of its energy norm per active cell, J
  /// Per active cell: the largest numbers of the patches of its eight nodes (Results::patch_kinds, patch_statuses).
  /// Empty without constrained recovery.
  std::vector<unsigned char> patch_kind, patch_status;
  /// Index into Scene::contacts for each boundary point that has something opposite, else -1.
  std::vector<int> contact_of_point;
};

struct Extreme {
  double value = 0;
  Vec3 at = Vec3::Zero();  ///< m, undeformed
};

/// Largest values at the points of a drawn mesh; stresses are those of the recovered field, Pa.
struct Extremes {
  Extreme displacement;  ///< m
  Extreme von_mises, tresca;
  Extreme tension, compression;         ///< the largest and the smallest principal stress, tension positive
  std::optional<Extreme> pressure;      ///< of the contact; none: no contact face
  std::optional<double> safety_factor;  ///< yield stress over the largest von Mises stress
};

/// Extremes of one body and of its declared faces.
struct BodyExtremes {
  Extremes body;
  std::vector<std::pair<std::string, Extremes>> faces;  ///< by name
};

/// Values at one point of a probe, in one body.
struct ProbeSample {
  int point = 0, body = 0;
  double way = 0;              ///< ProbeSpec::way
  Vec3 x = Vec3::Zero();       ///< m
  std::vector<double> values;  ///< of the fields of the probe; NaN: no contact face here (pressure)
  double weight = 0;           ///< m^2, of the points of a face
};

struct ProbeFigures {
  std::string name;
  ProbeSpec::Kind kind = ProbeSpec::Kind::point;
  std::vector<ScalarField> fields;
  std::size_t points = 0, outside = 0;  ///< points asked for, and those of them that no body holds
  std::vector<ProbeSample> samples;     ///< by point, then by body
};

/// One boundary point of a contact face.
struct ContactRow {
  int body = 0;
  int pair = 0;
  int cell = 0;            ///< active cell of the body
  double larger_cell = 0;  ///< m, size of the larger cell of the two that meet; nothing opposite: at most there
  Vec3 x = Vec3::Zero(), normal = Vec3::Zero();  ///< m; outward
  double weight = 0;                             ///< m^2
  double gap = 0;                                ///< m, after deformation, positive when open
  double distance = 0;  ///< m, of the geometry before, without interference; infinite: nothing opposite
  double pressure_raw = 0, pressure_spr = 0, pressure_sprc = 0;  ///< Pa, positive in compression
  double pressure_opposite = 0;     ///< Pa, SPR-C of the other body; NaN: nothing opposite, or rigid
  double pressure_transmitted = 0;  ///< Pa, what the solution transmits at the nearest contact point; NaN: none
  double pressure_error = 0;        ///< Pa, estimated error of pressure_sprc
  Sym3 stress_raw = Sym3::Zero(), stress_spr = Sym3::Zero(), stress_sprc = Sym3::Zero();  ///< Pa
  bool active = false;
  /// With friction: traction of the other body on this one, Pa (as transmitted, SPR-C); how far this body has slipped
  /// on the other one, m; the way that it has rubbed, m; pressure times slip, Pa m, of all steps; whether it slips
  /// here.
  Vec3 shear_transmitted = Vec3::Zero(), shear_sprc = Vec3::Zero(), slip = Vec3::Zero();
  double travelled = 0, wear = 0;
  bool slips = false;
  /// Closed, or open beside closed points: where the contact zone can be. These rows give area, largest pressure and
  /// force of the recovered pressure.
  bool touching = false;
};

/// Work of one of several ranks in the linear solver, and its memory.
struct RankFigures {
  double unknowns = 0, ghosts = 0, cut_cells = 0;  ///< of the finest grid: own, of others, cells computed here
  double messages = 0, sent_bytes = 0;             ///< of ghost values, all linear solves and their set-up
  double reductions = 0, reduced_bytes = 0;        ///< sums over all ranks
  double peak_memory_bytes = 0;
};

/// Pressure along the scene's path, one entry per sample and body.
struct PathSample {
  int body = 0;
  int pair = 0;
  double s = 0;  ///< m, the coordinate that the reference uses, else arc length
  Vec3 x = Vec3::Zero();
  double pressure_raw = 0, pressure_spr = 0, pressure_sprc = 0;
  bool has_reference = false;
  double pressure_reference = 0;
};

/// Stress error at a contact point against the reference, for stress_error.svg.
struct StressErrorSample {
  int body = 0;
  Vec3 x = Vec3::Zero();
  double error_raw = 0, error_spr = 0, error_sprc = 0;  ///< Frobenius norm of the stress difference, Pa
};

/// Figures of one contact pair.
struct PairFigures {
  std::string name, body_first, body_second;
  /// Tied faces: the area is that of all points, pressures are normal tractions (tension negative), the centre is that
  /// of the area.
  bool bonded = false;
  Vec3 force_on_first = Vec3::Zero(), force_on_second = Vec3::Zero();    ///< N
  Vec3 moment_on_first = Vec3::Zero(), moment_on_second = Vec3::Zero();  ///< N m about the origin
  /// Figures of the contact zone (ContactRow::touching); without contact all are exactly zero.
  double area = 0;                      ///< m^2, where the pressure is positive (closed points without SPR-C)
  double max_pressure = 0;              ///< Pa, of the SPR-C pressure (SPR when SPR-C is off)
  Vec3 max_pressure_at = Vec3::Zero();  ///< m
  Vec3 centre = Vec3::Zero();           ///< m, of the transmitted pressure: where the resultant acts
  int points = 0, active_points = 0;
  double interference = 0;             ///< m, as the scene gives it, or as found for the preload
  std::optional<double> preload;       ///< N
  double pressure_error_estimate = 0;  ///< of the recovered pressure, relative L2 over both faces
  /// Relative error of the pressure by that of the force, which a problem on the face takes as it is: beside the
  /// estimate, at the force of the run; with [accuracy] in it. 0 where the stress gives the pressure, whose estimate
  /// has it.
  double force_error_of_pressure = 0;
  bool pressure_on_face = false;  ///< that is from problems on the faces wherever the faces touch
  /// Zones without a problem on the face, whose pressure is that of the stress: the zone reaches the end of a face, or
  /// the face turns by more than 30 degrees and is not round about one axis, or the zone is more than some 90 cells
  /// across.
  int zones_of_stress = 0;
  /// Relative; zero where the loads give all of the force, none where nothing is transmitted or the zone is not
  /// resolved.
  std::optional<double> force_error_estimate;
  std::optional<double> max_pressure_error_estimate;  ///< relative; none: no contact, not resolved, or singular there
  bool force_given_by_loads = false;                  ///< its resultant, by equilibrium alone
  /// Smallest gap left between faces that nothing presses, and its estimated error, m; beside closed points the deepest
  /// overlap that was missed (negative, error 0); none: contact without such, or nothing opposite.
  std::optional<double> min_gap, min_gap_error;
  Vec3 min_gap_at = Vec3::Zero();           ///< m
  double min_gap_cell = 0;                  ///< m, size of the larger cell there
  ZoneFigures zone;                         ///< of the last step
  std::optional<FrictionFigures> friction;  ///< none: the scene has no friction there
};

/// Returns the force to tell of a pair, N: its resultant, or the sum of its normal forces where most of these balance
/// each other, as around a shaft.
inline double told_force(const PairFigures& pair) {
  const double resultant = pair.force_on_first.norm();
  return pair.zone.normal_force > 2 * resultant ? pair.zone.normal_force : resultant;
}

/// Verdict on a run: whether its contact can be used, and if not, what would help.
struct Verdict {
  enum class State { resolved, not_resolved, contact_missed, not_converged, no_contact };
  struct Pair {
    std::string name;
    State state = State::no_contact;
    /// Cells of the coarser body across the narrowest zone that matters; none: no open points bound the zone.
    std::optional<double> cells_across;
    std::optional<double> cell_size_needed;  ///< m, at most, of both bodies; where the zone is not resolved or missed
    std::optional<State> of_closed;          ///< of the closed points alone, where the pair has missed another zone
    /// Returns the state of what is closed.
    State closed_state() const { return of_closed.value_or(state); }
  };
  State state = State::resolved;
  std::string text;                ///< one sentence
  std::vector<std::string> notes;  ///< places where the pressure is wrong, but that carry next to nothing
  std::vector<Pair> pairs;
  double spring_share =
      0;  ///< the fraction of a push on a body that springs take beside contact, where it is too large
};

/// "resolved", "not_resolved", ... as in report.json.
inline const char* name_of(Verdict::State state) {
  constexpr const char* names[] = {"resolved", "not_resolved", "contact_missed", "not_converged", "no_contact"};
  return names[static_cast<int>(state)];
}

/// Reaction of one support.
struct SupportFigures {
  std::string face;            ///< "body.face"
  Vec3 force = Vec3::Zero();   ///< N, acts on the body
  std::string condition;       ///< "symmetry", "x = 0, z = -1.6e-06 m"
  double area = 0;             ///< m^2
  Vec3 moment = Vec3::Zero();  ///< N m, about the next; in plane strain about the axis alone
  Vec3 about = Vec3::Zero();   ///< m: the centroid of the face
};

/// Resultant of one load, as it acts in the last step.
struct LoadFigures {
  std::string face;            ///< "body.face", or the body that a body force acts on
  std::string condition;       ///< "pressure 0 .. 1e+07 Pa, traction"
  Vec3 force = Vec3::Zero();   ///< N
  double area = 0;             ///< m^2; of a body force: its volume, m^3
  bool of_body = false;        ///< a body force
  Vec3 moment = Vec3::Zero();  ///< N m, about the next
  Vec3 about = Vec3::Zero();   ///< m: where the force is said to act, else the centroid of the face or the body
};

/// Resultants of what acts on one body; they sum to zero up to the tolerance of the linear solver.
struct BodyBalance {
  std::string body;
  Vec3 loads = Vec3::Zero(), supports = Vec3::Zero(), contact = Vec3::Zero();  ///< N; loads with body forces
  /// N, share of `supports` that holds motions which the scene leaves free: exactly zero but for the cells.
  Vec3 holds = Vec3::Zero();
};

/// One step of several: what was on, how it was solved, its contact pairs (without estimated errors).
struct StepFigures {
  StepSpec step;
  int outer_iterations = 0;
  bool converged = false;
  std::vector<PairFigures> pairs;
  std::optional<double> displacement;  ///< m, the largest at the points of the drawn meshes; set when it is written
};

/// One solve on larger cells that a run on given ones starts from (NestedRun).
struct CoarseSolve {
  long long unknowns = 0;
  int outer_iterations = 0;
  bool converged = false;
};

/// One solve of a run to an accuracy (AdaptiveRun).
struct SolveFigures {
  long long unknowns = 0;
  double seconds = 0;  ///< wall time, with its grids
  int outer_iterations = 0, levels = 1;
  double smallest_cell = 0;  ///< m
  bool converged = false;
  /// Estimated relative errors: of the pressure and the force the largest of all pairs that matter, none while their
  /// zones are not resolved; of the stress in the energy norm.
  std::optional<double> pressure, force;
  std::optional<double> shear;  ///< the largest of all pairs that carry shear; none: no friction, or not known
  double stress = 0;
  std::vector<double> stress_of_body;  ///< of the bodies of AccuracyFigures::stress_of_body
  /// Errors of AccuracyFigures::named; none: not known, as the pressure.
  std::vector<std::optional<double>> named;
  /// Relative L2 norm of the change of the pressure since the solve before, the largest of all pairs; none: its zones
  /// were not resolved.
  std::optional<double> change;
};

/// Requested accuracy, and how the run went.
struct AccuracyFigures {
  bool asked = false, reached = false;
  std::string text;                                      ///< what stopped it, if it is not reached
  std::optional<double> pressure, force, shear, stress;  ///< targets
  std::vector<BodyTarget> stress_of_body;                ///< the same
  std::vector<NamedTarget> named;                        ///< the same
  std::vector<SolveFigures> solves;
  int answer = -1;     ///< number of the solve that has the results, from 0; -1: the last one that converged
  double seconds = 0;  ///< of all solves and grids, those too that were made and not solved on; 0: not known
};

/// Position where the stress has no finite value: from solve to solve it grows like a negative power of the cell size.
struct SingularPoint {
  std::string body;
  std::vector<std::string> faces;  ///< of the body, with those of supports and loads, that come near
  Vec3 x = Vec3::Zero();           ///< m
  double exponent = 0;             ///< stress ~ h^-exponent
  double cell = 0;                 ///< m, on the last grid
};

/// Solution of the linear systems.
struct LinearSolverFigures {
  std::string method, preconditioner;     ///< as in the scene
  std::vector<int> grid_unknowns;         ///< of geometric multigrid, finest first; empty: MueLu on the whole system
  std::vector<long long> cycles_of_grid;  ///< how often each grid was worked on
  std::vector<int> muelu_unknowns;        ///< of MueLu's levels; one: a direct solve
  int muelu_setups = 0;
};

/// Relative L2 error of the pressure in a zone.
struct ZoneError {
  std::string zone;
  double raw = 0, spr = 0, sprc = 0;
};

struct Results {
  std::string scene_file, title, backend;
  std::string command;  ///< the command line, quoted for a shell; empty: not run by the program
  int threads = 1;      ///< of each rank
  int ranks = 1;
  long long unknowns = 0;
  struct CellCounts {
    long long active = 0, cut = 0, interior = 0;
    long long joined =
        0;  ///< with a neighbour: less than GeometryOptions' fraction of them was the body's, which is rounding
  } cells;
  std::vector<CoarseSolve> coarse_solves;  ///< before it, coarsest first
  int outer_iterations = 0;
  std::vector<int> linear_iterations;
  LinearSolverFigures linear_solver;
  std::vector<double> outer_residuals;
  std::vector<long long> active_of_iteration;  ///< closed contact points after each outer iteration
  long long active_points = 0;
  bool converged = false;
  std::string diagnosis;  ///< why not, if not
  Verdict verdict;
  std::vector<std::string> warnings;
  std::vector<PairFigures> pairs;
  std::vector<StepFigures> steps;  ///< in order, the last one too; empty without [steps]
  std::vector<SupportFigures> supports;
  std::vector<LoadFigures> loads;
  std::vector<BodyExtremes> extremes;                        ///< by body; filled when they are written
  std::vector<ProbeFigures> probes;                          ///< as in the scene
  std::vector<BodyBalance> balance;                          ///< by body
  double estimated_error = 0, estimated_error_relative = 0;  ///< sqrt(J); relative to the energy norm of the solution
  double displacement_error_estimate = 0;  ///< relative, of the displacement that the loads do their work on
  bool has_effectivity = false;
  double exact_error = 0, effectivity = 0;
  std::vector<std::string> patch_kinds, patch_statuses;  ///< names of the numbers in BodyFields
  std::vector<std::pair<std::string, long long>> patches_by_kind, patches_by_status;  ///< those that occur, in order
  long long grown_patches = 0, truncated_rows = 0, inconsistent_patches = 0;
  long long quadratic_patches = 0, lowered_patches = 0;  ///< of degree 2; of degree 1 where 2 was asked for
  std::vector<std::pair<std::string, double>> times_s;   ///< phases in order
  long long peak_memory_bytes = 0;                       ///< of the rank with most
  std::vector<RankFigures> rank_figures;                 ///< of each rank; one rank: none
  std::vector<BodyFields> bodies;
  std::vector<ContactRow> contact_rows;
  std::vector<PathSample> path;
  bool path_from_largest = false;  ///< the path runs through the largest pressure of each pair, s is zero there
  std::vector<StressErrorSample> stress_errors;
  std::vector<ZoneError> pressure_errors;
  AccuracyFigures accuracy;
  std::vector<SingularPoint> singular_points;  ///< with [accuracy], from two solves on
};

/// Adds a warning, once, however many steps give it.
inline void add_warning(Results& results, const std::string& warning) {
  std::vector<std::string>& all = results.warnings;
  if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
}

/// Returns whether any pair has a friction coefficient.
inline bool has_friction(const Results& results) {
  for (const PairFigures& pair : results.pairs)
    if (pair.friction) return true;
  return false;
}

}  // namespace cgcontact
