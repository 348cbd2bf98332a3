#include "core/scene_file/sections/scene_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>

#include "core/base/errors/suggest.hpp"
#include "core/bodies/booleans.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/bodies/csg_body.hpp"
#include "core/scene_file/sections/scene_cad.hpp"
#include "core/scene_file/sections/scene_mesh.hpp"
#include "core/scene_file/sections/scene_profiles.hpp"

namespace cgcontact {

namespace {

const std::vector<std::string> box_faces = {"x-", "x+", "y-", "y+", "z-", "z+"};
const std::vector<std::string> sphere_faces = {"surface"};
const std::vector<std::string> cylinder_faces = {"side", "bottom", "top"};
const std::vector<std::string> half_space_faces = {"plane"};
const std::vector<std::string> kinds = {"box",     "sphere",       "cylinder",   "cone", "torus",
                                        "extrude", "revolve",      "half_space", "mesh", "cad",
                                        "union",   "intersection", "difference"};
const std::vector<std::string> placement_keys = {"name", "translate", "rotate"};

std::string corner_text(const Vec3& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); }

Solid read_box(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"min", "max", "center", "size"});
  const bool by_corners = node.find("min") || node.find("max");
  if (by_corners && (node.find("center") || node.find("size")))
    node.fail("mixes corners (min, max) with center and size", "{min, max} or {center, size}");
  if (by_corners) {
    const Vec3 min = node.at("min", "[x, y, z], m").vector("m"), max = node.at("max", "[x, y, z], m").vector("m");
    if (!(min.array() < max.array()).all())
      node.fail("is empty: min must be less than max, here they are " + corner_text(min) + " and " + corner_text(max),
                "min < max in x, y and z");
    return Solid::box(min, max, name);
  }
  const Vec3 center = node.at("center", "[x, y, z], m, or give min and max").vector("m");
  const TomlCursor size_node = node.at("size", "[x, y, z] > 0 m");
  const Vec3 size = size_node.vector("m");
  if (!(size.array() > 0).all()) size_node.fail("is empty", "three lengths > 0 m");
  return Solid::box(center - size / 2, center + size / 2, name);
}

Solid read_sphere(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"center", "radius"});
  return Solid::sphere(node.at("center", "[x, y, z], m").vector("m"),
                       node.at("radius", "> 0 m").number(Range::positive("m")), name);
}

Solid read_cylinder(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"base", "top", "radius"});
  const Vec3 base = node.at("base", "[x, y, z], m").vector("m"), top = node.at("top", "[x, y, z], m").vector("m");
  const double radius = node.at("radius", "> 0 m").number(Range::positive("m"));
  if (!((top - base).norm() > 0)) node.fail("has no length: base and top are equal", "base different from top");
  return Solid::cylinder(base, top, radius, name);
}

Solid read_half_space(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"point", "normal"});
  return Solid::half_space(node.at("point", "[x, y, z], m").vector("m"),
                           node.at("normal", "[x, y, z], outward").direction(), name);
}

/// Infinite for what is not bounded.
double longest(const Solid& solid) {
  Vec3 min, max;
  if (!solid.bounding_box(min, max)) return std::numeric_limits<double>::infinity();
  return (max - min).maxCoeff();
}

class ShapeReader {
 public:
  explicit ShapeReader(const TomlCursor& body) : body_(body) {}
  Solid read(const TomlCursor& node);

  std::vector<PrimitiveFaces> primitives;
  std::vector<std::string> notes, warnings;
  bool has_mesh = false;
  std::vector<std::shared_ptr<const RepairedSurface>> repairs;

 private:
  std::string kind_of(const TomlCursor& node) const;
  std::string name_of(const TomlCursor& node, const std::string& kind);
  Solid read_primitive(const TomlCursor& node, const std::string& kind);
  Solid read_mesh_shape(const TomlCursor& node, const std::string& name);
  Solid read_cad_shape(const TomlCursor& node, const std::string& name);
  Solid read_operation(const TomlCursor& node, const std::string& kind);
  Solid combine(const TomlCursor& list, const std::string& kind, const Solid& a, const Solid& b);
  Solid add(PrimitiveFaces primitive);
  Solid placed(const TomlCursor& node, const Solid& solid, std::size_t first_primitive);

  const TomlCursor& body_;
  std::set<std::string> names_;
};

std::string ShapeReader::kind_of(const TomlCursor& node) const {
  std::vector<std::string> keys = kinds;
  keys.insert(keys.end(), placement_keys.begin(), placement_keys.end());
  node.expect_keys(keys);
  std::string kind;
  for (const std::string& candidate : kinds) {
    if (!node.find(candidate)) continue;
    if (!kind.empty()) node.fail("has both \"" + kind + "\" and \"" + candidate + "\"", "one of " + join(kinds));
    kind = candidate;
  }
  if (kind.empty()) node.fail("says no shape", "one of " + join(kinds));
  return kind;
}

