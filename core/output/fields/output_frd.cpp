#include "core/output/fields/output_frd.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

constexpr int hexahedron = 1, tetrahedron = 3;              // element types he8, te4
constexpr int of_scalar = 1, of_vector = 2, of_tensor = 4;  // types of a component
constexpr int longest_title = 66;                           // of a header line, as names of materials
constexpr std::size_t bytes_per_write = std::size_t{1} << 20;

/// Text file that is written in chunks.
class TextFile {
 public:
  explicit TextFile(const std::string& name) : name_(name), file_(std::fopen(name.c_str(), "wb")) {
    if (!file_) fail(errno);
  }
  ~TextFile() {
    if (file_) std::fclose(file_);
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(waiting_), format, std::forward<Values>(values)...);
    if (waiting_.size() >= bytes_per_write) flush();
  }
  void finish() {
    flush();
    if (std::fclose(std::exchange(file_, nullptr)) != 0) fail(errno);
  }

 private:
  void flush() {
    errno = 0;
    if (std::fwrite(waiting_.data(), 1, waiting_.size(), file_) != waiting_.size()) fail(errno);
    waiting_.clear();
  }
  [[noreturn]] void fail(int reason) const {
    throw InputError(fmt::format("cannot write {}: {}", name_, std::strerror(reason)));
  }

  std::string name_;
  std::FILE* file_;
  std::string waiting_;
};

/// A name or title in a line: printable letters of one byte only, since readers count columns.
std::string plain(const std::string& text) {
  std::string result = text.substr(0, longest_title);
  std::replace_if(
      result.begin(), result.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '_');
  return result;
}

/// Node and its values: 12 columns each, so that an exponent has two digits.
template <class Values>
void add_node(TextFile& file, std::size_t node, const Values& values) {
  file.add(" -1{:10d}", node);
  for (const double value : values) file.add("{:12.5E}", std::abs(value) < 1e-99 ? 0.0 : value);
  file.add("\n");
}

struct Component {
  const char* name;
  int row, column;
};

/// number: from 1. has_length: readers compute the length of the vector as well.
void begin_dataset(TextFile& file, int number, const char* name, int type, const std::vector<Component>& components,
                   std::size_t num_nodes, bool has_length) {
  file.add("    1PSTEP{:26d}{:12d}{:12d}\n", number, 1, 1);
  file.add("  100CL  101{:12.5E}{:12d}{:22d}{:5d}{:>12s}\n", 1.0, num_nodes, 0, 1, "1");
  file.add(" -4  {:<8s}{:5d}{:5d}\n", name, components.size() + has_length, 1);
  for (const Component& c : components)
    file.add(" -5  {:<8s}{:5d}{:5d}{:5d}{:5d}{:5d}\n", c.name, 1, type, c.row, c.column, 0);
  if (has_length) file.add(" -5  {:<8s}{:5d}{:5d}{:5d}{:5d}{:5d}{}\n", "ALL", 1, type, 0, 0, 1, "ALL");
}

/// Values of all points, body after body.
template <class Member>
void add_dataset(const std::vector<DrawnBody>& bodies, const Member& member, TextFile& file) {
  std::size_t node = 0;
  for (const DrawnBody& body : bodies) {
    for (const auto& value : body.*member) add_node(file, ++node, value);
    each_interior_block(body, [&](int, const PointValues& values) {
      for (const auto& value : values.*member) add_node(file, ++node, value);
    });
  }
  file.add(" -3\n");
}

