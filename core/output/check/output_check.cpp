#include "core/output/check/output_check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/base/process/parallel.hpp"
#include "core/drawing/drawn_body.hpp"
#include "core/drawing/render.hpp"
#include "core/output/check/output_repair.hpp"
#include "core/output/fields/output_vtk.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/pictures/picture_sheet.hpp"
#include "core/program/scratch_folder.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr int legend_width = 620;
/// Bodies that get rows of their own.
constexpr std::size_t max_drawn_bodies = 12;
/// Pixels: a face gets its number where it is at least this far from its border.
constexpr int room_for_number = 7;
constexpr int arrow_length = 56, arrow_gap = 14;

constexpr Rgb full_cell{0.66, 0.80, 0.91}, cut_cell{0.95, 0.66, 0.33}, cut_outside{0.99, 0.92, 0.82}, no_cell{1, 1, 1},
    grid_line{0.62, 0.65, 0.70}, unknown_face{0.5, 0.5, 0.5};

/// Pixels, across the stripes of a face on which several things hold.
constexpr int stripe = 9;
/// Radius of the arc that stands for a moment, pixels; its segments.
constexpr double arc_radius = 24;
constexpr int arc_segments = 18;

/// Role of a region, which decides its hue: supports, loads and contact are distinguished at a glance.
enum class Role { free, support, load, contact };

/// The first one is the colour of the face, the others are stripes on it.
std::vector<Role> roles_of(const FaceRegion& region) {
  std::vector<Role> roles;
  if (!region.loads.empty()) roles.push_back(Role::load);
  if (!region.supports.empty()) roles.push_back(Role::support);  // also where a contact names the whole face
  if (!region.contacts.empty()) roles.push_back(Role::contact);
  if (roles.empty()) roles.push_back(Role::free);
  return roles;
}

Role role_of(const FaceRegion& region) { return roles_of(region).front(); }

/// Returns whether the moment of the loads is what they are for, and not what a varying pressure has beside its
/// resultant.
bool shows_moment(const Scene& scene, const FaceRegion& region) {
  if (region.moment.isZero(0)) return false;
  return region.force.isZero(0) ||
         std::any_of(region.loads.begin(), region.loads.end(), [&](int l) { return !scene.loads[l].moment.isZero(0); });
}

Rgb colour_of(Role role, int k) {
  static const Rgb free[] = {{0.88, 0.87, 0.84}, {0.78, 0.77, 0.74}, {0.93, 0.92, 0.90}, {0.70, 0.69, 0.67}};
  static const Rgb support[] = {{0.33, 0.55, 0.86}, {0.55, 0.73, 0.95}, {0.20, 0.38, 0.70}, {0.45, 0.50, 0.90}};
  static const Rgb load[] = {{0.90, 0.36, 0.28}, {0.97, 0.60, 0.45}, {0.72, 0.20, 0.25}, {0.95, 0.45, 0.60}};
  static const Rgb contact[] = {{0.30, 0.70, 0.40}, {0.58, 0.83, 0.52}, {0.13, 0.50, 0.33}, {0.45, 0.75, 0.65}};
  switch (role) {
    case Role::support:
      return support[k % 4];
    case Role::load:
      return load[k % 4];
    case Role::contact:
      return contact[k % 4];
    default:
      return free[k % 4];
  }
}

/// All that the panels draw from.
struct Drawing {
  const Scene& scene;
  const std::vector<CheckedBody>& bodies;
  const std::vector<FaceRegion>& regions;
  const std::vector<DrawnBody>& drawn;                      ///< boundaries at least
  const std::vector<std::vector<int>>& region_of_triangle;  ///< by body
  const std::vector<Rgb>& region_colours;
  std::string folder;  ///< of gnuplot's data
};

