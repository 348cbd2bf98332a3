#include "core/decks/deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {

using ElementShape = DeckElement::Shape;

constexpr int deepest_include = 10;
constexpr int max_number = 2'000'000'000;
constexpr int num_components = 3;

std::string capitals(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t end = std::min(line.find(','), line.size());
    fields.push_back(capitals(trimmed(line.substr(0, end))));
    if (end == line.size()) return fields;
    line.remove_prefix(end + 1);
  }
}

/// Keyword with its parameters, or a line of data.
struct DeckLine {
  int number = 0;
  std::string file;
  std::string text;                 ///< as it is written
  std::vector<std::string> fields;  ///< in capital letters
};

struct DeckBlock {
  std::string keyword;  ///< without the star, blanks inside as in "CONTACT PAIR"
  std::map<std::string, std::string> parameters;
  DeckLine head;
  std::vector<DeckLine> data;

  bool has(const std::string& parameter) const { return parameters.count(parameter) > 0; }
  std::string at(const std::string& parameter) const {
    const auto found = parameters.find(parameter);
    return found == parameters.end() ? "" : found->second;
  }
};

[[noreturn]] void fail(const DeckLine& line, const std::string& problem, const std::string& allowed = {}) {
  throw InputError(SourceLocation{line.file, line.number, ""}, "", problem, allowed);
}

/// Splits a file, and those that it includes, into blocks.
class BlockReader {
 public:
  std::vector<DeckBlock> read(const std::string& file) {
    read_file(file, 0);
    return std::move(blocks_);
  }

 private:
  void read_file(const std::string& file, int depth) {
    const std::string text = read_text(file);
    if (text.find('\0') != std::string::npos) throw InputError(file + ": is not a text, as input decks are");
    std::string_view rest = text;
    for (int number = 1; !rest.empty(); ++number) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string line = trimmed(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (line.empty() || line.substr(0, 2) == "**") continue;
      add_line({number, file, line, fields_of(line)}, depth);
    }
  }

  void add_line(const DeckLine& line, int depth) {
    const std::string& text = line.text;
    const bool goes_on = text.back() == ',';
    if (text[0] == '*' || in_head_) {
      in_head_ ? add_parameters(line, 0) : begin_block(line);
      in_head_ = goes_on;
      if (!in_head_ && blocks_.back().keyword == "INCLUDE") include(text, depth);
      return;
    }
    if (blocks_.empty()) fail(line, "does not begin with a keyword: is it an input deck?", "*NODE, *ELEMENT, ...");
    blocks_.back().data.push_back(line);
  }

  void begin_block(const DeckLine& line) {
    DeckBlock block;
    block.head = line;
    block.keyword = line.fields[0].substr(1);
    blocks_.push_back(std::move(block));
    add_parameters(line, 1);
  }

  void add_parameters(const DeckLine& line, std::size_t first) {
    for (std::size_t k = first; k < line.fields.size(); ++k) {
      const std::string& field = line.fields[k];
      const std::size_t equal = std::min(field.find('='), field.size());
      const std::string name(trimmed(std::string_view(field).substr(0, equal)));
      if (!name.empty())
        blocks_.back().parameters[name] =
            equal < field.size() ? std::string(trimmed(std::string_view(field).substr(equal + 1))) : "";
    }
  }

  /// The name as it is written, relative to the file that includes it.
  void include(std::string_view text, int depth) {
    const DeckBlock block = blocks_.back();
    blocks_.pop_back();
    const std::size_t equal = text.find('=');
    if (equal == std::string_view::npos) fail(block.head, "names no file", "*INCLUDE, INPUT=FILE");
    if (depth >= deepest_include) fail(block.head, "files include each other without end");
    std::string name(trimmed(text.substr(equal + 1)));
    name.erase(std::remove(name.begin(), name.end(), '"'), name.end());
    read_file((std::filesystem::path(block.head.file).parent_path() / name).string(), depth + 1);
  }

  std::vector<DeckBlock> blocks_;
  bool in_head_ = false;
};

double number_of(const DeckLine& line, std::size_t field, const char* what) {
  if (field >= line.fields.size() || line.fields[field].empty()) fail(line, "a number is missing", what);
  std::string text = line.fields[field];
  std::replace(text.begin(), text.end(), 'D', 'E');  // Fortran's exponent
  if (text[0] == '+') text.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    fail(line, fmt::format("\"{}\" is no number", line.fields[field]), what);
  return value;
}

