#include "core/output/pictures/output_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "core/base/files/text.hpp"
#include "core/drawing/clip_cells.hpp"
#include "core/drawing/drawn_fits.hpp"
#include "core/drawing/render.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/pictures/picture_sheet.hpp"

namespace cgcontact {

namespace {

constexpr int picture_side = 1000;
/// Pixels: side of the picture of the contact zone, as high as that of the scene within these bounds; space between
/// its parts.
constexpr int min_zone_side = 420, max_zone_side = 560, part_spacing = 40;
/// Pixels: by which the last body is drawn nearer to the viewer than the first one. Otherwise rounding would decide
/// which of overlapping sections in one plane is seen.
constexpr double nearer = 2;
/// Largest drawn displacement over the diagonal of the scene.
constexpr double drawn_displacement = 0.03;

/// View of the scene.
struct View {
  Camera camera;
  int thin_axis = -1;        ///< of SceneView
  double exaggeration = 1;   ///< of the displacement
  double low = 0, high = 1;  ///< Pa, range of colours
  SceneBox box;
};

double largest_displacement(const Results& results) {
  double largest = 0;
  for (const BodyExtremes& extremes : results.extremes) largest = std::max(largest, extremes.body.displacement.value);
  return largest;
}

double choose_exaggeration(double largest, const SceneBox& box) {
  if (!(largest > 0) || !std::isfinite(largest)) return 1;
  const double factor = drawn_displacement * box.extent().norm() / largest;
  return factor <= 1 || factor > 1e9 ? 1 : round_down(factor);  // smaller displacements are rounding
}

/// Returns the end of the range of colours for the boundary's stress: without its highest half per cent; the picture
/// says so. Zero: no stress.
double end_of_colours(const std::vector<DrawnBody>& bodies) {
  std::size_t num_triangles = 0;
  for (const DrawnBody& body : bodies) num_triangles += body.mesh.boundary.size();
  std::vector<double> values;
  values.reserve(3 * num_triangles);
  for (const DrawnBody& body : bodies)
    for (const BoundaryTriangle& triangle : body.mesh.boundary)
      for (int p : triangle.points)
        if (const double value = von_mises(body.stress[p]); std::isfinite(value)) values.push_back(value);
  if (values.empty()) return 0;
  const auto limit = values.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), limit, values.end());
  return *limit;
}

/// Extent of the deformed bodies as the camera sees them, m.
struct PaperBox {
  double low[2] = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  double high[2] = {-std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()};

  void add(const std::vector<DrawnBody>& bodies, const View& view) {
    for (const DrawnBody& body : bodies)
      for (std::size_t p = 0; p < body.position.size(); ++p) {
        Vec3 x = body.position[p];
        if (!body.displacement.empty()) x += view.exaggeration * body.displacement[p];
        if (!x.allFinite()) continue;
        const double on_paper[2] = {view.camera.right.dot(x), view.camera.up.dot(x)};
        for (int k = 0; k < 2; ++k) {
          low[k] = std::min(low[k], on_paper[k]);
          high[k] = std::max(high[k], on_paper[k]);
        }
      }
  }
};

/// Scales the camera so that the box fits; returns width and height in pixels, 0 if there is nothing to see.
std::array<int, 2> fit_camera(const PaperBox& box, View& view) {
  const double largest = std::max(box.high[0] - box.low[0], box.high[1] - box.low[1]);
  if (!(largest > 0)) return {0, 0};
  const double margin = 0.02 * largest;
  view.camera.pixels_per_metre = picture_side / (largest + 2 * margin);
  std::array<int, 2> size;
  for (int k = 0; k < 2; ++k) {
    view.camera.low[k] = box.low[k] - margin;
    size[k] = static_cast<int>(std::ceil((box.high[k] - box.low[k] + 2 * margin) * view.camera.pixels_per_metre));
  }
  return size;
}

Vec3 drawn_position(const DrawnBody& body, int point, double exaggeration) {
  return body.displacement.empty() ? body.position[point]
                                   : Vec3(body.position[point] + exaggeration * body.displacement[point]);
}