/// Draws bodies coloured by `colour(body, triangle)`, with outlines between different `region_of(body, triangle)`.
template <class Colour, class RegionOf>
RenderedImage draw(const Drawing& drawing, const std::vector<std::size_t>& bodies, const Panel& view,
                   const Colour& colour, const RegionOf& region_of) {
  std::vector<std::pair<std::size_t, std::size_t>> triangles;
  for (std::size_t b : bodies)
    for (std::size_t i = 0; i < drawing.drawn[b].mesh.boundary.size(); ++i) triangles.emplace_back(b, i);
  const auto triangle = [&](std::size_t k) {
    const auto [b, i] = triangles[k];
    const DrawnBody& body = drawing.drawn[b];
    const double value = packed(colour(b, i));
    return raster_triangle(
        body.mesh, body.mesh.boundary[i], region_of(b, i), [&](int p) { return body.position[p]; },
        [&](int) { return value; });
  };
  return render(view.size, view.camera, unpacked, 0.7, triangles.size(), triangle);
}

/// Pixel farthest from the border of a region, and that distance.
struct Spot {
  int x = 0, y = 0, room = 0;
};

std::map<int, Spot> roomiest_pixels(const RenderedImage& image) {
  const int w = image.width, h = image.height;
  std::vector<int> room(image.regions.size());
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * w + x; };
  const auto neighbour = [&](int x, int y, int dx, int dy) {
    const int nx = x + dx, ny = y + dy;
    if (nx < 0 || ny < 0 || nx >= w || ny >= h || image.regions[at(nx, ny)] != image.regions[at(x, y)]) return 0;
    return room[at(nx, ny)];
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) room[at(x, y)] = 1 + std::min(neighbour(x, y, -1, 0), neighbour(x, y, 0, -1));
  std::map<int, Spot> spots;
  for (int y = h - 1; y >= 0; --y)
    for (int x = w - 1; x >= 0; --x) {
      room[at(x, y)] = std::min(room[at(x, y)], 1 + std::min(neighbour(x, y, 1, 0), neighbour(x, y, 0, 1)));
      const int region = image.regions[at(x, y)];
      if (region < 0) continue;
      Spot& spot = spots[region];
      if (room[at(x, y)] > spot.room) spot = {x, y, room[at(x, y)]};
    }
  return spots;
}

/// An arrow that ends a little before a pixel; nothing if it points at the viewer.
void add_arrow(const Panel& view, const Spot& spot, const Vec3& direction, const char* colour, Sheet& sheet) {
  const double x = view.camera.right.dot(direction), y = view.camera.up.dot(direction), length = std::hypot(x, y);
  if (!(length > 0.15 * direction.norm())) return;
  const double tip[2] = {view.left + spot.x - arrow_gap * x / length, view.bottom + spot.y - arrow_gap * y / length};
  sheet.settings +=
      fmt::format("set arrow from {},{} to {},{} front filled size 11,22 lw 2.5 lc rgb '{}'\n",
                  tip[0] - arrow_length * x / length, tip[1] - arrow_length * y / length, tip[0], tip[1], colour);
}

/// Arc with a point around the axis of a moment, by the right hand, and the axis.
void add_moment(const Panel& view, const Spot& spot, const Vec3& moment, Sheet& sheet) {
  const Vec3 axis = moment.normalized();
  const Vec3 first = axis.cross(std::abs(axis[2]) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized();
  const Vec3 second = axis.cross(first);
  const auto on_sheet = [&](const Vec3& x) {
    return std::array<double, 2>{view.left + spot.x + view.camera.right.dot(x),
                                 view.bottom + spot.y + view.camera.up.dot(x)};
  };
  const auto line = [&](const std::array<double, 2>& from, const std::array<double, 2>& to, const char* style) {
    sheet.settings +=
        fmt::format("set arrow from {},{} to {},{} front {} lc rgb '#a00010'\n", from[0], from[1], to[0], to[1], style);
  };
  line(on_sheet(-1.2 * arc_radius * axis), on_sheet(1.2 * arc_radius * axis), "nohead lw 1 dt (6,4)");
  constexpr double whole = 1.7 * pi;  // an open arc
  std::array<double, 2> before = on_sheet(arc_radius * first);
  for (int k = 1; k <= arc_segments; ++k) {
    const double angle = whole * k / arc_segments;
    const std::array<double, 2> next = on_sheet(arc_radius * (std::cos(angle) * first + std::sin(angle) * second));
    line(before, next, k < arc_segments ? "nohead lw 2.5" : "filled size 11,22 lw 2.5");
    before = next;
  }
}

/// Stripes in the colours of all that holds on a face, in its shading.
void add_stripes(const Drawing& drawing, RenderedImage& image) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * image.width + x;
      const int r = image.regions[pixel];
      if (r < 0 || r >= static_cast<int>(drawing.regions.size())) continue;
      const std::vector<Role> roles = roles_of(drawing.regions[r]);
      const std::size_t k = static_cast<std::size_t>((x + y) / stripe) % roles.size();
      if (k == 0) continue;
      const Rgb from = drawing.region_colours[r], to = colour_of(roles[k], 0);
      for (std::size_t c = 0; c < 3; ++c) {
        char& channel = image.pixels[3 * pixel + c];
        const double shaded = static_cast<unsigned char>(channel) * to[c] / std::max(from[c], 0.05);
        channel = static_cast<char>(static_cast<unsigned char>(std::lround(std::min(shaded, 255.0))));
      }
    }
}

