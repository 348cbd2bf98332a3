/// Sections of the scene file that ask for results at points: [[probe]], [[section]].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/process/parallel.hpp"
#include "core/scene_file/sections/scene_reader.hpp"

namespace cgcontact {

namespace {

constexpr int max_points = 100000;                            // of a probe
constexpr int max_points_of_all = 1000000;                    // of all probes: each is looked for in every body
constexpr std::size_t max_probes = 1000, max_sections = 100;  // each has a picture

/// The elements of a list that the scene may have, not too many.
std::vector<TomlCursor> few_elements(const TomlCursor& root, const std::string& key, std::size_t most) {
  std::vector<TomlCursor> nodes = optional_elements(root, key);
  if (nodes.size() > most)
    root.at(key).fail(fmt::format("has {} of them, each with a picture of its own", nodes.size()),
                      fmt::format("at most {} [[{}]]", most, key));
  return nodes;
}

int read_count(const TomlCursor& node, int least) {
  return node.at("points", fmt::format("{} to {}", least, max_points)).integer(least, max_points);
}

/// Points of a probe, those of a face aside.
int count_points(const TomlCursor& probe) {
  const auto line = probe.find("line"), circle = probe.find("circle");
  if (line && line->is_table()) return read_count(*line, 2);
  return circle && circle->is_table() ? read_count(*circle, 3) : 1;
}

void read_line(const TomlCursor& node, ProbeSpec& probe) {
  node.expect_keys({"from", "to", "points"});
  const Vec3 from = node.at("from", "[x, y, z], m").vector("m"), to = node.at("to", "[x, y, z], m").vector("m");
  const double length = (to - from).stableNorm();
  if (!(length > 0)) node.fail("has no length", "from different from to");
  const int count = read_count(node, 2);
  for (int k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / (count - 1);
    probe.points.push_back((1 - t) * from + t * to);
    probe.way.push_back(t * length);
  }
}

/// From the direction of x as seen along the axis (that of y, if the axis is x) counterclockwise.
void read_circle(const TomlCursor& node, ProbeSpec& probe) {
  node.expect_keys({"centre", "axis", "radius", "points"});
  const Vec3 centre = node.at("centre", "[x, y, z], m").vector("m");
  const Vec3 axis = node.at("axis", "[x, y, z]").direction();
  const double radius = node.at("radius", "> 0 m").number(Range::positive("m"));
  const int count = read_count(node, 3);
  constexpr double nearly_along = 0.999;
  Vec3 first = std::abs(axis[0]) < nearly_along ? Vec3::UnitX() : Vec3::UnitY();
  first = (first - first.dot(axis) * axis).normalized();
  const Vec3 second = axis.cross(first);
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * pi * k / count;
    probe.points.push_back(centre + radius * (std::cos(angle) * first + std::sin(angle) * second));
    probe.way.push_back(360.0 * k / count);
  }
}

std::vector<ScalarField> read_fields(const TomlCursor& node) {
  std::vector<ScalarField> fields;
  for (const TomlCursor& entry : node.elements("[\"von_mises\", \"principal_1\", ...]")) {
    const auto field = static_cast<ScalarField>(entry.one_of(scalar_field_names()));
    if (std::find(fields.begin(), fields.end(), field) != fields.end())
      entry.fail("is given twice", "every field once");
    fields.push_back(field);
  }
  if (fields.empty()) node.fail("names no field", "at least one field");
  return fields;
}

}  // namespace

/// Points that no body holds are remembered; an error if there are no others, or if one is not in the half-plane of
/// bodies of revolution.
void SceneReader::find_outside(const TomlCursor& node, ProbeSpec& probe) const {
  if (const BodySpec& body = scene_.bodies.front(); body.axisymmetric()) {
    constexpr double rounding = 1e-9;
    const int across = *body.axis_across();
    for (const Vec3& x : probe.points)
      if (std::abs(x[across]) > rounding * body.unit_radius)
        node.fail(fmt::format("({:.4g}, {:.4g}, {:.4g}) m is not in the half-plane of the bodies of revolution", x[0],
                              x[1], x[2]),
                  fmt::format("{} = 0", coordinate_names()[across]));
  }
  std::vector<char> held(probe.points.size(), 0);
  parallel_for("cgcontact::scene::probes", probe.points.size(), 16, [&](std::size_t i) {
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
      if (probe.body < 0 || probe.body == static_cast<int>(b)) held[i] |= scene_.bodies[b].holds(probe.points[i]);
  });
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!held[i]) probe.outside.push_back(static_cast<int>(i));
  if (probe.outside.size() < held.size()) return;
  const std::string where = probe.body < 0 ? "every body" : "body \"" + scene_.bodies[probe.body].name + "\"";
  node.fail(probe.kind == ProbeSpec::Kind::point
                ? "is outside of " + where
                : fmt::format("has all its {} points outside of {}", held.size(), where),
            "a place in a body, m, before the deformation");
}