/// Pixels of the bodies, by row from the bottom.
std::string draw_bodies(const std::vector<DrawnBody>& bodies, const View& view, const std::array<int, 2>& size) {
  const auto is_seen = [&](const DrawnBody& body, std::size_t i) {
    const auto& points = body.mesh.boundary[i].points;
    const auto at = [&](int v) { return drawn_position(body, points[v], view.exaggeration); };
    return reaches_picture({at(0), at(1), at(2)}, size, view.camera);
  };
  std::vector<std::array<int, 2>> triangles;  // body, triangle of its boundary
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t i = 0; i < bodies[b].mesh.boundary.size(); ++i)
      if (is_seen(bodies[b], i)) triangles.push_back({static_cast<int>(b), static_cast<int>(i)});
  const double step = nearer / (view.camera.pixels_per_metre * static_cast<double>(bodies.size()));
  const auto triangle = [&](std::size_t i) {
    const DrawnBody& body = bodies[triangles[i][0]];
    const Vec3 shift = triangles[i][0] * step * view.camera.eye;
    const BoundaryTriangle& boundary = body.mesh.boundary[triangles[i][1]];
    return raster_triangle(
        body.mesh, boundary, triangles[i][0],
        [&](int p) { return Vec3(drawn_position(body, p, view.exaggeration) + shift); },
        [&](int v) { return (von_mises(body.stress[boundary.points[v]]) - view.low) / (view.high - view.low); });
  };
  return render(size, view.camera, palette_colour, view.thin_axis < 0 ? 1.0 : 0.0, triangles.size(), triangle).pixels;
}

/// Pixels from the left and the bottom of the picture.
using Pixel = std::array<double, 2>;

/// Script of gnuplot in pixels of the whole picture.
class Overlay {
 public:
  Overlay(int width, int height) : width_(width), height_(height) {}

  void label(const std::string& text, const Pixel& at, const std::string& style) {
    script_ += fmt::format("set label {} at {} {}\n", gnuplot_text(text), screen(at), style);
  }
  void line(const Pixel& from, const Pixel& to, const std::string& style) {
    script_ += fmt::format("set arrow from {} to {} {}\n", screen(from), screen(to), style);
  }
  void ring(const Pixel& at, double radius) {
    const auto circle = [&](const char* colour, double width) {
      script_ += fmt::format("set object circle at {} size screen {} fs empty border lc rgb '{}' lw {} front\n",
                             screen(at), radius / width_, colour, width);
    };
    circle("white", 4);
    circle("black", 2);
  }
  const std::string& script() const { return script_; }

 private:
  std::string screen(const Pixel& at) const { return fmt::format("screen {},{}", at[0] / width_, at[1] / height_); }

  const double width_, height_;
  std::string script_;
};

/// The coordinate axes as they are seen, and a length of 1, 2 or 5 times a power of ten.
void draw_axes_and_scale(const View& view, int picture_width, const Pixel& corner, Overlay& overlay) {
  constexpr double axis_length = 42;
  static const char* const names[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    const double right = view.camera.right[k], up = view.camera.up[k];
    if (std::hypot(right, up) < 0.05) continue;
    const Pixel tip{corner[0] + axis_length * right, corner[1] + axis_length * up};
    overlay.line(corner, tip, "front filled size screen 0.008,20 lw 2 lc rgb '#303030'");
    overlay.label(names[k], {tip[0] + 11 * right, tip[1] + 11 * up}, "center front font ',14'");
  }
  const double length = round_down(0.25 * picture_width / view.camera.pixels_per_metre);
  const double pixels = length * view.camera.pixels_per_metre;
  const Pixel from{corner[0] + 90, corner[1] - 12}, to{from[0] + pixels, from[1]};
  overlay.line(from, to, "heads front size screen 0.004,90 lw 2 lc rgb '#303030'");
  const DisplayUnit unit = length_unit(length);
  overlay.label(short_number(length * unit.factor) + " " + unit.name, {(from[0] + to[0]) / 2, from[1] + 14},
                "center front font ',13'");
}

/// Returns the largest von Mises stress of a body.
const Extreme& largest_stress(const Results& results, std::size_t body) {
  return results.extremes[body].body.von_mises;
}

