#include "core/output/plot/plot_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/drawing/render.hpp"
#include "core/output/pictures/picture_sheet.hpp"

namespace cgcontact {

namespace {

/// Pixels: side of the picture without what is around it, its margin, left and right of it, the strip of axes below.
constexpr int plot_side = 900, plot_margin = 50, plot_left = 30, plot_right = 190, axes_strip = 78;
constexpr int plot_bar_width = 24, note_height = 22;
/// Pixels by which a body is drawn nearer to the viewer than the one before, where sections overlap.
constexpr double nearer_by = 2;
/// Pixels by which a point may lie behind what is seen there and still be on it.
constexpr double depth_of_ring = 4;

/// Triangle of a body that is shown.
struct ShownTriangle {
  int body, triangle;
};

/// Scales the camera; all of the frame is seen. What is near a contact fills a square, else the height fits.
Panel panel_of(const PlotShape& shape) {
  Panel view;
  view.camera = shape.camera;
  view.side = plot_side;
  view.left = plot_left;
  view.fit(shape.frame);
  if (shape.near) return view;
  double low = 1e300, high = -1e300;
  for (const Vec3& x : shape.frame) {
    low = std::min(low, view.camera.up.dot(x));
    high = std::max(high, view.camera.up.dot(x));
  }
  const double margin = plot_margin / view.camera.pixels_per_metre;
  view.camera.low[1] = low - margin;
  view.size[1] = static_cast<int>(std::ceil((high - low + 2 * margin) * view.camera.pixels_per_metre));
  return view;
}

std::vector<ShownTriangle> triangles_in(const Panel& view, const PlotShape& shape) {
  std::vector<ShownTriangle> found;
  for (std::size_t b = 0; b < shape.shown.size(); ++b) {
    const DrawnBody& body = shape.shown[b];
    for (std::size_t i = 0; i < body.mesh.boundary.size(); ++i) {
      const auto& p = body.mesh.boundary[i].points;
      if (reaches_picture({shape.drawn(body, p[0]), shape.drawn(body, p[1]), shape.drawn(body, p[2])}, view.size,
                          view.camera))
        found.push_back({static_cast<int>(b), static_cast<int>(i)});
    }
  }
  return found;
}

RenderedImage pixels_of(const Panel& view, const PlotShape& shape, const PlotValues& values,
                        const std::vector<ShownTriangle>& triangles) {
  const double step = nearer_by / (view.camera.pixels_per_metre * static_cast<double>(shape.shown.size()));
  const double range = values.high - values.low;
  return render(view.size, view.camera, palette_colour, shape.shaded ? 1.0 : 0.0, triangles.size(), [&](std::size_t i) {
    const int b = triangles[i].body;
    const DrawnBody& body = shape.shown[b];
    const BoundaryTriangle& triangle = body.mesh.boundary[triangles[i].triangle];
    const Vec3 shift = b * step * view.camera.eye;
    return raster_triangle(
        body.mesh, triangle, b, [&](int p) { return Vec3(shape.drawn(body, p) + shift); },
        [&](int v) { return (values.at(b, triangle, v) - values.low) / range; });
  });
}

/// Pixels from the lower left corner of a panel, and the depth, in pixels too.
Vec3 in_pixels(const Panel& view, const Vec3& x) {
  const Camera& camera = view.camera;
  return camera.pixels_per_metre *
         Vec3(camera.right.dot(x) - camera.low[0], camera.up.dot(x) - camera.low[1], camera.eye.dot(x));
}

/// Returns whether a point lies in the picture, on what is seen there; in thin scenes and sections before or behind it.
bool is_seen(const Vec3& x, const Panel& view, const PlotShape& shape, const std::vector<ShownTriangle>& triangles) {
  const Vec3 at = in_pixels(view, x);
  if (at[0] < 0 || at[1] < 0 || at[0] > view.size[0] || at[1] > view.size[1]) return false;
  double nearest = -1e300;
  for (const auto& [b, t] : triangles) {
    const auto& points = shape.shown[b].mesh.boundary[t].points;
    std::array<Vec3, 3> corners;
    for (int v = 0; v < 3; ++v) corners[v] = in_pixels(view, shape.drawn(shape.shown[b], points[v])) - at;
    const auto cross = [&](int v, int w) { return corners[v][0] * corners[w][1] - corners[w][0] * corners[v][1]; };
    const Vec3 weights(cross(1, 2), cross(2, 0), cross(0, 1));
    const double area = weights.sum();
    if (area > 1e-9 && weights.minCoeff() >= -1e-6 * area)
      nearest = std::max(nearest,
                         (weights[0] * corners[0][2] + weights[1] * corners[1][2] + weights[2] * corners[2][2]) / area);
  }
  return shape.shaded ? std::abs(nearest) < depth_of_ring : nearest > -1e300;
}

/// "von_mises on the section z=5mm, near the contact lug-pin, displacement x 50"
std::string words_of(const PlotResult& result, const PlotOptions& options, const PlotField& field,
                     const PlotShape& shape) {
  std::string text = field.name;
  if (options.section) text += ", section " + options.section->text;
  if (shape.near) text += ", near the contact " + shortened_name(shape.pair, longest_entry);
  if (result.step > 0) text += fmt::format(", step {} of {}", result.step, result.num_steps);
  return text + (shape.factor == 0   ? ", undeformed"
                 : shape.factor == 1 ? ", displacement to scale"
                                     : ", displacement x " + short_number(shape.factor));
}

/// Bar of colours, and what lies beyond its ends.
std::string bar_of(const PlotField& field, const PlotValues& values, const Panel& view, int width, int height,
                   Sheet& sheet) {
  const double most = std::max(std::abs(values.low), std::abs(values.high));
  const DisplayUnit unit = field.display(most);
  const double length = std::max(0.8 * view.size[1], 160.0);
  const double bottom = view.bottom + (view.size[1] - length) / 2, left = view.left + view.side + 30;
  const auto beyond = [&](const char* word, double value, double y) {
    const DisplayUnit shown = field.display(std::abs(value));
    sheet.label(fmt::format("{} {}", word, in_unit(value, shown)), left, y, "left font ',12'");
  };
  const double rounding = 1e-6 * (values.high - values.low);
  if (values.largest.value > values.high + rounding) beyond("to", values.largest.value, bottom + length + 16);
  if (values.smallest.value < values.low - rounding) beyond("from", values.smallest.value, bottom - 16);
  return gnuplot_palette() +
         fmt::format("set cbrange [{}:{}]\nset cblabel '{} [{}]' offset 1.5,0\n", values.low * unit.factor,
                     values.high * unit.factor, field.name, unit.name) +
         fmt::format("set colorbox user origin screen {},{} size screen {},{}\n", left / width, bottom / height,
                     1.0 * plot_bar_width / width, length / height) +
         "set cbtics\nset format cb '%g'\n";
}

/// "largest (ring): 42.7 MPa in shell at (0.1, 0, 0.5) m", and whether the colours end below it.
std::string note_of(const char* which, const PlotExtreme& extreme, const PlotField& field, const PlotResult& result,
                    bool has_ring, const char* beyond) {
  const DisplayUnit unit = field.display(std::abs(extreme.value));
  return fmt::format("{} ({}): {} in {} at {}{}", which, has_ring ? "ring" : "not seen here",
                     in_unit(extreme.value, unit), result.known.bodies[extreme.body].name, position_text(extreme.at),
                     beyond);
}

void add_ring(const Vec3& pixel, const Panel& view, Sheet& sheet) {
  const auto circle = [&](const char* colour, double width) {
    sheet.settings += fmt::format("set object circle at {},{} size 9 fs empty border lc rgb '{}' lw {} front\n",
                                  view.left + pixel[0], view.bottom + pixel[1], colour, width);
  };
  circle("white", 4);
  circle("black", 2);
}

/// Notes of the extremes from the bottom up; returns their lines.
std::vector<std::string> notes_of(const PlotResult& result, const PlotField& field, const PlotValues& values,
                                  bool ring_of_largest) {
  const double rounding = 1e-6 * (values.high - values.low);
  std::vector<std::string> notes;
  if (field.can_be_negative())
    notes.push_back(fmt::format(
        "smallest: {} in {} at {}{}", in_unit(values.smallest.value, field.display(std::abs(values.smallest.value))),
        result.known.bodies[values.smallest.body].name, position_text(values.smallest.at),
        values.smallest.value < values.low - rounding ? "; below the bar all is dark blue" : ""));
  notes.push_back(note_of("largest", values.largest, field, result, ring_of_largest,
                          values.largest.value > values.high + rounding ? "; above the bar all is dark red" : ""));
  return notes;
}

}  // namespace

void draw_plot(const PlotResult& result, const PlotOptions& options, const PlotField& field, const PlotShape& shape,
               const PlotValues& values, const std::string& name, GnuplotRuns& runs) {
  Panel view = panel_of(shape);
  const std::vector<ShownTriangle> triangles = triangles_in(view, shape);
  if (triangles.empty())
    throw InputError(fmt::format("{}: nothing of it lies near the contact {}",
                                 options.section ? "--section " + options.section->text : "--body", shape.pair));
  const bool has_ring = is_seen(values.largest.drawn, view, shape, triangles);
  const std::vector<std::string> notes = notes_of(result, field, values, has_ring);
  const int width = plot_left + plot_side + plot_right;
  const GnuplotTitle title = gnuplot_title(drawable_text(result.known.title), width - 20, png_pixels(16));
  const int notes_top = 16 + note_height * static_cast<int>(notes.size());
  view.bottom = notes_top + axes_strip;
  const int height = static_cast<int>(view.bottom) + view.size[1] + 52 + 24 * title.lines;
  Sheet sheet;
  sheet.settings = page_settings((name + ".png").c_str(), width, height);
  const std::string bar = bar_of(field, values, view, width, height, sheet);
  sheet.settings += bar;
  sheet.settings += fmt::format("set label {} at {},{} center font ',16'\n", title.text, width / 2.0, height - 28);
  sheet.label(drawable_text(words_of(result, options, field, shape)), width / 2.0, view.bottom + view.size[1] + 20,
              "center font ',13' tc rgb '#404a58'");
  for (std::size_t k = 0; k < notes.size(); ++k)
    sheet.label(drawable_text(notes[k]), width / 2.0, 18 + note_height * static_cast<double>(k), "center font ',12'");
  sheet.add_panel(view, pixels_of(view, shape, values, triangles), name, "", runs.directory() + "/plots");
  if (shape.near)
    sheet.settings += fmt::format("set object rectangle from {},{} to {},{} fs empty border lc rgb '#a0a0a0'\n",
                                  view.left, view.bottom, view.left + view.size[0], view.bottom + view.size[1]);
  Panel strip = view;
  strip.bottom = notes_top;
  sheet.add_axes_and_scale(strip);
  if (has_ring) add_ring(in_pixels(view, values.largest.drawn), view, sheet);
  runs.start_layered(name, sheet.settings + plot_colours, {{name + ".png", sheet.panels}});
}

}  // namespace cgcontact