/// The given name, or that of the kind of shape with a number from the second one on (box, box2, box3, ...).
std::string ShapeReader::name_of(const TomlCursor& node, const std::string& kind) {
  if (const auto given = node.find("name")) {
    const std::string name = read_name(*given);
    if (!names_.insert(name).second) given->fail("is the name of another shape of this body", "unique names");
    return name;
  }
  std::string name = kind;
  for (int k = 2; !names_.insert(name).second; ++k) name = kind + std::to_string(k);
  return name;
}

Solid ShapeReader::read_primitive(const TomlCursor& node, const std::string& kind) {
  const std::string name = name_of(node, kind);
  const TomlCursor data = node.at(kind);
  if (kind == "box") {
    return add({name, box_faces, read_box(data, name)});
  }
  if (kind == "sphere") {
    return add({name, sphere_faces, read_sphere(data, name)});
  }
  if (kind == "cylinder") {
    return add({name, cylinder_faces, read_cylinder(data, name)});
  }
  if (kind == "cone" || kind == "torus" || kind == "extrude" || kind == "revolve") {
    const ProfileShape shape = kind == "cone"      ? read_cone(data, name)
                               : kind == "torus"   ? read_torus(data, name, body_)
                               : kind == "extrude" ? read_extrude(data, name)
                                                   : read_revolve(data, name, body_);
    return add({name, shape.faces, shape.solid});
  }
  if (kind == "mesh") return read_mesh_shape(data, name);
  if (kind == "cad") return read_cad_shape(data, name);
  return add({name, half_space_faces, read_half_space(data, name)});
}

Solid ShapeReader::add(PrimitiveFaces primitive) {
  primitives.push_back(std::move(primitive));
  return primitives.back().solid;
}

Solid ShapeReader::read_mesh_shape(const TomlCursor& node, const std::string& name) {
  const MeshShape mesh = read_mesh(node, name);
  primitives.push_back({name, mesh.faces, mesh.solid});
  notes.push_back(mesh.note);
  has_mesh = true;
  if (mesh.repaired) warnings.push_back(mesh.note);
  if (mesh.repair) repairs.push_back(mesh.repair);
  const std::string doubt = doubtful_unit(mesh.extent);
  if (!doubt.empty()) warnings.push_back(node.at("file").string("a file name") + ": " + doubt);
  return mesh.solid;
}

Solid ShapeReader::read_cad_shape(const TomlCursor& node, const std::string& name) {
  CadShape cad = read_cad_solid(node, name, body_);
  primitives.push_back({name, cad.faces, cad.solid});
  notes.push_back(cad.note);
  warnings.insert(warnings.end(), cad.warnings.begin(), cad.warnings.end());
  return cad.solid;
}

Solid ShapeReader::read_operation(const TomlCursor& node, const std::string& kind) {
  if (const auto given = node.find("name"); given && !names_.insert(read_name(*given)).second)
    given->fail("is the name of another shape of this body", "unique names");
  const TomlCursor list = node.at(kind);
  const std::vector<TomlCursor> operands = list.elements("[shape, shape, ...]");
  if (operands.empty()) list.fail("has no shapes", "[shape, shape, ...]");
  Solid solid = read(operands[0]);
  for (std::size_t k = 1; k < operands.size(); ++k) {
    const Solid next = read(operands[k]);
    solid = combine(list, kind, solid, next);
  }
  return solid;
}

Solid ShapeReader::combine(const TomlCursor& list, const std::string& kind, const Solid& a, const Solid& b) {
  const BooleanOp::Kind op = kind == "union"          ? BooleanOp::Kind::unite
                             : kind == "intersection" ? BooleanOp::Kind::intersect
                                                      : BooleanOp::Kind::subtract;
  if (const auto exact = combine_expressions(op, a, b)) return *exact;
  try {
    if (as_cad(a) || as_cad(b)) {
      if (const auto exact = combine_cad(op, a, b, cell_size_for_cad(body_, std::min(longest(a), longest(b)))))
        return *exact;
      throw InputError(
          std::string("a CAD solid and a mesh cannot be combined (allowed: CAD solids with each other and with shapes "
                      "of no file)"));
    }
    const TriangleBoolean result = combine_triangles(op, a, b, read_cell_size(body_));
    std::string note = fmt::format("{} with a mesh: {} triangles", kind, result.solid.geometry().num_facets());
    if (result.facet_error > 0)
      note += fmt::format("; curved faces in facets, at most {:.2g} m inside them", result.facet_error);
    notes.push_back(note);
    return result.solid;
  } catch (const InputError& error) {
    list.fail(error.what());
  }
}

/// Turns the solid and its primitives about `rotate.center`, then moves them by `translate`.
Solid ShapeReader::placed(const TomlCursor& node, const Solid& solid, std::size_t first_primitive) {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  const auto rotate = node.find("rotate");
  const auto translate = node.find("translate");
  if (!rotate && !translate) return solid;
  if (rotate) {
    rotate->expect_keys({"axis", "angle", "center"});
    rotation = rotate->rotation();
    const auto center = rotate->find("center");
    const Vec3 fixed = center ? center->vector("m") : Vec3(0, 0, 0);
    translation = fixed - rotation * fixed;
  }
  if (translate) translation += translate->vector("m");
  if (as_csg(solid))
    for (std::size_t p = first_primitive; p < primitives.size(); ++p)
      primitives[p].solid = primitives[p].solid.transformed(rotation, translation);
  return solid.transformed(rotation, translation);
}