/// Body with the largest von Mises stress; nothing if none.
std::optional<std::size_t> most_stressed(const Results& results) {
  std::optional<std::size_t> most;
  for (std::size_t b = 0; b < results.extremes.size(); ++b)
    if (largest_stress(results, b).value > (most ? largest_stress(results, *most).value : 0.0)) most = b;
  return most;
}

/// "largest (ring): 42.7 MPa in shell at (0.1, 0, 0.5) m", and whether the colours end below it.
std::string largest_text(const Results& results, std::size_t body, const View& view, bool has_ring) {
  const Extreme& most = largest_stress(results, body);
  return fmt::format("largest ({}): {} in {} at {}{}", has_ring ? "ring" : "cut away", scaled(most.value, "Pa"),
                     results.bodies[body].name, position_text(most.at),
                     most.value > view.high * (1 + 1e-6) ? "; above the bar all is dark red" : "");
}

/// The contact zone beside the scene, from nearby.
struct ZonePicture {
  View view;
  int side;  ///< pixels
  std::string heading;
};

/// Places of the parts of a picture, pixels; what is below `bottom` are axes and notes.
struct Frame {
  int left, bottom, notes, width, height;
  int zone_left, bar_left;
  GnuplotTitle title, largest;
};

Frame frame_of(const Results& results, const View& view, const std::array<int, 2>& size, bool has_ring,
               const std::optional<ZonePicture>& zone) {
  const bool flat = view.thin_axis >= 0;
  const int right = 145;
  Frame frame{};
  frame.left = flat ? 125 : 30;
  frame.zone_left = frame.left + size[0] + part_spacing;
  frame.bar_left = zone ? frame.zone_left + zone->side + part_spacing : frame.left + size[0] + 25;
  frame.width = frame.bar_left + right;
  const auto most = most_stressed(results);
  frame.title = gnuplot_title(drawable_text(results.title), frame.width - 20, png_pixels(18));
  frame.largest =
      gnuplot_title(most ? largest_text(results, *most, view, has_ring) : "", frame.width - 20, png_pixels(14));
  frame.notes = 10 + 20 * frame.largest.lines;
  frame.bottom = frame.notes + (flat ? 80 : 125);
  const int top = 36 + 24 * frame.title.lines + (zone ? 24 : 0);
  frame.height = frame.bottom + std::max(size[1], zone ? zone->side : 0) + top;
  return frame;
}

/// Margins of a plot of pixels with its lower left corner at (left, frame.bottom).
std::string margins(const Frame& frame, int left, const std::array<int, 2>& size) {
  const double width = frame.width, height = frame.height;
  return fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen {}\n",
      left / width, (left + size[0]) / width, frame.bottom / height, (frame.bottom + size[1]) / height);
}

/// Bar of colours for all of a picture. panels: their height, pixels; most: the largest stress, Pa, which the bar may
/// end below.
std::string colour_bar(const View& view, int panels, double most, const Frame& frame, Overlay& overlay) {
  const DisplayUnit stress = stress_unit(view.high);
  const double bottom = frame.bottom + 0.1 * panels, height = 0.8 * panels;
  if (most > view.high * (1 + 1e-6))
    overlay.label("to " + scaled(most, "Pa"), {frame.bar_left + 12.0, bottom + height + 16}, "center front font ',13'");
  return fmt::format("set cbrange [{}:{}]\nset cblabel 'von Mises stress [{}]'\n", view.low * stress.factor,
                     view.high * stress.factor, stress.name) +
         fmt::format("set colorbox user origin screen {},{} size screen {},{}\n",
                     static_cast<double>(frame.bar_left) / frame.width, bottom / frame.height, 24.0 / frame.width,
                     height / frame.height);
}