/// Numbers of the faces that can be seen, arrows for loads, moments and prescribed displacements.
void add_marks(const Drawing& drawing, const Panel& view, const RenderedImage& image, Sheet& sheet) {
  for (const auto& [region, spot] : roomiest_pixels(image)) {
    if (region >= static_cast<int>(drawing.regions.size())) continue;
    const FaceRegion& face = drawing.regions[region];
    if (spot.room >= room_for_number)
      sheet.label(std::to_string(region + 1), view.left + spot.x, view.bottom + spot.y,
                  "center front boxed font ',13'");
    if (face.force.norm() > 0) add_arrow(view, spot, face.force, "#a00010", sheet);
    if (shows_moment(drawing.scene, face)) add_moment(view, spot, face.moment, sheet);
    if (prescribed(face).norm() > 0) add_arrow(view, spot, prescribed(face), "#103a90", sheet);
  }
}

/// Active cell that holds a point of a body's grid, and the level of the leaf there; -1: none.
std::pair<int, int> cell_at(const CutCells& cells, const Vec3& x) {
  int leaf = 0;
  for (int l = 0; l < cells.num_levels(); ++l) {
    const Vec3 y = std::ldexp(1.0, l) * x;
    const Index3 c{static_cast<int>(std::floor(y[0])), static_cast<int>(std::floor(y[1])),
                   static_cast<int>(std::floor(y[2]))};
    leaf = l;
    if (const int found = cells.find(l, c); found >= 0) return {found, l};
    if (!cells.tree || !cells.tree->is_refined(l, c)) break;
  }
  return {-1, leaf};
}

/// Colour of a point of a body's grid in the slice.
Rgb slice_colour(const CutCells& cells, const Vec3& x, double cells_per_pixel, int axis) {
  bool in_grid = true;
  for (int k = 0; k < 3; ++k) in_grid &= x[k] >= 0 && x[k] < cells.grid.num_cells[k];
  if (!in_grid) return no_cell;
  const auto [active, level] = cell_at(cells, x);
  const double halvings = std::ldexp(1.0, level);
  if (halvings * cells_per_pixel < 0.2)
    for (int k = 0; k < 3; ++k) {
      const double at = halvings * x[k];
      if (k != axis && std::abs(at - std::round(at)) < 0.55 * halvings * cells_per_pixel) return grid_line;
    }
  if (active < 0) return no_cell;
  if (cells.cut_of_active[active] < 0) return full_cell;
  return cells.solid.contains(x) ? cut_cell : cut_outside;
}

