#include "core/output/pictures/output_stress_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "core/base/files/text.hpp"
#include "core/output/pictures/output_gnuplot.hpp"

namespace cgcontact {

namespace {

constexpr double thin_area = 0.15;  ///< ratio of the sides below which a face is drawn as a curve

/// Layout of the samples on paper.
struct SampleLayout {
  enum class Kind { line, arc, map } kind = Kind::map;
  int first = 0, second = 1;  ///< coordinate axes with the largest and second largest extent
  Vec3 low, extent;
  double centre[2] = {0, 0}, radius = 0;  ///< arc, in the plane of both axes

  /// Coordinate along a line or arc, m.
  double along(const Vec3& x) const {
    if (kind != Kind::arc) return x[first];
    return radius * std::atan2(x[second] - centre[1], x[first] - centre[0]);
  }
};

/// Least-squares circle through the samples in the plane of the layout; false if they do not lie on one.
bool fit_circle(const std::vector<StressErrorSample>& samples, SampleLayout& layout) {
  Mat3 matrix = Mat3::Zero();
  Vec3 rhs = Vec3::Zero();
  const double scale = layout.extent[layout.first];
  const Vec3 origin = layout.low;
  for (const StressErrorSample& sample : samples) {
    const double x = (sample.x[layout.first] - origin[layout.first]) / scale;
    const double y = (sample.x[layout.second] - origin[layout.second]) / scale;
    const Vec3 row(x, y, 1);
    matrix += row * row.transpose();
    rhs += row * (x * x + y * y);
  }
  const Vec3 c = matrix.inverse() * rhs;
  const double squared = c[2] + (c[0] * c[0] + c[1] * c[1]) / 4;
  if (!c.allFinite() || squared <= 0) return false;
  layout.radius = scale * std::sqrt(squared);
  layout.centre[0] = origin[layout.first] + scale * c[0] / 2;
  layout.centre[1] = origin[layout.second] + scale * c[1] / 2;
  return std::all_of(samples.begin(), samples.end(), [&](const StressErrorSample& sample) {
    const double r = std::hypot(sample.x[layout.first] - layout.centre[0], sample.x[layout.second] - layout.centre[1]);
    return std::abs(r - layout.radius) < 0.02 * layout.extent[layout.first];
  });
}

SampleLayout make_layout(const std::vector<StressErrorSample>& samples) {
  SampleLayout layout;
  layout.low = samples.front().x;
  Vec3 high = layout.low;
  for (const StressErrorSample& sample : samples) {
    layout.low = layout.low.cwiseMin(sample.x);
    high = high.cwiseMax(sample.x);
  }
  layout.extent = high - layout.low;
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return layout.extent[a] > layout.extent[b]; });
  layout.first = axes[0];
  layout.second = axes[1];
  if (layout.extent[axes[1]] <= thin_area * layout.extent[axes[0]])
    layout.kind = SampleLayout::Kind::line;
  else if (layout.extent[axes[2]] <= thin_area * layout.extent[axes[0]] && fit_circle(samples, layout))
    layout.kind = SampleLayout::Kind::arc;
  else if (layout.first > layout.second)
    std::swap(layout.first, layout.second);
  return layout;
}

/// Largest value but for the worst half per cent, which would leave the rest in one colour.
double colour_limit(const std::vector<StressErrorSample>& samples) {
  std::vector<double> values;
  for (const StressErrorSample& sample : samples) {
    if (std::isfinite(sample.error_spr)) values.push_back(sample.error_spr);
    if (std::isfinite(sample.error_sprc)) values.push_back(sample.error_sprc);
  }
  if (values.empty()) return 1;
  const auto limit = values.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), limit, values.end());
  return *limit > 0 ? *limit : 1;
}

/// Means over the thin direction: coordinate, SPR, SPR-C; one block per body.
std::string curve_data(const std::vector<std::vector<StressErrorSample>>& bodies, const SampleLayout& layout,
                       const DisplayUnit& length, const DisplayUnit& stress) {
  std::string data;
  for (const auto& samples : bodies) {
    std::map<long long, std::array<double, 5>> bins;  // sums of s, raw, spr, sprc, count
    const double width = 1e-7 * layout.extent[layout.first];
    for (const StressErrorSample& sample : samples) {
      const double s = layout.along(sample.x);
      std::array<double, 5>& bin = bins.try_emplace(std::llround(s / width), std::array<double, 5>{}).first->second;
      const double values[5] = {s, sample.error_raw, sample.error_spr, sample.error_sprc, 1};
      for (int k = 0; k < 5; ++k) bin[k] += values[k];
    }
    for (const auto& [key, bin] : bins)
      fmt::format_to(std::back_inserter(data), "{} {} {} {}\n", bin[0] / bin[4] * length.factor,
                     bin[1] / bin[4] * stress.factor, bin[2] / bin[4] * stress.factor, bin[3] / bin[4] * stress.factor);
    data += "\n\n";
  }
  return data;
}

