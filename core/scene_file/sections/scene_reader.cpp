#include "core/scene_file/sections/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "core/base/errors/suggest.hpp"
#include "core/bodies/meridian.hpp"
#include "core/geometry/solid_middle.hpp"
#include "core/scene/displacement_field.hpp"
#include "core/scene/scene_probe.hpp"

namespace cgcontact {

namespace {

constexpr double max_cells_of_box = 2e9;  // of the box around a body: beyond, the unit is wrong
constexpr double farthest_cells = 1e8;    // a body from the origin: rounding is then 1e-8 of a cell
constexpr std::size_t max_parameters = 1000;
constexpr double axis_rounding = 1e-12;  // rounding of a rotation
constexpr double end_cone = 45;  // degrees; the normals of a body in plane strain lie along the axis or across it

/// The number in the SI unit of the value that it replaces. An angle stays a number, which keys take in degrees.
Quantity with_unit_of(const Constants& in_file, const std::string& name, const Quantity& number) {
  const auto old = in_file.find(name);
  if (old == in_file.end() || !old->second.has_units || !old->second.dimension) return number;
  const Dimension& dimension = *old->second.dimension;
  return dimension.is_angle() ? number : Quantity(number.value, dimension, true);
}

/// One parameter after those that its expression uses; `in_progress` detects circles.
Quantity read_parameter(const TomlCursor& table, const std::string& name, const Constants& in_file, Constants& known,
                        std::set<std::string>& in_progress) {
  const TomlCursor entry = table.at(name);
  if (!is_free_name(name))
    entry.fail("\"" + name + "\" cannot be the name of a parameter",
               "letters, digits and _, but not x, y, z, pi, _pi, _e, contact_force or a function's name");
  if (const auto found = known.find(name); found != known.end()) return found->second;
  if (!in_progress.insert(name).second)
    entry.fail("is defined by itself", "parameters that do not refer to each other");
  if (entry.is_string()) {
    for (const std::string& used : identifiers(entry.string()))
      if (table.find(used)) read_parameter(table, used, in_file, known, in_progress);
    const SceneText text{entry.text().file, known};
    known[name] = TomlCursor(entry.node(), entry.key(), text).quantity();
  } else {
    known[name] = with_unit_of(in_file, name, entry.quantity());
  }
  in_progress.erase(name);
  return known[name];
}

/// Cell size, checked against the number of cells that it makes.
double read_cell_size(const TomlCursor& body, const Shape& shape) {
  const double size = read_cell_size(body);
  const TomlCursor node = body.at("cell_size");
  Vec3 min, max;
  shape.solid.bounding_box(min, max);
  const Vec3 extent = max - min;
  if (shape.has_mesh && size > extent.maxCoeff())
    node.fail(fmt::format("is more than the whole body, which is {:.3g} m long: is the unit of the mesh right?",
                          extent.maxCoeff()));
  const std::string lengths = fmt::format("{:.3g} x {:.3g} x {:.3g} m", extent[0], extent[1], extent[2]);
  if ((extent / size + Vec3::Ones()).prod() > max_cells_of_box) {
    const double least =
        std::cbrt(extent[0]) * std::cbrt(extent[1]) * std::cbrt(extent[2]) / std::cbrt(max_cells_of_box);
    node.fail("makes more than 2e9 cells of a body of " + lengths, fmt::format("about {:.2g} m or more", least));
  }
  if (size > extent.maxCoeff())
    node.fail("is more than the whole body, which is " + lengths, fmt::format("<= {:.3g} m", extent.maxCoeff()));
  const double distance = min.cwiseAbs().cwiseMax(max.cwiseAbs()).maxCoeff();
  if (distance > farthest_cells * size)
    node.fail(
        fmt::format("the body is {:.3g} m from the origin: rounding there is not small against the cells", distance),
        fmt::format(">= {:.2g} m, or a body nearer to the origin", distance / farthest_cells));
  return size;
}

void read_grid(const TomlCursor& node, BodySpec& body) {
  node.expect_keys({"offset", "rotation"});
  if (const auto offset = node.find("offset")) {
    Range fraction;
    fraction.min = 0;
    fraction.max = 1;
    fraction.max_allowed = false;
    fraction.text = "fractions of a cell, 0 <= f < 1";
    body.grid_offset = offset->vector();
    const std::vector<TomlCursor> components = offset->elements("");
    for (const TomlCursor& component : components) component.number(fraction);
  }
  if (const auto rotation = node.find("rotation")) {
    rotation->expect_keys({"axis", "angle"});
    body.grid_rotation = rotation->rotation();
  }
}

/// A change that a material without an expansion would not notice is a mistake.
double read_temperature(const TomlCursor& node, const Material& material) {
  Range range;
  range.unit = "K";
  range.text = "K, the change since the body was free of stress";
  const double temperature = node.number(range);
  if (temperature != 0 && !material.expansion)
    node.fail("the material of the body has no expansion", "material = {.., expansion = 12e-6} in 1/K");
  return temperature;
}

/// A stiffness along the normal, or along x, y, z: Pa/m or N/m.
std::array<double, 4> read_springs(const TomlCursor& node, const std::string& unit) {
  const std::string allowed = "a number along the normal or [x, y, z], " + unit + ", not negative and not all 0";
  std::array<double, 4> springs{0, 0, 0, 0};
  if (node.is_array()) {
    const std::vector<TomlCursor> components = node.elements(allowed);
    if (components.size() != 3) node.fail("has " + std::to_string(components.size()) + " components, not 3", allowed);
    for (std::size_t k = 0; k < 3; ++k) springs[k] = components[k].number(Range::not_negative(unit));
  } else {
    springs[3] = node.number(Range::not_negative(unit));
  }
  if (springs == std::array<double, 4>{0, 0, 0, 0}) node.fail("holds nothing", allowed);
  return springs;
}

/// Displacements of a rigid rotation by a small angle: angle axis x (x - centre).
std::array<std::optional<Expression>, 3> read_rotation(const TomlCursor& node) {
  node.expect_keys({"centre", "axis", "angle"});
  constexpr double largest = 5;  // degrees: the arc misses its tangent by 0.4 % of the way there
  Range range = Range::from_to(-largest, largest, "-5 to 5 degrees: small rotations", "deg");
  const double angle = radians_per_degree * node.at("angle", range.text).number(range);
  const Vec3 axis = node.at("axis", "[x, y, z], the direction of the axis").direction();
  const auto centre = node.find("centre");
  const Vec3 c = centre ? centre->vector("m") : Vec3::Zero(), spin = angle * axis;
  const char* const names = "xyz";
  std::array<std::optional<Expression>, 3> displacement;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    std::string text = "0";
    if (spin[j] != 0) text += fmt::format(" + ({:.17g})*({} - ({:.17g}))", spin[j], names[k], c[k]);
    if (spin[k] != 0) text += fmt::format(" - ({:.17g})*({} - ({:.17g}))", spin[k], names[j], c[j]);
    displacement[i] = text == "0" ? Expression(0.0) : Expression(text, node.location());
  }
  return displacement;
}

/// Components about an axis.
void read_cylindrical(const TomlCursor& node, SupportSpec& support) {
  node.expect_keys({"radial", "tangential", "axial", "point", "axis"});
  for (int k = 0; k < 3; ++k)
    if (const auto component = node.find(name_of(static_cast<Held>(static_cast<int>(Held::radial) + k))))
      support.cylindrical[k] = component->expression("m");
  if (!support.is_cylindrical()) node.fail("prescribes nothing", "at least one of radial, tangential, axial (m)");
  const auto point = node.find("point"), axis = node.find("axis");
  if (point.has_value() != axis.has_value())
    node.fail(point ? "has a point and no axis" : "has an axis and no point",
              "both point = [x, y, z] and axis = [x, y, z], or neither: the axis of the face");
  if (axis) support.axis = Axis{point->vector("m"), axis->direction()};
}

std::array<Expression, 3> read_vector_field(const TomlCursor& node, const std::string& unit) {
  const std::string allowed = "[x, y, z] of numbers or expressions, " + unit;
  const std::vector<TomlCursor> components = node.elements(allowed);
  if (components.size() != 3) node.fail("has " + std::to_string(components.size()) + " components, not 3", allowed);
  return {components[0].expression(unit), components[1].expression(unit), components[2].expression(unit)};
}

}  // namespace

