#include "core/scene_file/templates/cad_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/expressions/units.hpp"
#include "core/scene_file/sections/scene_mesh.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr double near_share = 0.01;  // of the smaller solid's longest side: faces this near to each other may touch
constexpr double max_facing_cosine = -0.5;  // cosine between the normals of faces that face each other
constexpr double min_share = 1e-3;   // of the smaller face: what lies less near than this touches along an edge only
constexpr double cells_through = 3;  // the thinnest side of a solid, if that does not take too many cells
constexpr double max_cells_of_solid = 60000;
constexpr std::size_t max_lines = 24;      // of faces of a solid
constexpr std::size_t longest_word = 80;   // of a name of a scene, which may be a little longer
constexpr double overlap_rounding = 1e-9;  // m: less is rounding

std::string word(const std::string& text) {
  std::string result;
  for (const unsigned char c : text)
    result += c < 0x80 && (std::isalnum(c) || c == '_' || c == '-') ? static_cast<char>(c) : '_';
  if (result.empty() || std::isdigit(static_cast<unsigned char>(result[0]))) result = "part_" + result;
  return result.substr(0, longest_word);
}

/// Faces of two solids that face each other within a distance.
struct Touching {
  std::set<int> first, second;
  double nearest = 0;  ///< m, < 0: they overlap
};

double area_of(const TriangleSurface& surface, int t) {
  const Vec3& a = surface.corner(t, 0);
  return (surface.corner(t, 1) - a).cross(surface.corner(t, 2) - a).norm() / 2;
}

/// Finds where two CAD bodies touch by the exact surfaces, which the triangles miss by a fraction of a cell.
Touching find_touching(const CadBody& a, const CadBody& b) {
  Vec3 a_min, a_max, b_min, b_max;
  a.bounding_box(a_min, a_max);
  b.bounding_box(b_min, b_max);
  const double limit = near_share * std::min((a_max - a_min).maxCoeff(), (b_max - b_min).maxCoeff());
  Touching touching;
  touching.nearest = limit;
  if ((a_min - b_max).cwiseMax(b_min - a_max).maxCoeff() > limit) return touching;
  const auto look = [&](const CadBody& from_body, const CadBody& to_body, bool swapped) {
    const TriangleSurface &from = from_body.surface().flat, &to = to_body.surface().flat;
    std::map<std::pair<int, int>, double> areas;
    std::vector<double> whole(from.face_names().size(), 0);
    for (int t = 0; t < static_cast<int>(from.triangles().size()); ++t) {
      whole[from.patch(t)] += area_of(from, t);
      // Large triangles of planes are sampled.
      constexpr int n = 4;
      for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
          const CurvedPoint sample = from_body.surface().curved.point_at(t, (i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
          const TriangleSurface::Foot foot = to.nearest(sample.x, -1, limit);
          if (foot.triangle < 0 || from.normal(t).dot(to.normal(foot.triangle)) > max_facing_cosine) continue;
          const int face = to.patch(foot.triangle);
          areas[{from.patch(t), face}] += 2 * area_of(from, t) / (n * (n + 1));
          const Surface there = to_body.surfaces()[face].near(sample.x);
          touching.nearest = std::min(touching.nearest, (sample.x - there.point).dot(there.direction));
        }
    }
    for (const auto& [pair, area] : areas) {
      if (area < min_share * whole[pair.first]) continue;
      (swapped ? touching.second : touching.first).insert(pair.first);
      (swapped ? touching.first : touching.second).insert(pair.second);
    }
  };
  look(a, b, false);
  look(b, a, true);
  return touching;
}

/// Formats a vector; components that are rounding beside `size` are zero.
std::string comment_vector(const Vec3& v, double size) {
  const Vec3 clean = without_rounding(v, size);
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", clean[0], clean[1], clean[2]);
}

/// Faces of a solid, largest first.
std::string face_lines(const CadModel& model, double scale) {
  std::vector<int> order(model.faces().size());
  for (std::size_t f = 0; f < order.size(); ++f) order[f] = static_cast<int>(f);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return model.faces()[a].area > model.faces()[b].area; });
  const auto [low, high] = model.box();
  const double size = (high - low).maxCoeff();
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), max_lines); ++k) {
    const CadFace& face = model.faces()[order[k]];
    text += fmt::format("#   face{:<4} {:8.4g} m^2  {}", order[k] + 1, face.area * scale * scale,
                        face.kind == "other" ? "free-form" : face.kind);
    if (face.kind == "plane") text += ", normal " + comment_vector(face.axis, 1);
    if (const std::string sizes = cad_size_text(face, scale, "m"); !sizes.empty()) text += ", " + sizes;
    text += ", at " + comment_vector(scale * face.middle, scale * size);
    if (!face.name.empty()) text += fmt::format(", called \"{}\"", face.name);
    text += "\n";
  }
  if (order.size() > max_lines) text += fmt::format("#   ... and {} smaller ones\n", order.size() - max_lines);
  return text;
}

