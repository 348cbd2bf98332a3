#include "core/scene_file/sections/scene_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "core/base/errors/suggest.hpp"
#include "core/triangles/triangle_faces.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "core/triangles/triangle_repair.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t max_patches = 20000;

/// m; a surface outside of this range was probably read in a wrong unit.
constexpr double max_usual = 100, min_usual = 1e-5;

Range angle_range() {
  Range angle = Range::positive("degrees");
  angle.max = 180;
  angle.text = "0 < angle <= 180 degrees";
  return angle;
}

/// Metres per unit of the file.
double read_scale(const TomlCursor& node) {
  const auto unit = node.find("unit"), scale = node.find("scale");
  if (unit && scale) node.fail("has both unit and scale", "unit = \"mm\" or scale = 1e-3");
  Range per_unit = Range::positive("m");
  per_unit.text = "> 0 m per unit of the file";
  if (scale) return scale->number(per_unit);
  std::vector<std::string> names;
  for (const auto& entry : mesh_units()) names.push_back(entry.first);
  return mesh_units().at(
      names[node.at("unit", join(names) + ", or scale = metres per unit of the file").one_of(names)]);
}

TriangleSelector::Growth read_growth(const TomlCursor& node, const TriangleSoup& soup) {
  node.expect_keys({"seed", "triangle", "angle"});
  TriangleSelector::Growth growth;
  const auto seed = node.find("seed"), triangle = node.find("triangle");
  if (seed.has_value() == triangle.has_value())
    node.fail("needs one of seed and triangle", "seed = [x, y, z] (m), or triangle = its number in the file, from 1");
  if (seed) {
    growth.seed = seed->vector("m");
  } else {
    const int wanted = triangle->integer(1, 2000000000);
    const auto found =
        soup.number.empty() ? soup.number.end() : std::find(soup.number.begin(), soup.number.end(), wanted);
    const std::size_t index = soup.number.empty() ? static_cast<std::size_t>(wanted) - 1
                                                  : static_cast<std::size_t>(found - soup.number.begin());
    if (index >= soup.triangles.size())
      triangle->fail("there is no such triangle on the surface", fmt::format("1 to {}", soup.triangles.size()));
    const Triangle& t = soup.triangles[index];
    growth.seed = (soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3;
  }
  const auto angle = node.find("angle");
  growth.angle = angle ? angle->number(angle_range()) * radians_per_degree : default_crease_angle;
  return growth;
}

/// The name of one of the groups that the file has.
std::string read_group(const TomlCursor& node, const TriangleSoup& soup) {
  std::vector<std::string> names;
  for (const FacetGroup& group : soup.groups)
    if (std::find(names.begin(), names.end(), group.name) == names.end()) names.push_back(group.name);
  const std::string name = node.string("the name of a group of the file");
  if (std::find(names.begin(), names.end(), name) == names.end())
    node.fail(
        "the file has no such group" + did_you_mean(name, names),
        names.empty() ? "groups are the lines \"g NAME\" of an OBJ file and the solids of an STL text" : join(names));
  return name;
}

TriangleSelector read_selector(const TomlCursor& node, const TriangleSoup& soup) {
  node.expect_keys({"name", "group", "normal", "box", "plane", "smooth"});
  TriangleSelector selector;
  selector.location = node.location();
  selector.name = read_name(node.at("name", "a name"));
  if (const auto normal = node.find("normal")) {
    normal->expect_keys({"axis", "angle"});
    selector.normal_cone =
        std::make_pair(normal->at("axis", "[x, y, z]").direction(),
                       std::cos(normal->at("angle", "degrees").number(angle_range()) * radians_per_degree));
  }
  if (const auto box = node.find("box")) {
    box->expect_keys({"min", "max"});
    selector.box =
        std::make_pair(box->at("min", "[x, y, z], m").vector("m"), box->at("max", "[x, y, z], m").vector("m"));
    if (!(selector.box->first.array() <= selector.box->second.array()).all())
      box->fail("is empty", "min <= max in x, y and z");
  }
  if (const auto plane = node.find("plane")) {
    plane->expect_keys({"point", "normal", "distance"});
    selector.plane = {plane->at("point", "[x, y, z], m").vector("m"), plane->at("normal", "[x, y, z]").direction(),
                      plane->at("distance", ">= 0 m").number(Range::not_negative("m"))};
  }
  if (const auto smooth = node.find("smooth")) selector.smooth = read_growth(*smooth, soup);
  if (const auto group = node.find("group")) selector.group = read_group(*group, soup);
  if (!selector.normal_cone && !selector.box && !selector.plane && !selector.smooth && !selector.group)
    node.fail("selects nothing", "at least one of group, normal, box, plane, smooth");
  return selector;
}

std::vector<TriangleSelector> read_selectors(const TomlCursor& node, const TriangleSoup& soup) {
  std::vector<TriangleSelector> selectors;
  std::set<std::string> seen{"rest"};
  if (const auto faces = node.find("faces"))
    for (const TomlCursor& entry : faces->elements("[{name, group, normal, box, plane, smooth}, ...]")) {
      selectors.push_back(read_selector(entry, soup));
      if (!seen.insert(selectors.back().name).second)
        entry.at("name").fail("is the name of another face of this mesh", "unique names other than \"rest\"");
    }
  return selectors;
}

/// Reads a surface; its errors name the key that holds the file's name.
BodySurface read_surface(const TomlCursor& node, const std::string& file, double scale, bool repair) {
  try {
    return read_body_surface(file, scale, repair);
  } catch (const InputError& error) {
    node.fail(error.what());
  }
}

}  // namespace