std::vector<TomlCursor> optional_elements(const TomlCursor& root, const std::string& key) {
  const auto list = root.find(key);
  return list ? list->elements("[[" + key + "]] sections") : std::vector<TomlCursor>{};
}

Constants read_parameters(const TomlCursor& table, const Constants& in_file) {
  if (!table.is_table()) table.expect_keys({"name = number"});
  if (table.entries().size() > max_parameters)
    table.fail("has too many parameters", fmt::format("at most {}", max_parameters));
  Constants known = table.text().parameters;
  std::set<std::string> in_progress;
  for (const auto& entry : table.entries()) read_parameter(table, entry.first, in_file, known, in_progress);
  return known;
}

FaceSpec SceneReader::read_face(const TomlCursor& node, const Shape& shape) const {
  node.expect_keys({"name", "surfaces", "box", "normal"});
  FaceSpec face;
  face.location = node.location();
  const TomlCursor name_node = node.at("name", "a name");
  face.name = read_name(name_node);
  if (!shape.resolve(face.name).empty())
    name_node.fail("is already the name of a shape or of its face", "another name");
  if (const auto surfaces = node.find("surfaces")) {
    const std::vector<TomlCursor> names = surfaces->elements("[\"shape.face\", ...]");
    for (const TomlCursor& entry : names) {
      const std::string name = entry.string("\"shape.face\"");
      const std::vector<std::string> resolved = shape.resolve(name);
      if (resolved.empty())
        entry.fail("is no face of this body" + did_you_mean(name, shape.face_names()), join(shape.face_names()));
      face.surfaces.insert(face.surfaces.end(), resolved.begin(), resolved.end());
    }
    if (names.empty()) surfaces->fail("names no face", join(shape.face_names()));
    face.owners = shape.owners_of_shared(face.surfaces);
  }
  if (const auto box = node.find("box")) {
    box->expect_keys({"min", "max"});
    const Vec3 min = box->at("min", "[x, y, z], m").vector("m"), max = box->at("max", "[x, y, z], m").vector("m");
    if (!(min.array() <= max.array()).all()) box->fail("is empty", "min <= max in x, y and z");
    face.box = std::make_pair(min, max);
  }
  if (const auto normal = node.find("normal")) {
    normal->expect_keys({"axis", "angle"});
    Range angle = Range::positive("degrees");
    angle.max = 180;
    angle.text = "0 < angle <= 180 degrees";
    face.normal_cone = std::make_pair(normal->at("axis", "[x, y, z]").direction(),
                                      std::cos(normal->at("angle", angle.text).number(angle) * radians_per_degree));
  }
  if (face.surfaces.empty() && !face.box && !face.normal_cone)
    node.fail("selects nothing", "at least one of surfaces, box, normal");
  return face;
}

namespace {

/// Halvings of the cell size, at most.
constexpr int max_halvings = 20;

void read_refined_box(const TomlCursor& node, RefineSpec& refine) {
  node.expect_keys({"min", "max"});
  refine.kind = RefineSpec::Kind::box;
  refine.min = node.at("min", "[x, y, z], m").vector("m");
  refine.max = node.at("max", "[x, y, z], m").vector("m");
  if (!(refine.min.array() <= refine.max.array()).all()) node.fail("is empty", "min <= max in x, y and z");
}

void read_refined_sphere(const TomlCursor& node, RefineSpec& refine) {
  node.expect_keys({"center", "radius"});
  refine.kind = RefineSpec::Kind::sphere;
  refine.center = node.at("center", "[x, y, z], m").vector("m");
  refine.radius = node.at("radius", ">= 0 m").number(Range::not_negative("m"));
}

void read_refined_ring(const TomlCursor& node, RefineSpec& refine) {
  node.expect_keys({"center", "axis", "radius", "tube_radius"});
  refine.kind = RefineSpec::Kind::ring;
  refine.center = node.at("center", "[x, y, z], m").vector("m");
  if (const auto axis = node.find("axis")) refine.axis = axis->direction();
  refine.radius = node.at("radius", "> 0 m").number(Range::positive("m"));
  if (const auto tube = node.find("tube_radius")) refine.tube_radius = tube->number(Range::not_negative("m"));
}

FaceSpec face_of_body(const TomlCursor& node, const BodySpec& body, const Shape& shape) {
  const std::string name = node.string("a face of this body");
  std::vector<std::string> known;
  for (const FaceSpec& declared : body.faces) {
    if (declared.name == name) return declared;
    known.push_back(declared.name);
  }
  FaceSpec face;
  face.name = name;
  face.location = node.location();
  face.surfaces = shape.resolve(name);
  face.owners = shape.owners_of_shared(face.surfaces);
  for (const std::string& own : shape.face_names()) known.push_back(own);
  if (face.surfaces.empty()) node.fail("is no face of this body" + did_you_mean(name, known), join(known));
  return face;
}

/// Tells whether a length of a shape is a number without a unit; directions, angles and texts that are no numbers are
/// none. Files have units of their own.
bool has_plain_length(const TomlCursor& node) {
  if (node.is_table()) {
    for (const auto& [key, child] : node.entries()) {
      const bool no_length = key == "mesh" || key == "cad" || key == "axis" || key == "angle" || key == "normal";
      if (!no_length && has_plain_length(child)) return true;
    }
    return false;
  }
  if (node.is_array()) {
    const std::vector<TomlCursor> elements = node.elements("");
    return std::any_of(elements.begin(), elements.end(), has_plain_length);
  }
  try {
    const Quantity quantity = node.quantity();
    return !quantity.has_units && quantity.value != 0;
  } catch (const InputError&) {  // a name
    return false;
  }
}

}  // namespace