double number_or(const DeckLine& line, std::size_t field, double otherwise, const char* what) {
  return field >= line.fields.size() || line.fields[field].empty() ? otherwise : number_of(line, field, what);
}

bool is_whole(const std::string& text) {
  return !text.empty() && text.size() < 10 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); });
}

int integer_of(const DeckLine& line, std::size_t field, const char* what) {
  const double value = number_of(line, field, what);
  if (value != std::floor(value) || value < 0 || value > max_number)
    fail(line, fmt::format("\"{}\" is no whole number from 0 on", line.fields[field]), what);
  return static_cast<int>(value);
}

struct ShapeOfType {
  const char* type;  ///< also with letters behind it: C3D10M, C3D8R
  ElementShape shape;
  std::size_t num_nodes;
};

/// Longer names first.
constexpr ShapeOfType shapes[] = {{"C3D10", ElementShape::tetrahedron, 10}, {"C3D15", ElementShape::wedge, 15},
                                  {"C3D20", ElementShape::hexahedron, 20},  {"C3D4", ElementShape::tetrahedron, 4},
                                  {"C3D6", ElementShape::wedge, 6},         {"C3D8", ElementShape::hexahedron, 8}};

const ShapeOfType* shape_of_type(const std::string& type) {
  for (const ShapeOfType& entry : shapes) {
    const std::string name = entry.type;
    const bool begins = type.compare(0, name.size(), name) == 0;
    if (begins && (type.size() == name.size() || !std::isdigit(static_cast<unsigned char>(type[name.size()]))))
      return &entry;
  }
  return nullptr;
}

/// Turns blocks into a deck, in turn.
class DeckReader {
 public:
  Deck read(const std::string& file) {
    deck_.file = file;
    for (const DeckBlock& block : BlockReader().read(file)) take(block);
    if (deck_.elements.empty())
      throw InputError(
          fmt::format("{}: holds no solid elements (allowed: C3D4, C3D6, C3D8, C3D10, C3D15, C3D20)", file));
    assign_materials();
    for (const auto& [what, lines] : unknown_)
      deck_.left_out.push_back(lines.size() == 1
                                   ? fmt::format("{} (line {})", what, lines.front())
                                   : fmt::format("{} (line {} and {} more)", what, lines.front(), lines.size() - 1));
    return std::move(deck_);
  }

 private:
  void take(const DeckBlock& block) {
    struct Take {
      void (DeckReader::*read)(const DeckBlock&);
      std::set<std::string> parameters;  ///< that are read, or say how it is solved or written; others are left out
    };
    static const std::map<std::string, Take> takes{
        {"HEADING", {&DeckReader::heading, {}}},
        {"NODE", {&DeckReader::nodes, {"NSET", "SYSTEM", "INPUT"}}},
        {"ELEMENT", {&DeckReader::elements, {"TYPE", "ELSET"}}},
        {"NSET", {&DeckReader::sets, {"NSET", "GENERATE", "INTERNAL", "UNSORTED"}}},
        {"ELSET", {&DeckReader::sets, {"ELSET", "GENERATE", "INTERNAL"}}},
        {"SURFACE", {&DeckReader::surface, {"NAME", "TYPE", "INTERNAL"}}},
        {"MATERIAL", {&DeckReader::material, {"NAME"}}},
        {"ELASTIC", {&DeckReader::elastic, {"TYPE"}}},
        {"DENSITY", {&DeckReader::density, {}}},
        {"EXPANSION", {&DeckReader::expansion, {}}},
        {"SOLID SECTION", {&DeckReader::section, {"ELSET", "MATERIAL", "CONTROLS"}}},
        {"BOUNDARY", {&DeckReader::boundary, {"OP", "FIXED"}}},
        {"CLOAD", {&DeckReader::point_loads, {"OP"}}},
        {"DLOAD", {&DeckReader::element_loads, {"OP"}}},
        {"DSLOAD", {&DeckReader::surface_loads, {"OP"}}},
        {"CONTACT PAIR", {&DeckReader::pair, {"INTERACTION", "TYPE", "SMALL SLIDING", "TIED"}}},
        {"TIE", {&DeckReader::tie, {"NAME", "TYPE", "ADJUST"}}},
        {"SURFACE INTERACTION", {&DeckReader::interaction, {"NAME"}}},
        {"SURFACE BEHAVIOR",
         {&DeckReader::behaviour, {"PRESSURE-OVERCLOSURE", "AUGMENTED LAGRANGE", "PENALTY", "DIRECT"}}},
        {"FRICTION", {&DeckReader::friction, {}}},
        {"STEP", {&DeckReader::step, {"INC", "NAME", "NLGEOM"}}}};
    static const std::set<std::string> conditions{"BOUNDARY", "CLOAD", "DLOAD", "DSLOAD"};
    // Say how a deck is solved or written, not what is solved.
    static const std::set<std::string> without_meaning{
        "END STEP",    "STATIC",   "NODE FILE",      "EL FILE",          "NODE PRINT",     "EL PRINT",
        "NODE OUTPUT", "OUTPUT",   "ELEMENT OUTPUT", "CONTACT FILE",     "CONTACT OUTPUT", "CONTROLS",
        "RESTART",     "PREPRINT", "TIME POINTS",    "CONTACT CONTROLS", "MONITOR",        "NO PRINT"};
    if (block.keyword == "PART" || block.keyword == "INSTANCE" || block.keyword == "ASSEMBLY")
      fail(block.head, fmt::format("*{}: the deck has parts and instances", block.keyword),
           "flat decks: \"do not use parts and assemblies in input files\"");
    const auto found = takes.find(block.keyword);
    if (num_steps_ > 1 && conditions.count(block.keyword) > 0)
      leave_out(fmt::format("*{} of a step beyond the first", block.keyword), block.head);
    else if (found != takes.end())
      take(block, found->second.read, found->second.parameters);
    else if (without_meaning.count(block.keyword) == 0)
      leave_out("*" + block.keyword, block.head);
  }

