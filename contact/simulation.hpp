/// The whole computation, one call per step: the page to read first.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "contact/model/contact_pairs.hpp"
#include "contact/solve/outer_loop.hpp"
#include "core/results/results.hpp"
#include "recovery/constrained/recover_stress.hpp"

namespace cgcontact {

/// Called when a phase starts (seconds = 0) or ends, and after every outer iteration.
struct ProgressCallbacks {
  std::function<void(const std::string& phase)> phase = [](const std::string&) {};
  std::function<void(const OuterStep&)> step = [](const OuterStep&) {};
};

/// Scene on its grids: what `cgcontact check` shows, and what run() continues from.
struct Preparation {
  std::vector<BodyModel> bodies;
  std::vector<ContactPair> pairs;
  std::vector<SupportPoint> supports;
  std::vector<std::string> warnings;
};

/// Throws InputError, also if the scene would clearly not fit into memory; refuse_near_limit: or by little, as far as
/// an estimate of a second or two says.
Preparation prepare(const Scene& scene, bool refuse_near_limit = true);

double count_contact_points(const std::vector<ContactPair>& pairs);

/// Throws InputError if a run of the scene would not fit into memory.
void check_memory(const Scene& scene, const Preparation& preparation);

Scales make_scales(const Scene& scene);

/// Everything a run leaves behind; `results` refers to the other members.
struct Simulation {
  explicit Simulation(const Scene& s) : scene(s) {}
  Simulation(const Simulation&) = delete;

  const Scene& scene;
  Scales scales;
  std::vector<BodyModel> bodies;
  std::vector<ContactPair> pairs;
  std::vector<SupportPoint> supports;
  ElasticSystem system;
  std::vector<PatchSet> patches;
  OuterResult outer;
  std::vector<RecoveredField> spr;   ///< per body: near the contact faces, where it is shown
  std::vector<RecoveredField> sprc;  ///< per body: everywhere (SPR where the scene does not want SPR-C)
  RecoveryCounts recovery_counts;
  std::vector<PatchStates> patch_states;  ///< by body
  ReferenceSpec reference;                ///< what the results are compared with
  Results results;

  /// Reads as the flow: grids, cut cells, operator, contact, solve, recovery, error estimate, results.
  void run(const ProgressCallbacks& progress);

  /// Its steps, for programs that measure them one by one; between the second and the third comes the solution.
  void place_on_grids();
  void make_system();
  void recover();
  void fill_results();

 private:
  void solve_steps(const ProgressCallbacks& progress);
  void set_step(const StepSpec& step);
  bool see_farther();
  void record_step(const StepSpec& step, bool is_last);
  void add_warning(const std::string& warning);
  void choose_reference();
};

}  // namespace cgcontact