RefineSpec SceneReader::read_refine(const TomlCursor& node, const BodySpec& body, const Shape& shape) const {
  node.expect_keys({"box", "sphere", "ring", "face", "size", "distance", "grading"});
  RefineSpec refine;
  refine.location = node.location();
  const auto box = node.find("box"), sphere = node.find("sphere"), ring = node.find("ring"), face = node.find("face");
  if (int(box.has_value()) + int(sphere.has_value()) + int(ring.has_value()) + int(face.has_value()) != 1)
    node.fail("says no place, or more than one", "one of box, sphere, ring, face");
  if (box) read_refined_box(*box, refine);
  if (sphere) read_refined_sphere(*sphere, refine);
  if (ring) read_refined_ring(*ring, refine);
  if (face) {
    refine.kind = RefineSpec::Kind::face;
    refine.face = face_of_body(*face, body, shape);
  }
  const TomlCursor size = node.at("size", "> 0 m");
  refine.size = size.number(Range::positive("m"));
  if (body.cell_size == 0) node.fail("stands without cell_size", "cell_size, the size of the largest cells, beside it");
  if (refine.size < std::ldexp(body.cell_size, -max_halvings))
    size.fail(fmt::format("is less than cell_size halved {} times", max_halvings),
              fmt::format(">= {:.3g} m", std::ldexp(body.cell_size, -max_halvings)));
  if (const auto distance = node.find("distance")) refine.distance = distance->number(Range::not_negative("m"));
  if (const auto grading = node.find("grading")) {
    refine.grading = grading->number(Range::from_to(0.05, 1, "0.05 to 1"));
  }
  return refine;
}

void SceneReader::read_faces_of_body(const TomlCursor& node, BodySpec& body, const Shape& shape) {
  std::set<std::string> seen;
  for (const TomlCursor& entry : node.elements("[{name, surfaces, box, normal}, ...]"))
    unread_.back().faces |= !mistakes_.attempt([&] {
      body.faces.push_back(read_face(entry, shape));
      check_unique(entry.at("name"), body.faces.back().name, seen, "face of this body");
    });
}

/// Adds a body and its shape, what of them can be read. Among keys that are not known may be one that seems to be
/// missing.
void SceneReader::read_body(const TomlCursor& node, const std::optional<SceneMaterials>& materials, bool known_keys) {
  Shape& shape = shapes_.back();
  BodySpec& body = scene_.bodies.back();
  body.location = node.location();
  const auto is_there = [&](const char* key) { return known_keys || node.find(key); };
  unread_.back().shape = !is_there("shape") || !mistakes_.attempt([&] { shape = read_shape(node); });
  body.solid = shape.solid;
  body.notes = shape.notes;
  body.warnings = shape.warnings;
  body.repairs = shape.repairs;
  if (const auto node_of_shape = node.find("shape")) body.plain_lengths = has_plain_length(*node_of_shape);
  const bool has_material = is_there("material") && mistakes_.attempt([&] {
    const auto rigid = node.find("rigid"), material = node.find("material");
    if (!materials) throw FollowingMistake();
    body.material = rigid && rigid->boolean()
                        ? materials->read_rigid(material)
                        : materials->read(node.at("material", "\"steel\" or another name, or {E = .., nu = ..}"));
  });
  // Without it the first grid of a run to an accuracy comes from the shape, that of a rigid body from its partners.
  const bool wants_size = known_keys && has_material && !(scene_.accuracy.any() || body.rigid());
  bool has_size = true;
  if (node.find("cell_size") || wants_size)
    has_size = mistakes_.attempt(
        [&] { body.cell_size = unread_.back().shape ? read_cell_size(node) : read_cell_size(node, shape); });
  if (const auto grid = node.find("grid")) mistakes_.attempt([&] { read_grid(*grid, body); });
  if (const auto force = node.find("body_force"))
    mistakes_.attempt([&] { body.body_force = read_vector_field(*force, "N/m^3"); });
  if (const auto temperature = node.find("temperature"); temperature && has_material)
    mistakes_.attempt([&] {
      if (body.rigid())
        temperature->fail("a rigid body does not expand", "without temperature, or without rigid = true");
      body.temperature = read_temperature(*temperature, body.material);
    });
  const auto faces = node.find("faces"), refine = node.find("refine");
  unread_.back().faces |= unread_.back().shape;
  if (faces && !unread_.back().shape)
    unread_.back().faces |= !mistakes_.attempt([&] { read_faces_of_body(*faces, body, shape); });
  if (refine && has_size && !unread_.back().faces)
    mistakes_.attempt([&] {
      for (const TomlCursor& entry : refine->elements("[{sphere, size}, ...]"))
        mistakes_.attempt([&] { body.refine.push_back(read_refine(entry, body, shape)); });
    });
}

namespace {

void set_plane_strain(const TomlCursor& node, BodySpec& body) {
  const int axis = node.one_of(coordinate_names());
  body.plane_strain = static_cast<Coordinate>(axis);
  body.plane_strain_location = node.location();
  const std::string& name = coordinate_names()[axis];
  if (const Vec3 e = Vec3::Unit(axis); (body.grid_rotation * e - e).norm() > axis_rounding)
    node.fail(fmt::format("the grid of body \"{}\" is turned about another axis than {}", body.name, name),
              fmt::format("grid.rotation about {} only", name));
}

}  // namespace