  void take(const DeckBlock& block, void (DeckReader::*read)(const DeckBlock&), const std::set<std::string>& known) {
    for (const auto& [name, value] : block.parameters)
      if (known.count(name) == 0)
        leave_out(fmt::format("*{}, {}{}", block.keyword, name, value.empty() ? "" : "=" + value), block.head);
    (this->*read)(block);
  }

  /// With OP=NEW conditions of these kinds end that held before the step.
  void drop_earlier(const DeckBlock& block, const std::set<DeckCondition::Kind>& kinds) {
    if (block.at("OP") != "NEW") return;
    const auto first = deck_.conditions.begin(), end = first + static_cast<std::ptrdiff_t>(before_step_);
    const auto left = std::remove_if(first, end, [&](const DeckCondition& c) { return kinds.count(c.kind) > 0; });
    before_step_ = static_cast<std::size_t>(left - first);
    deck_.conditions.erase(left, end);
  }

  void leave_out(const std::string& what, const DeckLine& line) { unknown_[what].push_back(line.number); }

  void heading(const DeckBlock& block) {
    if (!block.data.empty()) deck_.title = block.data.front().text;
  }

  void nodes(const DeckBlock& block) {
    if (const std::string system = block.at("SYSTEM"); !system.empty() && system != "R")
      fail(block.head, "*NODE, SYSTEM=" + system + ": the coordinates are not rectangular", "SYSTEM=R, or none");
    for (const DeckLine& line : block.data) {
      const int node = integer_of(line, 0, "number, x, y, z");
      Vec3 x;
      for (int k = 0; k < num_components; ++k) x[k] = number_or(line, k + 1, 0, "number, x, y, z");
      deck_.nodes[node] = x;
      if (block.has("NSET")) deck_.node_sets[block.at("NSET")].insert(node);
    }
  }

  /// The nodes of an element may go on in the next lines.
  void elements(const DeckBlock& block) {
    const ShapeOfType* const kind = shape_of_type(block.at("TYPE"));
    if (!kind) return leave_out(fmt::format("*ELEMENT, TYPE={}", block.at("TYPE")), block.head);
    std::vector<int> numbers;
    for (const DeckLine& line : block.data) {
      for (std::size_t k = 0; k < line.fields.size(); ++k)
        if (!line.fields[k].empty()) numbers.push_back(integer_of(line, k, "numbers of nodes"));
      if (numbers.size() < kind->num_nodes + 1) continue;
      if (numbers.size() > kind->num_nodes + 1)
        fail(line, fmt::format("element {} has {} nodes", numbers[0], numbers.size() - 1),
             fmt::format("{} of a {}", kind->num_nodes, kind->type));
      for (std::size_t k = 1; k < numbers.size(); ++k)
        if (deck_.nodes.count(numbers[k]) == 0)
          fail(line, fmt::format("element {} refers to node {}, which is not there", numbers[0], numbers[k]),
               "nodes in a *NODE before");
      deck_.elements[numbers[0]] = {kind->shape, {numbers.begin() + 1, numbers.end()}};
      if (block.has("ELSET")) deck_.element_sets[block.at("ELSET")].insert(numbers[0]);
      numbers.clear();
    }
    if (!numbers.empty()) fail(block.data.back(), fmt::format("element {} has too few nodes", numbers[0]));
  }

