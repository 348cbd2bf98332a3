#include "core/output/view/output_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/base/files/text.hpp"
#include "core/drawing/contact_fit.hpp"
#include "core/drawing/extremes.hpp"
#include "core/drawing/sampled_cells.hpp"
#include "core/drawing/thin_boundary.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/pictures/output_picture.hpp"
#include "core/output/view/packed_values.hpp"

namespace cgcontact {

namespace {

using ViewJson = nlohmann::json;

/// Bytes before base64 with pictures_beside_view: with these, and the library, some 1 MB, a page stays below 5 MB.
constexpr double bytes_for_boundaries = 1.0e6, bytes_for_insides = 0.5e6;
/// Bytes of a triangle: corners, stress error, status; of a point: position, displacement, stress. A closed boundary
/// has half as many points as triangles.
constexpr double bytes_of_triangle = 6.5, bytes_of_point = 24, bytes_of_fields = 18, points_by_triangle = 0.5;
/// Bytes of a cell or block inside: corners, stress error, status, and the values at about one corner.
constexpr double bytes_of_block = 12 + bytes_of_point;
constexpr int num_colours = 256;
/// Values at a point of a contact face: gap, pressure, its error; with friction shear, slip, wear.
constexpr std::size_t columns_without_friction = 3, contact_columns = 6;

ViewJson view_json(const Vec3& v) { return ViewJson::array({v[0], v[1], v[2]}); }

ViewJson view_json(const PackedValues& packed) {
  return {{"low", packed.low}, {"step", packed.step}, {"data", packed.data}};
}

/// Rows of values, packed; get(i) is a fixed-size vector.
template <class Get>
ViewJson packed_rows(std::size_t rows, std::size_t columns, const Get& get) {
  std::vector<double> values;
  values.reserve(rows * columns);
  for (std::size_t i = 0; i < rows; ++i) {
    const auto row = get(i);
    for (std::size_t k = 0; k < columns; ++k) values.push_back(row[static_cast<Eigen::Index>(k)]);
  }
  return view_json(pack_values(values, columns));
}

/// Positive values as their decimal logarithms: a low value keeps its digits beside a high one.
ViewJson packed_logarithms(const std::vector<double>& values) {
  std::vector<double> logarithms;
  for (const double value : values) logarithms.push_back(value > 0 ? std::log10(value) : std::nan(""));
  return view_json(pack_values(logarithms, 1));
}

/// The triangles of a contact surface by the boundary triangle that each of them is; -1: not on a contact face. Both
/// have them in the same order.
class ContactTriangles {
 public:
  explicit ContactTriangles(const ContactSurface& surface) : surface_(surface) {}

  /// Numbers those of the next body.
  std::vector<int> of_body(std::size_t body, const DrawnBody& drawn) {
    std::vector<int> number(drawn.mesh.boundary.size(), -1);
    for (std::size_t i = 0; i < number.size(); ++i)
      if (next_ < surface_.size() && surface_.body[next_] == static_cast<int>(body) &&
          is_next(drawn, drawn.mesh.boundary[i]))
        number[i] = static_cast<int>(next_++);
    return number;
  }

 private:
  bool is_next(const DrawnBody& drawn, const BoundaryTriangle& triangle) const {
    if (surface_.cell[next_] != triangle.cell) return false;
    for (int v = 0; v < 3; ++v)
      if (surface_.position[surface_.triangles[next_][v]] != drawn.position[triangle.points[v]]) return false;
    return true;
  }

  const ContactSurface& surface_;
  std::size_t next_ = 0;
};

/// Triangles of one surface, face, pair and state of contact (0: open, 1: closed, 2: and slips).
struct Group {
  int surface = 0, region = -1, pair = -1, closed = 0;
  bool operator<(const Group& o) const {
    return std::tie(surface, region, pair, closed) < std::tie(o.surface, o.region, o.pair, o.closed);
  }
};

/// Boundary of one body as the page gets it.
class BodyBoundary {
 public:
  BodyBoundary(const ViewInput& input, std::size_t body, std::vector<ThinTriangle> triangles,
               const std::vector<int>& contact_triangles)
      : input_(input), body_(body), drawn_(input.drawn[body]), triangles_(std::move(triangles)) {
    sort(contact_triangles);
    number_points(contact_triangles);
  }

