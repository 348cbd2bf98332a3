/// Pictures of several panels with labels and legends, in pixels, for gnuplot: those of `check` and of conditions.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/files/text.hpp"
#include "core/cells/cut_cells.hpp"
#include "core/drawing/render.hpp"
#include "core/output/pictures/png_layers.hpp"

namespace cgcontact {

using Rgb = std::array<double, 3>;  ///< channels in [0,1]

/// Pixels: side of a panel, space between panels, height of the line above a row of them.
constexpr int panel = 440, gap = 24, heading = 40;
constexpr int line_height = 24, legend_columns = 66;

/// Packs a colour as one number, for the renderer.
double packed(const Rgb& c);
Rgb unpacked(double value);
std::string hex(const Rgb& c);

Rgb colour_of_body(std::size_t b);

std::string in_unit(double value, const DisplayUnit& unit);

/// Returns the range of cell sizes: "2 mm", "0.25 mm to 2 mm".
std::string sizes_of(const CutCells& cells);

/// Plane of a panel: a picture and where it lies.
struct Panel {
  Camera camera;
  std::array<int, 2> size;
  double left, bottom;  ///< pixels in the whole picture
  int side = panel;     ///< pixels

  /// Scales the camera so that the points fit the panel.
  void fit(const std::vector<Vec3>& positions);
};

/// Looks from above in front, or from below behind.
void look_from(bool behind, Camera& camera);
/// Looks against a normal of length 1; the axis that is least along it points up, z before y before x.
void look_against(const Vec3& normal, Camera& camera);

/// Plots nothing, but draws what the settings of a page hold; the second one with the bar of colours.
constexpr const char *plot_nothing = "plot NaN notitle\n",
                     *plot_colours = "plot '+' using 1:(NaN):1 with points palette notitle\n";

/// Script of gnuplot in pixels of the whole picture, and the panels below its labels and arrows.
struct Sheet {
  std::string settings;
  std::vector<PixelLayer> panels;

  void label(const std::string& text, double x, double y, const std::string& style);
  /// Writes a heading above a row of panels.
  void heading(const std::string& text, double bottom);
  /// Adds a panel. `folder`: where gnuplot runs and the picture is written as NAME.rgb.
  void add_panel(const Panel& view, const RenderedImage& image, const std::string& name, const std::string& title,
                 const std::string& folder);
  /// Draws the coordinate axes as they are seen and a length, at the lower corners of a panel.
  void add_axes_and_scale(const Panel& view);
};

/// Lines of a legend from the top; each entry has a coloured square.
class Legend {
 public:
  Legend(double left, double top, double bottom, Sheet& sheet);

  void entry(const Rgb& colour, const std::string& text);
  void words(const std::string& text);
  /// Says how many entries had no room, and where they are to be found.
  void finish(const std::string& where);

 private:
  void label(const std::string& line, double left);

  double left_, line_, bottom_;
  int left_out_ = 0;
  Sheet& sheet_;
};

/// Returns gnuplot's settings of a picture without axes, drawn in pixels on a transparent page.
std::string page_settings(const char* file, int width, int height);

}  // namespace cgcontact