  /// Numbers, names of sets before, or with GENERATE first, last, step.
  void sets(const DeckBlock& block) {
    auto& all = block.keyword == "NSET" ? deck_.node_sets : deck_.element_sets;
    const std::string name = block.at(block.keyword);
    if (name.empty()) fail(block.head, "the set has no name", fmt::format("*{0}, {0}=NAME", block.keyword));
    std::set<int>& set = all[name];
    for (const DeckLine& line : block.data) {
      if (block.has("GENERATE")) {
        const char* const what = "first, last, step";
        const int first = integer_of(line, 0, what), last = integer_of(line, 1, what);
        const double step = number_or(line, 2, 1, what);
        if (step < 1) fail(line, "the step is less than 1", what);
        for (double k = first; k <= last; k += step) set.insert(static_cast<int>(k));
        continue;
      }
      for (std::size_t k = 0; k < line.fields.size(); ++k) {
        const std::string& field = line.fields[k];
        if (field.empty()) continue;
        if (const auto other = all.find(field); other != all.end()) {
          const std::set<int> numbers = other->second;
          set.insert(numbers.begin(), numbers.end());
        } else {
          set.insert(integer_of(line, k, "a number, or the name of a set before"));
        }
      }
    }
  }

  void surface(const DeckBlock& block) {
    const std::string name = block.at("NAME"), type = block.at("TYPE");
    for (const DeckLine& line : block.data) {
      if (type == "NODE") {
        const std::set<int> nodes = deck_.nodes_of(line.fields[0]);
        deck_.node_surfaces[name].insert(nodes.begin(), nodes.end());
        continue;
      }
      const std::set<int> elements = deck_.elements_of(line.fields[0]);
      const std::string side = line.fields.size() > 1 ? line.fields[1] : "";
      if (elements.empty()) fail(line, fmt::format("there are no elements \"{}\"", line.fields[0]));
      if (side.empty()) {  // all that is outside
        for (const int element : elements)
          for (int s = 1; s <= num_sides(element); ++s) deck_.surfaces[name].insert({element, s});
        continue;
      }
      if (side[0] != 'S' || !is_whole(side.substr(1)))
        fail(line, fmt::format("\"{}\" is no side of a solid element", side), "S1 to S6");
      for (const int element : elements)
        deck_.surfaces[name].insert({element, checked_side(side.substr(1), element, line)});
    }
  }

  int num_sides(int element) const {
    const auto found = deck_.elements.find(element);
    return found == deck_.elements.end() ? 0 : static_cast<int>(sides_of(found->second.shape).size());
  }

  int checked_side(const std::string& text, int element, const DeckLine& line) const {
    const int side = std::stoi(text), count = num_sides(element);
    if (count > 0 && (side < 1 || side > count))
      fail(line, fmt::format("element {} has no side {}", element, side), fmt::format("1 to {}", count));
    return side;
  }

  void material(const DeckBlock& block) {
    material_ = block.at("NAME");
    if (material_.empty()) fail(block.head, "the material has no name", "*MATERIAL, NAME=NAME");
    deck_.materials[material_];
  }
  DeckMaterial& present(const DeckBlock& block) {
    if (material_.empty())
      fail(block.head, fmt::format("*{} outside of a material", block.keyword), "*MATERIAL before");
    if (block.data.empty()) fail(block.head, fmt::format("*{} has no values", block.keyword));
    return deck_.materials[material_];
  }
  void elastic(const DeckBlock& block) {
    DeckMaterial& material = present(block);
    const std::string type = block.at("TYPE");
    if (!type.empty() && type.substr(0, 3) != "ISO") return leave_out("*ELASTIC, TYPE=" + type, block.head);
    material.youngs_modulus = number_of(block.data[0], 0, "E, nu");
    material.poissons_ratio = number_of(block.data[0], 1, "E, nu");
    if (block.data.size() > 1) leave_out("*ELASTIC at other temperatures than the first", block.data[1]);
  }
  void density(const DeckBlock& block) { present(block).density = number_of(block.data[0], 0, "density"); }
  void expansion(const DeckBlock& block) { present(block).expansion = number_of(block.data[0], 0, "coefficient"); }