const std::map<std::string, double>& mesh_units() {
  static const std::map<std::string, double> units = {{"um", 1e-6}, {"mm", 1e-3},   {"cm", 1e-2},
                                                      {"m", 1},     {"in", 0.0254}, {"ft", 0.3048}};
  return units;
}

BodySurface read_body_surface(const std::string& file, double scale, bool repair) {
  BodySurface surface;
  surface.soup = read_triangles(file);
  for (Vec3& x : surface.soup.points) x *= scale;
  const TriangleSoup as_read = repair ? surface.soup : TriangleSoup();
  try {
    surface.repairs = repair_and_check(surface.soup, file);
    return surface;
  } catch (const InputError& error) {
    if (!repair)
      throw InputError(std::string(error.what()) +
                       "; with repair = true in the mesh it is repaired as far as that goes (docs/scene.md)");
  }
  surface.soup = as_read;
  const SurfaceRepair done = repair_surface(surface.soup, file);
  surface.repair =
      std::make_shared<const RepairedSurface>(RepairedSurface{file, done.text(), surface.soup, done.is_new});
  try {
    surface.repairs = check_separated(surface.soup, file);
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + "; that is what repair = true has left (" + done.text() + ")");
  }
  return surface;
}

std::string describe_surface(const std::string& file, const BodySurface& surface, const Vec3& extent) {
  const SurfaceRepairs& repairs = surface.repairs;
  std::string text =
      fmt::format("{}: {} triangles in {} shell{}, {:.4g} x {:.4g} x {:.4g} m", file, repairs.num_triangles,
                  repairs.shells, repairs.shells > 1 ? "s" : "", extent[0], extent[1], extent[2]);
  if (repairs.any()) text += "; repaired: " + repairs.text();
  if (surface.repair) text += "; repaired on request: " + surface.repair->text;
  return text;
}

std::string doubtful_unit(const Vec3& extent) {
  const double longest = extent.maxCoeff();
  if (longest <= max_usual && longest >= min_usual) return "";
  return fmt::format("the surface is {:.3g} m long: is its unit right?", longest);
}

MeshShape read_mesh(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"file", "unit", "scale", "crease", "repair", "faces"});
  const TomlCursor file_node = node.at("file", "an .stl, .obj, .ply or .off file");
  const std::string given = file_node.string("a file name");
  const std::string file = (std::filesystem::path(node.text().file).parent_path() / given).string();
  const double scale = read_scale(node);
  const auto crease = node.find("crease");
  const double crease_angle = crease ? crease->number(angle_range()) * radians_per_degree : default_crease_angle;

  const auto repair = node.find("repair");
  const BodySurface read = read_surface(file_node, file, scale, repair && repair->boolean());
  const TriangleSoup& soup = read.soup;
  const NamedTriangles faces = name_faces(soup, name, read_selectors(node, soup));
  TriangleSurface surface = make_surface(soup, faces, crease_angle);
  if (surface.face_names().size() > max_patches)
    file_node.fail(
        fmt::format("creases divide the surface into {} patches: is it a rough scan?", surface.face_names().size()),
        fmt::format("{} patches; a larger angle for the key crease makes fewer", max_patches));
  MeshShape shape;
  shape.solid = Solid::bounded_by(std::move(surface));
  for (const std::string& face : faces.names) shape.faces.push_back(face.substr(name.size() + 1));
  Vec3 min, max;
  shape.solid.bounding_box(min, max);
  shape.extent = max - min;
  shape.repaired = read.repairs.any() || read.repair;
  shape.repair = read.repair;
  shape.note = describe_surface(given, read, shape.extent);
  return shape;
}

}  // namespace cgcontact
