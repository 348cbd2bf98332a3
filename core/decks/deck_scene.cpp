#include "core/decks/deck_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>

#include "core/base/errors/errors.hpp"
#include "core/base/files/new_file.hpp"
#include "core/decks/deck_bodies.hpp"
#include "core/scene_file/templates/scene_template.hpp"

namespace cgcontact {

namespace {

/// SI units per unit of the deck.
struct Units {
  double length, stress, density;
};

constexpr const char* component_names = "xyz";

Units units_of_deck(const std::string& unit) {
  return unit == "mm" ? Units{1e-3, 1e6, 1e12} : Units{1, 1, 1};  // t/mm^3 = 1e12 kg/m^3
}

std::string number(double value) { return fmt::format("{:.12g}", value); }

std::string toml_vector(const Vec3& v) { return fmt::format("[{}, {}, {}]", number(v[0]), number(v[1]), number(v[2])); }

struct DeckScene {
  std::string text;
  std::vector<std::pair<std::string, std::string>> files;  ///< surfaces: name (in the scene's folder), contents
  std::vector<std::string> remarks;                        ///< what of the deck is not in it
};

/// Conversion of a deck to sections of a scene; what cannot be one is a remark.
class SceneOfDeck {
 public:
  SceneOfDeck(const std::string& file, const std::string& unit, const std::string& scene)
      : deck_(read_deck(file)),
        found_(find_bodies(deck_)),
        unit_(unit),
        units_(units_of_deck(unit)),
        stem_(std::filesystem::path(scene).stem().string()) {}

  DeckScene make() {
    for (const std::string& text : deck_.left_out) result_.remarks.push_back(text);
    for (const DeckCondition& condition : deck_.conditions) take(condition);
    for (const DeckPair& pair : deck_.pairs) take(pair);
    for (const auto& joint : found_.joints) take(joint);
    const std::string conditions = supports() + loads_ + contacts_;
    std::string bodies;
    for (const DeckBody& body : found_.bodies) bodies += body_text(body);
    result_.text = head() + bodies + conditions;
    return std::move(result_);
  }

 private:
  void leave_out(const std::string& what, int line) {
    result_.remarks.push_back(fmt::format("{} (line {})", what, line));
  }

  /// Faces ("body.face") of the bodies that have outer sides there.
  std::vector<std::string> faces_of_nodes(const std::set<int>& nodes, const std::string& name) {
    std::vector<std::string> faces;
    for (DeckBody& body : found_.bodies)
      if (const std::string face = body.face(sides_on_nodes(deck_, body, nodes), name); !face.empty())
        faces.push_back(body.name + "." + face);
    return faces;
  }
  std::vector<std::string> faces_of_sides(const std::set<ElementSide>& sides, const std::string& name) {
    std::vector<std::string> faces;
    for (DeckBody& body : found_.bodies)
      if (const std::string face = body.face(sides, name); !face.empty()) faces.push_back(body.name + "." + face);
    return faces;
  }
  std::vector<std::string> faces_of_surface(const std::string& name) {
    if (const auto sides = deck_.surfaces.find(name); sides != deck_.surfaces.end())
      return faces_of_sides(sides->second, name);
    const auto nodes = deck_.node_surfaces.find(name);
    return nodes == deck_.node_surfaces.end() ? std::vector<std::string>{} : faces_of_nodes(nodes->second, name);
  }

  void take(const DeckCondition& c) {
    using Kind = DeckCondition::Kind;
    if (c.kind == Kind::gravity) {
      if (deck_.elements_of(c.set).size() < deck_.elements.size())
        leave_out(fmt::format("*DLOAD, GRAV on {} alone: gravity acts on all bodies of a scene", c.set), c.line);
      if (gravity_.empty())
        gravity_ = fmt::format("gravity = {}   # m/s^2, on all bodies\n\n",
                               toml_vector(units_.length * c.value * c.direction.normalized()));
      else
        leave_out("*DLOAD, GRAV: a second one", c.line);
      return;
    }
    const std::vector<std::string> faces = faces_of(c);
    if (faces.empty()) {
      const char* const keywords[] = {"BOUNDARY", "CLOAD", "DLOAD", "DSLOAD"};
      leave_out(fmt::format("*{} on {}: no whole outer side of an element lies there",
                            keywords[static_cast<int>(c.kind)], c.set),
                c.line);
      return;
    }
    report_nodes_beside(c);
    if (c.kind == Kind::displacement) return hold(c, faces);
    if (c.kind != Kind::force)
      for (const std::string& face : faces) loads_ += load(face, "pressure = " + number(units_.stress * c.value));
    else
      push(c, faces);
  }

