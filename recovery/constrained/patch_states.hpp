/// States of the patches of a body in the constrained recovery.
#pragma once

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "kernels/mesh/mesh.hpp"
#include "recovery/patch/patch_kinds.hpp"
#include "recovery/patch/patches.hpp"

namespace cgcontact {

/// Kind and status of every node's patch of one body; of a constrained node those of its masters, the last in the
/// lists.
struct PatchStates {
  std::vector<PatchKind> kind;
  std::vector<PatchStatus> status;
  std::vector<std::pair<int, int>>
      pressed;                             ///< free nodes and the pairs that their patches carry pressure of; ascending
  std::vector<std::pair<int, int>> known;  ///< those of `pressed` whose pressure was given as a load
  std::vector<std::pair<int, int>> open_sides;  ///< nodes of these and contact surfaces that stay traction-free there

  /// Brings the lists into the order that is asked for below.
  void sort() {
    for (auto* list : {&pressed, &known, &open_sides}) std::sort(list->begin(), list->end());
  }
  bool is_pressed(int node, int pair) const {
    return std::binary_search(pressed.begin(), pressed.end(), std::pair(node, pair));
  }
  /// Returns whether it was given as a load.
  bool is_known(int node, int pair) const {
    return std::binary_search(known.begin(), known.end(), std::pair(node, pair));
  }
  /// Returns whether the pressure of a pair came from the patch alone.
  bool is_of_stress(int node, int pair) const { return is_pressed(node, pair) && !is_known(node, pair); }
  /// Returns pairs whose pressure came from the patch alone somewhere.
  std::set<int> pairs_of_stress() const {
    std::set<int> pairs;
    for (const auto& [node, pair] : pressed)
      if (!is_known(node, pair)) pairs.insert(pair);
    return pairs;
  }
  /// Returns whether a pair has any pressure on a surface in a cell (-1: on any): none where all patches around are
  /// open.
  bool presses(const BodyMesh& mesh, int cell, int pair, int surface) const {
    bool found = false;
    for (const int corner : mesh.cell_nodes[cell])
      each_master(mesh, corner - mesh.first_node, [&](int node, double) {
        found = found || (is_pressed(node, pair) &&
                          !std::binary_search(open_sides.begin(), open_sides.end(), std::pair(node, surface)));
      });
    return found;
  }
};

}  // namespace cgcontact