  ViewJson json() const {
    ViewJson json = fields(drawn_);
    json["points"] = points_.size();
    json["position"] = packed_rows(points_.size(), 3, [&](std::size_t i) { return drawn_.position[points_[i]]; });
    json["triangles"] = pack_corners(corners_);
    json["groups"] = ViewJson::array();
    for (const auto& [group, count] : groups_)
      json["groups"].push_back({group.surface, group.region, group.pair, group.closed, count});
    add_cell_values(json);
    if (!contact_points_.empty()) json["contact"] = contact();
    return json;
  }

  /// Displacement and stress at the points.
  ViewJson fields(const PointValues& values) const {
    ViewJson json = ViewJson::object();
    if (!values.displacement.empty())
      json["displacement"] =
          packed_rows(points_.size(), 3, [&](std::size_t i) { return values.displacement[points_[i]]; });
    if (!values.stress.empty() && !input_.results.bodies[body_].rigid)
      json["stress"] = packed_rows(points_.size(), 6, [&](std::size_t i) { return values.stress[points_[i]]; });
    return json;
  }

 private:
  Group group_of(const ThinTriangle& triangle, const std::vector<int>& contact_triangles) const {
    Group group;
    group.surface = drawn_.mesh.boundary[triangle.source].surface;
    if (input_.faces) group.region = input_.faces->region_of_triangle[body_][triangle.source];
    if (const int contact = contact_triangles[triangle.source]; contact >= 0) {
      group.pair = input_.surface.pair[contact];
      group.closed = input_.surface.active[contact] ? 1 + (input_.surface.slips[contact] ? 1 : 0) : 0;
    }
    return group;
  }

  /// Sorts the triangles by group.
  void sort(const std::vector<int>& contact_triangles) {
    std::map<Group, std::vector<ThinTriangle>> sorted;
    for (const ThinTriangle& triangle : triangles_) sorted[group_of(triangle, contact_triangles)].push_back(triangle);
    triangles_.clear();
    for (const auto& [group, members] : sorted) {
      groups_.emplace_back(group, members.size());
      triangles_.insert(triangles_.end(), members.begin(), members.end());
    }
  }

  /// Numbers points in the order of their first use, those of the contact surface with them.
  void number_points(const std::vector<int>& contact_triangles) {
    std::vector<int> contact_of(drawn_.position.size(), -1);
    for (std::size_t i = 0; i < contact_triangles.size(); ++i)
      for (int v = 0; v < 3 && contact_triangles[i] >= 0; ++v)
        contact_of[drawn_.mesh.boundary[i].points[v]] = input_.surface.triangles[contact_triangles[i]][v];
    std::vector<int> number(drawn_.position.size(), -1);
    for (const ThinTriangle& triangle : triangles_)
      for (const int p : triangle.points) {
        if (number[p] < 0) {
          number[p] = static_cast<int>(points_.size());
          points_.push_back(p);
          if (contact_of[p] >= 0) {
            contact_points_.push_back(number[p]);
            contact_numbers_.push_back(contact_of[p]);
          }
        }
        corners_.push_back(number[p]);
      }
  }

  ViewJson contact() const {
    using Row = std::array<double, contact_columns>;
    const std::size_t columns = has_friction(input_.results) ? contact_columns : columns_without_friction;
    const CutCells& cells = *input_.results.bodies[body_].cut_cells;
    ContactFit fit(input_.results, static_cast<int>(body_));
    std::vector<Row> rows;
    for (std::size_t i = 0; i < contact_points_.size(); ++i) {
      const int p = points_[contact_points_[i]];
      const auto& mean = input_.surface.point_values[contact_numbers_[i]];
      rows.push_back(
          {mean[ContactSurface::gap], mean[ContactSurface::pressure_sprc], mean[ContactSurface::pressure_error]});
      if (const auto values = fit.at(drawn_.position[p], cells.h(drawn_.mesh.cell_of_point[p])))
        rows.back() = {values->gap,   values->pressure, values->pressure_error,
                       values->shear, values->slip,     values->wear};
    }
    assign_largest(rows);
    ViewJson json;
    json["points"] = pack_ascending(contact_points_);
    json["values"] = packed_rows(rows.size(), columns, [&](std::size_t i) { return rows[i]; });
    return json;
  }

