#include "core/output/study/output_study_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include "core/base/files/text.hpp"
#include "core/output/pictures/output_gnuplot.hpp"

namespace cgcontact {

namespace {

/// Pixels. A panel is what lies around the axes, too.
constexpr int panel_width = 520, panel_height = 410, legend_line = 22;
/// Pixels of a letter, and of an entry's line and gaps.
constexpr double letter_width = 8.2;
constexpr int entry_width = 70;
/// Letters of the name of a pair.
constexpr int longest_pair = 60;
constexpr int left_margin = 95, right_margin = 35, top_margin = 45, bottom_margin = 85;

/// Abscissa of a picture.
struct Abscissa {
  const char *picture, *label, *title;
  std::function<double(const RunFigures&)> value;
};

struct Point {
  double x, y;  ///< y in %
};

/// One pressure of one variant in one zone, from left to right.
struct ZoneCurve {
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

/// The estimate is of the whole face only; elsewhere its curve has no points.
const PressureKind estimated{"result, estimated", "estimated", "#1a9850", nullptr};

std::optional<double> drawn_error(const StudyRow& row, const std::string& zone, const PressureKind& kind) {
  if (kind.error) return pressure_error(row, zone, kind);
  return zone == "whole" ? row.figures.pressure_error_estimate : std::nullopt;
}

std::vector<ZoneCurve> curves_of_zone(const Study& study, const std::string& zone, const Abscissa& abscissa) {
  std::vector<ZoneCurve> curves;
  std::vector<PressureKind> kinds = pressure_kinds();
  kinds.push_back(estimated);
  for (const PressureKind& kind : kinds)
    for (std::size_t v = 0; v < study.variants.size(); ++v) {
      ZoneCurve curve{v, kind, {}};
      for (const StudyRow& row : study.rows) {
        if (row.variant != study.variants[v] || row.status != StudyRow::Status::solved) continue;
        const auto error = drawn_error(row, zone, kind);
        const double x = abscissa.value(row.figures);
        if (error && *error > min_error && std::isfinite(*error) && x > 0) curve.points.push_back({x, 100 * *error});
      }
      std::stable_sort(curve.points.begin(), curve.points.end(),
                       [](const Point& a, const Point& b) { return a.x < b.x; });
      curves.push_back(std::move(curve));
    }
  return curves;
}

/// Every decade, and more of them where the axis is short.
std::string tics(const LogRange& range) {
  const double ratio = range.high / range.low;
  std::vector<double> digits{1};
  if (ratio < 300) digits = {1, 2, 5};
  if (ratio < 12) digits = {1, 1.5, 2, 3, 4, 5, 7};
  std::string list;
  for (int power = static_cast<int>(std::floor(std::log10(range.low))); power <= std::log10(range.high); ++power)
    for (const double digit : digits) {
      const double value = digit * std::pow(10, power);
      const std::string label = value >= 1e6   ? fmt::format("{:.6g}M", value / 1e6)
                                : value >= 1e3 ? fmt::format("{:.6g}k", value / 1e3)
                                               : fmt::format("{:.6g}", value);
      list += fmt::format("{}'{}' {}", list.empty() ? "" : ", ", label, value);
    }
  return "(" + list + ")";
}

std::string curve_name(const Study& study, const ZoneCurve& curve) {
  return study.variants.size() == 1 ? curve.kind.name
                                    : fmt::format("{}, {}", curve.kind.name, study.variants[curve.variant]);
}

std::string data_of(const std::vector<std::vector<ZoneCurve>>& zones) {
  std::string data;
  for (const auto& curves : zones)
    for (const ZoneCurve& curve : curves) {
      for (const Point& point : curve.points) fmt::format_to(std::back_inserter(data), "{} {}\n", point.x, point.y);
      data += curve.points.empty() ? "NaN NaN\n\n\n" : "\n\n";
    }
  return data;
}

/// Colour: kind of pressure; dashes and mark: variant.
std::string curve_style(const ZoneCurve& curve) {
  static const char* const dashes[] = {"1", "(6,4)", "(2,3)", "(8,3,2,3)"};
  static const int marks[] = {7, 5, 9, 13, 6, 4, 8, 12};
  return fmt::format("with linespoints lc rgb '{}' lw {} dt {} pt {} ps 0.7", curve.kind.colour,
                     curve.kind.error == &ZoneError::sprc ? 2.2 : 1.6, dashes[curve.variant % std::size(dashes)],
                     marks[curve.variant % std::size(marks)]);
}

/// Panels in two columns below title and legend.
struct PanelLayout {
  int columns, width, height, top, title_height, legend_columns;
  GnuplotTitle title;

