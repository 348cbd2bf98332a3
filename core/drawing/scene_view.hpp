/// From where the pictures of a result look at the scene, and what they leave out so that the contact is seen.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/drawing/raster.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

struct SceneBox {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  void add(const Vec3& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  Vec3 extent() const { return high - low; }
};

/// The quarter that is left out: beyond the corner in both directions.
struct SceneCut {
  Vec3 corner = Vec3::Zero();
  std::array<Vec3, 2> directions{Vec3::Zero(), Vec3::Zero()};
};

struct SceneView {
  Camera camera;                 ///< directions only
  int thin_axis = -1;            ///< axis along which a thin scene is seen, or -1: view in space
  SceneBox box;                  ///< of the whole bodies, undeformed
  bool opened = false;           ///< without the quarter towards the viewer around the contact
  SceneCut cut;                  ///< if it is opened
  std::vector<DrawnBody> shown;  ///< boundaries, and sections where they are opened
};

/// Chooses the view: thin bodies (at most two cells across) and quadtrees are seen from the front, others from above at
/// an angle, from the corner that shows the most stress, cut open where the contact lies inside.
SceneView look_at_scene(const Results& results, const std::vector<DrawnBody>& bodies);

/// Chooses the same without what is shown: from where, and where it would be opened.
SceneView direction_to_scene(const Results& results, const std::vector<DrawnBody>& bodies);

/// Returns SceneView::shown of the same bodies with other fields.
std::vector<DrawnBody> shown_in(const SceneView& view, const std::vector<DrawnBody>& bodies);

/// Fraction of the largest pressure at which a contact zone ends in all pictures; the contact area of the report is
/// measured so too.
constexpr double zone_end = 0.01;
/// Fraction of the scene's view: one of a zone that takes more of it shows nothing new.
constexpr double nearly_all_of_scene = 0.6;

/// Box of a pair's pressed zone.
struct ContactZoneBox {
  SceneBox box;
  int axis = 2;                ///< coordinate axis nearest to its normal
  Vec3 normal = Vec3::Zero();  ///< of the first body, outward, integrated: near zero where it goes all round
};

/// Returns none if nothing is pressed.
std::optional<ContactZoneBox> zone_of_pair(const Results& results, int pair);

/// Views the scene for a contact zone: from a side of the scene that the zone reaches, else cut open in the middle of
/// it.
SceneView look_at_zone(const std::vector<DrawnBody>& bodies, const SceneView& scene, const ContactZoneBox& zone);

/// The contact zone that pictures show from nearby.
struct ZoneLook {
  int pair = 0;
  SceneBox box;  ///< of the zone
  SceneView view;
};

/// Looks at the zone of the pressed pair with the largest force; none: nothing is pressed, or `scene` shows nothing.
std::optional<ZoneLook> look_at_main_zone(const Results& results, const std::vector<DrawnBody>& bodies,
                                          const SceneView& scene);

/// Returns the corners of the box that is shown around a zone, which keeps its middle.
std::vector<Vec3> corners_around(const SceneBox& zone);

}  // namespace cgcontact
