#include "core/scene/cad_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>

#include "core/base/errors.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/scene/scene_mesh.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr double mm = 1e-3;
constexpr int default_cells = 20;       // along the longest side of a solid
constexpr double near_share = 0.01;     // of the smaller solid's longest side: faces this near to each other may touch
constexpr double least_facing = -0.5;   // cosine between the normals of faces that face each other
constexpr double least_share = 1e-3;    // of the smaller face: what lies less near than this touches along an edge only
constexpr double cells_through = 3;     // the thinnest side of a solid, if that does not take too many cells
constexpr double most_cells = 60000;    // of a solid
constexpr std::size_t most_lines = 24;  // of faces of a solid

struct Part {
  std::string name, solid;
  const CadModel* model;
  Solid body;
  double cell_size;
  Vec3 min, max;
  std::vector<std::pair<std::string, std::vector<int>>> faces;  ///< declared: name, numbers from 0
};

std::string word(const std::string& text) {
  std::string result;
  for (const unsigned char c : text)
    result += c < 0x80 && (std::isalnum(c) || c == '_' || c == '-') ? static_cast<char>(c) : '_';
  if (result.empty() || std::isdigit(static_cast<unsigned char>(result[0]))) result = "part_" + result;
  return result;
}

double two_digits(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::round(value / unit) * unit;
}

std::vector<Part> read_parts(const std::vector<CadSolid>& solids, double scale, int cells) {
  std::vector<Part> parts;
  std::set<std::string> seen;
  for (const CadSolid& solid : solids) {
    std::string name = word(solid.name);
    while (!seen.insert(name).second) name += "_";
    const auto [low, high] = solid.model.box();
    const Vec3 extent = scale * (high - low);
    const double volume = solid.model.volume() * scale * scale * scale;
    const double h = two_digits(std::max(std::min(extent.maxCoeff() / cells, extent.minCoeff() / cells_through),
                                         std::cbrt(volume / (most_cells * std::pow(cells / 20.0, 3)))));
    std::vector<std::vector<std::string>> names(solid.model.faces().size());
    for (std::size_t f = 0; f < names.size(); ++f) names[f] = {fmt::format("face{}", f + 1)};
    const Solid body(std::make_shared<CadBody>(solid.model.named(names), scale, h));
    parts.push_back({name, solid.name, &solid.model, body, h, scale * low, scale * high, {}});
  }
  return parts;
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

Touching find_touching(const Part& a, const Part& b) {
  const double limit = near_share * std::min((a.max - a.min).maxCoeff(), (b.max - b.min).maxCoeff());
  Touching touching;
  touching.nearest = limit;
  if ((a.min - b.max).cwiseMax(b.min - a.max).maxCoeff() > limit) return touching;
  const TriangleSurface &of_a = as_cad(a.body)->surface().flat, &of_b = as_cad(b.body)->surface().flat;
  const auto look = [&](const TriangleSurface& from, const TriangleSurface& to, bool swapped) {
    std::map<std::pair<int, int>, double> areas;
    std::vector<double> whole(from.face_names().size(), 0);
    for (int t = 0; t < static_cast<int>(from.triangles().size()); ++t) {
      whole[from.patch(t)] += area_of(from, t);
      // Large triangles of planes are looked at in parts.
      constexpr int n = 4;
      for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
          const double u = (i + 1.0 / 3) / n, v = (j + 1.0 / 3) / n;
          const Vec3 x = from.corner(t, 0) + u * (from.corner(t, 1) - from.corner(t, 0)) +
                         v * (from.corner(t, 2) - from.corner(t, 0));
          const TriangleSurface::Foot foot = to.nearest(x, -1, limit);
          if (foot.triangle < 0 || from.normal(t).dot(to.normal(foot.triangle)) > least_facing) continue;
          areas[{from.patch(t), to.patch(foot.triangle)}] += 2 * area_of(from, t) / (n * (n + 1));
          touching.nearest = std::min(touching.nearest, (x - foot.point).dot(to.normal(foot.triangle)));
        }
    }
    for (const auto& [pair, area] : areas) {
      if (area < least_share * whole[pair.first]) continue;
      (swapped ? touching.second : touching.first).insert(pair.first);
      (swapped ? touching.first : touching.second).insert(pair.second);
    }
  };
  look(of_a, of_b, false);
  look(of_b, of_a, true);
  return touching;
}

std::string vector(const Vec3& v) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v[0], v[1], v[2]); }

std::string face_lines(const Part& part, double scale) {
  std::vector<int> order(part.model->faces().size());
  for (std::size_t f = 0; f < order.size(); ++f) order[f] = static_cast<int>(f);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return part.model->faces()[a].area > part.model->faces()[b].area; });
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), most_lines); ++k) {
    const CadFace& face = part.model->faces()[order[k]];
    text += fmt::format("#   face{:<4} {:8.4g} m^2  {}", order[k] + 1, face.area * scale * scale,
                        face.kind == "other" ? "free-form" : face.kind);
    if (face.kind == "plane")
      text += ", normal " + vector(face.axis.unaryExpr([](double x) { return std::abs(x) < 1e-9 ? 0 : x; }));
    if (face.radius > 0) text += fmt::format(", radius {:.6g} m", face.radius * scale);
    text += ", at " + vector(scale * face.middle);
    if (!face.name.empty()) text += fmt::format(", called \"{}\"", face.name);
    text += "\n";
  }
  if (order.size() > most_lines) text += fmt::format("#   ... and {} smaller ones\n", order.size() - most_lines);
  return text;
}

