/// Run to an accuracy: solves on grids that are refined until the estimated errors are below the targets of [accuracy],
/// or a limit is reached. The method: docs/adaptivity.md.
#pragma once

#include <chrono>
#include <memory>

#include "contact/adaptive/displacement_error.hpp"
#include "contact/adaptive/next_grid.hpp"
#include "contact/adaptive/singular_points.hpp"
#include "contact/adaptive/two_grid_estimate.hpp"
#include "contact/simulation.hpp"

namespace cgcontact {

struct AdaptiveCallbacks : ProgressCallbacks {
  /// After each solve; its number begins with 1.
  std::function<void(int number, const SolveFigures&)> solved = [](int, const SolveFigures&) {};
};

/// Throws InputError if the first grids have more unknowns than accuracy.max_unknowns.
void check_first_grids(const Scene& scene, const std::vector<BodyModel>& bodies);

/// Describes a solve in one line: unknowns, time, estimated errors.
std::string describe(int number, const SolveFigures& solve);

class AdaptiveRun {
 public:
  /// The scene must outlive this. Throws InputError for a body without volume.
  explicit AdaptiveRun(const Scene& scene);

  /// Throws InputError for what a single run would refuse on the first grid.
  void run(const AdaptiveCallbacks& callbacks);

  /// Returns the solve that AccuracyFigures::answer names; Results::accuracy has all.
  Simulation& simulation() { return *simulation_; }
  /// Returns its scene, with its grids.
  const Scene& scene() const { return *scene_; }

 private:
  bool set_up(const AdaptiveCallbacks& callbacks);
  bool set_up_within(double allowed, double factor, const AdaptiveCallbacks& callbacks);
  void refine(const AdaptiveCallbacks& callbacks);
  ErrorFigures solve(const AdaptiveCallbacks& callbacks);
  void keep(const SolveFigures& solve, const ErrorFigures& errors);
  void take_best();
  std::vector<std::vector<CellEnergies>> energies() const;
  std::string needed_text() const;
  void tell_other_times(double all, double paths, Results& results) const;
  bool is_out_of_time() const;
  double allowed_unknowns() const;
  double seconds_of_cells(double unknowns) const;
  double forecast() const;
  double excess(double allowed);
  double seconds() const;
  bool has_solution() const;
  std::string after_failure() const;
  std::string standstill() const;
  bool stands_still() const;

  /// A solve that is kept while later ones are worse.
  struct Kept {
    std::unique_ptr<Scene> scene;
    std::unique_ptr<Simulation> simulation;
    std::size_t number = 0;
    double factor = 0;  ///< its errors over their targets
  };

  /// Energies of a solve that converged.
  struct SolveEnergies {
    std::size_t number = 0;
    bool begins = false;  ///< zones were not resolved before
    std::vector<CellEnergies> of_bodies;
  };

  const Scene& given_;
  GridSizes sizes_;
  std::unique_ptr<Scene> scene_, next_scene_;
  std::unique_ptr<Simulation> simulation_, next_;
  std::size_t number_ = 0;  // of the solve in simulation_
  Kept best_;               // simulation: none, the present one is better
  AccuracyFigures figures_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::vector<ZoneState> zones_;  // of the last solve
  std::vector<SolveEnergies> energies_;
  DisplacementState displacements_;          // of the last solve that converged
  std::vector<double> displacement_errors_;  // of the last solve that converged
  bool resolved_ = false;                    // all zones are
  bool may_converge_when_finer_ = false;     // the last solve, if it has not
  std::string refused_;                      // why a next grid could not be made
  double search_ = 0;                        // s, for zones after the last solve: takes no longer with more unknowns
  double begin_ = 0;                         // s, when the last solve had ended
  double own_ = 0;                           // s, of the last solve and its own grid; others may have been tried before
  const char* limit_ = "";                   // that binds the next grid
  double needed_ = 0;                        // unknowns of the grid that the targets ask for
  bool is_counted_ = false;                  // that grid was made; else its unknowns are an estimate
};

}  // namespace cgcontact
