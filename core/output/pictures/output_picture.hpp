/// scene.png: the deformed bodies coloured by the von Mises stress of the recovered field, and a contact zone from
/// nearby; the bodies of every step.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/drawing/scene_view.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Returns the factor by which the pictures multiply displacements, so that they are seen; 1: to scale.
double picture_exaggeration(const Results& results, const SceneBox& box);

/// `scene`: look_at_scene of the bodies; `zone`: look_at_main_zone, nullptr if there is none. The displacements of what
/// they show become those of the picture, with fits drawn closed. Returns whether the zone is drawn beside the scene.
/// Needs the folder plots of the result directory.
bool write_picture(const Results& results, const std::vector<DrawnBody>& bodies, SceneView& scene, ZoneLook* zone,
                   GnuplotRuns& runs);

struct StepLook {
  std::size_t number = 0;  ///< of the step, from 0
  std::string name;        ///< of the picture, without .png
  Results words;           ///< title; contact rows and pairs as they are in the step
};
/// All bodies with the fields of a step.
using StepBodies = std::function<const std::vector<DrawnBody>&(std::size_t number)>;

/// Draws steps in the view of scene.png, all with one range of colours and one exaggeration, that for
/// `largest_displacement` (m). Returns the files.
std::vector<std::string> write_step_pictures(const std::vector<StepLook>& steps, const SceneView& scene,
                                             double largest_displacement, const StepBodies& bodies, GnuplotRuns& runs);

}  // namespace cgcontact
