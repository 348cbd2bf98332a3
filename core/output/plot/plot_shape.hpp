/// What is drawn of a result: surfaces or a section, all of it or what is near a contact zone, and from where.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/drawing/scene_view.hpp"
#include "core/output/plot/plot_result.hpp"
#include "core/program/plot_options.hpp"

namespace cgcontact {

struct PlotShape {
  std::vector<DrawnBody> shown;  ///< one for each body of the result; without triangles: it is left out
  std::vector<char> is_chosen;   ///< of each body
  bool is_section = false;
  bool shaded = true;
  double factor = 1;             ///< of the displacements
  Camera camera;                 ///< directions only
  std::vector<Vec3> frame;       ///< m, as drawn: what the picture has to hold
  std::optional<SceneBox> near;  ///< m, undeformed: only what is in it counts; none: all
  std::string pair;              ///< whose zone that is

  bool counts(const Vec3& x) const {
    return !near || ((x - near->low).minCoeff() >= 0 && (near->high - x).minCoeff() >= 0);
  }
  /// Returns where a point of a drawn body is drawn, m.
  Vec3 drawn(const DrawnBody& body, int point) const {
    return body.displacement.empty() ? body.position[point] : body.position[point] + factor * body.displacement[point];
  }
};

/// Surfaces are seen as in scene.png, displaced as they are (factor 1); sections as in section_NAME.png, undeformed.
/// Throws InputError that names the option: an unknown body or pair, a pair that nothing presses, a plane that meets
/// no body.
PlotShape shape_to_plot(const PlotResult& result, const PlotOptions& options);

}  // namespace cgcontact
