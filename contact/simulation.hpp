/// The whole computation, one call per step: the page to read first.
#pragma once

#include <functional>
#include <string>

#include "contact/solve/preload.hpp"
#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Called when a phase starts, before the solve with the memory (bytes) that the run is expected to take, after every
/// outer iteration, and after each step of [steps] but the last one, with its number from 0, its fields, contact rows
/// and pairs, valid until the next step begins.
struct ProgressCallbacks {
  std::function<void(const std::string& phase)> phase = [](const std::string&) {};
  std::function<void(double expected)> memory = [](double) {};
  std::function<void(const OuterStep&)> step = [](const OuterStep&) {};
  std::function<void(std::size_t number, const Results&)> load_step = [](std::size_t, const Results&) {};
};

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
  void solve_faces();
  void solve_steps(const ProgressCallbacks& progress, const SolvedState* earlier);
  void set_step(const StepSpec& step);
  bool rubs() const;
  std::size_t first_increment_of_new_solver(std::size_t increment);
  bool extend_contact_search();
  void constrain_drift();
  bool lost_by_drift(const std::string& fault) const;
  void record_step(std::size_t number, const ProgressCallbacks& progress);
  void add_warning(const std::string& warning);
  bool tighten();
  void choose_reference();

  ExecSpace exec_;  ///< what kernels run on
  Preload preload_;
  double expected_memory_ = 0;  ///< bytes
};

}  // namespace cgcontact