std::string list(const std::set<int>& faces) {
  std::string text;
  for (const int f : faces) text += fmt::format("{}\"cad.face{}\"", text.empty() ? "" : ", ", f + 1);
  return text;
}

const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

}  // namespace

CadTemplate::CadTemplate(const InitOptions& options, const std::string& source)
    : options_(options),
      source_(source),
      without_unit_(cad_format(options.cad) == CadFormat::brep),
      scale_(without_unit_ ? mesh_units().at(options.unit) : mm),
      solids_(read_cad(options.cad, {options.repair})) {
  try {
    add_parts();
  } catch (const InputError& error) {
    throw InputError(options.cad + ": " + error.what());
  }
  add_contacts();
}

void CadTemplate::add_parts() {
  const int cells = options_.cells.value_or(default_init_cells);
  std::set<std::string> seen;
  for (const CadSolid& solid : solids_) {
    std::string name = word(solid.name);
    while (!seen.insert(name).second) name += "_";
    const auto [low, high] = solid.model.box();
    const Vec3 extent = scale_ * (high - low);
    const double volume = solid.model.volume() * scale_ * scale_ * scale_;
    const double h = two_digits(std::max(std::min(extent.maxCoeff() / cells, extent.minCoeff() / cells_through),
                                         std::cbrt(volume / (max_cells_of_solid * std::pow(cells / 20.0, 3)))));
    std::vector<std::vector<std::string>> names(solid.model.faces().size());
    for (std::size_t f = 0; f < names.size(); ++f) names[f] = {fmt::format("face{}", f + 1)};
    const Solid body(std::make_shared<CadBody>(solid.model.named(names), scale_, h));
    parts_.push_back({name, &solid, body, h, scale_ * low, scale_ * high, {}, ""});
  }
}

void CadTemplate::add_contacts() {
  for (std::size_t a = 0; a < parts_.size(); ++a)
    for (std::size_t b = a + 1; b < parts_.size(); ++b) {
      const Touching touching = find_touching(*as_cad(parts_[a].body), *as_cad(parts_[b].body));
      if (touching.first.empty() || touching.second.empty()) continue;
      ++pairs_;
      const auto declare = [](Part& own, const Part& other, const std::set<int>& faces) {
        own.touching.insert(faces.begin(), faces.end());
        own.declared += fmt::format("  {{name = \"to_{}\", surfaces = [{}]}},\n", other.name, list(faces));
      };
      declare(parts_[a], parts_[b], touching.first);
      declare(parts_[b], parts_[a], touching.second);
      const double gap = std::abs(touching.nearest) < overlap_rounding ? 0 : touching.nearest;
      contacts_ += fmt::format(
          "\n[[contact]]                        # TODO may they touch? {} {:.3g} m\n"
          "faces = [\"{}.to_{}\", \"{}.to_{}\"]\n",
          gap < 0 ? "They overlap by at least" : "The gap is about", std::abs(gap), parts_[a].name, parts_[b].name,
          parts_[b].name, parts_[a].name);
    }
}

/// Finds a face that touches nothing: of the largest solid's larger flat ones that which looks down most; else such a
/// one of any solid; then the largest flat one, then the largest.
CadTemplate::Held CadTemplate::find_held(std::size_t largest) const {
  Held held{largest, -1};
  for (int choice = 0; choice < 4 && held.face < 0; ++choice) {
    double most = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (choice == 0 && p != largest) continue;
      const std::vector<CadFace>& faces = parts_[p].solid->model.faces();
      for (std::size_t f = 0; f < faces.size(); ++f) {
        if (parts_[p].touching.count(static_cast<int>(f)) > 0 || (choice < 3 && faces[f].kind != "plane")) continue;
        const double size = (choice < 2 ? -faces[f].axis[2] : 1) * faces[f].area;
        if (size <= most) continue;
        most = size;
        held = {p, static_cast<int>(f)};
      }
    }
  }
  return held;
}