/// That of the scene for bodies without one of their own; one axis for all.
void SceneReader::read_plane_strain(const TomlCursor& root) {
  const std::vector<TomlCursor> nodes = root.at("body").elements("[[body]] sections");
  const auto of_scene = root.find("plane_strain");
  std::optional<Coordinate> first;
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    const auto own = nodes[b].find("plane_strain");
    if (!own && !of_scene) continue;
    BodySpec& body = scene_.bodies[b];
    set_plane_strain(own ? *own : *of_scene, body);
    if (!first) first = body.plane_strain;
    if (body.plane_strain != first)
      own->fail("is another axis than that of an earlier body", '"' + name_of(*first) + '"');
  }
  const bool refined = scene_.accuracy.any() || std::any_of(scene_.bodies.begin(), scene_.bodies.end(),
                                                            [](const BodySpec& body) { return !body.refine.empty(); });
  for (BodySpec& body : scene_.bodies) body.quadtree = refined && body.plane_strain;
}

/// Bodies become prisms of the section by a half-plane through the axis, in cells that are rings.
void SceneReader::read_axisymmetric(const TomlCursor& root) {
  const auto node = root.find("axisymmetric");
  if (!node) return;
  const int axis = node->one_of(coordinate_names());
  const auto allowed = [&](const std::string& what) { return what + " about " + coordinate_names()[axis]; };
  const std::vector<TomlCursor> nodes = root.at("body").elements("[[body]] sections");
  double largest = 0;
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    BodySpec& body = scene_.bodies[b];
    if (body.plane_strain)
      node->fail("stands beside plane_strain of body \"" + body.name + '"', "one of the two for all bodies");
    if ((body.grid_rotation - Mat3::Identity()).norm() > axis_rounding)
      node->fail("the grid of body \"" + body.name + "\" is turned",
                 "no grid.rotation: the axis is a line of the grid");
    body.plane_strain = static_cast<Coordinate>((axis + 2) % 3);
    body.plane_strain_location = node->location();
    body.quadtree = true;
    try {
      body.solid = meridian_of(body.solid, axis);
    } catch (const InputError& error) {
      node->fail("body \"" + body.name + "\": " + error.what(), allowed("bodies of revolution"));
    }
    Vec3 min, max;
    body.solid.bounding_box(min, max);
    largest = std::max(largest, max[(axis + 1) % 3]);
  }
  for (BodySpec& body : scene_.bodies) body.unit_radius = largest;
}

/// Both ends of a body in plane strain are symmetry planes, for everything but the linear system; an axis of revolution
/// is one as well.
void SceneReader::add_implied_supports() {
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    const BodySpec& body = scene_.bodies[b];
    if (!body.plane_strain) continue;
    if (body.axisymmetric()) {
      SupportSpec axis;
      axis.symmetry = axis.implied = true;
      axis.location = axis.face.location = axis.face.face.location = body.plane_strain_location;
      axis.face.body = static_cast<int>(b);
      axis.face.face.name = "axis";
      axis.face.face.surfaces = {"axis.plane"};
      scene_.supports.push_back(axis);
      continue;
    }
    for (const int side : {-1, 1}) {
      SupportSpec end;
      end.symmetry = end.implied = true;
      end.location = end.face.location = end.face.face.location = body.plane_strain_location;
      end.face.body = static_cast<int>(b);
      end.face.face.name = "plane_strain." + name_of(*body.plane_strain) + (side < 0 ? '-' : '+');
      end.face.face.normal_cone = std::make_pair(side * Vec3(Vec3::Unit(static_cast<int>(*body.plane_strain))),
                                                 std::cos(end_cone * radians_per_degree));
      scene_.supports.push_back(end);
    }
  }
}

namespace {

/// Cells of a rigid body along its longest side, at least.
constexpr double coarsest_of_rigid = 4;

}  // namespace

void SceneReader::read_bodies(const TomlCursor& root) {
  std::set<std::string> seen;
  const TomlCursor list = root.at("body", "one [[body]] section per body");
  const std::vector<TomlCursor> nodes = list.elements("[[body]] sections");
  if (nodes.empty()) list.fail("there is no body", "one [[body]] section per body");
  std::optional<SceneMaterials> materials;
  mistakes_.attempt([&] { materials.emplace(root); });
  for (const TomlCursor& node : nodes) {
    shapes_.emplace_back();
    scene_.bodies.emplace_back();
    unread_.emplace_back();
    const bool known_keys = mistakes_.attempt([&] {
      node.expect_keys({"name", "shape", "material", "rigid", "cell_size", "grid", "body_force", "temperature", "faces",
                        "refine", "plane_strain"});
    });
    unread_.back().name = !mistakes_.attempt([&] {
      const TomlCursor name = node.at("name", "a name");
      scene_.bodies.back().name = read_name(name);
      check_unique(name, scene_.bodies.back().name, seen, "body");
    });
    read_body(node, materials, known_keys);
  }
  if (mistakes_.size() == 0 &&
      std::all_of(scene_.bodies.begin(), scene_.bodies.end(), [](const BodySpec& body) { return body.rigid(); }))
    list.fail("all bodies are rigid: there is nothing to compute", "at least one body without rigid = true");
}

/// Checks the keys of a table by body: only elastic bodies have a stress.
void SceneReader::check_bodies_of_stress(const TomlCursor& node) const {
  node.expect_keys(body_names());
  for (const BodySpec& body : scene_.bodies)
    if (const auto value = node.find(body.name); value && body.rigid())
      value->fail("a rigid body has no stress", "elastic bodies");
}

int SceneReader::body_index(const std::string& name) const {
  for (std::size_t k = 0; k < scene_.bodies.size(); ++k)
    if (scene_.bodies[k].name == name) return static_cast<int>(k);
  return -1;
}

std::vector<std::string> SceneReader::body_names() const {
  std::vector<std::string> names;
  for (const BodySpec& body : scene_.bodies) names.push_back(body.name);
  return names;
}

/// "body.face" of all declared faces and of all faces of the primitives.
std::vector<std::string> SceneReader::face_names(int body) const {
  std::vector<std::string> names;
  const std::string prefix = scene_.bodies[body].name + ".";
  for (const FaceSpec& face : scene_.bodies[body].faces) names.push_back(prefix + face.name);
  for (const std::string& face : shapes_[body].face_names()) names.push_back(prefix + face);
  return names;
}

FaceRef SceneReader::resolve_face(const TomlCursor& node) const {
  return resolve_face(node, node.string("\"body.face\""));
}

