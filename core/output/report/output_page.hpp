/// report.html: the results of a run on one page for people, with all pictures inside.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/output/check/output_check.hpp"
#include "core/output/pictures/output_pressure_map.hpp"
#include "core/output/view/view_page.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Contents of the page beside the results.
struct PageContents {
  std::string directory;  ///< of the pictures; those that are missing are left out
  std::vector<PressureMap> pressure_maps;
  std::string zone_in_scene;         ///< pair whose contact zone scene.png shows from nearby; empty: none
  std::vector<ConditionFace> faces;  ///< of conditions.png
  std::vector<std::pair<std::string, std::string>> sections;  ///< name, picture
  std::vector<std::string> steps;                             ///< pictures
  std::vector<std::string> warnings;                          ///< those of the output
  std::vector<std::string> files;                             ///< of the result directory
  ViewData view;                                              ///< to turn; empty: none
  std::set<std::string> beside;                               ///< pictures that the page leaves to the view
};

/// Names those that would make the page too large to be mailed and that the view shows too: pictures of steps, then of
/// faces with what holds there, then maps of the pressure from the last one on; the first stays.
std::set<std::string> pictures_for_view(const PageContents& contents);

/// Returns a whole page in HTML 5, well-formed XML too, without references to anything outside. The only scripts are
/// those of the view, without which everything else is there. Figures are `data value="..."` elements with the value in
/// SI; what differs between two runs of a scene (times, memory, date, command) has the class "run".
std::string page(const Results& results, const PageContents& contents);

}  // namespace cgcontact