  std::vector<std::string> faces_of(const DeckCondition& c) {
    using Kind = DeckCondition::Kind;
    if (c.kind == Kind::displacement || c.kind == Kind::force) return faces_of_nodes(deck_.nodes_of(c.set), c.set);
    if (c.kind == Kind::surface_pressure) return faces_of_surface(c.set);
    std::set<ElementSide> sides;
    for (const int element : deck_.elements_of(c.set)) sides.insert({element, c.first});
    return faces_of_sides(sides, fmt::format("{}_p{}", c.set, c.first));
  }

  /// Nodes that no whole side has are not held, and their forces act on the sides that there are.
  void report_nodes_beside(const DeckCondition& c) {
    if (c.kind != DeckCondition::Kind::displacement && c.kind != DeckCondition::Kind::force) return;
    const std::set<int> nodes = deck_.nodes_of(c.set);
    std::set<int> on_sides;
    for (const DeckBody& body : found_.bodies)
      on_sides.merge(nodes_of_sides(deck_, sides_on_nodes(deck_, body, nodes)));
    const auto beside = std::count_if(nodes.begin(), nodes.end(), [&](int node) { return on_sides.count(node) == 0; });
    if (beside > 0)
      leave_out(fmt::format("{} of the {} nodes of {}, which are on no whole outer side of an element", beside,
                            nodes.size(), c.set),
                c.line);
  }

  void hold(const DeckCondition& c, const std::vector<std::string>& faces) {
    for (const std::string& face : faces)
      for (int k = c.first; k <= c.last; ++k) held_[face][component_names[k - 1]] = units_.length * c.value;
  }

  /// A force on every node of a set is one on its face, as large as all of them.
  void push(const DeckCondition& c, const std::vector<std::string>& faces) {
    if (faces.size() > 1) return leave_out(fmt::format("*CLOAD on {}: nodes of several bodies", c.set), c.line);
    Vec3 force = Vec3::Zero();
    force[c.first - 1] = c.value * static_cast<double>(deck_.nodes_of(c.set).size());
    loads_ += load(faces[0], "force = " + toml_vector(force));
  }

  static std::string load(const std::string& face, const std::string& what) {
    return fmt::format("[[load]]\nface = {}\n{}\n\n", toml_string(face), what);
  }

  std::string supports() const {
    std::string text;
    for (const auto& [face, components] : held_) {
      std::string values;
      for (const auto& [axis, value] : components)
        values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", axis, number(value));
      text += fmt::format("[[support]]\nface = {}\ndisplacement = {{{}}}\n\n", toml_string(face), values);
    }
    return text;
  }

  void take(const DeckPair& pair) {
    const std::vector<std::string> slave = faces_of_surface(pair.slave), master = faces_of_surface(pair.master);
    if (slave.size() != 1 || master.size() != 1)
      return leave_out(
          fmt::format("contact of {} and {}: the surfaces are not one face of one body each", pair.slave, pair.master),
          pair.line);
    const auto friction = deck_.friction.find(pair.interaction);
    const bool bonded = pair.bonded || deck_.tied.count(pair.interaction) > 0;
    add_contact(slave[0], master[0], bonded, friction == deck_.friction.end() ? 0 : friction->second);
  }

  void take(const DeckBodies::Joint& joint) {
    DeckBody &first = found_.bodies[joint.first], &second = found_.bodies[joint.second];
    const std::string of_first = first.face(joint.of_first, "joint_" + second.name),
                      of_second = second.face(joint.of_second, "joint_" + first.name);
    add_contact(first.name + "." + of_first, second.name + "." + of_second, true, 0);
  }

  void add_contact(const std::string& slave, const std::string& master, bool bonded, double friction) {
    const std::string more = bonded         ? "bonded = true\n"
                             : friction > 0 ? fmt::format("friction = {:g}\n", friction)
                                            : "";
    contacts_ += fmt::format("[[contact]]\nfaces = [{}, {}]\n{}\n", toml_string(slave), toml_string(master), more);
    touches_ = touches_ || !bonded;
  }