std::string curve_script(const Results& results, const std::vector<std::vector<StressErrorSample>>& bodies,
                         const SampleLayout& layout, const DisplayUnit& length, const DisplayUnit& stress) {
  std::string script =
      "set encoding utf8\nset terminal svg size 1100,480 fixed noenhanced font 'sans-serif,14' background 'white'\n";
  script += "set output '../stress_error.svg'\nset border 3 lw 1 lc rgb '#404040'\nset tics nomirror out\n";
  script += "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset key outside top center horizontal Left reverse samplen 2.6\n";
  script += fmt::format(
      "set multiplot layout 1,2 title {} font ',16'\nset xlabel '{} [{}]'\n",
      gnuplot_title("Error of the recovered stress on the contact face: " + results.title, 1080, 16).text,
      layout.kind == SampleLayout::Kind::arc ? "arc length" : std::string(1, "xyz"[layout.first]), length.name);
  double highest = 0;
  for (const auto& samples : bodies)
    for (const StressErrorSample& sample : samples) highest = std::max({highest, sample.error_spr, sample.error_sprc});
  if (!(highest > 0)) highest = 1 / stress.factor;
  script +=
      fmt::format("set yrange [0:{}]\nset ylabel '|stress error| [{}]'\n", 1.05 * highest * stress.factor, stress.name);
  static const char* const colours[] = {"#2070b8", "#d2501e"};
  for (int method = 0; method < 2; ++method) {
    script += fmt::format("set title '{}'\nplot", method == 0 ? "SPR" : "SPR-C");
    for (std::size_t b = 0; b < std::min<std::size_t>(bodies.size(), 2); ++b)
      script += fmt::format("{} 'stress_error.dat' index {} using 1:{} with lines lc rgb '{}' lw {} dt {} title {}",
                            b ? ", \\\n " : "", b, 3 + method, colours[method], b ? 1.6 : 2.0, b ? "(6,4)" : "1",
                            gnuplot_text(shortened_name(results.bodies[bodies[b].front().body].name, longest_entry)));
    script += "\n";
  }
  return script + "unset multiplot\n";
}

/// Samples of one body on a raster: the nearest sample gives the value, blank where none is near.
struct Raster {
  int width = 0, height = 0;
  double step[2], low[2];
  std::vector<int> sample;  ///< or -1
};

Raster make_raster(const std::vector<StressErrorSample>& samples, const SampleLayout& layout) {
  Raster raster;
  const int axes[2] = {layout.first, layout.second};
  const double largest = std::max(layout.extent[axes[0]], layout.extent[axes[1]]);
  const double spacing =
      std::sqrt(layout.extent[axes[0]] * layout.extent[axes[1]] / static_cast<double>(samples.size()));
  const double step = std::max(spacing / 2, largest / 200);
  raster.width = std::max(1, static_cast<int>(std::ceil(layout.extent[axes[0]] / step)));
  raster.height = std::max(1, static_cast<int>(std::ceil(layout.extent[axes[1]] / step)));
  for (int k = 0; k < 2; ++k) {
    raster.low[k] = layout.low[axes[k]];
    raster.step[k] = layout.extent[axes[k]] / (k == 0 ? raster.width : raster.height);
  }
  raster.sample.assign(static_cast<std::size_t>(raster.width) * raster.height, -1);
  std::vector<double> distance(raster.sample.size(), std::numeric_limits<double>::max());
  const int reach = static_cast<int>(std::ceil(2 * spacing / step));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double x = (samples[i].x[axes[0]] - raster.low[0]) / raster.step[0] - 0.5;
    const double y = (samples[i].x[axes[1]] - raster.low[1]) / raster.step[1] - 0.5;
    const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    for (int r = std::max(0, row - reach); r <= std::min(raster.height - 1, row + reach); ++r)
      for (int c = std::max(0, column - reach); c <= std::min(raster.width - 1, column + reach); ++c) {
        const double d = (c - x) * (c - x) + (r - y) * (r - y);
        const std::size_t pixel = static_cast<std::size_t>(r) * raster.width + c;
        if (d > reach * reach || d >= distance[pixel]) continue;
        distance[pixel] = d;
        raster.sample[pixel] = static_cast<int>(i);
      }
  }
  return raster;
}