FaceRef SceneReader::resolve_face(const TomlCursor& node, const std::string& reference) const {
  const std::size_t dot = reference.find('.');
  const std::string name = reference.substr(0, dot);
  FaceRef result;
  result.location = node.location();
  result.body = body_index(name);
  if (result.body < 0 && std::any_of(unread_.begin(), unread_.end(), [](const Unread& body) { return body.name; }))
    throw FollowingMistake();
  if (result.body < 0)
    node.fail("there is no body \"" + name + "\"" + did_you_mean(name, body_names()),
              "\"body.face\" with body one of " + join(body_names()));
  const std::string face = dot == std::string::npos ? "" : reference.substr(dot + 1);
  for (const FaceSpec& declared : scene_.bodies[result.body].faces) {
    if (declared.name != face) continue;
    result.face = declared;
    return result;
  }
  result.face.name = face;
  result.face.location = result.location;
  if (unread_[result.body].shape) throw FollowingMistake();
  result.face.surfaces = shapes_[result.body].resolve(face);
  result.face.owners = shapes_[result.body].owners_of_shared(result.face.surfaces);
  if (const std::string other = shapes_[result.body].one_with(result.face.surfaces); !other.empty())
    node.fail("lies in line with \"" + name + "." + other + "\": both edges are one face",
              "one name for both edges, or a part of the face: faces = [{name = .., surfaces = [\"" + face +
                  "\"], box = {min, max}}] in the [[body]]");
  if (!result.face.surfaces.empty()) return result;
  if (unread_[result.body].faces) throw FollowingMistake();
  const std::vector<std::string> known = face_names(result.body);
  node.fail("body \"" + name + "\" has no face \"" + face + "\"" + did_you_mean(reference, known), join(known));
}

namespace {

void read_displacement(const TomlCursor& node, SupportSpec& support) {
  node.expect_keys({"x", "y", "z", "normal"});
  if (const auto normal = node.find("normal")) support.normal_displacement = normal->expression("m");
  for (int k = 0; k < 3; ++k)
    if (const auto component = node.find(name_of(static_cast<Held>(k))))
      support.displacement[k] = component->expression("m");
  if (node.entries().empty()) node.fail("prescribes nothing", "at least one of x, y, z, normal (m)");
}

/// What the support holds: one of the ways of saying it, maybe the key that is not known. An earlier result comes
/// later, when the body is known.
void read_held(const TomlCursor& node, SupportSpec& support, bool known_keys) {
  const std::vector<std::string> ways{"symmetry",  "displacement", "displacement_from", "cylindrical", "rotation",
                                      "stiffness", "spring"};
  std::vector<std::string> given;
  for (const std::string& way : ways)
    if (const auto value = node.find(way); value && (way != "symmetry" || value->boolean())) given.push_back(way);
  if (given.empty() && !known_keys) throw FollowingMistake();
  if (given.size() != 1)
    node.fail(
        given.empty() ? "says nothing" : "has both " + given[0] + " and " + given[1],
        "symmetry = true, or displacement = {x = .., y = .., z = ..}, displacement_from = \"out/..\", cylindrical = "
        "{radial = ..}, rotation = {axis, angle}, stiffness = .. or spring = ..");
  const TomlCursor value = node.at(given[0]);
  if (given[0] == "symmetry") support.symmetry = true;
  if (given[0] == "displacement") read_displacement(value, support);
  if (given[0] == "cylindrical") read_cylindrical(value, support);
  if (given[0] == "rotation") support.displacement = read_rotation(value);
  if (given[0] == "stiffness") support.springs = read_springs(value, "N/m^3");
  if (given[0] == "spring") {
    support.springs = read_springs(value, "N/m");
    support.of_face = true;
  }
}

}  // namespace

void SceneReader::read_support(const TomlCursor& node) {
  const bool known_keys = mistakes_.attempt([&] {
    node.expect_keys({"face", "symmetry", "displacement", "displacement_from", "cylindrical", "rotation", "stiffness",
                      "spring", "steps"});
  });
  SupportSpec support;
  support.location = node.location();
  const bool has_face = (known_keys || node.find("face")) &&
                        mistakes_.attempt([&] { support.face = resolve_face(node.at("face", "\"body.face\"")); });
  const bool is_read = mistakes_.attempt([&] { read_held(node, support, known_keys); });
  if (const auto steps = node.find("steps"))
    mistakes_.attempt([&] { support.steps = read_own_steps(*steps, scene_.steps); });
  if (!has_face || !is_read) return;
  std::vector<const Expression*> given;
  if (support.normal_displacement) given.push_back(&*support.normal_displacement);
  for (const auto& components : {&support.displacement, &support.cylindrical})
    for (const auto& component : *components)
      if (component) given.push_back(&*component);
  probe_expressions(scene_.bodies[support.face.body], support.face.face, given);
  if (const auto from = node.find("displacement_from")) read_displacement_from(*from, support);
  scene_.supports.push_back(support);
}

/// Prescribes the displacements of an earlier result, without the one across a half-plane or plane strain, which is
/// zero.
void SceneReader::read_displacement_from(const TomlCursor& node, SupportSpec& support) {
  const BodySpec& body = scene_.bodies[support.face.body];
  const std::string given = node.string("the directory of a result, relative to the scene file");
  const std::string directory = (std::filesystem::path(node.text().file).parent_path() / given).string();
  std::shared_ptr<const DisplacementField>& field = fields_[{directory, body.name}];
  try {
    if (!field) field = std::make_shared<const DisplacementField>(directory, body);
  } catch (const InputError& error) {
    node.fail(error.what(),
              "the directory of a result that has converged, relative to the scene file, with "
              "result.vtkhdf and a body of this name");
  }
  for (int k = 0; k < 3; ++k) {
    if (body.plane_strain && k == static_cast<int>(*body.plane_strain)) continue;
    support.displacement[k] = Expression(
        [field = field, k, location = node.location(), value = node.value(), name = body.name](const Vec3& x) {
          const DisplacementField::Value found = field->at(x);
          if (found.distance <= field->cell_size()) return found.displacement[k];
          throw InputError(location, value,
                           fmt::format("({:.4g}, {:.4g}, {:.4g}) m is {:.3g} m outside of body \"{}\" of this result",
                                       x[0], x[1], x[2], found.distance, name),
                           fmt::format("faces in that body, or within its cell size of {:.3g} m; its files are in m",
                                       field->cell_size()));
        });
  }
}

