#include "core/output/pictures/picture_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/output/pictures/output_gnuplot.hpp"

namespace cgcontact {

double packed(const Rgb& c) {
  double value = 0;
  for (double channel : c) value = 256 * value + std::round(255 * channel);
  return value;
}
Rgb unpacked(double value) {
  const auto v = static_cast<long>(std::lround(value));
  return {static_cast<double>(v >> 16 & 255) / 255, static_cast<double>(v >> 8 & 255) / 255,
          static_cast<double>(v & 255) / 255};
}
Rgb colour_of_body(std::size_t b) {
  static const Rgb colours[] = {{0.45, 0.62, 0.80}, {0.90, 0.68, 0.40}, {0.55, 0.75, 0.55}, {0.78, 0.55, 0.70},
                                {0.70, 0.70, 0.45}, {0.50, 0.72, 0.75}, {0.85, 0.58, 0.52}, {0.62, 0.60, 0.82}};
  return colours[b % 8];
}

std::string hex(const Rgb& c) {
  return fmt::format("#{:02x}{:02x}{:02x}", std::lround(255 * c[0]), std::lround(255 * c[1]), std::lround(255 * c[2]));
}

std::string in_unit(double value, const DisplayUnit& unit) {
  return short_number(value * unit.factor, 4) + " " + unit.name;
}

std::string sizes_of(const CutCells& cells) {
  const double largest = cells.grid.cell_size, smallest = cells.grid.cell_size_of(cells.num_levels() - 1);
  const std::string one = in_unit(largest, length_unit(largest));
  return cells.num_levels() == 1 ? one : fmt::format("{} to {}", in_unit(smallest, length_unit(smallest)), one);
}

void Panel::fit(const std::vector<Vec3>& positions) {
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (const Vec3& x : positions)
    for (int k = 0; k < 2; ++k) {
      const double coordinate = (k == 0 ? camera.right : camera.up).dot(x);
      low[k] = std::min(low[k], coordinate);
      high[k] = std::max(high[k], coordinate);
    }
  const double largest = std::max({high[0] - low[0], high[1] - low[1], 1e-300});
  size = {side, side};
  camera.pixels_per_metre = 0.86 * side / largest;
  for (int k = 0; k < 2; ++k) camera.low[k] = (low[k] + high[k]) / 2 - side / (2 * camera.pixels_per_metre);
}

void look_from(bool behind, Camera& camera) {
  camera.eye = (behind ? -1.0 : 1.0) * Vec3(0.55, -0.75, 0.42).normalized();
  camera.right = Vec3::UnitZ().cross(camera.eye).normalized();
  camera.up = camera.eye.cross(camera.right);
}

void look_against(const Vec3& normal, Camera& camera) {
  constexpr double nearly_along = 0.9;
  camera.eye = normal;
  const Vec3 up = std::abs(normal[2]) < nearly_along ? Vec3::UnitZ() : Vec3::UnitY();
  camera.right = up.cross(normal).normalized();
  camera.up = normal.cross(camera.right);
}

void Sheet::label(const std::string& text, double x, double y, const std::string& style) {
  settings += fmt::format("set label {} at {},{} {}\n", gnuplot_text(text), x, y, style);
}

void Sheet::heading(const std::string& text, double bottom) {
  label(text, gap, bottom + panel + 38, "left font ',16'");
}

void Sheet::add_panel(const Panel& view, const RenderedImage& image, const std::string& name, const std::string& title,
                      const std::string& folder) {
  const std::string file = folder + "/" + name + ".rgb";
  write_text(file, image.pixels);
  label(title, view.left + view.side / 2.0, view.bottom + view.side + 14, "center font ',13' tc rgb '#404a58'");
  panels.push_back({file, image.width, image.height, view.left, view.bottom});
}

void Sheet::add_axes_and_scale(const Panel& view) {
  constexpr double axis_length = 24, corner = 30, foot = 4;
  const double x = view.left + corner, y = view.bottom + corner;
  static const char* const names[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    const double right = view.camera.right[k], up = view.camera.up[k];
    settings += fmt::format("set arrow from {},{} to {},{} front filled size 7,20 lw 1.5 lc rgb '#303030'\n", x, y,
                            x + axis_length * right, y + axis_length * up);
    label(names[k], x + (axis_length + 8) * right, y + (axis_length + 8) * up, "center front font ',11'");
  }
  const double length = round_down(0.3 * view.side / view.camera.pixels_per_metre);
  const double end = view.left + view.side, begin = end - length * view.camera.pixels_per_metre,
               line = view.bottom + foot;
  settings += fmt::format("set arrow from {},{} to {},{} heads front size 4,90 lw 1.5 lc rgb '#303030'\n", begin, line,
                          end, line);
  const DisplayUnit unit = length_unit(length);
  label(short_number(length * unit.factor) + " " + unit.name, (begin + end) / 2, line + 10, "center front font ',11'");
}

Legend::Legend(double left, double top, double bottom, Sheet& sheet)
    : left_(left), line_(top), bottom_(bottom), sheet_(sheet) {}

void Legend::entry(const Rgb& colour, const std::string& text) {
  const std::vector<std::string> lines = wrapped(text, "", legend_columns);
  const double needed = line_height * static_cast<double>(lines.size() + 1);
  if (line_ - needed < bottom_) {
    ++left_out_;
    return;
  }
  sheet_.settings +=
      fmt::format("set object rectangle from {},{} to {},{} fs solid 1 border lc rgb '#505050' fc rgb '{}'\n", left_,
                  line_ - 9, left_ + 20, line_ + 9, hex(colour));
  for (const std::string& line : lines) label(line, left_ + 30);
}

void Legend::words(const std::string& text) { label(text, left_); }

void Legend::finish(const std::string& where) {
  if (left_out_ > 0) words(fmt::format("and {} more, {}", left_out_, where));
}

void Legend::label(const std::string& line, double left) {
  sheet_.label(line, left, line_, "left font ',12'");
  line_ -= line_height;
}

std::string page_settings(const char* file, int width, int height) {
  std::string text = fmt::format(
      "set encoding utf8\nset terminal pngcairo size {},{} noenhanced font 'sans-serif,12' transparent\n"
      "set output '../{}'\n",
      width, height, file);
  text += "set lmargin 0\nset rmargin 0\nset tmargin 0\nset bmargin 0\nunset border\nunset tics\nunset key\n";
  text += fmt::format("set xrange [0:{}]\nset yrange [0:{}]\n", width, height);
  text += "set style textbox opaque margins 0.6,0.6 fc rgb 'white' border lc rgb '#505050'\n";
  return text;
}

}  // namespace cgcontact
