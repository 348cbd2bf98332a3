/// Files of the steps before the last one: steps.vtkhdf, the pictures of the steps, force_displacement.svg. Fields go
/// to the disk step by step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/output/fields/output_vtk.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/pictures/output_picture.hpp"
#include "core/output/view/output_view.hpp"

namespace cgcontact {

class StepFields {
 public:
  /// `num_steps` with the last one; `file`: for the fields, none if they are not wanted.
  StepFields(std::size_t num_steps, const std::optional<std::string>& file) : num_steps_(num_steps), file_(file) {}

  /// Adds step 0, 1, ...; step 0 begins anew (the bodies have other grids). The last one has its final pairs.
  void add(std::size_t number, const Results& step);
  /// Returns whether the steps are those of the solve that has these results: on the same cells.
  bool are_of(const Results& results) const;
  /// Returns the bodies with the fields of the step that was added last.
  const std::vector<DrawnBody>& drawn() const { return drawn_; }
  /// Returns the largest displacement at the points of the drawn bodies, m, by step.
  const std::vector<double>& largest_displacements() const { return largest_; }
  /// Pictures step_K.png; returns their names.
  std::vector<std::string> draw(const std::string& title, const SceneView& scene, GnuplotRuns& runs);
  /// Reads the fields of the steps that have a picture, at the boundary points; none without the file.
  std::vector<ViewStep> boundary_fields();
  /// Ends the file.
  void finish();

 private:
  const std::size_t num_steps_;
  const std::optional<std::string> file_;
  std::optional<VtkSteps> vtk_;
  std::vector<DrawnBody> drawn_;
  std::vector<double> largest_;
  std::vector<StepLook> looks_;
};

/// Plots force_displacement.svg: force of every pair over the largest displacement, step by step.
void write_force_displacement_plot(const Results& results, GnuplotRuns& runs);

}  // namespace cgcontact
