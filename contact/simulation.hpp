/// The whole computation, one call per step: the page to read first.
#pragma once

#include "contact/progress.hpp"
#include "contact/solve/forces/preload.hpp"
#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// The steps of a run, and what they leave behind.
class Simulation {
 public:
  explicit Simulation(const Scene& scene, const ExecSpace& exec = ExecSpace())
      : state(scene), exec_(exec), preload_(scene) {}
  Simulation(const Simulation&) = delete;

  SolvedState state;
  Results results;  ///< refers to the state

  /// Reads as the flow: grids, cut cells, operator, contact, solve, recovery, error estimate, results. Throws
  /// InputError.
  void run(const ProgressCallbacks& progress);
  /// Steps of a simulation: making the grids; solving on them, with all results. The pressure along the paths that are
  /// drawn may come later. earlier: a solution on other grids to start from, or none.
  void set_up(const ProgressCallbacks& progress);
  void solve(const ProgressCallbacks& progress, const SolvedState* earlier = nullptr, bool with_paths = true);
  /// Halves of solve: up to the displacements, and what follows from them.
  void solve_system(const ProgressCallbacks& progress, const SolvedState* earlier);
  void finish(const ProgressCallbacks& progress, bool with_paths);
  void sample_paths(const ProgressCallbacks& progress);
  /// Preloads begin with what the same scene has on other grids.
  void start_preloads_from(const Simulation& earlier) { preload_.start_from(earlier.preload_); }

  /// Steps, for programs that measure them one by one; between the second and the third comes the solution.
  void set_up_grids();
  void make_system();
  void recover();
  void fill_results();

 private:
  void fill_forces();
  void fill_fields();
  void estimate_errors();
  void warn_of_results();
  void choose_reference();

  ExecSpace exec_;  ///< what kernels run on
  Preload preload_;
  double expected_memory_ = 0;  ///< bytes
};

}  // namespace cgcontact
