#include "core/scene_file/sections/scene_profiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/bodies/cad_body.hpp"
#include "core/bodies/profile_body.hpp"
#include "core/expressions/units.hpp"
#include "core/scene_file/sections/scene_cad.hpp"

namespace cgcontact {

namespace {

constexpr double max_axis_cosine = 1e-9;  // cosine of the angle between the plane's x axis and its normal
constexpr double on_axis = 1e-12;         // relative to the profile: an edge there has no face
constexpr double arc_on_axis = 1e-9;      // relative to the profile: the centre of an arc that belongs to a sphere
constexpr std::size_t max_edges = 200;
const char* const profile_help = "[[a, b], [a, b], {to = [a, b], through = [a, b], name = ..}, ...], m";

Vec2 read_point(const TomlCursor& node) {
  const std::vector<TomlCursor> components = node.elements("[a, b], m");
  if (components.size() != 2) node.fail(fmt::format("has {} components, not 2", components.size()), "[a, b], m");
  return {components[0].number(Range::any("m")), components[1].number(Range::any("m"))};
}

/// The edge that ends at an element of the list.
ProfileEdge read_edge(const TomlCursor& node, const Vec2& from, std::size_t number) {
  ProfileEdge edge;
  edge.from = from;
  edge.face = "side" + std::to_string(number);
  if (node.is_array()) {
    edge.to = read_point(node);
    return edge;
  }
  node.expect_keys({"to", "through", "name"});
  edge.to = read_point(node.at("to", "[a, b], m"));
  if (const auto through = node.find("through")) {
    edge.is_arc = true;
    edge.through = read_point(*through);
  }
  if (const auto name = node.find("name")) edge.face = read_name(*name);
  return edge;
}

/// From the first point through all others and, by a line, back to the first one unless the last one is there.
std::vector<ProfileEdge> read_edges(const TomlCursor& node) {
  const std::vector<TomlCursor> points = node.elements(profile_help);
  if (points.size() < 3 || points.size() > max_edges)
    node.fail(fmt::format("has {} points", points.size()), fmt::format("3 to {}: {}", max_edges, profile_help));
  if (points[0].is_table()) points[0].fail("is the first point, no edge ends there", "[a, b], m");
  const Vec2 start = read_point(points[0]);
  std::vector<ProfileEdge> edges;
  for (std::size_t k = 1; k < points.size(); ++k)
    edges.push_back(read_edge(points[k], edges.empty() ? start : edges.back().to, k));
  const Vec2 end = edges.back().to;
  if (end != start) edges.push_back({end, start, "side" + std::to_string(points.size())});
  return edges;
}

/// Names of the edges' faces, each once, and those with the primitive's name before them.
std::vector<std::string> name_faces(std::vector<ProfileEdge>& edges, const std::string& primitive) {
  std::vector<std::string> faces;
  for (ProfileEdge& edge : edges) {
    if (std::find(faces.begin(), faces.end(), edge.face) == faces.end()) faces.push_back(edge.face);
    edge.face = primitive + "." + edge.face;
  }
  return faces;
}

Vec3 origin_of(const TomlCursor& node) {
  const auto origin = node.find("origin");
  return origin ? origin->vector("m") : Vec3(0, 0, 0);
}

Vec3 direction_of(const TomlCursor& node, const char* key, const Vec3& otherwise) {
  const auto given = node.find(key);
  return given ? given->direction() : otherwise;
}

/// What `make` returns; what it refuses is an error of the node.
template <class Make>
Solid made_of(const TomlCursor& node, const std::string& allowed, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    node.fail(error.what(), allowed);
  }
}

/// Tells whether an arc has its centre beside the axis.
bool has_torus(const std::vector<ProfileEdge>& edges) {
  const auto is_torus = [](const ProfileEdge& edge) {
    const auto arc = edge.is_arc ? arc_through(edge.from, edge.through, edge.to) : std::nullopt;
    return arc && std::abs(arc->circle.centre[0]) > arc_on_axis * std::max(edge.from[0], edge.to[0]);
  };
  return std::any_of(edges.begin(), edges.end(), is_torus);
}

Solid with_tori(std::vector<ProfileEdge> edges, ProfileFrame frame, const TomlCursor& body) {
  for (ProfileEdge& edge : edges)
    for (Vec2* x : {&edge.from, &edge.to, &edge.through}) *x /= mm;
  frame.origin /= mm;
  const CadModel model = CadModel::revolved(edges, frame);
  const auto [low, high] = model.box();
  return Solid(std::make_shared<CadBody>(model, mm, cell_size_for_cad(body, mm * (high - low).maxCoeff())));
}

}  // namespace