void add_mesh(const std::vector<DrawnBody>& bodies, const std::vector<std::size_t>& first_point, TextFile& file) {
  file.add("    2C{:30d}{:38d}\n", first_point.back(), 1);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t p = 0; p < bodies[b].mesh.num_points(); ++p)
      add_node(file, first_point[b] + p + 1, position_of(bodies[b], p));
  file.add(" -3\n");
  std::size_t num_elements = 0, element = 0;
  for (const DrawnBody& body : bodies) num_elements += body.mesh.num_polyhedra();
  file.add("    3C{:30d}{:38d}\n", num_elements, 1);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t i = 0; i < bodies[b].mesh.num_polyhedra(); ++i) {
      const ClippedMesh::Polyhedron polyhedron = bodies[b].mesh.polyhedron(i);
      file.add(" -1{:10d}{:5d}{:5d}{:5d}\n -2", ++element, polyhedron.num_points == 8 ? hexahedron : tetrahedron, b + 1,
               b + 1);
      for (int v = 0; v < polyhedron.num_points; ++v)
        file.add("{:10d}", first_point[b] + static_cast<std::size_t>(polyhedron.points[v]) + 1);
      file.add("\n");
    }
  file.add(" -3\n");
}

/// Nodes of the contact faces that have something opposite, ascending, with the point of the surface.
std::vector<std::pair<std::size_t, std::size_t>> contact_nodes(const ContactSurface& surface,
                                                               const std::vector<std::size_t>& first_point) {
  std::vector<std::pair<std::size_t, std::size_t>> nodes;
  std::vector<bool> taken(surface.position.size(), false);
  for (std::size_t i = 0; i < surface.size(); ++i)
    for (const int p : surface.triangles[i]) {
      if (taken[p] || !std::isfinite(surface.point_values[p][ContactSurface::gap])) continue;
      taken[p] = true;
      nodes.emplace_back(first_point[surface.body[i]] + static_cast<std::size_t>(surface.point[p]) + 1, p);
    }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

void add_contact(const ContactSurface& surface, const std::vector<std::size_t>& first_point, TextFile& file) {
  const auto nodes = contact_nodes(surface, first_point);
  if (nodes.empty()) return;
  begin_dataset(file, 3, "CONTACT", of_scalar, {{"COPEN", 0, 0}, {"CPRESS", 0, 0}, {"CPERROR", 0, 0}}, nodes.size(),
                false);
  for (const auto& [node, point] : nodes) {
    const auto& values = surface.point_values[point];
    add_node(file, node,
             std::array<double, 3>{values[ContactSurface::gap], values[ContactSurface::pressure_sprc],
                                   values[ContactSurface::pressure_error]});
  }
  file.add(" -3\n");
}

}  // namespace

void write_frd(const std::vector<DrawnBody>& bodies, const ContactSurface& surface,
               const std::vector<std::string>& names, const std::string& title, const std::string& file_name) {
  std::vector<std::size_t> first_point{0};
  for (const DrawnBody& body : bodies) first_point.push_back(first_point.back() + body.mesh.num_points());
  const auto all = [&](const auto& has) { return std::all_of(bodies.begin(), bodies.end(), has); };
  TextFile file(file_name);
  file.add("    1C{}\n    1UPGM               cgcontact\n    1UUNITS             m, N, Pa\n", plain(title));
  for (std::size_t b = 0; b < names.size(); ++b) file.add("    1UMAT{:5d}{}\n", b + 1, plain(names[b]));
  add_mesh(bodies, first_point, file);
  if (all([](const DrawnBody& body) { return !body.displacement.empty(); })) {
    begin_dataset(file, 1, "DISP", of_vector, {{"D1", 1, 0}, {"D2", 2, 0}, {"D3", 3, 0}}, first_point.back(), true);
    add_dataset(bodies, &PointValues::displacement, file);
  }
  if (all([](const DrawnBody& body) { return !body.stress.empty(); })) {
    begin_dataset(file, 2, "STRESS", of_tensor,
                  {{"SXX", 1, 1}, {"SYY", 2, 2}, {"SZZ", 3, 3}, {"SXY", 1, 2}, {"SYZ", 2, 3}, {"SZX", 3, 1}},
                  first_point.back(), false);
    add_dataset(bodies, &PointValues::stress, file);
  }
  add_contact(surface, first_point, file);
  file.add(" 9999\n");
  file.finish();
}

}  // namespace cgcontact