/// Slice through the middle of a body's grid, across the direction with the fewest cells.
RenderedImage draw_slice(const CutCells& cells) {
  const Index3& n = cells.grid.num_cells;
  const int axis = static_cast<int>(std::min_element(n.begin(), n.end()) - n.begin());
  const int right = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  const double step = static_cast<double>(std::max(n[right], n[up])) / (0.94 * panel);
  const double layer = n[axis] / 2 + 0.5;  // NOLINT(bugprone-integer-division): the middle of a cell
  RenderedImage image{panel, panel, std::string(std::size_t{3} * panel * panel, '\0'), {}};
  parallel_for("cgcontact::output_check::panel", panel, 8, [&](std::size_t row) {
    for (int column = 0; column < panel; ++column) {
      Vec3 x = Vec3::Constant(layer);
      x[right] = n[right] / 2.0 + (column + 0.5 - panel / 2.0) * step;
      x[up] = n[up] / 2.0 + (static_cast<double>(row) + 0.5 - panel / 2.0) * step;
      const Rgb colour = slice_colour(cells, x, step, axis);
      for (std::size_t k = 0; k < 3; ++k)
        image.pixels[3 * (row * panel + static_cast<std::size_t>(column)) + k] =
            static_cast<char>(static_cast<unsigned char>(std::lround(255 * colour[k])));
    }
  });
  return image;
}

void add_boundary_points(const DrawnBody& body, std::vector<Vec3>& points) {
  std::vector<char> is_added(body.position.size(), 0);
  for (const BoundaryTriangle& triangle : body.mesh.boundary)
    for (const int p : triangle.points)
      if (!std::exchange(is_added[p], char{1})) points.push_back(body.position[p]);
}

/// Adds both views of some bodies; outlines separate different values of `region_of`.
template <class Colour, class RegionOf>
void add_views(const Drawing& drawing, const std::vector<std::size_t>& bodies, double bottom, const std::string& name,
               const Colour& colour, const RegionOf& region_of, bool numbered, Sheet& sheet) {
  std::vector<Vec3> positions;
  for (std::size_t b : bodies) add_boundary_points(drawing.drawn[b], positions);
  for (const bool behind : {false, true}) {
    Panel view;
    view.left = gap + (behind ? panel + gap : 0);
    view.bottom = bottom;
    look_from(behind, view.camera);
    view.fit(positions);
    RenderedImage image = draw(drawing, bodies, view, colour, region_of);
    if (numbered) add_stripes(drawing, image);
    sheet.add_panel(view, image, name + (behind ? "_behind" : "_front"),
                    behind ? "from below, behind" : "from above, in front", drawing.folder);
    sheet.add_axes_and_scale(view);
    if (numbered) add_marks(drawing, view, image, sheet);
  }
}

void add_overview(const Drawing& drawing, double bottom, Sheet& sheet) {
  std::vector<std::size_t> all(drawing.drawn.size());
  for (std::size_t b = 0; b < all.size(); ++b) all[b] = b;
  sheet.heading(drawable_text(drawing.scene.title.empty() ? drawing.scene.file : drawing.scene.title), bottom);
  add_views(
      drawing, all, bottom, "scene", [](std::size_t b, std::size_t) { return colour_of_body(b); },
      [](std::size_t b, std::size_t) { return static_cast<int>(b); }, false, sheet);
  Legend legend(gap + 2.0 * (panel + gap), bottom + panel - 20, bottom, sheet);
  for (std::size_t b = 0; b < drawing.drawn.size(); ++b) {
    const CutCells& cells = *drawing.bodies[b].cut_cells;
    legend.entry(colour_of_body(b), fmt::format("{}: {} cells of {}, {} of them cut", drawing.scene.bodies[b].name,
                                                grouped(static_cast<long long>(cells.cells.size())), sizes_of(cells),
                                                grouped(static_cast<long long>(cells.active_of_cut.size()))));
  }
  std::set<int> contacts;
  for (const FaceRegion& region : drawing.regions) contacts.insert(region.contacts.begin(), region.contacts.end());
  for (int c : contacts) {
    const ContactSpec& contact = drawing.scene.contacts[c];
    legend.words(fmt::format("contact {}: {} and {}", contact.name, drawing.scene.bodies[contact.first.body].name,
                             drawing.scene.bodies[contact.second.body].name));
  }
  legend.words("");
  legend.words("Colours of the faces below:");
  for (const auto& [role, name] : {std::pair<Role, const char*>{Role::support, "support (arrow: prescribed motion)"},
                                   {Role::load, "load (arrow: its direction; arc: a moment)"},
                                   {Role::contact, "contact"},
                                   {Role::free, "free"}})
    legend.entry(colour_of(role, 0), name);
  legend.words("stripes: several of them on one face");
  legend.finish("see check_faces.vtkhdf");
}