/// Axes of a scene that is seen from the front, else the directions of the axes and a length.
std::string axes(const View& view, const std::array<int, 2>& size, const Frame& frame, Overlay& overlay) {
  const std::string scale = view.exaggeration > 1 ? fmt::format("displacement x {:.0f}", view.exaggeration)
                                                  : std::string("displacement to scale");
  if (view.thin_axis < 0) {
    draw_axes_and_scale(view, size[0], {frame.left + 55.0, frame.notes + 50.0}, overlay);
    overlay.label(scale, {frame.left + 145.0, frame.notes + 16.0}, "left front font ',14'");
    return "unset border\nunset xtics\nunset ytics\n";
  }
  const DisplayUnit length = length_unit(view.box.extent().maxCoeff());
  return "set border 3 lc rgb '#404040'\nset tics nomirror out\n" +
         fmt::format("set xlabel '{} [{}]     ({})'\nset ylabel '{} [{}]'\n", view.thin_axis == 0 ? "y" : "x",
                     length.name, scale, view.thin_axis == 2 ? "y" : "z", length.name);
}

/// Frame of a zone's pixels beside those of the scene.
std::string zone_script(const ZonePicture& zone, const Frame& frame) {
  const int side = zone.side;
  Overlay overlay(frame.width, frame.height);
  overlay.label(zone.heading, {frame.zone_left + side / 2.0, frame.bottom + side + 14.0}, "center front font ',12'");
  draw_axes_and_scale(zone.view, side, {frame.zone_left + 55.0, frame.bottom - 62.0}, overlay);
  return "unset label\nunset arrow\nunset object\nunset colorbox\nunset xtics\nunset ytics\nunset xlabel\n"
         "unset ylabel\nset border 15 lc rgb '#a0a0a0'\n" +
         margins(frame, frame.zone_left, {side, side}) + fmt::format("set xrange [0:{0}]\nset yrange [0:{0}]\n", side) +
         overlay.script() + plot_nothing;
}

/// Script of a picture NAME.png and where its pixels lie, NAME.rgb and NAME_zone.rgb in a folder.
std::pair<std::string, LayeredPicture> picture_script(const std::string& name, const std::string& folder,
                                                      const Results& results, const View& view,
                                                      const std::array<int, 2>& size,
                                                      const std::optional<Vec3>& largest_at,
                                                      const std::optional<ZonePicture>& zone) {
  const Frame frame = frame_of(results, view, size, largest_at.has_value(), zone);
  const double height = frame.height;
  const auto most = most_stressed(results);
  Overlay overlay(frame.width, frame.height);
  std::string script =
      fmt::format("set encoding utf8\nset terminal pngcairo size {},{} noenhanced font 'sans-serif,15' transparent\n",
                  frame.width, frame.height);
  script += "set output '../" + name + ".png'\nunset key\n" + gnuplot_palette() + margins(frame, frame.left, size);
  script += fmt::format("set label {} at screen 0.5,{} center font ',18'\n", frame.title.text, 1 - 28.0 / height);
  if (most)
    script += fmt::format("set label {} at screen 0.5,{} center font ',14'\n", frame.largest.text,
                          (frame.notes - 12.0) / height);
  script += colour_bar(view, std::max(size[1], zone ? zone->side : 0), most ? largest_stress(results, *most).value : 0,
                       frame, overlay);
  if (largest_at) {
    const auto pixels = [&](const Vec3& direction, double low) {
      return (direction.dot(*largest_at) - low) * view.camera.pixels_per_metre;
    };
    overlay.ring({frame.left + pixels(view.camera.right, view.camera.low[0]),
                  frame.bottom + pixels(view.camera.up, view.camera.low[1])},
                 9);
  }
  const DisplayUnit length = length_unit(view.box.extent().maxCoeff());
  const double step = length.factor / view.camera.pixels_per_metre;
  const double x = view.camera.low[0] * length.factor, y = view.camera.low[1] * length.factor;
  script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x, x + size[0] * step, y, y + size[1] * step);
  script += axes(view, size, frame, overlay) + overlay.script() + (zone ? "set multiplot\n" : "");
  script += plot_colours;
  LayeredPicture picture{name + ".png",
                         {{folder + "/" + name + ".rgb", size[0], size[1], 1.0 * frame.left, 1.0 * frame.bottom}}};
  if (zone) {
    script += zone_script(*zone, frame) + "unset multiplot\n";
    picture.layers.push_back(
        {folder + "/" + name + "_zone.rgb", zone->side, zone->side, 1.0 * frame.zone_left, 1.0 * frame.bottom});
  }
  return {script, picture};
}

