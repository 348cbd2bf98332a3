/// Run on given cells that starts from solutions on cells of two, four, ... times the size (nested iteration): closed
/// points recede by a row of cells per outer iteration, however small the cells are, so the coarsest grid finds the
/// zone in few steps and finer ones correct it by few rows. Figures: docs/decisions.md, "Supports and contact".
#pragma once

#include <memory>
#include <vector>

#include "contact/simulation.hpp"

namespace cgcontact {

class NestedRun {
 public:
  /// The scene must outlive this.
  explicit NestedRun(const Scene& scene);

  /// Throws InputError for what the given grid refuses; what a coarser one refuses only means that the run starts
  /// without it.
  void run(const ProgressCallbacks& progress);

  /// Returns the simulation on the given cells.
  Simulation& simulation() { return *simulation_; }

 private:
  struct Coarse;

  std::unique_ptr<Coarse> solve_coarser(const ProgressCallbacks& progress);

  const Scene& scene_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<CoarseSolve> coarse_;
};

}  // namespace cgcontact
