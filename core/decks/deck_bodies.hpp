/// Bodies of a deck: what hangs together by common nodes and has one material, bounded by the outer sides of its
/// elements.
#pragma once

#include <string>
#include <vector>

#include "core/decks/deck.hpp"

namespace cgcontact {

/// Outer sides of a body that a condition or a pair of the deck names.
struct DeckFace {
  std::string name;
  std::set<ElementSide> sides;
};

struct DeckBody {
  std::string name, material;
  std::set<int> elements;
  std::set<ElementSide> outer;
  std::vector<DeckFace> faces;

  /// Returns the face with these outer sides, which is added if none; "": there are none of this body.
  std::string face(const std::set<ElementSide>& sides, const std::string& wanted_name);
};

/// Finds bodies in the order of their first elements. Bodies of different materials that share nodes are joined:
/// `joints` are the outer sides of the first that are sides of the second too, and the other way round.
struct DeckBodies {
  struct Joint {
    std::size_t first, second;
    std::set<ElementSide> of_first, of_second;
  };
  std::vector<DeckBody> bodies;
  std::vector<Joint> joints;
};

/// Throws InputError for elements without a material, or of no volume.
DeckBodies find_bodies(const Deck& deck);

/// Returns outer sides of a body all of whose corners are among the nodes.
std::set<ElementSide> sides_on_nodes(const Deck& deck, const DeckBody& body, const std::set<int>& nodes);

/// Returns the nodes of some sides, with the middles of their edges.
std::set<int> nodes_of_sides(const Deck& deck, const std::set<ElementSide>& sides);

/// Writes the outer sides of a body as triangles in the OBJ format, in the units of the deck; the middles of edges are
/// corners too. Sides that are in the same faces are a group, whose name stands behind "g". `groups`: of each face,
/// those that it consists of.
std::string surface_text(const Deck& deck, const DeckBody& body, std::vector<std::vector<std::string>>& groups);

}  // namespace cgcontact