/// A body from both sides with its faces numbered.
void add_faces(const Drawing& drawing, std::size_t b, double bottom, Sheet& sheet) {
  const auto region = [&](std::size_t body, std::size_t i) { return drawing.region_of_triangle[body][i]; };
  const auto colour = [&](std::size_t body, std::size_t i) {
    const int r = region(body, i);
    return r < 0 ? unknown_face : drawing.region_colours[r];
  };
  const int none = static_cast<int>(drawing.regions.size());
  const auto region_or_none = [&](std::size_t body, std::size_t i) {
    return region(body, i) < 0 ? none : region(body, i);
  };
  sheet.heading(drawing.scene.bodies[b].name, bottom);
  add_views(drawing, {b}, bottom, fmt::format("body{}", b), colour, region_or_none, true, sheet);
}

void add_body(const Drawing& drawing, std::size_t b, double bottom, Sheet& sheet) {
  add_faces(drawing, b, bottom, sheet);
  const std::string name = fmt::format("body{}", b);
  Panel slice;
  slice.left = gap + 2.0 * (panel + gap);
  slice.bottom = bottom;
  sheet.add_panel(slice, draw_slice(*drawing.bodies[b].cut_cells), name + "_slice",
                  "slice through the grid: full cells blue, cut cells orange", drawing.folder);
  Legend legend(gap + 3.0 * (panel + gap), bottom + panel - 10, bottom, sheet);
  for (std::size_t r = 0; r < drawing.regions.size(); ++r) {
    const FaceRegion& face = drawing.regions[r];
    if (face.body != static_cast<int>(b)) continue;
    legend.entry(drawing.region_colours[r],
                 fmt::format("{}  {}: {} ({})", r + 1, face.name, conditions(drawing.scene, face),
                             in_unit(face.area, area_unit(face.area))));
  }
  legend.finish("see check_faces.vtkhdf");
}

Sheet check_sheet(const Drawing& drawing) {
  const std::size_t shown = std::min(drawing.drawn.size(), max_drawn_bodies);
  const int row = panel + heading + gap;
  const int width = 4 * gap + 3 * panel + legend_width, height = row * static_cast<int>(shown + 1) + gap;
  const std::string text = page_settings("check.png", width, height);
  Sheet sheet;
  add_overview(drawing, height - row, sheet);
  for (std::size_t b = 0; b < shown; ++b) add_body(drawing, b, height - row * static_cast<int>(b + 2), sheet);
  if (shown < drawing.drawn.size())
    sheet.label(fmt::format("and {} more bodies, see check_faces.vtkhdf", drawing.drawn.size() - shown), gap, gap / 2.0,
                "left");
  sheet.settings = text + sheet.settings + plot_nothing;
  return sheet;
}

/// Two views of each body, without legends.
Sheet conditions_sheet(const Drawing& drawing) {
  const std::size_t shown = std::min(drawing.drawn.size(), max_drawn_bodies);
  const int row = panel + heading + gap, key = 2 * line_height;
  const int width = 3 * gap + 2 * panel, height = row * static_cast<int>(shown) + gap + key;
  const std::string text = page_settings("conditions.png", width, height);
  Sheet sheet;
  for (std::size_t b = 0; b < shown; ++b) add_faces(drawing, b, height - row * static_cast<int>(b + 1), sheet);
  double left = gap;
  for (const auto& [role, name] : {std::pair<Role, const char*>{Role::support, "support"},
                                   {Role::load, "load"},
                                   {Role::contact, "contact"},
                                   {Role::free, "free"}}) {
    Legend legend(left, key, 0, sheet);
    legend.entry(colour_of(role, 0), name);
    left += 130;
  }
  sheet.label("red: loads, arcs: moments; blue: motions", left, key, "left font ',12'");
  sheet.settings = text + sheet.settings + plot_nothing;
  return sheet;
}

