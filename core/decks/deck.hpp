/// Input decks of CalculiX and Abaqus (keywords as in the CalculiX CrunchiX manual 2.20, chapter 7): the keywords that
/// describe solid bodies, what holds and loads them, and where they touch. Flat decks only: no parts and instances.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Side of an element, from 1, as in the manual.
struct ElementSide {
  int element, side;
  bool operator<(const ElementSide& other) const {
    return element != other.element ? element < other.element : side < other.side;
  }
  bool operator==(const ElementSide& other) const { return element == other.element && side == other.side; }
};

struct DeckElement {
  enum class Shape { tetrahedron, wedge, hexahedron };
  Shape shape;
  std::vector<int> nodes;  ///< numbers of the file; corners first, then the middles of the edges, if it has any
};

struct DeckMaterial {
  std::optional<double> youngs_modulus, poissons_ratio, density, expansion;
};

/// Line of *BOUNDARY, *CLOAD, *DLOAD or *DSLOAD.
struct DeckCondition {
  enum class Kind { displacement, force, pressure, surface_pressure, gravity };
  Kind kind;
  std::string set;                ///< nodes, elements or surface
  int first = 0, last = 0;        ///< components from 1; of a pressure the side of the elements
  double value = 0;               ///< of the line; of gravity the acceleration
  Vec3 direction = Vec3::Zero();  ///< of gravity
  int line = 0;
};

/// *CONTACT PAIR or *TIE.
struct DeckPair {
  std::string slave, master, interaction;
  bool bonded = false;
  int line = 0;
};

/// Names are in capital letters; a set of a single number is named by it.
struct Deck {
  std::string file, title;
  std::map<int, Vec3> nodes;
  std::map<int, DeckElement> elements;
  std::map<std::string, std::set<int>> node_sets, element_sets;
  std::map<std::string, std::set<ElementSide>> surfaces;
  std::map<std::string, double> friction;  ///< coefficient of surface interactions
  std::map<std::string, std::set<int>> node_surfaces;
  std::map<std::string, DeckMaterial> materials;
  std::map<int, std::string> material_of_element, section_of_element;  ///< the section's set of elements
  std::vector<DeckCondition> conditions;
  std::vector<DeckPair> pairs;
  std::set<std::string> tied;         ///< interactions whose faces neither part nor slide
  std::vector<std::string> left_out;  ///< what a scene does not take over, with the lines

  /// Return nodes of a set, or of the number that is its name; empty: there is none.
  std::set<int> nodes_of(const std::string& set) const;
  std::set<int> elements_of(const std::string& set) const;
};

int num_corners(DeckElement::Shape shape);
/// Returns the corners of each side of a shape, as indices into the nodes.
const std::vector<std::vector<int>>& sides_of(DeckElement::Shape shape);
/// Returns the index of the node in the middle between two corners, -1: the element has none.
int middle_node(const DeckElement& element, int corner, int other);

/// Throws InputError with file and line for what is no deck, or refers to what is not there.
Deck read_deck(const std::string& file);

}  // namespace cgcontact