void SceneReader::read_supports(const TomlCursor& root) {
  const std::vector<TomlCursor> nodes = optional_elements(root, "support");
  for (const TomlCursor& node : nodes) mistakes_.attempt([&] { read_support(node); });
  if (nodes.empty()) {
    SourceLocation location{scene_.file, 0, "support"};
    throw InputError(location, "", "nothing holds the bodies: the scene has no support",
                     "at least one [[support]] with symmetry = true or displacement = {...}");
  }
}

void SceneReader::read_load(const TomlCursor& node) {
  const bool known_keys = mistakes_.attempt([&] {
    node.expect_keys({"face", "pressure", "traction", "force", "moment", "at", "bearing", "steps"});
  });
  LoadSpec load;
  load.location = node.location();
  const bool has_face = (known_keys || node.find("face")) &&
                        mistakes_.attempt([&] { load.face = resolve_face(node.at("face", "\"body.face\"")); });
  const auto pressure = node.find("pressure"), traction = node.find("traction");
  const auto force = node.find("force"), moment = node.find("moment"), at = node.find("at");
  if (!pressure && !traction && !force && !moment && known_keys)
    node.fail("says no load", "pressure, traction = [x, y, z] (Pa), force = [x, y, z] (N), moment = [x, y, z] (N m)");
  if (pressure) mistakes_.attempt([&] { load.pressure = pressure->expression("Pa"); });
  if (traction) mistakes_.attempt([&] { load.traction = read_vector_field(*traction, "Pa"); });
  const bool has_force = force && mistakes_.attempt([&] { load.force = force->vector("N"); });
  if (moment) mistakes_.attempt([&] { load.moment = moment->vector("N*m"); });
  if (at && !force && known_keys) at->fail("says where a force acts, and there is none", "with force = [x, y, z]");
  if (at) mistakes_.attempt([&] { load.at = at->vector("m"); });
  if (const auto bearing = node.find("bearing")) mistakes_.attempt([&] { load.bearing = bearing->boolean(); });
  if (load.bearing && ((force ? has_force && load.force.isZero(0) : known_keys) || moment || at))
    node.at("bearing").fail(force ? "is the pressure of a force towards the axis: it has no moment and no other place"
                                  : "is the pressure of a force, and there is none",
                            "with force = [x, y, z], without moment and at");
  if (const auto steps = node.find("steps"))
    mistakes_.attempt([&] { load.steps = read_own_steps(*steps, scene_.steps); });
  if (!has_face) return;
  probe_expressions(scene_.bodies[load.face.body], load.face.face,
                    {&load.pressure, &load.traction[0], &load.traction[1], &load.traction[2]});
  scene_.loads.push_back(load);
}

void SceneReader::read_loads(const TomlCursor& root) {
  for (const TomlCursor& node : optional_elements(root, "load")) mistakes_.attempt([&] { read_load(node); });
}

/// Gravity and steady rotation of the whole scene, on the mass of every body.
void SceneReader::read_inertia(const TomlCursor& root) {
  const auto gravity = root.find("gravity"), rotation = root.find("rotation");
  if (!gravity && !rotation) return;
  const Vec3 acceleration = gravity ? gravity->vector("m/s^2") : Vec3::Zero();
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();
  double speed = 0;
  if (rotation) {
    rotation->expect_keys({"centre", "axis", "speed"});
    if (const auto node = rotation->find("centre")) centre = node->vector("m");
    axis = rotation->at("axis", "[x, y, z], the direction of the axis").direction();
    Range range;
    range.unit = "rad/s";
    range.text = "rad/s, or a text with a unit: \"3000 rpm\"";
    speed = rotation->at("speed", range.text).number(range);
  }
  for (BodySpec& body : scene_.bodies) {
    if (!body.material.density && body.rigid()) {
      body.inertia.unknown = true;
      continue;
    }
    if (!body.material.density)
      throw InputError(body.location, "\"" + body.name + "\"",
                       "its material has no density, which gravity and rotation act on",
                       "material = {.., density = 7850} in kg/m^3");
    body.inertia = {*body.material.density * acceleration, *body.material.density * speed * speed, centre, axis};
  }
}

namespace {

MomentSpec read_moment(const TomlCursor& node) {
  node.expect_keys({"point", "axis"});
  MomentSpec moment;
  moment.point = node.at("point", "[x, y, z], m").vector("m");
  if (const auto axis = node.find("axis")) moment.axis = axis->direction();
  return moment;
}

}  // namespace

namespace {

void read_bonded(const TomlCursor& node, ContactSpec& contact) {
  const auto value = node.find("bonded");
  contact.bonded = value && value->boolean();
  if (!contact.bonded) return;
  if (contact.automatic)
    value->fail("automatic pairs press and slide: which faces are bonded is not guessed",
                "in a section with faces = [\"body.face\", \"body.face\"]");
  for (const char* key : {"interference", "preload"})
    if (const auto other = node.find(key))
      other->fail("bonded faces are tied as they are drawn, without stress",
                  "without bonded = true, or without " + std::string(key));
  if (const auto friction = node.find("friction"))
    friction->fail("bonded faces carry any shear: nothing rubs", "without bonded = true, or without friction");
}

/// Rubber on a rough floor has 1, clean metals in vacuum up to 2.
constexpr double max_friction = 2;

}  // namespace

ContactSpec SceneReader::read_pair(const TomlCursor& node) const {
  ContactSpec contact;
  contact.location = node.location();
  const TomlCursor list = node.at("faces", "[\"body.face\", \"body.face\"] of two bodies, or automatic = true");
  const std::vector<TomlCursor> faces = list.elements("[\"body.face\", \"body.face\"]");
  if (faces.size() != 2)
    list.fail("a contact pair needs two faces, here are " + std::to_string(faces.size()),
              "[\"body.face\", \"body.face\"]");
  contact.first = resolve_face(faces[0]);
  contact.second = resolve_face(faces[1]);
  if (contact.first.body == contact.second.body)
    list.fail("both faces belong to the body \"" + scene_.bodies[contact.first.body].name + "\"",
              "faces of two different bodies");
  const auto is_rigid = [](const BodySpec& body) { return body.rigid(); };
  if (std::all_of(scene_.bodies.begin(), scene_.bodies.end(), is_rigid)) throw FollowingMistake();
  if (scene_.bodies[contact.first.body].rigid() && scene_.bodies[contact.second.body].rigid())
    list.fail("both bodies are rigid: the pressure between them is not determined", "at least one elastic body");
  const auto name = node.find("name");
  contact.name =
      name ? read_name(*name) : scene_.bodies[contact.first.body].name + "-" + scene_.bodies[contact.second.body].name;
  return contact;
}