  std::string body_text(const DeckBody& body) {
    std::vector<std::vector<std::string>> groups;
    const std::string surface = surface_text(deck_, body, groups), file = fmt::format("{}_{}.obj", stem_, body.name);
    result_.files.emplace_back(file, surface);
    std::set<std::string> names;
    std::string faces, selectors;
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
      std::string list;
      for (const std::string& group : groups[f]) {
        list += fmt::format("{}{}", list.empty() ? "" : ", ", toml_string(body.name + "." + group));
        if (names.insert(group).second)
          selectors += fmt::format("  {{name = {0}, group = {0}}},\n", toml_string(group));
      }
      faces += fmt::format("  {{name = {}, surfaces = [{}]}},\n", toml_string(body.faces[f].name), list);
    }
    std::string text =
        fmt::format("[[body]]\nname = {}\nmaterial = {}\n", toml_string(body.name), material(body.material));
    if (!faces.empty()) text += fmt::format("faces = [\n{}]\n", faces);
    text += fmt::format("[body.shape]\nname = {0}\n[body.shape.mesh]\nfile = {1}\nunit = \"{2}\"\n",
                        toml_string(body.name), toml_string(file), unit_);
    if (!selectors.empty()) text += fmt::format("faces = [\n{}]\n", selectors);
    return text + "\n";
  }

  std::string material(const std::string& name) {
    const DeckMaterial& m = deck_.materials.at(name);
    if (!m.youngs_modulus)
      throw InputError(fmt::format(
          "{}: the material {} is not linear elastic and isotropic (allowed: *ELASTIC with E, nu)", deck_.file, name));
    std::string text =
        fmt::format("{{E = {}, nu = {}", number(units_.stress * *m.youngs_modulus), number(*m.poissons_ratio));
    if (m.density) text += fmt::format(", density = {}", number(units_.density * *m.density));
    if (m.expansion) text += fmt::format(", expansion = {}", number(*m.expansion));
    return text + fmt::format("}}   # {}", comment_word(name));
  }

  std::string head() const {
    std::string text = fmt::format("# Made of {} by cgcontact init. SI units: m, N, Pa.\n", comment_word(deck_.file));
    for (const std::string& remark : result_.remarks) text += "# Not taken over: " + comment_word(remark) + "\n";
    text += fmt::format("title = {}\n", toml_string(printable(deck_.title.empty() ? stem_ : deck_.title, 200)));
    text += gravity_;
    text += fmt::format(
        "\n[accuracy]\n{} = \"5 %\"   # estimated error that is asked for; less costs more\n"
        "max_unknowns = 4e5    # limits of a first look\nmax_time = 60         # s\n\n",
        touches_ ? "pressure" : "displacement");
    return text;
  }

  Deck deck_;
  DeckBodies found_;
  std::string unit_;
  Units units_;
  std::string stem_;
  DeckScene result_;
  std::map<std::string, std::map<char, double>> held_;  ///< by face: components, m
  std::string gravity_, loads_, contacts_;
  bool touches_ = false;
};

void check_deck_options(const InitOptions& options) {
  if (!options.surface.empty() || !options.cad.empty() || options.repair || options.cells)
    throw InputError(options.file + ": an input deck has no --stl, --cad, --repair and --cells (allowed: --unit)");
  if (options.unit != "mm" && options.unit != "m")
    throw InputError(
        fmt::format("{} needs --unit: a deck does not say in which units its numbers are (allowed: mm, with "
                    "N, MPa and t, or m, with N, Pa and kg)",
                    options.file));
}

/// Surfaces that are written before the scene which names them; they go again if that does not come about.
class WrittenFiles {
 public:
  void write(const std::string& file, const std::string& text) {
    write_new_file(file, text);
    files_.push_back(file);
  }
  void keep() { files_.clear(); }
  ~WrittenFiles() {
    for (const std::string& file : files_) std::remove(file.c_str());
  }

 private:
  std::vector<std::string> files_;
};

}  // namespace

std::string init_deck(const InitOptions& options, const FindFault& find_fault) {
  check_deck_options(options);
  const std::string file = std::filesystem::path(options.file).stem().string() + ".toml";
  check_file_names({options.file, file});
  const DeckScene scene = SceneOfDeck(options.file, options.unit, file).make();
  expect_new_file(file);
  for (const auto& [name, text] : scene.files) expect_new_file(name);
  WrittenFiles written;
  std::string told;
  for (const auto& [name, text] : scene.files) {
    written.write(name, text);
    told += fmt::format("wrote {}\n", name);
  }
  for (const std::string& remark : scene.remarks) told += fmt::format("not taken over: {}\n", remark);
  const std::string fault = find_fault ? find_fault(scene.text, file) : "";
  if (!fault.empty()) told += fmt::format("warning: the scene does not pass check yet: {}\n", fault);
  write_new_file(file, scene.text);
  written.keep();
  return told + fmt::format("wrote {0}\nNext:\n  cgcontact check {1}\n  cgcontact run {1}\n", file, comment_word(file));
}

}  // namespace cgcontact
