/// The view of report.html in three dimensions: what the page's script draws, as data.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/output/check/output_check.hpp"
#include "core/output/view/view_page.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Displacement and stress of one step at the boundary points of the drawn bodies.
struct ViewStep {
  std::size_t number = 0;           ///< of the step, from 0
  std::vector<PointValues> bodies;  ///< by body
};

/// Input of the view. The drawn bodies have the fields of the last step.
struct ViewInput {
  const Results& results;
  const std::vector<DrawnBody>& drawn;
  const ContactSurface& surface;
  const DrawnFaces* faces = nullptr;  ///< nullptr: not known
  const Scene* scene = nullptr;       ///< for what holds on the faces, with them
  std::vector<ViewStep> steps;        ///< some of them, with the last one; empty: one step
};

/// Writes them as JSON; the format is that of view_data.js. Boundaries that are too large for a page lose triangles
/// away from the contact, the inside is cells joined to blocks where there are too many.
ViewData view_data(const ViewInput& input);

/// Says the largest values and where they are, for those who do not see the pictures.
std::string result_in_words(const Results& results);

}  // namespace cgcontact