  void section(const DeckBlock& block) { sections_.push_back({block.at("ELSET"), block.at("MATERIAL"), block.head}); }

  void assign_materials() {
    for (const auto& [set, name, line] : sections_) {
      if (deck_.materials.count(name) == 0) fail(line, fmt::format("there is no material \"{}\"", name));
      for (const int element : deck_.elements_of(set)) {
        deck_.material_of_element[element] = name;
        deck_.section_of_element[element] = set;
      }
    }
  }

  void boundary(const DeckBlock& block) {
    if (block.has("FIXED")) return leave_out("*BOUNDARY, FIXED", block.head);
    drop_earlier(block, {DeckCondition::Kind::displacement});
    static const std::map<std::string, std::pair<int, int>> named{
        {"XSYMM", {1, 1}}, {"YSYMM", {2, 2}}, {"ZSYMM", {3, 3}}, {"PINNED", {1, 3}}, {"ENCASTRE", {1, 3}}};
    for (const DeckLine& line : block.data) {
      DeckCondition condition{DeckCondition::Kind::displacement, line.fields[0]};
      condition.line = line.number;
      const auto word = line.fields.size() > 1 ? named.find(line.fields[1]) : named.end();
      if (word != named.end()) {
        std::tie(condition.first, condition.last) = word->second;
      } else {
        const char* const what = "nodes, first component, last component, value";
        condition.first = integer_of(line, 1, what);
        condition.last = static_cast<int>(number_or(line, 2, condition.first, what));
        condition.value = number_or(line, 3, 0, what);
      }
      condition.last = std::min(condition.last, num_components);  // rotations: solid elements have none
      if (condition.first < 1 || condition.first > condition.last)
        leave_out(fmt::format("*BOUNDARY on {}: components that solids do not have", line.fields[0]), line);
      else
        deck_.conditions.push_back(condition);
    }
  }

  void point_loads(const DeckBlock& block) {
    drop_earlier(block, {DeckCondition::Kind::force});
    for (const DeckLine& line : block.data) {
      DeckCondition condition{DeckCondition::Kind::force, line.fields[0]};
      condition.line = line.number;
      condition.first = condition.last = integer_of(line, 1, "nodes, component, force");
      condition.value = number_of(line, 2, "nodes, component, force");
      if (condition.first < 1 || condition.first > num_components)
        leave_out(fmt::format("*CLOAD on {}: component {}", line.fields[0], condition.first), line);
      else
        deck_.conditions.push_back(condition);
    }
  }

  void element_loads(const DeckBlock& block) {
    drop_earlier(block, {DeckCondition::Kind::pressure, DeckCondition::Kind::gravity});
    for (const DeckLine& line : block.data) {
      DeckCondition condition{DeckCondition::Kind::pressure, line.fields[0]};
      condition.line = line.number;
      const std::string kind = line.fields.size() > 1 ? line.fields[1] : "";
      if (kind == "GRAV") {
        condition.kind = DeckCondition::Kind::gravity;
        condition.value = number_of(line, 2, "elements, GRAV, acceleration, direction");
        for (int k = 0; k < num_components; ++k)
          condition.direction[k] = number_of(line, k + 3, "elements, GRAV, acceleration, direction");
      } else if (kind.size() > 1 && kind[0] == 'P' && is_whole(kind.substr(1))) {
        condition.first = condition.last = std::stoi(kind.substr(1));
        condition.value = number_of(line, 2, "elements, side, pressure");
      } else {
        leave_out(fmt::format("*DLOAD, {}", kind), line);
        continue;
      }
      deck_.conditions.push_back(condition);
    }
  }

  void surface_loads(const DeckBlock& block) {
    drop_earlier(block, {DeckCondition::Kind::surface_pressure});
    for (const DeckLine& line : block.data) {
      DeckCondition condition{DeckCondition::Kind::surface_pressure, line.fields[0]};
      condition.line = line.number;
      if (line.fields.size() < 2 || line.fields[1] != "P") {
        leave_out(fmt::format("*DSLOAD, {}", line.fields.size() < 2 ? "" : line.fields[1]), line);
        continue;
      }
      condition.value = number_of(line, 2, "surface, P, pressure");
      deck_.conditions.push_back(condition);
    }
  }