ProbeSpec SceneReader::read_probe(const TomlCursor& node) const {
  node.expect_keys({"name", "point", "line", "circle", "face", "body", "fields"});
  ProbeSpec probe;
  probe.location = node.location();
  probe.name = read_name(node.at("name", "a name"));
  if (const auto body = node.find("body")) probe.body = body->one_of(body_names());
  const auto fields = node.find("fields");
  probe.fields =
      fields ? read_fields(*fields) : std::vector<ScalarField>{ScalarField::displacement, ScalarField::von_mises};
  const char* const kinds[] = {"point", "line", "circle", "face"};
  std::vector<TomlCursor> given;
  for (int k = 0; k < 4; ++k)
    if (const auto value = node.find(kinds[k])) {
      given.push_back(*value);
      probe.kind = static_cast<ProbeSpec::Kind>(k);
    }
  if (given.size() != 1)
    node.fail(given.empty() ? "says no place" : "says more than one place", "one of point, line, circle, face");
  const TomlCursor& where = given.front();
  if (probe.kind == ProbeSpec::Kind::face) {
    if (probe.body >= 0) node.at("body").fail("stands beside a face, which has its body", "face = \"body.face\" alone");
    probe.face = resolve_face(where);
    probe.body = probe.face.body;
    return probe;
  }
  if (probe.kind == ProbeSpec::Kind::point) {
    probe.points = {where.vector("m")};
    probe.way = {0};
  } else if (probe.kind == ProbeSpec::Kind::line) {
    read_line(where, probe);
  } else {
    read_circle(where, probe);
  }
  find_outside(where, probe);
  return probe;
}

void SceneReader::read_probes(const TomlCursor& root) {
  const std::vector<TomlCursor> nodes = few_elements(root, "probe", max_probes);
  int points = 0;
  for (const TomlCursor& node : nodes)
    if ((points += count_points(node)) > max_points_of_all)
      node.at("name").fail("with it the probes have more points than allowed",
                           fmt::format("at most {} points of all probes together", max_points_of_all));
  std::set<std::string> seen;
  for (const TomlCursor& node : nodes) {
    mistakes_.attempt([&] {
      scene_.probes.push_back(read_probe(node));
      check_unique(node.at("name"), scene_.probes.back().name, seen, "probe");
    });
  }
}

SectionSpec SceneReader::read_section(const TomlCursor& node) const {
  node.expect_keys({"name", "point", "normal", "field"});
  SectionSpec section;
  section.location = node.location();
  section.name = read_name(node.at("name", "a name"));
  section.point = node.at("point", "[x, y, z], m").vector("m");
  section.normal = node.at("normal", "[x, y, z]").direction();
  if (const auto field = node.find("field")) {
    std::vector<std::string> names = scalar_field_names();
    names.pop_back();  // the contact pressure is none of the inside
    section.field = static_cast<ScalarField>(field->one_of(names));
  }
  bool meets = false;
  for (const BodySpec& body : scene_.bodies) {
    Vec3 min, max;
    body.solid.bounding_box(min, max);
    const double middle = section.normal.dot((min + max) / 2 - section.point);
    meets |= std::abs(middle) <= section.normal.cwiseAbs().dot((max - min) / 2);
  }
  if (!meets) node.fail("is a plane that meets no body", "a point in or between the bodies, m");
  return section;
}

void SceneReader::read_sections(const TomlCursor& root) {
  std::set<std::string> seen;
  for (const TomlCursor& node : few_elements(root, "section", max_sections))
    mistakes_.attempt([&] {
      scene_.sections.push_back(read_section(node));
      check_unique(node.at("name"), scene_.sections.back().name, seen, "section");
    });
}

}  // namespace cgcontact