/// Mean displacement of the points that are pressed, m.
Vec3 displacement_of_zone(const Results& results, int pair) {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const ContactRow& row : results.contact_rows) {
    const BodyFields& body = results.bodies[row.body];
    if (row.pair != pair || !(row.pressure_sprc > zone_end * results.pairs[pair].max_pressure) || !body.displacement)
      continue;
    const CutCells& cells = *body.cut_cells;
    sum +=
        row.weight * body.displacement(row.cell, clamped_cell_coordinates(cells, row.cell, cells.grid.to_grid(row.x)));
    area += row.weight;
  }
  return area > 0 ? Vec3(sum / area) : sum;
}

/// Looks at the zone where the true displacements take it: those of the scene's picture are many times the zone. None:
/// it would show nearly all of the scene.
std::optional<ZonePicture> picture_of_zone(const Results& results, const View& scene, const std::array<int, 2>& size,
                                           const ZoneLook& zone) {
  const Vec3 moved = displacement_of_zone(results, zone.pair);
  if (!moved.allFinite()) return std::nullopt;
  Panel panel;
  panel.side = std::clamp(size[1], min_zone_side, max_zone_side);
  panel.camera = zone.view.camera;
  std::vector<Vec3> corners = corners_around(zone.box);
  for (Vec3& corner : corners) corner += moved;
  panel.fit(corners);
  const double shown = panel.side / panel.camera.pixels_per_metre;
  if (shown > nearly_all_of_scene * std::max(size[0], size[1]) / scene.camera.pixels_per_metre) return std::nullopt;
  ZonePicture picture{scene, panel.side, ""};
  picture.view.camera = panel.camera;
  picture.view.exaggeration = 1;
  picture.heading =
      "zone of " + drawable_text(shortened_name(results.pairs[zone.pair].name, longest_entry)) + ", to scale";
  return picture;
}

/// Finds how far the point of a drawn body that is nearest to x has been shifted beside its displacements, m.
Vec3 shift_near(const DrawnBody& body, const std::vector<Vec3>& displacements, const Vec3& x) {
  std::size_t nearest = 0;
  for (std::size_t p = 1; p < displacements.size(); ++p)
    if ((body.position[p] - x).squaredNorm() < (body.position[nearest] - x).squaredNorm()) nearest = p;
  return displacements.empty() ? Vec3(Vec3::Zero()) : Vec3(body.displacement[nearest] - displacements[nearest]);
}

/// Finds where a point is drawn that moves like the nearest one of a body; nothing if it has none.
std::optional<Vec3> beside_nearest(const DrawnBody& body, const Vec3& x, double exaggeration) {
  const auto nearest = std::min_element(body.position.begin(), body.position.end(), [&](const Vec3& a, const Vec3& b) {
    return (a - x).squaredNorm() < (b - x).squaredNorm();
  });
  if (nearest == body.position.end()) return std::nullopt;
  const int point = static_cast<int>(nearest - body.position.begin());
  return Vec3(x + drawn_position(body, point, exaggeration) - *nearest);
}

/// Finds where the largest von Mises stress is drawn; nothing if it has been cut away. displacements: of the drawn
/// bodies before fits were closed.
std::optional<Vec3> drawn_position_of_largest(const Results& results, const std::vector<DrawnBody>& whole,
                                              const std::vector<DrawnBody>& drawn,
                                              const std::vector<std::vector<Vec3>>& displacements, bool opened,
                                              const View& view) {
  const auto most = most_stressed(results);
  if (!most) return std::nullopt;
  const Vec3& at = largest_stress(results, *most).at;
  const auto position_in = [&](const DrawnBody& body) -> std::optional<Vec3> {
    for (std::size_t p = 0; p < body.position.size(); ++p)
      if (body.position[p] == at) return drawn_position(body, static_cast<int>(p), view.exaggeration);
    return std::nullopt;
  };
  if (const auto found = position_in(drawn[*most]); found || opened) return found;
  const DrawnBody& body = whole[*most];
  const Vec3 shift = view.exaggeration * shift_near(drawn[*most], displacements[*most], at);
  if (const auto found = position_in(body)) return Vec3(*found + shift);
  for (int p = 0; p < static_cast<int>(body.mesh.num_interior_points()); ++p) {
    if (interior_position(body, p) != at) continue;
    const std::vector<Vec3> displacement = body.interior(body.mesh, {p}).displacement;
    return displacement.empty() ? at : Vec3(at + view.exaggeration * displacement.front() + shift);
  }
  return beside_nearest(drawn[*most], at, view.exaggeration);
}

}  // namespace

