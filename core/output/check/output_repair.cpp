#include "core/output/check/output_repair.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/output/pictures/picture_sheet.hpp"
#include "core/triangles/triangle_repair.hpp"

namespace cgcontact {
namespace {

constexpr const char* repair_picture = "check_repair.png";
constexpr Rgb as_before{0.82, 0.83, 0.85}, new_triangle{0.90, 0.36, 0.28};
constexpr std::size_t max_surfaces = 12;

RenderedImage draw(const RepairedSurface& surface, const Panel& view) {
  const auto triangle = [&](std::size_t t) {
    RasterTriangle drawn;
    drawn.region = surface.is_new[t];
    for (int v = 0; v < 3; ++v) {
      const Vec3& x = surface.soup.points[surface.soup.triangles[t][v]];
      drawn.vertices[v] = {x, Vec3::Constant(0.5), packed(surface.is_new[t] ? new_triangle : as_before)};  // no grid
    }
    return drawn;
  };
  return render(view.size, view.camera, unpacked, 0.7, surface.soup.triangles.size(), triangle);
}

}  // namespace

std::string draw_repairs(const Scene& scene, GnuplotRuns& runs) {
  std::vector<std::pair<std::string, const RepairedSurface*>> surfaces;
  for (const BodySpec& body : scene.bodies)
    for (const auto& repair : body.repairs) surfaces.emplace_back(body.name, repair.get());
  if (surfaces.empty()) return "";
  const std::size_t shown = std::min(surfaces.size(), max_surfaces);
  constexpr int row = panel + heading + gap, legend = 620;
  const int width = 3 * gap + 2 * panel + legend, height = row * static_cast<int>(shown) + gap;
  Sheet sheet;
  for (std::size_t k = 0; k < shown; ++k) {
    const auto& [body, surface] = surfaces[k];
    const double bottom = height - row * static_cast<int>(k + 1);
    sheet.heading(drawable_text(fmt::format("{}: {}", body, surface->file)), bottom);
    for (const bool behind : {false, true}) {
      Panel view;
      view.left = gap + (behind ? panel + gap : 0);
      view.bottom = bottom;
      look_from(behind, view.camera);
      view.fit(surface->soup.points);
      sheet.add_panel(view, draw(*surface, view), fmt::format("repair{}_{}", k, behind ? "behind" : "front"),
                      behind ? "from below, behind" : "from above, in front", runs.directory() + "/plots");
      sheet.add_axes_and_scale(view);
    }
    Legend list(gap + 2.0 * (panel + gap), bottom + panel - 20, bottom, sheet);
    list.entry(new_triangle, fmt::format("{} triangles that were not in the file (cut or added)",
                                         std::count(surface->is_new.begin(), surface->is_new.end(), char{1})));
    list.entry(as_before, "triangles of the file");
    for (const std::string& line : wrapped(surface->text, "", legend_columns)) list.words(line);
  }
  if (shown < surfaces.size())
    sheet.label(fmt::format("and {} more surfaces", surfaces.size() - shown), gap, gap / 2.0, "left");
  runs.start_layered("check_repair", page_settings(repair_picture, width, height) + sheet.settings + plot_nothing,
                     {{repair_picture, sheet.panels}});
  return repair_picture;
}

}  // namespace cgcontact