std::string CadTemplate::cad_line(const CadSolid& solid) const {
  return fmt::format("cad = {{file = {}, solid = {}{}{}}}", toml_string(source_), toml_string(solid.name),
                     without_unit_ ? fmt::format(", unit = \"{}\"", options_.unit) : "",
                     options_.repair ? ", repair = true" : "");
}

std::optional<CadTemplate::Single> CadTemplate::single() const {
  if (parts_.size() != 1) return std::nullopt;
  const Part& part = parts_.front();
  const CadModel& model = part.solid->model;
  const Vec3 extent = part.max - part.min;
  return Single{cad_line(*part.solid) + "\n# Its faces, largest first; they are \"part.surface.face1\" and so on:\n" +
                    face_lines(model, scale_),
                outline_surface(
                    as_cad(part.body)->surface().flat,
                    fmt::format("{}: solid \"{}\", {} face{}, {:.4g} x {:.4g} x {:.4g} m", source_, part.solid->name,
                                model.faces().size(), plural(model.faces().size()), extent[0], extent[1], extent[2]))};
}

std::string CadTemplate::scene(const std::string& file, const std::string& state, std::string& told) const {
  std::size_t largest = 0;
  for (std::size_t p = 1; p < parts_.size(); ++p)
    if (parts_[p].solid->model.volume() > parts_[largest].solid->model.volume()) largest = p;
  const Held held = find_held(largest);

  std::string text = fmt::format(
      "# The {} solids of {}. {}\n#\n"
      "#   cgcontact check {}       what the scene contains\n"
      "#   cgcontact check {} --out pictures      the same with a picture of the faces\n#\n"
      "# It knows nothing of your problem: go through the lines marked TODO. Lengths in m, pressures in Pa. Every key "
      "is in\n"
      "# docs/scene.md of cgcontact.\n\n"
      "title = {}\n",
      parts_.size(), comment_word(fs::path(options_.cad).filename().string()), state, comment_word(file),
      comment_word(file), toml_string(fs::path(options_.cad).stem().string()));
  for (const Part& part : parts_) {
    text += fmt::format(
        "\n[[body]]\nname = \"{}\"\nmaterial = {{E = 210e9, nu = 0.3}}   # TODO Young's modulus (Pa) and Poisson's "
        "ratio; "
        "this is steel\ncell_size = {:.6g}   # smaller is more accurate and costs more\nshape = {{{}}}\n",
        part.name, part.cell_size, cad_line(*part.solid));
    if (!part.declared.empty()) text += "faces = [\n" + part.declared + "]\n";
    text += "# Its faces, largest first; they are \"" + part.name + ".face1\" and so on:\n" +
            face_lines(part.solid->model, scale_);
  }
  text += "\n[[support]]                        # TODO what holds the bodies\n";
  text += fmt::format("face = \"{}.{}\"\n", parts_[held.part].name,
                      held.face < 0 ? "cad" : fmt::format("face{}", held.face + 1));
  text +=
      "displacement = {x = 0, y = 0, z = 0}   # components that are not given are free; or: symmetry = true\n\n"
      "# TODO what loads them, N/m^2 against the normal; or a support with a displacement that is not zero\n"
      "# [[load]]\n";
  text += fmt::format("# face = \"{}.face1\"\n# pressure = 1e6\n", parts_.back().name);
  text += contacts_;

  told += fmt::format("{}: {} solids, {} pair{} of them that touch or nearly touch\n", options_.cad, parts_.size(),
                      pairs_, plural(static_cast<std::size_t>(pairs_)));
  for (const Part& part : parts_) {
    const Vec3 extent = part.max - part.min;
    told += fmt::format("  {}: {:.4g} x {:.4g} x {:.4g} m, {} face{}, cells of {:.3g} m\n", part.name, extent[0],
                        extent[1], extent[2], part.solid->model.faces().size(),
                        plural(part.solid->model.faces().size()), part.cell_size);
    const std::string doubt = doubtful_unit(extent);
    if (!doubt.empty()) told += fmt::format("warning: {}: {}\n", part.name, doubt);
  }
  told += remarks();
  return text;
}

std::string CadTemplate::remarks() const {
  std::string text;
  for (const CadSolid& solid : solids_)
    if (!solid.repair.empty()) text += fmt::format("repaired on request: \"{}\": {}\n", solid.name, solid.repair);
  if (!solids_.front().left_out.empty())
    text += fmt::format("warning: {}: {}\n", options_.cad, solids_.front().left_out);
  return text;
}

}  // namespace cgcontact