  /// Fits are below the largest pressure: the point nearest to that of each pair gets it, so that it is the report's.
  /// On a quadtree nothing varies across: all points that differ in this only get it.
  void assign_largest(std::vector<std::array<double, contact_columns>>& rows) const {
    const Grid& grid = input_.results.bodies[body_].cut_cells->grid;
    constexpr double same = 1e-6;              // of a cell: rounding is far below
    std::map<int, const ContactRow*> largest;  // by pair
    for (const ContactRow& row : input_.results.contact_rows) {
      if (row.body != static_cast<int>(body_)) continue;
      const ContactRow*& most = largest[row.pair];
      if (!most || row.pressure_sprc > most->pressure_sprc) most = &row;
    }
    for (const auto& [pair, row] : largest) {
      std::size_t nearest = 0;
      const auto distance = [&, x = row->x](std::size_t i) {
        return (grid.in_layer(input_.surface.position[contact_numbers_[i]]) - grid.in_layer(x)).norm();
      };
      for (std::size_t i = 1; i < rows.size(); ++i)
        if (distance(i) < distance(nearest)) nearest = i;
      const double least = distance(nearest);
      if (!(row->pressure_sprc > 0 && least < row->larger_cell)) continue;
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (distance(i) <= least + same * row->larger_cell) rows[i][1] = std::max(rows[i][1], row->pressure_sprc);
    }
  }

  void add_cell_values(ViewJson& json) const {
    const BodyFields& fields = input_.results.bodies[body_];
    const auto cell = [&](const ThinTriangle& t) { return drawn_.mesh.boundary[t.source].cell; };
    if (!fields.error_of_cell.empty() && !fields.rigid) {
      std::vector<double> errors;
      for (const ThinTriangle& t : triangles_) errors.push_back(stress_error(fields, cell(t)));
      json["error"] = packed_logarithms(errors);
    }
    if (!fields.patch_status.empty() && !fields.rigid) {
      std::vector<unsigned char> status;
      for (const ThinTriangle& t : triangles_) status.push_back(fields.patch_status[cell(t)]);
      json["status"] = pack_bytes(status);
    }
  }