std::vector<int> regions_of_triangles(const MarkedFaces& faces, int b, const DrawnBody& drawn, const CutCells& cells) {
  std::vector<int> regions;
  for (const BoundaryTriangle& triangle : drawn.mesh.boundary) {
    const Vec3 &a = drawn.position[triangle.points[0]], &p = drawn.position[triangle.points[1]],
               &q = drawn.position[triangle.points[2]];
    const bool known = triangle.surface < static_cast<int>(cells.solid.surfaces().size());
    regions.push_back(
        known ? faces.region_at(b, triangle.cell, triangle.surface, (a + p + q) / 3, (p - a).cross(q - a).normalized())
              : -1);
  }
  return regions;
}

std::vector<DrawnBody> draw_boundaries(const std::vector<CheckedBody>& bodies) {
  std::vector<DrawnBody> drawn(bodies.size());
  parallel_for("cgcontact::output_check::draw_bodies", bodies.size(), 1, [&](std::size_t b) {
    BodyFields fields;
    fields.cut_cells = bodies[b].cut_cells;
    drawn[b] = draw_body(fields, clip_boundary(*fields.cut_cells));
  });
  return drawn;
}

/// Cell array over all triangles; first(region) gives the value.
template <class First>
BoundaryArray region_array(const Drawing& drawing, const std::string& name, const std::string& names,
                           const First& first) {
  BoundaryArray array{name, names, {}};
  for (const std::vector<int>& regions : drawing.region_of_triangle)
    for (int r : regions) array.values.push_back(r < 0 ? -1 : first(r, drawing.regions[r]));
  return array;
}

void write_faces(const Drawing& drawing, const std::string& file_name) {
  std::string names;
  for (std::size_t r = 0; r < drawing.regions.size(); ++r)
    names += fmt::format("{}{} {}", r ? ", " : "", r + 1, drawing.regions[r].name);
  const auto first = [](const std::vector<int>& list) { return list.empty() ? -1 : list.front(); };
  write_vtk_boundary(
      drawing.drawn,
      {region_array(drawing, "body", "", [](int, const FaceRegion& r) { return r.body; }),
       region_array(drawing, "face", names, [](int index, const FaceRegion&) { return index + 1; }),
       region_array(drawing, "support", "", [&](int, const FaceRegion& r) { return first(r.supports); }),
       region_array(drawing, "load", "", [&](int, const FaceRegion& r) { return first(r.loads); }),
       region_array(drawing, "contact", "", [&](int, const FaceRegion& r) { return first(r.contacts); })},
      file_name);
}

/// False: there is no such file.
bool deliver(const std::string& name, const fs::path& from, const fs::path& to) {
  if (!fs::exists(from / name)) return false;
  fs::rename(from / name, to / name);
  return true;
}

}  // namespace

DrawnFaces find_faces(const Scene& scene, const std::vector<CheckedBody>& bodies, const std::vector<DrawnBody>& drawn) {
  const MarkedFaces faces(scene, bodies);
  DrawnFaces found{faces.regions(), std::vector<std::vector<int>>(bodies.size()), {}};
  parallel_for("cgcontact::output_check::regions", bodies.size(), 1, [&](std::size_t b) {
    found.region_of_triangle[b] = regions_of_triangles(faces, static_cast<int>(b), drawn[b], *bodies[b].cut_cells);
  });
  std::map<std::pair<int, Role>, int> shades;
  for (const FaceRegion& region : found.regions) {
    const Role role = role_of(region);
    found.colours.push_back(colour_of(role, shades[{region.body, role}]++));
  }
  return found;
}

const char* role_name(const FaceRegion& region) {
  constexpr const char* names[] = {"free", "support", "load", "contact"};
  return names[static_cast<int>(role_of(region))];
}

Vec3 prescribed(const FaceRegion& region) {
  Vec3 u = Vec3::Zero();
  double largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = region.low_displacement[k], high = region.high_displacement[k];
    if (low > high) continue;
    largest = std::max({largest, std::abs(low), std::abs(high)});
    if (low >= 0 || high <= 0) u[static_cast<Eigen::Index>(k)] = (low + high) / 2;
  }
  return without_rounding(u, largest);
}

