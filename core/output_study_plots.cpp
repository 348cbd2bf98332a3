#include "core/output_study_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include "core/output_gnuplot.hpp"
#include "core/output_text.hpp"

namespace cgcontact {

namespace {

constexpr int panel_width = 520, panel_height = 400, title_height = 50, legend_line_height = 24;

/// What is drawn to the right.
struct Abscissa {
  const char *picture, *label, *title, *format;
  std::function<double(const RunFigures&)> value;
};

struct Point {
  double x, y;  ///< y in %
};

/// One pressure of one variant in one zone, from left to right.
struct Curve {
  std::size_t variant = 0;
  PressureKind kind;
  std::vector<Point> points;
};

/// Range of a logarithmic axis.
struct LogRange {
  double low = std::numeric_limits<double>::max(), high = 0;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// With some room at both ends.
  LogRange widened() const { return {low / 1.4, high * 1.4}; }
};

std::vector<Curve> curves_of_zone(const Study& study, const std::string& zone, const Abscissa& abscissa) {
  std::vector<Curve> curves;
  for (std::size_t v = 0; v < study.variants.size(); ++v)
    for (const PressureKind& kind : pressure_kinds()) {
      Curve curve{v, kind, {}};
      for (const StudyRow& row : study.rows) {
        if (row.variant != study.variants[v] || row.status != StudyRow::Status::solved) continue;
        const auto error = pressure_error(row, zone, kind);
        const double x = abscissa.value(row.figures);
        if (error && *error > smallest_error && std::isfinite(*error) && x > 0) curve.points.push_back({x, 100 * *error});
      }
      std::stable_sort(curve.points.begin(), curve.points.end(),
                       [](const Point& a, const Point& b) { return a.x < b.x; });
      curves.push_back(std::move(curve));
    }
  return curves;
}

/// Every decade, and 1, 2, 5 of each where the axis is short.
std::string tics(const LogRange& range, const char* format) {
  const bool dense = range.high / range.low < 300;
  std::string list;
  for (int power = static_cast<int>(std::floor(std::log10(range.low))); power <= std::log10(range.high); ++power)
    for (const int digit : {1, 2, 5})
      if (dense || digit == 1) list += fmt::format("{}{}e{}", list.empty() ? "" : ", ", digit, power);
  return fmt::format("format '{}' ({})", format, list);
}

std::string curve_name(const Study& study, const Curve& curve) {
  return study.variants.size() == 1 ? curve.kind.name
                                    : fmt::format("{}, {}", curve.kind.name, study.variants[curve.variant]);
}

std::string data_of(const std::vector<std::vector<Curve>>& zones) {
  std::string data;
  for (const auto& curves : zones)
    for (const Curve& curve : curves) {
      for (const Point& point : curve.points) fmt::format_to(std::back_inserter(data), "{} {}\n", point.x, point.y);
      data += curve.points.empty() ? "NaN NaN\n\n\n" : "\n\n";
    }
  return data;
}

/// Colour: kind of pressure; dashes and mark: variant.
std::string curve_style(const Curve& curve) {
  static const char* const dashes[] = {"1", "(6,4)", "(2,3)", "(8,3,2,3)"};
  static const int marks[] = {7, 5, 9, 13, 6, 4, 8, 12};
  return fmt::format("with linespoints lc rgb '{}' lw {} dt {} pt {} ps 0.7", curve.kind.colour,
                     curve.kind.error == &ZoneError::sprc ? 2.2 : 1.6, dashes[curve.variant % std::size(dashes)],
                     marks[curve.variant % std::size(marks)]);
}

std::string panel(const Study& study, const std::vector<Curve>& curves, const std::string& file, std::size_t first) {
  std::string text = "plot";
  for (std::size_t c = 0; c < curves.size(); ++c)
    text += fmt::format("{} '{}' index {} using 1:2 {} title {}", c ? ", \\\n " : "", file, first + c,
                        curve_style(curves[c]), gnuplot_text(curve_name(study, curves[c])));
  return text + "\n";
}

void write_plot(const Study& study, const Abscissa& abscissa, const std::string& directory,
                std::vector<std::string>& warnings) {
  const std::vector<std::string> zones = zone_names(study);
  std::vector<std::vector<Curve>> curves;
  LogRange x, y;
  for (const std::string& zone : zones) {
    curves.push_back(curves_of_zone(study, zone, abscissa));
    for (const Curve& curve : curves.back())
      for (const Point& point : curve.points) {
        x.add(point.x);
        y.add(point.y);
      }
  }
  if (!(x.high > 0)) return;
  const std::string file = fmt::format("{}.dat", abscissa.picture);
  write_text(directory + "/plots/" + file, data_of(curves));

  const int columns = std::min<int>(2, static_cast<int>(zones.size()));
  const int rows = (static_cast<int>(zones.size()) + 1) / 2;
  const int legend_height = legend_line_height * static_cast<int>(study.variants.size()) + 10;
  const int width = columns == 1 ? 3 * panel_width / 2 : 2 * panel_width;
  const int height = title_height + legend_height + rows * panel_height;
  const auto from_top = [&](int pixels) { return 1 - static_cast<double>(pixels) / height; };
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size {},{} fixed noenhanced font 'sans-serif,14' background 'white'\n",
      width, height);
  script += fmt::format("set output '../{}.svg'\nset border 3 lw 1 lc rgb '#404040'\nset tics nomirror out\n",
                        abscissa.picture);
  script += "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset logscale xy\nunset mxtics\nunset mytics\n";
  script += fmt::format("set key at screen 0.5,{} center top horizontal maxcols 3 Left reverse samplen 2.6\n",
                        from_top(title_height));
  x = x.widened();
  y = y.widened();
  script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x.low, x.high, y.low, y.high);
  script += fmt::format("set xtics {}\nset ytics {}\n", tics(x, abscissa.format), tics(y, "%g"));
  script += fmt::format("set xlabel '{}'\nset ylabel 'error of the contact pressure [%]'\n", abscissa.label);
  script +=
      fmt::format("set multiplot layout {},{} title {} font ',16' margins {},{},{},{} spacing {},{}\n", rows, columns,
                  gnuplot_text(fmt::format("{}: {}", abscissa.title, study.title)), 75.0 / width, 1 - 20.0 / width,
                  60.0 / height, from_top(title_height + legend_height + 25), 90.0 / width, 90.0 / height);
  for (std::size_t z = 0; z < zones.size(); ++z) {
    script += fmt::format("set title {}\n", gnuplot_text(zones[z] == "whole" ? "whole contact face" : zones[z]));
    if (z > 0) script += "unset key\n";
    script += panel(study, curves[z], file, z * curves[z].size());
  }
  script += "unset multiplot\n";
  run_gnuplot(directory, abscissa.picture, script, std::string(abscissa.picture) + ".svg", warnings);
}

}  // namespace

void write_study_plots(const Study& study, const std::string& directory, std::vector<std::string>& warnings) {
  write_plot(study,
             {"error_time", "time of the run [s]", "Error against time", "%g",
              [](const RunFigures& run) { return run.total_time_s(); }},
             directory, warnings);
  write_plot(study,
             {"error_unknowns", "unknowns [-]", "Error against unknowns", "%.0s%c",
              [](const RunFigures& run) { return static_cast<double>(run.unknowns); }},
             directory, warnings);
}

}  // namespace cgcontact
