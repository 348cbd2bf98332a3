#include "core/decks/deck_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <map>
#include <numeric>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

/// Corners of a side, so that its normal points out of the element.
std::vector<int> corners_of(const Deck& deck, const ElementSide& side) {
  const DeckElement& element = deck.elements.at(side.element);
  std::vector<int> corners = sides_of(element.shape)[side.side - 1];
  const auto position = [&](int corner) { return deck.nodes.at(element.nodes[corner]); };
  Vec3 middle = Vec3::Zero(), of_side = Vec3::Zero(), normal = Vec3::Zero();
  const int n = num_corners(element.shape);
  for (int c = 0; c < n; ++c) middle += position(c) / n;
  for (const int c : corners) of_side += position(c) / static_cast<double>(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k)
    normal += (position(corners[k]) - of_side).cross(position(corners[(k + 1) % corners.size()]) - of_side);
  if (normal.dot(of_side - middle) < 0) std::reverse(corners.begin(), corners.end());
  return corners;
}

std::vector<int> sorted_nodes(const Deck& deck, const ElementSide& side) {
  const DeckElement& element = deck.elements.at(side.element);
  std::vector<int> nodes;
  for (const int corner : sides_of(element.shape)[side.side - 1]) nodes.push_back(element.nodes[corner]);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// Finds which of some things hang together.
class ElementComponents {
 public:
  explicit ElementComponents(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[std::max(of(a), of(b))] = std::min(of(a), of(b)); }

 private:
  std::vector<std::size_t> parent_;
};

std::string name_in_scene(const std::string& name) {
  std::string result;
  for (const unsigned char c : name) result += std::isalnum(c) && c < 0x80 ? static_cast<char>(std::tolower(c)) : '_';
  if (result.empty() || !std::isalpha(static_cast<unsigned char>(result[0]))) result = "s_" + result;
  return result;
}

void find_outer_sides(const Deck& deck, DeckBody& body) {
  std::map<std::vector<int>, ElementSide> once;
  for (const int element : body.elements)
    for (int s = 1; s <= static_cast<int>(sides_of(deck.elements.at(element).shape).size()); ++s) {
      const auto [found, added] = once.try_emplace(sorted_nodes(deck, {element, s}), ElementSide{element, s});
      if (!added) once.erase(found);
    }
  for (const auto& entry : once) body.outer.insert(entry.second);
}

void find_joints(const Deck& deck, DeckBodies& found) {
  std::map<std::vector<int>, std::pair<std::size_t, ElementSide>> sides;
  for (std::size_t b = 0; b < found.bodies.size(); ++b)
    for (const ElementSide& side : found.bodies[b].outer) {
      const auto [other, added] = sides.try_emplace(sorted_nodes(deck, side), b, side);
      if (added) continue;
      const std::size_t first = other->second.first;
      auto joint = std::find_if(found.joints.begin(), found.joints.end(),
                                [&](const auto& j) { return j.first == first && j.second == b; });
      if (joint == found.joints.end()) joint = found.joints.insert(joint, {first, b, {}, {}});
      joint->of_first.insert(other->second.second);
      joint->of_second.insert(side);
    }
}

/// Bodies of one section are numbered.
void number_bodies(std::vector<DeckBody>& bodies) {
  std::map<std::string, int> count, number;
  for (const DeckBody& body : bodies) ++count[body.name];
  for (DeckBody& body : bodies)
    if (const std::string section = body.name; count[section] > 1) body.name += fmt::format("_{}", ++number[section]);
}

/// Triangles of a side as nodes of the file: with the middles of its edges, where it has them, in the middle too.
std::vector<std::array<int, 3>> triangles_of(const Deck& deck, const ElementSide& side) {
  const DeckElement& element = deck.elements.at(side.element);
  const std::vector<int> corners = corners_of(deck, side);
  const std::size_t n = corners.size();
  std::vector<int> nodes, middles;
  for (std::size_t k = 0; k < n; ++k) {
    nodes.push_back(element.nodes[corners[k]]);
    middles.push_back(middle_node(element, corners[k], corners[(k + 1) % n]));
  }
  std::vector<std::array<int, 3>> triangles;
  const auto fan = [&](const std::vector<int>& polygon) {
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) triangles.push_back({polygon[0], polygon[k], polygon[k + 1]});
  };
  if (std::find(middles.begin(), middles.end(), -1) != middles.end()) {
    fan(nodes);
    return triangles;
  }
  for (std::size_t k = 0; k < n; ++k) triangles.push_back({nodes[k], middles[k], middles[(k + n - 1) % n]});
  fan(middles);
  return triangles;
}

}  // namespace