double picture_exaggeration(const Results& results, const SceneBox& box) {
  return choose_exaggeration(largest_displacement(results), box);
}

bool write_picture(const Results& results, const std::vector<DrawnBody>& bodies, SceneView& scene, ZoneLook* zone,
                   GnuplotRuns& runs) {
  if (scene.shown.empty()) return false;
  View view;
  view.box = scene.box;
  view.camera = scene.camera;
  view.thin_axis = scene.thin_axis;
  view.exaggeration = picture_exaggeration(results, view.box);
  std::vector<DrawnBody>& drawn = scene.shown;
  std::vector<std::vector<Vec3>> displacements;
  for (const DrawnBody& body : drawn) displacements.push_back(body.displacement);
  draw_fits_closed(results, view.exaggeration, drawn);
  if (const double end = end_of_colours(drawn); end > 0) view.high = end;
  PaperBox box;
  box.add(drawn, view);
  const std::array<int, 2> size = fit_camera(box, view);
  if (size[0] < 1 || size[1] < 1) return false;
  const std::string folder = runs.directory() + "/plots";
  write_text(folder + "/scene.rgb", draw_bodies(drawn, view, size));
  const std::optional<ZonePicture> near = zone ? picture_of_zone(results, view, size, *zone) : std::nullopt;
  if (near) {
    draw_fits_closed(results, near->view.exaggeration, zone->view.shown);
    write_text(folder + "/scene_zone.rgb", draw_bodies(zone->view.shown, near->view, {near->side, near->side}));
  }
  const std::optional<Vec3> largest_at =
      drawn_position_of_largest(results, bodies, drawn, displacements, scene.opened, view);
  const auto [script, picture] = picture_script("scene", folder, results, view, size, largest_at, near);
  runs.start_layered("scene", script, {picture});
  return near.has_value();
}

std::vector<std::string> write_step_pictures(const std::vector<StepLook>& steps, const SceneView& scene,
                                             double largest_displacement, const StepBodies& bodies, GnuplotRuns& runs) {
  std::vector<std::string> pictures;
  if (scene.shown.empty() || steps.empty()) return pictures;
  View view;
  view.box = scene.box;
  view.camera = scene.camera;
  view.thin_axis = scene.thin_axis;
  view.exaggeration = choose_exaggeration(largest_displacement, view.box);
  const auto drawn_in = [&](const StepLook& step) {
    std::vector<DrawnBody> drawn = shown_in(scene, bodies(step.number));
    draw_fits_closed(step.words, view.exaggeration, drawn);
    return drawn;
  };
  PaperBox box;
  double end = 0;
  for (const StepLook& step : steps) {
    const std::vector<DrawnBody> drawn = drawn_in(step);
    end = std::max(end, end_of_colours(drawn));
    box.add(drawn, view);
  }
  if (end > 0) view.high = end;
  const std::array<int, 2> size = fit_camera(box, view);
  if (size[0] < 1 || size[1] < 1) return pictures;
  const std::string folder = runs.directory() + "/plots";
  std::string scripts;
  std::vector<LayeredPicture> layered;
  for (const StepLook& step : steps) {
    write_text(folder + "/" + step.name + ".rgb", draw_bodies(drawn_in(step), view, size));
    const auto [script, picture] =
        picture_script(step.name, folder, step.words, view, size, std::nullopt, std::nullopt);
    scripts += "reset\n" + script;
    pictures.push_back(picture.name);
    layered.push_back(picture);
  }
  runs.start_layered("step_pictures", scripts, std::move(layered));
  return pictures;
}

}  // namespace cgcontact