  const ViewInput& input_;
  std::size_t body_;
  const DrawnBody& drawn_;
  std::vector<ThinTriangle> triangles_;
  std::vector<std::pair<Group, std::size_t>> groups_;
  std::vector<int> points_;                            ///< of the drawn body
  std::vector<int> corners_;                           ///< of the triangles: into points_
  std::vector<int> contact_points_, contact_numbers_;  ///< into points_, ascending; into the points of the surface
};

ViewJson inside_of(const BodyFields& body, const std::vector<SceneBox>& zones, std::size_t most, int& largest_block) {
  const SampledCells sampled = sample_cells(body, zones, most);
  largest_block = std::max(largest_block, sampled.largest_block);
  ViewJson json;
  const std::size_t n = sampled.position.size();
  json["points"] = n;
  json["position"] = packed_rows(n, 3, [&](std::size_t i) { return sampled.position[i]; });
  json["displacement"] = packed_rows(n, 3, [&](std::size_t i) { return sampled.displacement[i]; });
  if (!sampled.stress.empty() && !body.rigid)
    json["stress"] = packed_rows(n, 6, [&](std::size_t i) { return sampled.stress[i]; });
  std::vector<int> corners;
  for (const auto& block : sampled.blocks) corners.insert(corners.end(), block.begin(), block.end());
  json["blocks"] = pack_corners(corners);
  if (!sampled.stress_error.empty() && !body.rigid) json["error"] = packed_logarithms(sampled.stress_error);
  if (!sampled.status.empty() && !body.rigid) json["status"] = pack_bytes(sampled.status);
  return json;
}

/// The largest values of the report with their positions.
ViewJson extremes_of_body(const Extremes& most) {
  const auto one = [](const Extreme& extreme) {
    return ViewJson{{"value", extreme.value}, {"at", view_json(extreme.at)}};
  };
  ViewJson json;
  json["von_mises"]["max"] = one(most.von_mises);
  json["tresca"]["max"] = one(most.tresca);
  json["principal_1"]["max"] = one(most.tension);
  json["principal_3"]["min"] = one(most.compression);
  json["displacement"]["max"] = one(most.displacement);
  if (most.pressure && most.pressure->value > 0) json["pressure"]["max"] = one(*most.pressure);
  return json;
}

ViewJson faces_of(const ViewInput& input) {
  ViewJson faces = ViewJson::array();
  if (!input.faces) return faces;
  for (std::size_t r = 0; r < input.faces->regions.size(); ++r) {
    const FaceRegion& region = input.faces->regions[r];
    faces.push_back({{"name", region.name},
                     {"role", role_name(region)},
                     {"colour", hex(input.faces->colours[r])},
                     {"text", input.scene ? conditions(*input.scene, region) : ""},
                     {"force", view_json(region.force)},
                     {"motion", view_json(prescribed(region))},
                     {"at", view_json(region.centroid)}});
  }
  return faces;
}

/// Planes of symmetry, each once: a point and the normal of the faces on it.
ViewJson symmetry_planes(const ViewInput& input) {
  ViewJson planes = ViewJson::array();
  if (!input.faces) return planes;
  std::vector<std::pair<Vec3, Vec3>> found;
  constexpr double same = 1e-6;  // of length 1, or of the size of the face: rounding is far below
  for (std::size_t b = 0; b < input.drawn.size(); ++b) {
    const DrawnBody& body = input.drawn[b];
    std::map<int, Vec3> normals;
    for (std::size_t i = 0; i < body.mesh.boundary.size(); ++i) {
      const auto& t = body.mesh.boundary[i].points;
      const int region = input.faces->region_of_triangle[b][i];
      if (region < 0 || !input.faces->regions[region].symmetry) continue;
      const Vec3& a = body.position[t[0]];
      normals.try_emplace(region, Vec3::Zero()).first->second +=
          (body.position[t[1]] - a).cross(body.position[t[2]] - a) / 2;
    }
    for (const auto& [region, sum] : normals) {
      const FaceRegion& face = input.faces->regions[region];
      if (sum.norm() < (1 - same) * face.area) continue;  // not plane
      const Vec3 n = sum.normalized();
      const bool known = std::any_of(found.begin(), found.end(), [&](const auto& plane) {
        return std::abs(plane.second.dot(n)) > 1 - same &&
               std::abs(n.dot(face.centroid - plane.first)) < same * std::sqrt(face.area);
      });
      if (!known) found.emplace_back(face.centroid, n);
    }
  }
  for (const auto& [point, normal] : found)
    planes.push_back({{"point", view_json(point)}, {"normal", view_json(normal)}});
  return planes;
}

ViewJson pairs_of(const Results& results) {
  ViewJson pairs = ViewJson::array();
  for (std::size_t k = 0; k < results.pairs.size(); ++k) {
    const PairFigures& pair = results.pairs[k];
    ViewJson json{{"name", pair.name}, {"bodies", {pair.body_first, pair.body_second}}};
    if (const auto zone = zone_of_pair(results, static_cast<int>(k)))
      json["zone"] = {{"low", view_json(zone->box.low)},
                      {"high", view_json(zone->box.high)},
                      {"axis", zone->axis},
                      {"normal", view_json(zone->normal)}};
    pairs.push_back(json);
  }
  return pairs;
}

/// Returns the boxes of the pairs' zones. On a quadtree, whose points of contact lie in its middle, they reach through
/// it.
std::vector<SceneBox> zones_of(const ViewInput& input) {
  const Results& results = input.results;
  std::vector<SceneBox> zones;
  for (std::size_t k = 0; k < results.pairs.size(); ++k)
    if (const auto zone = zone_of_pair(results, static_cast<int>(k))) zones.push_back(zone->box);
  const Grid& grid = results.bodies.front().cut_cells->grid;
  if (!grid.is_quadtree()) return zones;
  int across = 0;
  grid.rotation.col(grid.plane_strain).cwiseAbs().maxCoeff(&across);
  SceneBox all;
  for (const DrawnBody& body : input.drawn)
    for (const Vec3& x : body.position) all.add(x);
  for (SceneBox& zone : zones) {
    zone.low[across] = all.low[across];
    zone.high[across] = all.high[across];
  }
  return zones;
}

/// Finds the axis of revolution; -1: there is none.
int axis_of_revolution(const Results& results) {
  const Grid& grid = results.bodies.front().cut_cells->grid;
  return grid.is_axisymmetric() ? grid.axis_of_revolution() : -1;
}

std::string palette() {
  std::vector<unsigned char> bytes;
  for (int i = 0; i < num_colours; ++i)
    for (const double channel : palette_colour(i / (num_colours - 1.0)))
      bytes.push_back(static_cast<unsigned char>(std::lround(255 * channel)));
  return pack_bytes(bytes);
}

std::string note_on_size(std::size_t drawn, std::size_t all, int largest_block) {
  std::string text;
  if (drawn < all)
    text += fmt::format("The boundary has {} triangles here of {}, fewer of them away from the contact. ",
                        grouped(static_cast<long long>(drawn)), grouped(static_cast<long long>(all)));
  if (largest_block > 1)
    text += fmt::format("Sections show blocks of up to {} cells along a side, smaller ones near the contact. ",
                        largest_block);
  return text;
}

/// Text in a script element must not end it, nor be markup where the page is read as XML.
std::string harmless(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<' || c == '>' || c == '&')
      text += fmt::format("\\u{:04x}", static_cast<int>(c));
    else
      text += c;
  }
  return text;
}

/// Writes the bodies and their steps; says how many triangles are drawn of how many.
ViewJson bodies_of(const ViewInput& input, const std::vector<SceneBox>& zones, ViewJson& steps, std::string& left_out) {
  const double fields = bytes_of_point + bytes_of_fields * static_cast<double>(input.steps.size());
  const double most = bytes_for_boundaries / (bytes_of_triangle + points_by_triangle * fields);
  std::vector<std::vector<ThinTriangle>> thin = thin_boundaries(input.drawn, zones, static_cast<std::size_t>(most));
  double cells = 0;
  for (const BodyFields& body : input.results.bodies) cells += static_cast<double>(body.cut_cells->cells.size());
  ContactTriangles contact(input.surface);
  ViewJson bodies = ViewJson::array();
  std::size_t drawn = 0, all = 0;
  int largest_block = 1;
  for (std::size_t b = 0; b < input.drawn.size(); ++b) {
    const BodyFields& body = input.results.bodies[b];
    drawn += thin[b].size();
    all += input.drawn[b].mesh.boundary.size();
    const BodyBoundary boundary(input, b, std::move(thin[b]), contact.of_body(b, input.drawn[b]));
    ViewJson json = boundary.json();
    json["name"] = body.name;
    json["colour"] = hex(colour_of_body(b));
    const double share = static_cast<double>(body.cut_cells->cells.size()) / cells;
    json["inside"] =
        inside_of(body, zones, static_cast<std::size_t>(share * bytes_for_insides / bytes_of_block), largest_block);
    if (b < input.results.extremes.size()) json["extremes"] = extremes_of_body(input.results.extremes[b].body);
    for (std::size_t k = 0; k < input.steps.size(); ++k)
      steps[k]["bodies"].push_back(boundary.fields(input.steps[k].bodies[b]));
    bodies.push_back(json);
  }
  left_out = note_on_size(drawn, all, largest_block);
  if (axis_of_revolution(input.results) >= 0)
    left_out += "Bodies of revolution are their section turned by 270°; r is the distance from the axis. ";
  return bodies;
}

}  // namespace