/// One pair of all points for every two bodies that no other pair joins.
void SceneReader::add_automatic_contacts(const TomlCursor& node) {
  if (node.find("faces") || node.find("name"))
    node.fail("automatic pairs take no faces and no name", "automatic = true");
  if (scene_.bodies.size() < 2) node.fail("automatic contact needs at least two bodies", "two or more [[body]]");
  std::set<std::pair<int, int>> joined;
  for (const ContactSpec& contact : scene_.contacts)
    joined.insert(std::minmax(contact.first.body, contact.second.body));
  for (int b = 1; b < static_cast<int>(scene_.bodies.size()); ++b) {
    for (int a = 0; a < b; ++a) {
      if (joined.count({a, b}) > 0) continue;
      ContactSpec contact;
      contact.location = node.location();
      contact.name = scene_.bodies[a].name + "-" + scene_.bodies[b].name;
      contact.automatic = true;
      contact.first.body = a;
      contact.second.body = b;
      contact.first.face.name = contact.second.face.name = "all";
      contact.first.location = contact.second.location = contact.location;
      contact.first.face.location = contact.second.face.location = contact.location;
      scene_.contacts.push_back(contact);
    }
  }
}

/// Cells of a rigid body that has none of its own serve contact and pictures only: at its surface as small as those of
/// the elastic bodies that it may touch, and smaller where these are; large inside.
void SceneReader::choose_cells_of_rigid_bodies() {
  for (int b = 0; b < static_cast<int>(scene_.bodies.size()); ++b) {
    BodySpec& body = scene_.bodies[b];
    if (!body.rigid() || body.cell_size > 0 || scene_.accuracy.any()) continue;
    std::set<int> partners;
    for (const ContactSpec& contact : scene_.contacts) {
      if (contact.first.body == b) partners.insert(contact.second.body);
      if (contact.second.body == b) partners.insert(contact.first.body);
    }
    if (partners.empty())
      throw InputError(body.location, "\"" + body.name + "\"", "a rigid body without contact moves nothing",
                       "a [[contact]] with an elastic body");
    RefineSpec surface;
    surface.kind = RefineSpec::Kind::face;
    surface.size = longest_side(scene_.bodies[b].solid);
    surface.grading = 1;
    surface.location = body.location;
    for (const int partner : partners) {
      const BodySpec& other = scene_.bodies[partner];
      if (other.rigid()) continue;
      surface.size = std::min(surface.size, other.cell_size);
      for (const RefineSpec& refine : other.refine)
        if (refine.kind != RefineSpec::Kind::face) body.refine.push_back(refine);
    }
    body.cell_size = surface.size;
    if (body.plane_strain) continue;  // cells of one size, as those of the others
    while (2 * body.cell_size * coarsest_of_rigid <= longest_side(scene_.bodies[b].solid)) body.cell_size *= 2;
    if (body.cell_size > surface.size) body.refine.push_back(surface);
  }
}

/// The same two faces in an earlier pair would carry the pressure twice.
void SceneReader::check_new_pair(const TomlCursor& node, const ContactSpec& contact) const {
  const auto id = [](const FaceRef& face) { return std::make_pair(face.body, face.face.name); };
  for (const ContactSpec& earlier : scene_.contacts)
    if (!earlier.automatic &&
        std::minmax(id(earlier.first), id(earlier.second)) == std::minmax(id(contact.first), id(contact.second)))
      node.at("faces").fail("is the pair \"" + earlier.name + "\" again", "every two faces once");
}

namespace {

/// A target of the pair's own, beside [accuracy].
void read_pair_target(const TomlCursor& node, const std::string& pair, AccuracyOptions& accuracy) {
  node.expect_keys({"pressure"});
  if (!accuracy.any()) node.fail("stands in a scene without [accuracy]", "[accuracy] with a target for all, beside it");
  accuracy.named.push_back({NamedTarget::Kind::pressure, pair, read_target(node.at("pressure", "\"5 %\""))});
}

bool is_automatic(const TomlCursor& node) {
  const auto automatic = node.find("automatic");
  return automatic && automatic->boolean();
}

}  // namespace

/// Reads what a section says of its pair; `has_pair`: bodies and faces of the contact could be read.
void SceneReader::read_pair_values(const TomlCursor& node, bool has_pair, ContactSpec& contact) {
  const auto read = [&](const char* key, const auto& task) {
    if (const auto value = node.find(key)) mistakes_.attempt([&] { task(*value); });
  };
  mistakes_.attempt([&] { read_bonded(node, contact); });
  read("friction",
       [&](const TomlCursor& value) { contact.friction = value.number(Range::from_to(0, max_friction, "0 to 2")); });
  read("interference", [&](const TomlCursor& value) {
    contact.interference = value.number(Range::any("m"));
    if (!has_pair || unread_[contact.first.body].shape || unread_[contact.second.body].shape) return;
    const double longest = std::min(longest_side(scene_.bodies[contact.first.body].solid),
                                    longest_side(scene_.bodies[contact.second.body].solid));
    if (std::abs(contact.interference) > longest)
      value.fail(fmt::format("is more than the smaller body, which is {:.3g} m long", longest));
  });
  read("preload", [&](const TomlCursor& value) {
    contact.preload = value.number(Range::positive("N"));
    if (contact.automatic)
      value.fail("a preload is that of one pair", "in a section with faces = [\"body.face\", \"body.face\"]");
  });
  read("search_distance",
       [&](const TomlCursor& value) { contact.search_distance = value.number(Range::not_negative("m")); });
  read("moment_about", [&](const TomlCursor& value) { contact.moment_about = read_moment(value); });
  read("accuracy", [&](const TomlCursor& value) { read_pair_target(value, contact.name, scene_.accuracy); });
}