/// The flat face that looks down most, of the larger ones; -1: none.
int standing_face(const CadModel& model) {
  int best = -1;
  double most = 0;
  for (std::size_t f = 0; f < model.faces().size(); ++f) {
    const CadFace& face = model.faces()[f];
    if (face.kind != "plane" || -face.axis[2] * face.area <= most) continue;
    most = -face.axis[2] * face.area;
    best = static_cast<int>(f);
  }
  return best;
}

std::string list(const std::set<int>& faces) {
  std::string text;
  for (const int f : faces) text += fmt::format("{}\"cad.face{}\"", text.empty() ? "" : ", ", f + 1);
  return text;
}

}  // namespace

std::string scene_of_cad_file(const InitOptions& options, const std::string& file, const std::string& state,
                              std::string& told) {
  const bool without_unit = cad_format(options.cad) == CadFormat::brep;
  const double scale = without_unit ? mesh_units().at(options.unit) : mm;
  const std::vector<CadSolid> solids = read_cad(options.cad, {options.repair});
  std::vector<Part> parts = read_parts(solids, scale, options.cells.value_or(default_cells));
  const std::string source =
      fs::path(options.cad).is_absolute()
          ? options.cad
          : fs::absolute(options.cad).lexically_proximate(fs::absolute(file).parent_path()).string();

  std::string contacts;
  int pairs = 0;
  std::vector<std::string> declared(parts.size());
  for (std::size_t a = 0; a < parts.size(); ++a)
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      const Touching touching = find_touching(parts[a], parts[b]);
      if (touching.first.empty() || touching.second.empty()) continue;
      ++pairs;
      const auto declare = [&](std::size_t own, std::size_t other, const std::set<int>& faces) {
        declared[own] += fmt::format("  {{name = \"to_{}\", surfaces = [{}]}},\n", parts[other].name, list(faces));
      };
      declare(a, b, touching.first);
      declare(b, a, touching.second);
      const double gap = std::abs(touching.nearest) < 1e-9 ? 0 : touching.nearest;
      contacts += fmt::format(
          "\n[[contact]]                        # TODO may they touch? {} {:.3g} m\n"
          "faces = [\"{}.to_{}\", \"{}.to_{}\"]\n",
          gap < 0 ? "They overlap by at least" : "The gap is about", std::abs(gap), parts[a].name, parts[b].name,
          parts[b].name, parts[a].name);
    }

  std::size_t largest = 0;
  for (std::size_t p = 1; p < parts.size(); ++p)
    if (parts[p].model->volume() > parts[largest].model->volume()) largest = p;
  const int standing = standing_face(*parts[largest].model);

  std::string text = fmt::format(
      "# The {} of {}. {}\n#\n"
      "#   cgcontact check {}       what the scene contains\n"
      "#   cgcontact check {} --out pictures      the same with a picture of the faces\n#\n"
      "# It knows nothing of your problem: go through the lines marked TODO. Lengths in m, pressures in Pa. Every key "
      "is in\n"
      "# docs/scene.md of cgcontact.\n\n"
      "title = {}\n",
      parts.size() == 1 ? "solid" : fmt::format("{} solids", parts.size()),
      comment_word(fs::path(options.cad).filename().string()), state, comment_word(file), comment_word(file),
      toml_string(fs::path(options.cad).stem().string()));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = parts[p];
    text += fmt::format(
        "\n[[body]]\nname = \"{}\"\nmaterial = {{E = 210e9, nu = 0.3}}   # TODO Young's modulus (Pa) and Poisson's "
        "ratio; "
        "this is steel\ncell_size = {:.6g}   # smaller is more accurate and costs more\n"
        "shape = {{cad = {{file = {}, solid = {}{}{}}}}}\n",
        part.name, part.cell_size, toml_string(source), toml_string(part.solid),
        without_unit ? fmt::format(", unit = \"{}\"", options.unit) : "", options.repair ? ", repair = true" : "");
    if (!declared[p].empty()) text += "faces = [\n" + declared[p] + "]\n";
    text += "# Its faces, largest first; they are \"" + part.name + ".face1\" and so on:\n" + face_lines(part, scale);
  }
  text += "\n[[support]]                        # TODO what holds the bodies\n";
  if (standing >= 0)
    text += fmt::format("face = \"{}.face{}\"\n", parts[largest].name, standing + 1);
  else
    text += fmt::format("face = \"{}.cad\"\n", parts[largest].name);
  text +=
      "displacement = {x = 0, y = 0, z = 0}   # components that are not given are free; or: symmetry = true\n\n"
      "# TODO what loads them, N/m^2 against the normal; or a support with a displacement that is not zero\n"
      "# [[load]]\n";
  text += fmt::format("# face = \"{}.face1\"\n# pressure = 1e6\n", parts.back().name);
  text += contacts;

  told += fmt::format("{}: {} solid{}, {} pair{} of them that touch or nearly touch\n", options.cad, parts.size(),
                      parts.size() == 1 ? "" : "s", pairs, pairs == 1 ? "" : "s");
  for (const Part& part : parts) {
    const Vec3 extent = part.max - part.min;
    told += fmt::format("  {}: {:.4g} x {:.4g} x {:.4g} m, {} faces, cells of {:.3g} m\n", part.name, extent[0],
                        extent[1], extent[2], part.model->faces().size(), part.cell_size);
    const std::string doubt = doubtful_unit(extent);
    if (!doubt.empty()) told += fmt::format("warning: {}: {}\n", part.name, doubt);
  }
  for (const CadSolid& solid : solids)
    if (!solid.repair.empty()) told += fmt::format("repaired on request: \"{}\": {}\n", solid.name, solid.repair);
  return text;
}

}  // namespace cgcontact