ProfileShape read_cone(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"base", "top", "base_radius", "top_radius"});
  const Vec3 base = node.at("base", "[x, y, z], m").vector("m"), top = node.at("top", "[x, y, z], m").vector("m");
  const double base_radius = node.at("base_radius", ">= 0 m").number(Range::not_negative("m"));
  const double top_radius = node.at("top_radius", ">= 0 m").number(Range::not_negative("m"));
  if (!((top - base).norm() > 0)) node.fail("has no length: base and top are equal", "base different from top");
  if (base_radius == top_radius) node.fail("has two equal radii", "a cylinder, or different radii");
  ProfileShape shape{made_of(node, "other radii or another height",
                             [&] { return Solid::cone(base, top, base_radius, top_radius, name); }),
                     {"side"}};
  if (base_radius > 0) shape.faces.emplace_back("bottom");
  if (top_radius > 0) shape.faces.emplace_back("top");
  return shape;
}

ProfileShape read_extrude(const TomlCursor& node, const std::string& name) {
  node.expect_keys({"profile", "height", "origin", "x", "normal"});
  const TomlCursor profile = node.at("profile", profile_help);
  std::vector<ProfileEdge> edges = read_edges(profile);
  for (const ProfileEdge& edge : edges)
    if (edge.face == "bottom" || edge.face == "top")
      profile.fail("\"" + edge.face + "\" is the name of an end", "another name for the edge");
  const Vec3 normal = direction_of(node, "normal", Vec3::UnitZ()), x = direction_of(node, "x", Vec3::UnitX());
  if (std::abs(x.dot(normal)) > max_axis_cosine)
    node.fail("x is not at right angles to normal", "x in the plane of the profile");
  const double height = node.at("height", "> 0 m").number(Range::positive("m"));
  ProfileShape shape;
  shape.faces = name_faces(edges, name);
  shape.faces.insert(shape.faces.end(), {"bottom", "top"});
  const ProfileFrame frame{origin_of(node), x, normal.cross(x)};
  shape.solid = made_of(profile, "a closed line that does not cross or touch itself",
                        [&] { return extruded(edges, frame, height, name + ".bottom", name + ".top"); });
  return shape;
}

ProfileShape read_revolve(const TomlCursor& node, const std::string& name, const TomlCursor& body) {
  node.expect_keys({"profile", "origin", "axis"});
  const TomlCursor profile = node.at("profile", profile_help);
  std::vector<ProfileEdge> edges = read_edges(profile);
  double size = 0;
  for (const ProfileEdge& edge : edges) {
    if (edge.from[0] < 0) profile.fail("is on both sides of the axis", "distances from the axis >= 0, [r, z]");
    size = std::max(size, edge.from[0]);
  }
  ProfileShape shape;
  std::vector<ProfileEdge> with_face;
  for (const ProfileEdge& edge : edges)
    if (edge.is_arc || std::max(edge.from[0], edge.to[0]) > on_axis * size) with_face.push_back(edge);
  shape.faces = name_faces(with_face, name);
  name_faces(edges, name);
  const Vec3 axis = direction_of(node, "axis", Vec3::UnitZ());
  const ProfileFrame frame{origin_of(node), axis.unitOrthogonal(), axis};
  shape.solid = made_of(profile, "a closed line that does not cross or touch itself",
                        [&] { return has_torus(edges) ? with_tori(edges, frame, body) : revolved(edges, frame); });
  return shape;
}

ProfileShape read_torus(const TomlCursor& node, const std::string& name, const TomlCursor& body) {
  node.expect_keys({"center", "axis", "ring_radius", "tube_radius"});
  const Vec3 center = node.at("center", "[x, y, z], m").vector("m"), axis = direction_of(node, "axis", Vec3::UnitZ());
  const double ring = node.at("ring_radius", "> 0 m").number(Range::positive("m"));
  const TomlCursor tube_node = node.at("tube_radius", "> 0 m, < ring_radius");
  const double tube = tube_node.number(Range::positive("m"));
  if (!(tube < ring)) tube_node.fail("is not less than ring_radius", fmt::format("> 0 m, < {:.6g} m", ring));
  const ProfileEdge circle{{ring + tube, 0}, {ring + tube, 0}, name + ".surface", true, {ring - tube, 0}};
  return {made_of(node, "a ring with a hole",
                  [&] {
                    return with_tori({circle}, {center, axis.unitOrthogonal(), axis}, body);
                  }),
          {"surface"}};
}

}  // namespace cgcontact