std::string DeckBody::face(const std::set<ElementSide>& sides, const std::string& wanted_name) {
  std::set<ElementSide> own;
  std::set_intersection(sides.begin(), sides.end(), outer.begin(), outer.end(), std::inserter(own, own.begin()));
  if (own.empty()) return "";
  for (const DeckFace& other : faces)
    if (other.sides == own) return other.name;
  const std::string wanted = name_in_scene(wanted_name);
  std::string unique = wanted;
  const auto is_taken = [&] {
    return std::any_of(faces.begin(), faces.end(), [&](const DeckFace& other) { return other.name == unique; });
  };
  for (int k = 2; is_taken(); ++k) unique = fmt::format("{}_{}", wanted, k);
  faces.push_back({unique, own});
  return unique;
}

DeckBodies find_bodies(const Deck& deck) {
  std::vector<int> numbers;
  for (const auto& entry : deck.elements) {
    if (deck.material_of_element.count(entry.first) == 0)
      throw InputError(fmt::format("{}: element {} has no material (allowed: a *SOLID SECTION for every solid element)",
                                   deck.file, entry.first));
    numbers.push_back(entry.first);
  }
  ElementComponents components(numbers.size());
  std::map<std::pair<int, std::string>, std::size_t> first_at;  // an element at each node, by material
  for (std::size_t i = 0; i < numbers.size(); ++i)
    for (const int node : deck.elements.at(numbers[i]).nodes)
      components.join(i, first_at.try_emplace({node, deck.material_of_element.at(numbers[i])}, i).first->second);
  DeckBodies found;
  std::map<std::size_t, std::size_t> body_of_component;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto [body, added] = body_of_component.try_emplace(components.of(i), found.bodies.size());
    if (added) {
      found.bodies.emplace_back();
      found.bodies.back().material = deck.material_of_element.at(numbers[i]);
      found.bodies.back().name = name_in_scene(deck.section_of_element.at(numbers[i]));
    }
    found.bodies[body->second].elements.insert(numbers[i]);
  }
  number_bodies(found.bodies);
  for (DeckBody& body : found.bodies) find_outer_sides(deck, body);
  find_joints(deck, found);
  return found;
}

std::set<ElementSide> sides_on_nodes(const Deck& deck, const DeckBody& body, const std::set<int>& nodes) {
  std::set<ElementSide> found;
  for (const ElementSide& side : body.outer) {
    const std::vector<int> corners = sorted_nodes(deck, side);
    if (std::all_of(corners.begin(), corners.end(), [&](int node) { return nodes.count(node) > 0; }))
      found.insert(side);
  }
  return found;
}

std::set<int> nodes_of_sides(const Deck& deck, const std::set<ElementSide>& sides) {
  std::set<int> nodes;
  for (const ElementSide& side : sides)
    for (const std::array<int, 3>& triangle : triangles_of(deck, side)) nodes.insert(triangle.begin(), triangle.end());
  return nodes;
}

std::string surface_text(const Deck& deck, const DeckBody& body, std::vector<std::vector<std::string>>& groups) {
  std::map<std::vector<std::size_t>, std::vector<ElementSide>> by_faces;
  for (const ElementSide& side : body.outer) {
    std::vector<std::size_t> faces;
    for (std::size_t f = 0; f < body.faces.size(); ++f)
      if (body.faces[f].sides.count(side) > 0) faces.push_back(f);
    by_faces[faces].push_back(side);
  }
  groups.assign(body.faces.size(), {});
  std::map<int, std::size_t> number;
  std::string points, triangles;
  std::size_t num_groups = 0;
  for (const auto& [faces, sides] : by_faces) {
    const std::string name = faces.empty() ? "rest" : fmt::format("g{}", ++num_groups);
    for (const std::size_t f : faces) groups[f].push_back(name);
    triangles += fmt::format("g {}\n", name);
    for (const ElementSide& side : sides)
      for (const std::array<int, 3>& triangle : triangles_of(deck, side)) {
        triangles += "f";
        for (const int node : triangle) {
          const auto [entry, added] = number.try_emplace(node, number.size() + 1);
          const Vec3& x = deck.nodes.at(node);
          if (added) points += fmt::format("v {:.17g} {:.17g} {:.17g}\n", x[0], x[1], x[2]);
          triangles += fmt::format(" {}", entry->second);
        }
        triangles += "\n";
      }
  }
  return points + triangles;
}

}  // namespace cgcontact