/// One pair, or all automatic ones.
void SceneReader::read_contact(const TomlCursor& node, std::set<std::string>& seen) {
  const bool known_keys = mistakes_.attempt([&] {
    node.expect_keys({"name", "faces", "automatic", "bonded", "friction", "interference", "preload", "search_distance",
                      "moment_about", "accuracy"});
  });
  const std::size_t first = scene_.contacts.size();
  if (is_automatic(node)) {
    add_automatic_contacts(node);
  } else if (known_keys || node.find("faces")) {
    ContactSpec contact;
    const bool has_pair = mistakes_.attempt([&] {
      contact = read_pair(node);
      check_new_pair(node, contact);
    });
    if (has_pair)
      scene_.contacts.push_back(std::move(contact));
    else
      read_pair_values(node, has_pair, contact);
  }
  for (std::size_t k = first; k < scene_.contacts.size(); ++k) {
    ContactSpec& contact = scene_.contacts[k];
    check_unique(node.find("name").value_or(node), contact.name, seen, "contact pair: give this one a name");
    read_pair_values(node, true, contact);
  }
}

void SceneReader::read_contacts(const TomlCursor& root) {
  std::set<std::string> seen;
  std::vector<TomlCursor> ordered = optional_elements(root, "contact");
  // Automatic pairs fill what the named ones leave; a section that cannot tell is one with a mistake.
  std::stable_partition(ordered.begin(), ordered.end(), [](const TomlCursor& node) {
    const auto automatic = node.find("automatic");
    return !(automatic && automatic->node().is_boolean() && automatic->boolean());
  });
  for (const TomlCursor& node : ordered) mistakes_.attempt([&] { read_contact(node, seen); });
}

/// Faces of targets of displacements; other names are those of probes.
void SceneReader::find_faces_of_targets(const TomlCursor& root) {
  const auto accuracy = root.find("accuracy");
  const auto node = accuracy ? accuracy->find("displacement") : std::nullopt;
  if (!node || !node->is_table()) return;
  for (const auto& [name, target] : node->entries()) {
    const auto is_this = [&probe_name = name](const ProbeSpec& probe) { return probe.name == probe_name; };
    if (name == "largest" || std::any_of(scene_.probes.begin(), scene_.probes.end(), is_this)) continue;
    if (name.find('.') == std::string::npos)
      target.fail("there is no probe \"" + name + "\"", "\"body.face\", the name of a [[probe]], or largest");
    scene_.accuracy_faces[name] = resolve_face(target, name);
  }
}

/// A preload is found in the first step and kept: fractions of interferences would leave fractions of it.
void SceneReader::check_preload_of_steps(const TomlCursor& node) const {
  const auto has_preload = [](const ContactSpec& contact) { return contact.preload.has_value(); };
  const auto is_partial = [](const StepSpec& step) { return step.interference != 1; };
  if (std::any_of(scene_.contacts.begin(), scene_.contacts.end(), has_preload) &&
      std::any_of(scene_.steps.begin(), scene_.steps.end(), is_partial))
    node.fail("takes parts of the interference that a preload is reached by in the first step and that is kept",
              "loads = [..] and displacements = [..], without factors and interference");
}

/// Refuses a target of shear that nothing would have.
void SceneReader::check_target_of_shear(const TomlCursor& node) const {
  const auto has_friction = [](const ContactSpec& contact) { return contact.friction > 0; };
  if (std::none_of(scene_.contacts.begin(), scene_.contacts.end(), has_friction))
    node.fail("asks for the error of a shear that no contact has", "beside a [[contact]] with friction = 0.3, say");
}

const std::vector<std::string>& scene_keys() {
  static const std::vector<std::string> keys{"title",    "parameters", "plane_strain", "axisymmetric", "accuracy",
                                             "material", "body",       "support",      "load",         "contact",
                                             "steps",    "solver",     "recovery",     "output",       "reference",
                                             "gravity",  "rotation",   "probe",        "section"};
  return keys;
}

/// Sections that need no grid and no body.
void SceneReader::read_settings(const TomlCursor& root) {
  if (const auto node = root.find("solver")) mistakes_.attempt([&] { scene_.solver = read_solver(*node); });
  if (const auto node = root.find("recovery")) mistakes_.attempt([&] { scene_.recovery = read_recovery(*node); });
  if (const auto node = root.find("output")) mistakes_.attempt([&] { scene_.output = read_output(*node); });
}

Scene SceneReader::read(const TomlCursor& root) {
  mistakes_.attempt([&] { root.expect_keys(scene_keys()); });
  scene_.file = root.text().file;
  scene_.parameters = root.text().parameters;
  if (const auto title = root.find("title")) mistakes_.attempt([&] { scene_.title = printable(title->string()); });
  if (const auto node = root.find("accuracy"))
    if (!mistakes_.attempt([&] { scene_.accuracy = read_accuracy(*node); }))
      scene_.accuracy.pressure = 1;  // bodies need no cell_size beside it
  const std::size_t before = mistakes_.size();
  mistakes_.attempt([&] { read_bodies(root); });
  if (scene_.bodies.empty()) mistakes_.throw_if_any(scene_.file);
  const bool has_bodies = mistakes_.size() == before;
  if (!scene_.accuracy.stress_of_body.empty() && has_bodies)
    mistakes_.attempt([&] { check_bodies_of_stress(*root.find("accuracy")->find("stress")); });
  if (has_bodies) mistakes_.attempt([&] { read_inertia(root); });
  mistakes_.attempt([&] { read_plane_strain(root); });
  if (has_bodies) mistakes_.attempt([&] { read_axisymmetric(root); });
  const auto steps = root.find("steps");
  if (steps) mistakes_.attempt([&] { scene_.steps = read_steps(*steps); });
  mistakes_.attempt([&] { read_supports(root); });
  add_implied_supports();
  mistakes_.attempt([&] { read_loads(root); });
  mistakes_.attempt([&] { read_contacts(root); });
  const bool has_contacts = mistakes_.size() == before;
  if (has_contacts) mistakes_.attempt([&] { choose_cells_of_rigid_bodies(); });
  if (has_bodies) mistakes_.attempt([&] { read_probes(root); });
  if (has_bodies) mistakes_.attempt([&] { find_faces_of_targets(root); });
  if (has_bodies) mistakes_.attempt([&] { read_sections(root); });
  if (steps) mistakes_.attempt([&] { check_preload_of_steps(*steps); });
  if (scene_.accuracy.shear && has_contacts)
    mistakes_.attempt([&] { check_target_of_shear(root.find("accuracy")->at("shear", "")); });
  read_settings(root);
  if (const auto node = root.find("reference"); node && has_contacts)
    mistakes_.attempt([&] {
      std::optional<double> contact_force;
      if (!scene_.contacts.empty()) contact_force = 1;
      scene_.reference = read_reference(*node, body_names(), contact_force);
    });
  mistakes_.throw_if_any(scene_.file);
  return std::move(scene_);
}

}  // namespace cgcontact
