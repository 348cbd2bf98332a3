#include "core/output/pictures/output_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/files/text.hpp"
#include "core/drawing/cut_open.hpp"
#include "core/drawing/render.hpp"
#include "core/output/pictures/picture_sheet.hpp"

namespace cgcontact {

namespace {

constexpr int section_side = 860;                   ///< of the picture of the section, pixels
constexpr int left = 30, bottom = 20, right = 190;  ///< around it
constexpr double bar_width = 24;

/// Section with the values at its points.
struct DrawnSection {
  std::vector<DrawnBody> bodies;
  std::vector<std::vector<double>> values;
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
};

DrawnSection cut(const SectionSpec& spec, const std::vector<DrawnBody>& bodies) {
  DrawnSection section;
  for (const DrawnBody& whole : bodies) {
    section.bodies.push_back(section_of(whole, spec.point, spec.normal));
    const DrawnBody& body = section.bodies.back();
    std::vector<double>& values = section.values.emplace_back();
    for (std::size_t p = 0; p < body.position.size(); ++p) {
      values.push_back(value_of(spec.field, body.displacement[p], body.stress[p]));
      if (!std::isfinite(values.back())) continue;
      section.low = std::min(section.low, values.back());
      section.high = std::max(section.high, values.back());
    }
  }
  return section;
}

RenderedImage draw(const DrawnSection& section, const Panel& panel) {
  std::vector<std::array<int, 2>> triangles;  // body, triangle
  for (std::size_t b = 0; b < section.bodies.size(); ++b)
    for (std::size_t i = 0; i < section.bodies[b].mesh.boundary.size(); ++i)
      triangles.push_back({static_cast<int>(b), static_cast<int>(i)});
  const double range = section.high > section.low ? section.high - section.low : 1;
  return render(panel.size, panel.camera, palette_colour, 0, triangles.size(), [&](std::size_t i) {
    const auto [b, t] = triangles[i];
    const DrawnBody& body = section.bodies[b];
    const BoundaryTriangle& triangle = body.mesh.boundary[t];
    const std::vector<double>& values = section.values[b];
    return raster_triangle(
        body.mesh, triangle, b, [&](int p) { return body.position[p]; },
        [&](int v) { return (values[triangle.points[v]] - section.low) / range; });
  });
}

/// Colour bar from the smallest to the largest value of the section.
std::string colour_bar(const SectionSpec& spec, const DrawnSection& section, int width, int height) {
  const double most = std::max(std::abs(section.low), std::abs(section.high));
  const DisplayUnit unit = is_length(spec.field) ? length_unit(most) : stress_unit(most);
  const double high = section.high > section.low ? section.high : section.low + std::max(1e-9 * most, 1e-300);
  std::string text = gnuplot_palette();
  text += fmt::format("set cbrange [{}:{}]\nset cblabel '{} [{}]'\n", section.low * unit.factor, high * unit.factor,
                      name_of(spec.field), unit.name);
  text += fmt::format("set colorbox user origin screen {},{} size screen {},{}\n", (left + section_side + 30.0) / width,
                      (bottom + 0.1 * section_side) / height, bar_width / width, 0.8 * section_side / height);
  return text + "set cbtics\nset format cb '%g'\n";
}

void write_section(const Scene& scene, const SectionSpec& spec, const std::vector<DrawnBody>& bodies,
                   GnuplotRuns& runs) {
  const DrawnSection section = cut(spec, bodies);
  Panel panel;
  panel.left = left;
  panel.bottom = bottom;
  panel.side = section_side;
  look_against(spec.normal, panel.camera);
  std::vector<Vec3> positions;
  for (const DrawnBody& body : section.bodies)
    positions.insert(positions.end(), body.position.begin(), body.position.end());
  if (positions.empty()) return runs.warn(fmt::format("section \"{}\": its plane meets no body", spec.name));
  panel.fit(positions);
  const std::string name = "section_" + spec.name, file = section_picture(spec);
  const int width = left + section_side + right;
  const GnuplotTitle title = gnuplot_title(drawable_text(spec.name + ": " + scene.title), width - 20, png_pixels(16));
  const int height = bottom + section_side + 40 + 24 * title.lines;
  Sheet sheet;
  sheet.settings = page_settings(file.c_str(), width, height) + colour_bar(spec, section, width, height) +
                   fmt::format("set label {} at {},{} center font ',16'\n", title.text, width / 2.0, height - 28);
  sheet.add_panel(panel, draw(section, panel), name, "", runs.directory() + "/plots");
  sheet.add_axes_and_scale(panel);
  runs.start_layered(name, sheet.settings + plot_colours, {{file, sheet.panels}});
}

}  // namespace

std::string section_picture(const SectionSpec& section) { return "section_" + section.name + ".png"; }

void write_sections(const Scene& scene, const std::vector<DrawnBody>& bodies, GnuplotRuns& runs) {
  const auto has_fields = [](const DrawnBody& body) {
    return body.position.empty() || (!body.displacement.empty() && !body.stress.empty());
  };
  if (!std::all_of(bodies.begin(), bodies.end(), has_fields)) return;
  for (const SectionSpec& section : scene.sections) write_section(scene, section, bodies, runs);
}

}  // namespace cgcontact