ViewData view_data(const ViewInput& input) {
  const Results& results = input.results;
  ViewData view;
  if (input.drawn.empty()) return view;
  const SceneView look = direction_to_scene(results, input.drawn);
  ViewJson json;
  json["steps"] = ViewJson::array();
  for (const ViewStep& step : input.steps) json["steps"].push_back({{"number", step.number + 1}});
  json["bodies"] = bodies_of(input, zones_of(input), json["steps"], view.left_out);
  json["faces"] = faces_of(input);
  json["pairs"] = pairs_of(results);
  json["symmetry"] = symmetry_planes(input);
  json["palette"] = palette();
  json["eye"] = view_json(look.camera.eye);
  json["up"] = view_json(look.camera.up);
  json["flat"] = look.thin_axis;
  json["axis"] = axis_of_revolution(results);
  json["exaggeration"] = picture_exaggeration(results, look.box);
  json["status_names"] = results.patch_statuses;
  view.alternative = result_in_words(results);
  json["alternative"] = view.alternative;
  view.json = harmless(json.dump(-1, ' ', false, ViewJson::error_handler_t::replace));
  return view;
}

std::string result_in_words(const Results& results) {
  std::string text;
  const auto add = [&](const std::string& words) { text += (text.empty() ? "" : "; ") + words; };
  if (const int s = body_with_largest(results.extremes, &Extremes::von_mises); s >= 0) {
    const Extreme& most = results.extremes[s].body.von_mises;
    add(fmt::format("largest von Mises stress {} in {} at {}", scaled(most.value, "Pa"), results.bodies[s].name,
                    position_text(most.at)));
  }
  if (const int u = body_with_largest(results.extremes, &Extremes::displacement); u >= 0) {
    const Extreme& most = results.extremes[u].body.displacement;
    const DisplayUnit unit = length_unit(most.value);
    add(fmt::format("largest displacement {} {} in {} at {}", short_number(most.value * unit.factor), unit.name,
                    results.bodies[u].name, position_text(most.at)));
  }
  for (const PairFigures& pair : results.pairs)
    if (pair.max_pressure > 0)
      add(fmt::format("largest contact pressure of {} {} at {}", pair.name, scaled(pair.max_pressure, "Pa"),
                      position_text(pair.max_pressure_at)));
  return text;
}

}  // namespace cgcontact