std::string conditions(const Scene& scene, const FaceRegion& region) {
  std::string text;
  const auto add = [&](const std::string& condition) { text += (text.empty() ? "" : "; ") + condition; };
  for (int c : region.contacts) add("contact " + scene.contacts[c].name);
  if (region.symmetry) add("symmetry");
  if (region.elastic) add("springs");
  for (std::size_t k = 0; k < num_held; ++k) {
    const char* const name = name_of(static_cast<Held>(k));
    const double low = region.low_displacement[k], high = region.high_displacement[k];
    if (low > high) continue;
    const DisplayUnit unit = length_unit(std::max(std::abs(low), std::abs(high)));
    if (low == 0 && high == 0)
      add(fmt::format("held: {} = 0", name));
    else
      add(fmt::format("moved: {} = {}{}", name, low == high ? "" : short_number(low * unit.factor) + " .. ",
                      in_unit(high, unit)));
  }
  if (!region.force.isZero(0)) add("load " + vector_text(region.force, force_unit(region.force.norm())));
  if (shows_moment(scene, region)) add("moment " + vector_text(region.moment, DisplayUnit{1, "N m"}));
  if (!region.loads.empty() && region.force.isZero(0) && region.moment.isZero(0)) add("load without a resultant");
  return text.empty() ? "free" : text;
}

std::vector<ConditionFace> draw_conditions(const Scene& scene, const std::vector<CheckedBody>& bodies,
                                           const std::vector<DrawnBody>& drawn, const DrawnFaces& found,
                                           GnuplotRuns& runs) {
  const Drawing drawing{
      scene, bodies, found.regions, drawn, found.region_of_triangle, found.colours, runs.directory() + "/plots"};
  const Sheet sheet = conditions_sheet(drawing);
  runs.start_layered("conditions", sheet.settings, {{"conditions.png", sheet.panels}});
  std::vector<ConditionFace> list;
  for (std::size_t r = 0; r < found.regions.size(); ++r) {
    const FaceRegion& face = found.regions[r];
    if (role_of(face) != Role::free)
      list.push_back({static_cast<int>(r) + 1, face.name, conditions(scene, face), face.area});
  }
  return list;
}

CheckFiles write_check(const Scene& scene, const std::vector<CheckedBody>& bodies, const std::string& directory) try {
  const ScratchFolder workshop(fs::path(directory) / fmt::format(".check.tmp-{}", getpid()));
  fs::create_directory(workshop.path() / "plots");
  const std::vector<DrawnBody> drawn = draw_boundaries(bodies);
  const DrawnFaces found = find_faces(scene, bodies, drawn);
  const Drawing drawing{scene,
                        bodies,
                        found.regions,
                        drawn,
                        found.region_of_triangle,
                        found.colours,
                        (workshop.path() / "plots").string()};
  GnuplotRuns runs(workshop.path().string());
  const Sheet sheet = check_sheet(drawing);
  runs.start_layered("check", sheet.settings, {{"check.png", sheet.panels}});
  const std::string repairs = draw_repairs(scene, runs);
  std::vector<const CutCells*> cut_cells;
  for (const CheckedBody& body : bodies) cut_cells.push_back(body.cut_cells);
  write_vtk_cells(drawing.drawn, cut_cells, (workshop.path() / "check_cells.vtkhdf").string());
  write_faces(drawing, (workshop.path() / "check_faces.vtkhdf").string());
  CheckFiles written;
  if (!runs.finish().empty())
    written.warnings.emplace_back(
        "no check.png: the program gnuplot was not found (Debian package gnuplot-nox) or failed");
  for (const char* name : {"check.png", "check_repair.png", "check_faces.vtkhdf", "check_cells.vtkhdf"})
    if (deliver(name, workshop.path(), directory)) written.names.emplace_back(name);
  if (repairs.empty()) fs::remove(fs::path(directory) / "check_repair.png");  // of an earlier check
  return written;
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("cannot write to {}: {}", directory, error.code().message()));
}

}  // namespace cgcontact
