#include "core/output/pictures/output_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/base/files/text.hpp"
#include "core/drawing/drawn_body.hpp"
#include "core/drawing/render.hpp"
#include "core/output/pictures/picture_sheet.hpp"

namespace cgcontact {

namespace {

/// Pixels: side of a panel, room for the colour bar at the right, for the title, for the line above a panel.
constexpr int panel_side = 520, bar_room = 130, title_room = 44, line_room = 30;
/// Bodies in the legend.
constexpr std::size_t max_listed_bodies = 8;
/// Colours of the largest cells keep so much of their body's.
constexpr double palest = 0.3;
/// Fractions of the cells whose errors are below and above the range of colours.
constexpr double below_colours = 0.01, above_colours = 0.001;

std::vector<Vec3> positions_of(const std::vector<DrawnBody>& bodies) {
  std::vector<Vec3> positions;
  for (const DrawnBody& body : bodies) positions.insert(positions.end(), body.position.begin(), body.position.end());
  return positions;
}

/// Colour of an active cell of a body.
using CellColour = std::function<Rgb(std::size_t body, int cell)>;

RenderedImage draw(const std::vector<DrawnBody>& bodies, const Panel& view, const CellColour& colour) {
  std::vector<std::pair<std::size_t, std::size_t>> triangles;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t i = 0; i < bodies[b].mesh.boundary.size(); ++i) {
      const auto& t = bodies[b].mesh.boundary[i].points;
      const std::vector<Vec3>& x = bodies[b].position;
      if (reaches_picture({x[t[0]], x[t[1]], x[t[2]]}, view.size, view.camera)) triangles.emplace_back(b, i);
    }
  const auto triangle = [&](std::size_t k) {
    const auto [b, i] = triangles[k];
    const DrawnBody& body = bodies[b];
    const BoundaryTriangle& t = body.mesh.boundary[i];
    const double value = packed(colour(b, t.cell));
    return raster_triangle(
        body.mesh, t, static_cast<int>(b), [&](int p) { return body.position[p]; }, [&](int) { return value; });
  };
  return render(view.size, view.camera, unpacked, 0.7, triangles.size(), triangle);
}

/// The smaller the cells, the stronger the colour of their body.
CellColour colours_of_sizes(const Results& results) {
  double largest = 0, smallest = std::numeric_limits<double>::max();
  for (const BodyFields& body : results.bodies) {
    const Grid& grid = body.cut_cells->grid;
    largest = std::max(largest, grid.cell_size);
    smallest = std::min(smallest, grid.cell_size_of(body.cut_cells->num_levels() - 1));
  }
  const double range = std::log(largest / smallest);
  return [&results, largest, range](std::size_t b, int cell) {
    const double fineness = range > 0 ? std::log(largest / results.bodies[b].cut_cells->h(cell)) / range : 1;
    const double strength = palest + (1 - palest) * fineness;
    Rgb colour = colour_of_body(b);
    for (double& channel : colour) channel = 1 - strength * (1 - channel);
    return colour;
  };
}

/// The estimated error of the stress in each cell, Pa.
struct StressErrors {
  std::vector<std::vector<double>> of_body;
  double low = 0, high = 0;  ///< range of the colours