  PanelLayout(std::size_t panels, const std::string& heading, const std::vector<std::string>& entries)
      : columns(panels == 1 ? 1 : 2), width(panels == 1 ? 3 * panel_width / 2 : 2 * panel_width) {
    title = gnuplot_title(heading, width - 20, 16);
    title_height = 28 + legend_line * title.lines;
    int longest = 1;
    for (const std::string& entry : entries) longest = std::max(longest, columns_of(entry));
    const int count = std::max<int>(1, static_cast<int>(entries.size()));
    legend_columns = std::clamp(static_cast<int>((width - 40) / (letter_width * longest + entry_width)), 1, count);
    top = title_height + legend_line * ((count + legend_columns - 1) / legend_columns);
    height = top + (static_cast<int>(panels) + columns - 1) / columns * panel_height;
  }
  double from_top(int pixels) const { return 1 - static_cast<double>(pixels) / height; }
  std::string key() const {
    return fmt::format("set key at screen 0.5,{} center top vertical maxcols {} Left reverse samplen 2.6\n",
                       from_top(title_height), legend_columns);
  }
  std::string margins(std::size_t panel) const {
    const int column = static_cast<int>(panel) % columns, row = static_cast<int>(panel) / columns;
    const double step = static_cast<double>(width) / columns;
    return fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset tmargin at screen {}\nset bmargin at screen {}\n",
        (column * step + left_margin) / width, ((column + 1) * step - right_margin) / width,
        from_top(top + row * panel_height + top_margin), from_top(top + (row + 1) * panel_height - bottom_margin));
  }
};

/// Everything but the curves.
std::string frame(const Abscissa& abscissa, const PanelLayout& layout, const LogRange& x, const LogRange& y) {
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size {},{} fixed noenhanced font 'sans-serif,14' background 'white'\n",
      layout.width, layout.height);
  script += fmt::format("set output '../{}.svg'\nset border 3 lw 1 lc rgb '#404040'\nset tics nomirror out\n",
                        abscissa.picture);
  script += "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset logscale xy\nunset mxtics\nunset mytics\n";
  script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x.low, x.high, y.low, y.high);
  script += fmt::format("set xtics {}\nset ytics {}\n", tics(x), tics(y));
  script += fmt::format("set xlabel '{}'\nset ylabel 'error of the contact pressure [%]'\n", abscissa.label);
  return script + layout.key() + fmt::format("set multiplot title {} font ',16'\n", layout.title.text);
}

std::string draw_panel(const Study& study, const std::vector<ZoneCurve>& curves, const std::string& file,
                       std::size_t first) {
  std::string text = "plot";
  for (std::size_t c = 0; c < curves.size(); ++c)
    text += fmt::format("{} '{}' index {} using 1:2 {} title {}", c ? ", \\\n " : "", file, first + c,
                        curve_style(curves[c]), gnuplot_text(curve_name(study, curves[c])));
  return text + "\n";
}

void write_plot(const Study& study, const Abscissa& abscissa, GnuplotRuns& runs) {
  const std::vector<std::string> zones = zone_names(study);
  std::vector<std::vector<ZoneCurve>> curves;
  LogRange x, y;
  for (const std::string& zone : zones) {
    curves.push_back(curves_of_zone(study, zone, abscissa));
    for (const ZoneCurve& curve : curves.back())
      for (const Point& point : curve.points) {
        x.add(point.x);
        y.add(point.y);
      }
  }
  if (!(x.high > 0)) return;
  const std::string file = fmt::format("{}.dat", abscissa.picture);
  write_text(runs.directory() + "/plots/" + file, data_of(curves));

  std::vector<std::string> entries;
  for (const ZoneCurve& curve : curves.front()) entries.push_back(curve_name(study, curve));
  const std::string heading =
      fmt::format("{}: {}{}", abscissa.title, study.title, study.own_reference ? " (reference: own finest run)" : "");
  const PanelLayout layout(zones.size(), heading, entries);
  std::string script = frame(abscissa, layout, x.widened(), y.widened());
  for (std::size_t z = 0; z < zones.size(); ++z) {
    script += layout.margins(z) +
              fmt::format("set title {}\n", gnuplot_text(zones[z] == "whole" ? "whole contact face" : zones[z]));
    if (z > 0) script += "unset key\n";
    script += draw_panel(study, curves[z], file, z * curves[z].size());
  }
  script += "unset multiplot\n";
  runs.start(abscissa.picture, script, {std::string(abscissa.picture) + ".svg"});
}