  void pair(const DeckBlock& block) {
    for (const DeckLine& line : block.data) add_pair(line, block.has("TIED"), block.at("INTERACTION"));
  }
  void interaction(const DeckBlock& block) { interaction_ = block.at("NAME"); }
  void behaviour(const DeckBlock& block) {
    const std::string law = block.at("PRESSURE-OVERCLOSURE");
    if (law == "TIED")
      deck_.tied.insert(interaction_);
    else if (!law.empty() && law != "HARD")
      leave_out("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=" + law + ": contact is hard", block.head);
  }
  void friction(const DeckBlock& block) {
    if (interaction_.empty()) return leave_out("*FRICTION of no surface interaction", block.head);
    if (block.data.empty()) return leave_out("*FRICTION without a coefficient", block.head);
    deck_.friction[interaction_] = number_of(block.data[0], 0, "coefficient");
  }
  void tie(const DeckBlock& block) {
    for (const DeckLine& line : block.data) add_pair(line, true);
  }
  void add_pair(const DeckLine& line, bool bonded, const std::string& of_interaction = "") {
    if (line.fields.size() < 2) fail(line, "names one surface", "slave surface, master surface");
    deck_.pairs.push_back({line.fields[0], line.fields[1], of_interaction, bonded, line.number});
  }

  void step(const DeckBlock& block) {
    if (++num_steps_ > 1) leave_out("*STEP beyond the first", block.head);
    if (block.has("NLGEOM") && block.at("NLGEOM") != "NO")
      leave_out("*STEP, NLGEOM: displacements are small", block.head);
    before_step_ = deck_.conditions.size();
  }

  struct Section {
    std::string set, material;
    DeckLine line;
  };

  Deck deck_;
  std::string material_, interaction_;
  std::vector<Section> sections_;
  std::map<std::string, std::vector<int>> unknown_;  ///< the lines
  int num_steps_ = 0;
  std::size_t before_step_ = 0;  ///< conditions that were there before the step
};

std::set<int> set_or_number(const std::map<std::string, std::set<int>>& sets, const std::string& name) {
  if (const auto found = sets.find(name); found != sets.end()) return found->second;
  return is_whole(name) ? std::set<int>{std::stoi(name)} : std::set<int>{};
}

}  // namespace

std::set<int> Deck::nodes_of(const std::string& set) const { return set_or_number(node_sets, set); }
std::set<int> Deck::elements_of(const std::string& set) const { return set_or_number(element_sets, set); }

int num_corners(ElementShape shape) {
  return shape == ElementShape::tetrahedron ? 4 : shape == ElementShape::wedge ? 6 : 8;
}

const std::vector<std::vector<int>>& sides_of(DeckElement::Shape shape) {
  static const std::vector<std::vector<int>> of_tetrahedron{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}},
      of_wedge{{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}},
      of_hexahedron{{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
  return shape == ElementShape::tetrahedron ? of_tetrahedron : shape == ElementShape::wedge ? of_wedge : of_hexahedron;
}

int middle_node(const DeckElement& element, int corner, int other) {
  using Edges = std::vector<std::pair<int, int>>;
  static const Edges of_tetrahedron{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}},
      of_wedge{{0, 1}, {1, 2}, {0, 2}, {3, 4}, {4, 5}, {3, 5}, {0, 3}, {1, 4}, {2, 5}},
      of_hexahedron{{0, 1}, {1, 2}, {2, 3}, {0, 3}, {4, 5}, {5, 6}, {6, 7}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  const Edges& edges = element.shape == ElementShape::tetrahedron ? of_tetrahedron
                       : element.shape == ElementShape::wedge     ? of_wedge
                                                                  : of_hexahedron;
  const auto found = std::find(edges.begin(), edges.end(), std::minmax({corner, other}));
  const int index = num_corners(element.shape) + static_cast<int>(found - edges.begin());
  return found != edges.end() && index < static_cast<int>(element.nodes.size()) ? element.nodes[index] : -1;
}

Deck read_deck(const std::string& file) { return DeckReader().read(file); }

}  // namespace cgcontact