/// x, y, SPR, SPR-C on the raster of each body.
std::string map_data(const std::vector<std::vector<StressErrorSample>>& bodies, const SampleLayout& layout,
                     const DisplayUnit& length, const DisplayUnit& stress) {
  std::string data;
  for (const auto& samples : bodies) {
    const Raster raster = make_raster(samples, layout);
    for (int r = 0; r < raster.height; ++r)
      for (int c = 0; c < raster.width; ++c) {
        const int i = raster.sample[static_cast<std::size_t>(r) * raster.width + c];
        const double nan = std::numeric_limits<double>::quiet_NaN();
        fmt::format_to(std::back_inserter(data), "{:.6g} {:.6g} {:.5g} {:.5g}\n",
                       (raster.low[0] + (c + 0.5) * raster.step[0]) * length.factor,
                       (raster.low[1] + (r + 0.5) * raster.step[1]) * length.factor,
                       i < 0 ? nan : samples[i].error_spr * stress.factor,
                       i < 0 ? nan : samples[i].error_sprc * stress.factor);
      }
    data += "\n\n";
  }
  return data;
}

/// Returns the title in one line, so that the maps keep their positions.
std::string title_of(const Results& results, int width) {
  const std::string what = "Error of the recovered stress on the contact face", title = what + ": " + results.title;
  return gnuplot_text(gnuplot_width(title, 16) <= width ? title : what);
}

std::string map_script(const Results& results, const std::vector<std::vector<StressErrorSample>>& bodies,
                       const SampleLayout& layout, const DisplayUnit& length, const DisplayUnit& stress) {
  const int rows = static_cast<int>(std::min<std::size_t>(bodies.size(), 2));
  const double limit = colour_limit(results.stress_errors) * stress.factor;
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size 1060,{} fixed noenhanced font 'sans-serif,14' background 'white'\n",
      60 + 440 * rows);
  script += "set output '../stress_error.svg'\nset border lw 1 lc rgb '#404040'\nset tics nomirror out\nunset key\n";
  script += gnuplot_palette() + fmt::format("set cbrange [0:{}]\nset size ratio -1\n", limit);
  for (int k = 0; k < 2; ++k) {
    const int axis = k == 0 ? layout.first : layout.second;
    script += fmt::format("set {}range [{}:{}]\nset {}label '{} [{}]'\n", "xy"[k], layout.low[axis] * length.factor,
                          (layout.low[axis] + layout.extent[axis]) * length.factor, "xy"[k], "xyz"[axis], length.name);
  }
  script += fmt::format("set multiplot layout {},2 title {} font ',16' margins 0.08,0.87,{},{} spacing 0.10,{}\n", rows,
                        title_of(results, 1040), rows == 1 ? 0.13 : 0.08, rows == 1 ? 0.84 : 0.90, 0.13);
  for (int b = 0; b < rows; ++b)
    for (int method = 0; method < 2; ++method) {
      const std::string name = shortened_name(results.bodies[bodies[b].front().body].name, longest_entry);
      script += fmt::format("set title {}\n", gnuplot_text((method == 0 ? "SPR, " : "SPR-C, ") + name));
      script += method == 0 ? "unset colorbox\n"
                            : fmt::format("set colorbox\nset cblabel '|stress error| [{}]'\n", stress.name);
      script += fmt::format("plot 'stress_error.dat' index {} using 1:2:{} with image\n", b, 3 + method);
    }
  return script + "unset multiplot\n";
}

}  // namespace

void write_stress_error_plot(const Results& results, GnuplotRuns& runs) {
  std::vector<std::vector<StressErrorSample>> bodies;
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    std::vector<StressErrorSample> samples;
    for (const StressErrorSample& sample : results.stress_errors)
      if (sample.body == static_cast<int>(b)) samples.push_back(sample);
    if (!samples.empty()) bodies.push_back(std::move(samples));
  }
  if (bodies.empty()) return;
  const SampleLayout layout = make_layout(results.stress_errors);
  const DisplayUnit length = length_unit((layout.low.cwiseAbs() + layout.extent).maxCoeff());
  const DisplayUnit stress = stress_unit(colour_limit(results.stress_errors));
  const bool curves = layout.kind != SampleLayout::Kind::map;
  write_text(runs.directory() + "/plots/stress_error.dat",
             curves ? curve_data(bodies, layout, length, stress) : map_data(bodies, layout, length, stress));
  const std::string script = curves ? curve_script(results, bodies, layout, length, stress)
                                    : map_script(results, bodies, layout, length, stress);
  runs.start("stress_error", script, {"stress_error.svg"});
}

}  // namespace cgcontact