  double position(double value) const { return std::log(value / low) / std::log(high / low); }
};

/// None where the run has no estimates.
std::optional<StressErrors> stress_errors(const Results& results) {
  StressErrors errors;
  std::vector<double> all;
  for (const BodyFields& body : results.bodies) {
    const CutCells& cells = *body.cut_cells;
    if (body.error_of_cell.size() != cells.cells.size()) return std::nullopt;
    std::vector<double>& values = errors.of_body.emplace_back();
    for (std::size_t c = 0; c < cells.cells.size(); ++c) {
      values.push_back(stress_error(body, static_cast<int>(c)));
      if (values.back() > 0 && std::isfinite(values.back())) all.push_back(values.back());
    }
  }
  if (all.empty()) return std::nullopt;
  std::sort(all.begin(), all.end());
  const auto at = [&](double fraction) {
    return all[static_cast<std::size_t>(fraction * static_cast<double>(all.size() - 1))];
  };
  errors.high = at(1 - above_colours);
  errors.low = std::min(at(below_colours), errors.high / 10);
  return errors;
}

/// Powers of ten, and twice and five times them if there would be few.
std::string bar_tics(double low, double high) {
  std::string text;
  for (int power = static_cast<int>(std::floor(std::log10(low))); std::pow(10.0, power) <= high; ++power)
    for (const int digit : {1, 2, 5}) {
      const double value = digit * std::pow(10.0, power);
      if (value >= low && value <= high && (digit == 1 || high < 300 * low))
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", gnuplot_text(short_number(value)), value);
    }
  return "(" + text + ")";
}

/// The bar of colours beside a row of panels.
std::string colour_bar(const StressErrors& errors, double left, double bottom, int width, int height) {
  const DisplayUnit unit = stress_unit(errors.high);
  const double low = errors.low * unit.factor, high = errors.high * unit.factor;
  std::string text = gnuplot_palette();
  text += fmt::format("set logscale cb\nset cbrange [{}:{}]\nset cbtics {}\n", low, high, bar_tics(low, high));
  text += fmt::format("set label 'estimated error of the stress [{}]' at {},{} center rotate by 90\n", unit.name,
                      left + 105, bottom + panel_side / 2.0);
  text += fmt::format("set colorbox user origin screen {},{} size screen {},{}\n", left / width,
                      (bottom + 0.1 * panel_side) / height, 22.0 / width, 0.8 * panel_side / height);
  return text;
}

/// One look at the scene.
struct Look {
  const SceneView* scene;
  Panel view;
  const char* name;  ///< of the files
  const char* text;
};

std::vector<Look> looks_at(const SceneView& scene, const ZoneLook* zone) {
  Look whole{&scene, {}, "whole", "the whole scene"};
  whole.view.side = panel_side;
  whole.view.camera = scene.camera;
  whole.view.fit(positions_of(scene.shown));
  std::vector<Look> looks{whole};
  if (!zone) return looks;
  Look near{&zone->view, {}, "zone", "near the contact zone"};
  near.view.side = panel_side;
  near.view.camera = zone->view.camera;
  near.view.fit(corners_around(zone->box));
  if (nearly_all_of_scene * near.view.camera.pixels_per_metre > whole.view.camera.pixels_per_metre)
    looks.push_back(near);
  return looks;
}

/// White under the axes and the length of a panel that is full.
void add_grounds(const Panel& view, Sheet& sheet) {
  const double right = view.left + panel_side, scale_width = 0.34 * panel_side;
  for (const auto& [left, width, height] :
       {std::array<double, 3>{view.left, 68, 72}, std::array<double, 3>{right - scale_width, scale_width, 24}})
    sheet.settings += fmt::format(
        "set object rectangle from {},{} to {},{} front fs solid 1 border lc rgb '#c0c0c0' fc rgb 'white'\n", left,
        view.bottom, left + width, view.bottom + height);
}

void add_legend(const Results& results, double top, Sheet& sheet) {
  Legend legend(gap, top, 0, sheet);
  const std::size_t shown = std::min(results.bodies.size(), max_listed_bodies);
  for (std::size_t b = 0; b < shown; ++b) {
    const CutCells& cells = *results.bodies[b].cut_cells;
    legend.entry(colour_of_body(b), fmt::format("{}: {} cells of {}", drawable_text(results.bodies[b].name),
                                                grouped(static_cast<long long>(cells.cells.size())), sizes_of(cells)));
  }
  if (shown < results.bodies.size()) legend.words(fmt::format("and {} more bodies", results.bodies.size() - shown));
}

/// Rows: the cells, the errors; columns: the scene, the zone. Without a column for the zone both are in one row.
Sheet sheet_of(const Results& results, std::vector<Look>& looks, const std::optional<StressErrors>& errors,
               const std::string& folder) {
  const bool one_row = looks.size() == 1 || !errors;
  const int legend_room = line_height * static_cast<int>(std::min(results.bodies.size(), max_listed_bodies + 1) + 1);
  const int row = panel_side + line_room, width = 3 * gap + 2 * panel_side + bar_room;
  const int height = title_room + (one_row ? 1 : 2) * row + legend_room + gap;
  std::string text = page_settings("grid.png", width, height);
  Sheet sheet;
  const GnuplotTitle title =
      gnuplot_title("The final grid: " + drawable_text(results.title), width - 2 * gap, png_pixels(16));
  sheet.settings += fmt::format("set label {} at {},{} left font ',16'\n", title.text, gap, height - 24);
  const double top = height - title_room - row;
  const auto add = [&](Look& look, int column, double bottom, const std::string& what, const CellColour& colour) {
    look.view.left = gap + column * (panel_side + gap);
    look.view.bottom = bottom;
    sheet.add_panel(look.view, draw(look.scene->shown, look.view, colour), fmt::format("grid_{}_{}", what, look.name),
                    fmt::format("{}: {}", what, look.text), folder);
    if (look.scene != looks.front().scene) add_grounds(look.view, sheet);
    sheet.add_axes_and_scale(look.view);
  };
  const CellColour by_size = colours_of_sizes(results);
  for (std::size_t k = 0; k < looks.size(); ++k) add(looks[k], static_cast<int>(k), top, "cells", by_size);
  add_legend(results, top - line_height, sheet);
  if (errors) {
    const CellColour by_error = [&](std::size_t b, int cell) {
      const double value = errors->of_body[b][cell];
      return palette_colour(value > 0 && std::isfinite(value) ? errors->position(value) : 0);
    };
    const double bottom = one_row ? top : gap;
    for (std::size_t k = 0; k < looks.size(); ++k)
      add(looks[k], static_cast<int>(one_row ? 1 : k), bottom, "errors", by_error);
    text += colour_bar(*errors, 2.5 * gap + 2 * panel_side, bottom, width, height);
  }
  sheet.settings = text + sheet.settings + (errors ? plot_colours : plot_nothing);
  return sheet;
}

}  // namespace

void write_grid_picture(const Results& results, const SceneView& scene, const ZoneLook* zone, GnuplotRuns& runs) {
  const bool refined = std::any_of(results.bodies.begin(), results.bodies.end(),
                                   [](const BodyFields& body) { return body.cut_cells->num_levels() > 1; });
  if (scene.shown.empty() || !(refined || results.accuracy.asked)) return;
  std::vector<Look> looks = looks_at(scene, zone);
  const Sheet sheet = sheet_of(results, looks, stress_errors(results), runs.directory() + "/plots");
  runs.start_layered("grid", sheet.settings, {{"grid.png", sheet.panels}});
}

}  // namespace cgcontact
