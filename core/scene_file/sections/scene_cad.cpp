#include "core/scene_file/sections/scene_cad.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>

#include "core/base/errors/suggest.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/expressions/units.hpp"
#include "core/scene_file/sections/scene_mesh.hpp"
#include "core/scene_file/sections/scene_shapes.hpp"

namespace cgcontact {

namespace {

constexpr double first_cells = 20;  // along the longest side, of a body without cell_size
constexpr double max_cells_across =
    2000;  // smaller cells, relative to the body, are a mistake that is reported elsewhere
constexpr double radius_tolerance = 1e-4;
constexpr int colour_tolerance = 2;  // of 255: what rounding in the file makes of it

/// The solids of a file are read once for all bodies that are made of them.
std::shared_ptr<const std::vector<CadSolid>> read_once(const std::string& file, bool repair) {
  struct Read {
    std::filesystem::file_time_type time;
    std::shared_ptr<const std::vector<CadSolid>> solids;
  };
  static std::mutex mutex;
  static std::map<std::pair<std::string, bool>, Read> files;
  std::error_code missing;
  const auto time = std::filesystem::last_write_time(file, missing);
  const std::lock_guard<std::mutex> lock(mutex);
  Read& read = files[{file, repair}];
  if (!read.solids || missing || read.time != time)
    read = {time, std::make_shared<const std::vector<CadSolid>>(read_cad(file, {repair}))};
  return read.solids;
}

const CadSolid& choose_solid(const TomlCursor& node, const TomlCursor& file_node, const std::vector<CadSolid>& solids) {
  std::vector<std::string> names, quoted;
  for (const CadSolid& solid : solids) {
    names.push_back(solid.name);
    quoted.push_back('"' + solid.name + '"');
  }
  const auto given = node.find("solid");
  const std::string allowed = join(quoted) + fmt::format(", or a number from 1 to {}", solids.size());
  if (!given) {
    if (solids.size() > 1)
      file_node.fail(fmt::format("there are {} solids in it: say which with the key solid", solids.size()), allowed);
    return solids.front();
  }
  if (!given->is_string())
    return solids[static_cast<std::size_t>(given->integer(1, static_cast<int>(solids.size())) - 1)];
  const std::string wanted = given->string("a name");
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found == names.end()) given->fail("there is no such solid in the file" + did_you_mean(wanted, names), allowed);
  return solids[static_cast<std::size_t>(found - names.begin())];
}

std::array<int, 3> read_colour(const TomlCursor& node) {
  const std::string text = node.string("\"#rrggbb\"");
  const bool good = text.size() == 7 && text[0] == '#' &&
                    std::all_of(text.begin() + 1, text.end(), [](unsigned char c) { return std::isxdigit(c); });
  if (!good) node.fail("is no colour", "\"#rrggbb\", two hexadecimal digits each for red, green and blue");
  return {std::stoi(text.substr(1, 2), nullptr, 16), std::stoi(text.substr(3, 2), nullptr, 16),
          std::stoi(text.substr(5, 2), nullptr, 16)};
}

std::string colour_text(const std::array<int, 3>& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

/// Lists the different values of a property of the faces.
template <class Get>
std::string list_of(const std::vector<CadFace>& faces, const Get& get) {
  std::set<std::string> all;
  for (const CadFace& face : faces)
    if (const std::string text = get(face); !text.empty()) all.insert(text);
  return all.empty() ? "the file has none" : join({all.begin(), all.end()});
}

class FaceSelector {
 public:
  FaceSelector(const TomlCursor& node, const CadModel& model, double scale)
      : node_(node), model_(model), faces_(model.faces()), scale_(scale), selected_(faces_.size(), 1) {}

  /// The numbers (from 0) of the faces that meet all that the table says.
  std::vector<int> run() {
    node_.expect_keys({"name", "number", "called", "color", "kind", "radius", "normal", "nearest"});
    bool any = by_number();
    any = by_text() || any;
    any = by_size() || any;
    const auto nearest = node_.find("nearest");
    if (!any && !nearest)
      node_.fail("selects nothing", "at least one of number, called, color, kind, radius, normal, nearest");
    std::vector<int> numbers;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (selected_[f]) numbers.push_back(static_cast<int>(f));
    if (numbers.empty()) node_.fail("selects no face of the solid", "faces that meet all selectors given");
    if (!nearest) return numbers;
    const Vec3 x = nearest->vector("m") / scale_;
    try {
      const std::vector<double> distances = model_.distances(numbers, x);
      return {numbers[std::min_element(distances.begin(), distances.end()) - distances.begin()]};
    } catch (const InputError& error) {
      nearest->fail(error.what());
    }
  }

 private:
  template <class Meets>
  void keep(const Meets& meets) {
    for (std::size_t f = 0; f < faces_.size(); ++f) selected_[f] = selected_[f] && meets(faces_[f]);
  }

  /// keep, and an error that says what there is if nothing meets it.
  template <class Meets, class Get>
  void keep_some(const TomlCursor& node, const Meets& meets, const Get& get) {
    if (std::none_of(faces_.begin(), faces_.end(), meets))
      node.fail("no face of the solid is so", list_of(faces_, get));
    keep(meets);
  }

  bool by_number() {
    const auto number = node_.find("number");
    if (!number) return false;
    std::set<int> wanted;
    const auto add = [&](const TomlCursor& one) { wanted.insert(one.integer(1, static_cast<int>(faces_.size()))); };
    if (number->is_array())
      for (const TomlCursor& one : number->elements("[number, ...]")) add(one);
    else
      add(*number);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      selected_[f] = selected_[f] && wanted.count(static_cast<int>(f) + 1) > 0;
    return true;
  }

  bool by_text() {
    bool any = false;
    if (const auto called = node_.find("called")) {
      const std::string text = called->string("the name that a face has in the file");
      keep_some(
          *called, [&](const CadFace& f) { return f.name == text; }, [](const CadFace& f) { return f.name; });
      any = true;
    }
    if (const auto color = node_.find("color")) {
      const std::array<int, 3> wanted = read_colour(*color);
      keep_some(
          *color,
          [&](const CadFace& f) {
            for (int k = 0; k < 3; ++k)
              if (!f.colour || std::abs((*f.colour)[k] - wanted[k]) > colour_tolerance) return false;
            return true;
          },
          [](const CadFace& f) { return f.colour ? colour_text(*f.colour) : ""; });
      any = true;
    }
    if (const auto kind = node_.find("kind")) {
      const std::string wanted = cad_kinds()[kind->one_of(cad_kinds())];
      keep_some(
          *kind, [&](const CadFace& f) { return f.kind == wanted; }, [](const CadFace& f) { return f.kind; });
      any = true;
    }
    return any;
  }

  bool by_size() {
    bool any = false;
    if (const auto radius = node_.find("radius")) {
      const double wanted = radius->number(Range::positive("m")) / scale_;
      keep_some(
          *radius, [&](const CadFace& f) { return std::abs(f.radius - wanted) <= radius_tolerance * wanted; },
          [&](const CadFace& f) { return f.radius > 0 ? fmt::format("{:.6g} m", f.radius * scale_) : ""; });
      any = true;
    }
    if (const auto normal = node_.find("normal")) {
      normal->expect_keys({"axis", "angle"});
      Range angle = Range::positive("degrees");
      angle.max = 180;
      angle.text = "0 < angle <= 180 degrees";
      const Vec3 axis = normal->at("axis", "[x, y, z]").direction();
      const double least = std::cos(normal->at("angle", angle.text).number(angle) * radians_per_degree);
      keep([&](const CadFace& f) { return f.kind == "plane" && f.axis.dot(axis) >= least - 1e-12; });
      any = true;
    }
    return any;
  }

  const TomlCursor& node_;
  const CadModel& model_;
  const std::vector<CadFace>& faces_;
  double scale_;
  std::vector<char> selected_;
};

/// The solid with the names of its faces: "faceN", that of the file, those declared; the list of all in `known`.
CadModel name_cad_faces(const TomlCursor& node, const std::string& primitive, const CadModel& model, double scale,
                        std::vector<std::string>& known) {
  std::vector<std::vector<std::string>> names(model.faces().size());
  std::set<std::string> seen;
  const auto add = [&](std::size_t face, const std::string& name) {
    names[face].insert(names[face].begin(), primitive + "." + name);  // what it is called most specially comes first
    if (seen.insert(name).second) known.push_back(name);
  };
  for (std::size_t f = 0; f < names.size(); ++f) add(f, fmt::format("face{}", f + 1));
  for (std::size_t f = 0; f < names.size(); ++f)
    if (const std::string& name = model.faces()[f].name; is_scene_name(name)) add(f, name);
  const std::set<std::string> of_file = seen;
  std::set<std::string> declared;
  if (const auto faces = node.find("faces"))
    for (const TomlCursor& entry : faces->elements("[{name, number, kind, radius, ...}, ...]")) {
      const TomlCursor name_node = entry.at("name", "a name");
      const std::string name = read_name(name_node);
      if (of_file.count(name) > 0)
        name_node.fail("is a name that the file gives a face, or the number of one", "another name");
      if (!declared.insert(name).second) name_node.fail("is the name of another face of this solid", "unique names");
      for (const int f : FaceSelector(entry, model, scale).run()) add(static_cast<std::size_t>(f), name);
    }
  return model.named(names);
}

double read_cad_scale(const TomlCursor& node, const std::string& file) {
  const auto unit = node.find("unit");
  if (cad_format(file) != CadFormat::brep) {
    if (unit) unit->fail("is not needed: the file says its unit", "unit beside a .brep file only");
    return mm;
  }
  std::vector<std::string> names;
  for (const auto& entry : mesh_units()) names.push_back(entry.first);
  return mesh_units().at(names[node.at("unit", join(names) + ": a .brep file does not say its unit").one_of(names)]);
}

}  // namespace

bool is_scene_name(const std::string& name) {
  return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-'); });
}

double cell_size_for_cad(const TomlCursor& body, double longest) {
  if (!body.find("cell_size")) return longest / first_cells;
  return std::clamp(read_cell_size(body), longest / max_cells_across, longest);
}

CadShape read_cad_solid(const TomlCursor& node, const std::string& name, const TomlCursor& body) {
  node.expect_keys({"file", "solid", "unit", "repair", "faces"});
  const TomlCursor file_node = node.at("file", "a .step, .stp, .iges, .igs, .brep or .brp file");
  const std::string given = file_node.string("a file name");
  const std::string file = (std::filesystem::path(node.text().file).parent_path() / given).string();
  const double scale = read_cad_scale(node, given);
  const auto repair_node = node.find("repair");
  const bool repair = repair_node && repair_node->boolean();
  std::shared_ptr<const std::vector<CadSolid>> solids;
  try {
    solids = read_once(file, repair);
  } catch (const InputError& error) {
    file_node.fail(error.what());
  }
  const CadSolid& chosen = choose_solid(node, file_node, *solids);
  CadShape shape;
  const CadModel model = name_cad_faces(node, name, chosen.model, scale, shape.faces);
  Vec3 extent;
  try {
    const auto [low, high] = model.box();
    extent = scale * (high - low);
    shape.solid = Solid(std::make_shared<CadBody>(model, scale, cell_size_for_cad(body, extent.maxCoeff())));
    shape.note =
        fmt::format("{}: solid \"{}\", {} face{}, {:.4g} x {:.4g} x {:.4g} m, volume {:.6g} m^3, area {:.6g} m^2",
                    given, chosen.name, model.faces().size(), model.faces().size() == 1 ? "" : "s", extent[0],
                    extent[1], extent[2], model.volume() * scale * scale * scale, model.area() * scale * scale);
  } catch (const InputError& error) {
    file_node.fail(error.what());
  }
  if (!chosen.repair.empty()) {
    shape.note += "; repaired on request: " + chosen.repair;
    shape.warnings.push_back(shape.note);
  }
  if (!chosen.left_out.empty()) shape.note += "; " + chosen.left_out;
  for (const std::string& doubt : {chosen.left_out, doubtful_unit(extent)})
    if (!doubt.empty()) shape.warnings.push_back(given + ": " + doubt);
  return shape;
}

}  // namespace cgcontact
