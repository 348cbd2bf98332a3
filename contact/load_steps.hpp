/// The load steps of a run, each solved from the one before.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/progress.hpp"
#include "contact/solve/forces/preload.hpp"
#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Solves increments: the ends of the steps and, where friction needs them, points on the way. Where a solve shows that
/// supports, pairs, interferences or increments are to be others, these are changed and the increment is solved again.
class LoadSteps {
 public:
  /// The arguments must outlive this object; the state has its system. earlier: a solution on other grids to start
  /// from, or none.
  LoadSteps(const ExecSpace& exec, SolvedState& state, Results& results, Preload& preload,
            const ProgressCallbacks& progress, const SolvedState* earlier);

  /// Solves all steps: the state has the solution of the last one then, the results the figures of each, if the scene
  /// has steps, and warnings. Throws InputError for a preload that is not reached.
  void run();

 private:
  /// The end of a step, or a point on the way there from the end of the one before.
  struct Increment {
    std::size_t step;
    double fraction;
  };
  /// A solution without bodies held, and its closed points.
  struct NotHeld {
    OuterResult outer;
    std::vector<ContactPair> pairs;
    std::size_t num_supports;
  };

  void solve_increment();
  void set_loads_of(const StepSpec& step);
  StepSpec present_step() const;

  // What a solved increment may still need. Each returns whether the increment is to be solved again.
  bool hold_drifting_bodies();
  bool search_farther();
  bool tighten_preloads();
  bool hold_lost_bodies();
  bool repeat_tightened();
  bool divide_step();

  void find_fault();
  void accept();
  void record_step();
  void end();
  void solve_approaches();
  void warn_of_divided_steps();
  void warn_of_solver();

  std::unique_ptr<ContactSolver> make_solver();
  void renew_solver(bool from_present);
  void hold_along_surfaces();
  void release_lost_bodies();
  bool has_friction() const;
  bool is_solved() const { return state_.outer.converged && fault_.empty(); }
  std::string name_of_step(std::size_t step) const;

  ExecSpace exec_;
  SolvedState& state_;
  Results& results_;
  Preload& preload_;
  const ProgressCallbacks& progress_;
  const SolvedState* earlier_;

  const std::vector<StepSpec> steps_;  ///< one of its own if the scene has none
  std::vector<Increment> increments_;
  std::size_t present_ = 0;  ///< of the increments
  std::unique_ptr<ContactSolver> solver_;
  std::string fault_;                ///< why the present solution is none although it converged, or empty
  std::string first_failure_;        ///< of all steps, or empty
  std::optional<NotHeld> not_held_;  ///< before bodies were held for having let go of their contact in this increment
  bool tightened_ = false;           ///< preloads: the next failure is repeated once
  int num_extensions_ = 0;           ///< of the contact search
};

}  // namespace cgcontact