Solid ShapeReader::read(const TomlCursor& node) {
  const std::string kind = kind_of(node);
  const bool is_operation = kind == "union" || kind == "intersection" || kind == "difference";
  const std::size_t first_primitive = primitives.size();
  return placed(node, is_operation ? read_operation(node, kind) : read_primitive(node, kind), first_primitive);
}

/// Largest radius in sizes of the body. Points are on a surface to 1e-9 of the size; one of a larger radius deviates
/// from its tangent plane by less than a hundred times that, and planes beside it take its points.
constexpr double max_radius = 1e6;

/// Fails where a sphere or cylinder of a solid with endless surfaces is as good as plane across the solid.
void check_radii(const TomlCursor& node, const Solid& solid, double size) {
  if (!solid.geometry().has_endless_surfaces()) return;
  for (const Surface& surface : solid.surfaces()) {
    const bool round = surface.kind == Surface::Kind::sphere || surface.kind == Surface::Kind::cylinder;
    if (!round || surface.radius <= max_radius * size) continue;
    const std::string name = surface.names.empty() ? "a surface" : surface.names.front();
    node.fail(fmt::format("{} has a radius of {:.4g} m, beside which a body of {:.4g} m sees a plane", name,
                          surface.radius, size),
              fmt::format("at most {:.4g} m here, or a half_space", max_radius * size));
  }
}

}  // namespace

std::vector<std::string> Shape::face_names() const {
  std::vector<std::string> names;
  for (const PrimitiveFaces& primitive : primitives)
    for (const std::string& face : primitive.faces) names.push_back(primitive.name + "." + face);
  return names;
}

std::vector<std::string> Shape::resolve(const std::string& reference) const {
  std::vector<std::string> whole, by_face;
  for (const PrimitiveFaces& primitive : primitives) {
    for (const std::string& face : primitive.faces) {
      const std::string name = primitive.name + "." + face;
      if (reference == name) return {name};
      if (reference == primitive.name) whole.push_back(name);
      if (reference == face) by_face.push_back(name);
    }
  }
  if (!whole.empty()) return whole;
  return by_face.size() == 1 ? by_face : std::vector<std::string>{};
}

std::string Shape::one_with(const std::vector<std::string>& faces) const {
  if (!as_csg(solid)) return "";
  const auto primitive_of = [](const std::string& name) { return name.substr(0, name.find('.')); };
  const auto is_listed = [&](const std::string& name) {
    return std::find(faces.begin(), faces.end(), name) != faces.end();
  };
  for (const Surface& surface : solid.surfaces())
    for (const std::string& listed : surface.names)
      for (const std::string& other : surface.names)
        if (is_listed(listed) && !is_listed(other) && primitive_of(listed) == primitive_of(other)) return other;
  return "";
}

std::vector<Solid> Shape::owners_of_shared(const std::vector<std::string>& faces) const {
  if (!as_csg(solid)) return {};
  const auto is_listed = [&](const std::string& name) {
    return std::find(faces.begin(), faces.end(), name) != faces.end();
  };
  const auto is_shared = [&](const Surface& surface) {
    return std::any_of(surface.names.begin(), surface.names.end(), is_listed) &&
           !std::all_of(surface.names.begin(), surface.names.end(), is_listed);
  };
  if (std::none_of(solid.surfaces().begin(), solid.surfaces().end(), is_shared)) return {};
  std::vector<Solid> owners;
  for (const PrimitiveFaces& primitive : primitives)
    if (std::any_of(primitive.faces.begin(), primitive.faces.end(),
                    [&](const std::string& face) { return is_listed(primitive.name + "." + face); }))
      owners.push_back(primitive.solid);
  return owners;
}

double read_cell_size(const TomlCursor& body) { return body.at("cell_size", "> 0 m").number(Range::positive("m")); }

Shape read_shape(const TomlCursor& body) {
  const TomlCursor node = body.at("shape", "{box = {...}} or another shape");
  ShapeReader reader(body);
  Shape shape;
  shape.solid = reader.read(node);
  shape.primitives = std::move(reader.primitives);
  shape.notes = std::move(reader.notes);
  shape.repairs = std::move(reader.repairs);
  shape.warnings = std::move(reader.warnings);
  shape.has_mesh = reader.has_mesh;
  Vec3 min, max;
  if (!shape.solid.bounding_box(min, max))
    node.fail("is unbounded or empty", "a bounded solid: intersect half-spaces with a box");
  if (!(min.array() < max.array()).all()) node.fail("is empty: its parts do not overlap", "a solid with a volume");
  check_radii(node, shape.solid, (max - min).norm());
  return shape;
}

}  // namespace cgcontact