/// One quantity of the contact pairs over the sizes.
struct PlottedQuantity {
  const char* name;
  double RunFigures::Pair::*value;
  DisplayUnit (*unit)(double largest);
};
constexpr std::size_t num_quantities = 3, max_curves = 8;
const PlottedQuantity quantities[num_quantities] = {{"force", &RunFigures::Pair::force, force_unit},
                                                    {"largest pressure", &RunFigures::Pair::max_pressure, stress_unit},
                                                    {"contact area", &RunFigures::Pair::area, area_unit}};

/// Pair of one variant, from left to right.
struct FigureCurve {
  std::string name;
  std::vector<std::pair<double, RunFigures::Pair>> points;
};

std::vector<FigureCurve> figure_curves(const Study& study) {
  std::vector<FigureCurve> curves;
  std::vector<std::string> pairs;  // automatic contact may have other ones in other runs
  for (const StudyRow& row : study.rows)
    for (const auto& pair : row.figures.pairs)
      if (std::find(pairs.begin(), pairs.end(), pair.name) == pairs.end()) pairs.push_back(pair.name);
  for (const std::string& pair : pairs)
    for (const std::string& variant : study.variants) {
      FigureCurve curve;
      for (const StudyRow& row : study.rows) {
        if (row.variant != variant || row.status != StudyRow::Status::solved) continue;
        curve.name = shortened_name(pair, longest_pair) + (study.variants.size() > 1 ? ", " + variant : "");
        for (const auto& figures : row.figures.pairs)
          if (figures.name == pair) curve.points.emplace_back(std::stod(row.size), figures);
      }
      std::stable_sort(curve.points.begin(), curve.points.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      if (!curve.points.empty() && curves.size() < max_curves) curves.push_back(std::move(curve));
    }
  return curves;
}

/// Force, largest pressure and area over what the study varies: figures.svg.
void write_figures_plot(const Study& study, GnuplotRuns& runs) {
  static const char* const colours[] = {"#2070b8", "#d2501e", "#1a9850", "#7b3fa0",
                                        "#b8860b", "#17a2a2", "#c03060", "#606060"};
  const std::vector<FigureCurve> curves = figure_curves(study);
  if (curves.empty()) return;
  std::vector<std::string> entries;
  std::string data;
  for (const FigureCurve& curve : curves) {
    entries.push_back(curve.name);
    for (const auto& [size, pair] : curve.points)
      fmt::format_to(std::back_inserter(data), "{} {} {} {}\n", size, pair.force, pair.max_pressure, pair.area);
    data += "\n\n";
  }
  write_text(runs.directory() + "/plots/figures.dat", data);
  const PanelLayout layout(num_quantities, "Contact over " + study.key + ": " + study.title, entries);
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size {},{} fixed noenhanced font 'sans-serif,14' background 'white'\n"
      "set output '../figures.svg'\nset border 3 lw 1 lc rgb '#404040'\nset tics nomirror out\n"
      "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset yrange [0:*]\nset offsets graph 0.05, graph 0.05, graph 0.08, 0\n"
      "set xlabel {}\n{}set multiplot title {} font ',16'\n",
      layout.width, layout.height, gnuplot_text(study.key), layout.key(), layout.title.text);
  for (std::size_t q = 0; q < num_quantities; ++q) {
    double largest = 0;
    for (const FigureCurve& curve : curves)
      for (const auto& point : curve.points) largest = std::max(largest, point.second.*quantities[q].value);
    const DisplayUnit unit = quantities[q].unit(largest);
    script += layout.margins(q) + fmt::format("set ylabel '{} [{}]'\nplot", quantities[q].name, unit.name);
    for (std::size_t c = 0; c < curves.size(); ++c)
      script += fmt::format(
          "{} 'figures.dat' index {} using 1:(${}*{}) with linespoints lc rgb '{}' lw 2 pt 7 ps 0.7 title {}",
          c ? ", \\\n " : "", c, q + 2, unit.factor, colours[c % max_curves], gnuplot_text(curves[c].name));
    script += "\nunset key\n";
  }
  runs.start("figures", script + "unset multiplot\n", {"figures.svg"});
}

}  // namespace

void write_study_plots(const Study& study, const std::string& directory, std::vector<std::string>& warnings) {
  GnuplotRuns runs(directory);
  write_plot(study,
             {"error_time", "time of the run [s]", "Error against time",
              [](const RunFigures& run) { return run.total_time_s(); }},
             runs);
  write_plot(study,
             {"error_unknowns", "unknowns [-]", "Error against unknowns",
              [](const RunFigures& run) { return static_cast<double>(run.unknowns); }},
             runs);
  write_figures_plot(study, runs);
  const std::vector<std::string>& found = runs.finish();
  warnings.insert(warnings.end(), found.begin(), found.end());
}

}  // namespace cgcontact
