#include "core/output/pictures/output_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "core/base/files/text.hpp"
#include "core/drawing/curve_ends.hpp"
#include "core/drawing/scene_view.hpp"
#include "core/output/pictures/output_accuracy.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/pictures/output_pressure_map.hpp"
#include "core/output/pictures/output_probes.hpp"
#include "core/output/pictures/output_stress_error.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t max_path_bodies = 2;  ///< bodies of a path that are drawn

/// Samples of a pair's path by body, each sorted along the path.
std::vector<std::vector<PathSample>> samples_by_body(const Results& results, int pair) {
  std::vector<std::vector<PathSample>> bodies;
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    std::vector<PathSample> samples;
    for (const PathSample& sample : results.path)
      if (sample.body == static_cast<int>(b) && sample.pair == pair) samples.push_back(sample);
    std::stable_sort(samples.begin(), samples.end(), [](const auto& p, const auto& q) { return p.s < q.s; });
    if (!samples.empty()) bodies.push_back(std::move(samples));
  }
  return bodies;
}

/// Range of the recovered and reference pressure; the raw one may leave it.
std::pair<double, double> pressure_range(const std::vector<std::vector<PathSample>>& bodies) {
  double low = 0, high = 0;
  for (const auto& samples : bodies)
    for (const PathSample& sample : samples)
      for (double p :
           {sample.pressure_spr, sample.pressure_sprc, sample.has_reference ? sample.pressure_reference : 0.0}) {
        if (!std::isfinite(p)) continue;
        low = std::min(low, p);
        high = std::max(high, p);
      }
  if (high <= low) high = low + 1;
  return {low - 0.08 * (high - low), high + 0.12 * (high - low)};
}

struct PressureAxes {
  DisplayUnit length, stress;
  double low, high;    ///< Pa
  double first, last;  ///< m, along the path
};

/// End of a body's curve at a plane of symmetry.
struct PathEnd {
  std::size_t curve;
  CurveEnd at;
};

/// Planes of symmetry that the zone of a path's pair reaches; of a path of the scene those of all pairs.
std::vector<SymmetryPlane> planes_of_path(const Results& results, int pair) {
  if (results.path_from_largest) return results.pairs[static_cast<std::size_t>(pair)].zone.planes;
  std::vector<SymmetryPlane> planes;
  for (const PairFigures& figures : results.pairs)
    planes.insert(planes.end(), figures.zone.planes.begin(), figures.zone.planes.end());
  return planes;
}

/// Finds the ends at which planes of symmetry cut the zone; where nothing is pressed, they cut nothing off.
std::vector<PathEnd> ends_at_planes(const std::vector<std::vector<PathSample>>& bodies,
                                    const std::vector<SymmetryPlane>& planes) {
  std::vector<PathEnd> ends;
  for (std::size_t b = 0; b < std::min(bodies.size(), max_path_bodies); ++b) {
    const std::vector<PathSample>& samples = bodies[b];
    double largest = 0;
    for (const PathSample& p : samples) largest = std::max(largest, p.pressure_sprc);
    for (const bool last : {false, true}) {
      const PathSample& tip = last ? samples.back() : samples.front();
      const PathSample& inner = samples.size() < 2 ? tip : last ? samples[samples.size() - 2] : samples[1];
      if (!(tip.pressure_sprc > zone_end * largest)) continue;
      if (const auto end = end_at_plane({tip.s, tip.x, tip.x - inner.x, tip.s - inner.s}, planes))
        ends.push_back({b, *end});
    }
  }
  return ends;
}

/// Range of the path, mirror images included.
void set_range(const std::vector<std::vector<PathSample>>& bodies, const std::vector<PathEnd>& ends,
               PressureAxes& axes) {
  axes.first = axes.last = bodies.front().front().s;
  const auto add = [&](double s) {
    axes.first = std::min(axes.first, s);
    axes.last = std::max(axes.last, s);
  };
  for (const auto& samples : bodies)
    for (const PathSample& p : samples) add(p.s);
  for (const PathEnd& end : ends)
    if (end.at.across)
      for (const PathSample& p : bodies[end.curve]) add(end.at.mirrored(p.s));
}

/// One block per body: s, raw, SPR, SPR-C, reference; then one per end at a plane: s, SPR-C of the mirror image.
std::string pressure_data(const std::vector<std::vector<PathSample>>& bodies, const std::vector<PathEnd>& ends,
                          const PressureAxes& axes) {
  std::string data;
  for (const auto& samples : bodies) {
    for (const PathSample& p : samples)
      fmt::format_to(std::back_inserter(data), "{} {} {} {} {}\n", p.s * axes.length.factor,
                     p.pressure_raw * axes.stress.factor, p.pressure_spr * axes.stress.factor,
                     p.pressure_sprc * axes.stress.factor,
                     p.has_reference ? fmt::format("{}", p.pressure_reference * axes.stress.factor) : "NaN");
    data += "\n\n";
  }
  for (const PathEnd& end : ends) {
    std::vector<CurvePoint> curve;
    for (const PathSample& p : bodies[end.curve]) curve.push_back({p.s, p.pressure_sprc});
    for (const auto& [s, pressure] : mirror_image(std::move(curve), end.at))
      fmt::format_to(std::back_inserter(data), "{} {}\n", s * axes.length.factor, pressure * axes.stress.factor);
    data += "\n\n";
  }
  return data;
}

/// Mirror images as lighter lines, and lines at the planes; ends at planes that are not across say so.
std::string mirrored_curves(const std::vector<PathEnd>& ends, std::size_t num_curves, double largest,
                            const std::string& data) {
  std::string text;
  std::set<std::string> named;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const CurveEnd& end = ends[k].at;
    const std::string name = (end.across ? "mirrored at " : "ends at symmetry, ") + name_of(end.plane, largest);
    const std::string title = named.insert(name).second ? "title " + gnuplot_text(name) : "notitle";
    if (end.across)
      text += fmt::format("  '{}' index {} using 1:2 with lines lc rgb '{}' lw {} dt {} {}, \\\n", data, num_curves + k,
                          mirrored_colour, ends[k].curve == 0 ? 2.4 : 1.9, ends[k].curve == 0 ? "1" : "(6,4)", title);
    else
      text += fmt::format("  NaN with lines lc rgb '{}' lw 1.4 dt {} {}, \\\n", plane_colour, plane_dashes, title);
  }
  return text;
}

/// First body as full lines, the second one dashed, with one line of legend for each kind of pressure.
std::string pressure_curves(const Results& results, const std::vector<std::vector<PathSample>>& bodies,
                            const std::string& data) {
  struct Curve {
    int column;
    const char *name, *colour;
    double width;
  };
  std::vector<Curve> curves{{2, "raw stress", "#b0b0b0", 1.0}, {3, "SPR", "#2070b8", 1.8}};
  curves.push_back({4, name_of_pressure(results.pairs[bodies.front().front().pair].pressure_on_face), "#d2501e", 2.4});
  std::string text;
  for (const Curve& curve : curves)
    for (std::size_t b = 0; b < std::min(bodies.size(), max_path_bodies); ++b)
      text += fmt::format("  '{}' index {} using 1:{} with lines lc rgb '{}' lw {} dt {} {}, \\\n", data, b,
                          curve.column, curve.colour, b == 0 ? curve.width : 0.8 * curve.width, b == 0 ? "1" : "(6,4)",
                          b == 0 ? fmt::format("title '{}'", curve.name) : "notitle");
  if (std::any_of(results.path.begin(), results.path.end(), [](const PathSample& p) { return p.has_reference; }))
    text +=
        fmt::format("  '{}' index 0 using 1:5 with lines lc rgb 'black' lw 1.4 dt (2,3) title 'reference', \\\n", data);
  if (bodies.size() > 1)
    for (int b = 0; b < 2; ++b)
      text += fmt::format("  NaN with lines lc rgb '#606060' lw 1.6 dt {} title {}, \\\n", b == 0 ? "1" : "(6,4)",
                          gnuplot_text(shortened_name(results.bodies[bodies[b].front().body].name, longest_entry)));
  return text;
}

void write_pressure_plot(const Results& results, const Scene& scene, int pair, GnuplotRuns& runs) {
  const auto bodies = samples_by_body(results, pair);
  if (bodies.empty()) return;
  const std::vector<PathEnd> ends = ends_at_planes(bodies, planes_of_path(results, pair));
  const std::string picture = path_picture(static_cast<std::size_t>(pair));
  const std::string name = picture.substr(0, picture.size() - 4);  // without .svg
  const auto [low, high] = pressure_range(bodies);
  PressureAxes axes{{}, stress_unit(std::max(-low, high) / 1.12), low, high, 0, 0};
  set_range(bodies, ends, axes);
  const double largest_s = std::max(-axes.first, axes.last);
  axes.length = length_unit(largest_s);
  write_text(runs.directory() + "/plots/" + name + ".dat", pressure_data(bodies, ends, axes));

  const bool by_reference = !scene.reference.pressure_file.empty();
  const std::string of_pair = results.pairs.size() > 1 && results.path_from_largest
                                  ? results.pairs[static_cast<std::size_t>(pair)].name + ", "
                                  : "";
  const GnuplotTitle title = gnuplot_title("Contact pressure: " + of_pair + results.title, 860, 15);
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size 900,{} fixed noenhanced font 'sans-serif,15' background 'white'\n",
      560 + 20 * (title.lines - 1));
  script += fmt::format("set output '../{}'\nset border 3 lw 1 lc rgb '#404040'\nset tics nomirror out\n", picture);
  script +=
      "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset key outside right center vertical Left reverse samplen 2.6 spacing "
      "1.25\n";
  const double height = 560 + 20 * (title.lines - 1);
  script += fmt::format("set label {} at screen 0.5,{} center font ',15'\nset tmargin at screen {}\n", title.text,
                        1 - 24 / height, 1 - (24 + 20 * title.lines) / height);
  const char* const along =
      results.path_from_largest ? "along the face, from the largest pressure" : "position on the path";
  script += fmt::format("set xlabel '{} [{}]'\nset ylabel 'contact pressure [{}]'\n",
                        by_reference ? name_of(scene.reference.coordinate) : along, axes.length.name, axes.stress.name);
  script += fmt::format("set yrange [{}:{}]\nset xzeroaxis lc rgb '#808080' lw 1 dt 1\n", low * axes.stress.factor,
                        high * axes.stress.factor);
  if (axes.last > axes.first)
    script += fmt::format("set xrange [{}:{}]\n", axes.first * axes.length.factor, axes.last * axes.length.factor);
  for (const PathEnd& end : ends)
    script += fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead lc rgb '{1}' lw 1 dt {2}\n",
                          end.at.s * axes.length.factor, plane_colour, plane_dashes);
  script += "plot \\\n" + pressure_curves(results, bodies, name + ".dat") +
            mirrored_curves(ends, bodies.size(), largest_s, name + ".dat") + "  NaN notitle\n";
  runs.start(name, script, {picture});
}

/// Plots the pairs with the largest forces, as the pressure maps do.
void write_pressure_plots(const Results& results, const Scene& scene, GnuplotRuns& runs) {
  if (results.path.empty()) {
    if (!results.contact_rows.empty() && !results.path_from_largest)
      runs.warn("no pressure.svg: output.path meets no contact face");
    return;
  }
  if (!results.path_from_largest) return write_pressure_plot(results, scene, 0, runs);
  for (const std::size_t pair : pairs_to_draw(results))
    write_pressure_plot(results, scene, static_cast<int>(pair), runs);
}

/// Force, area and largest pressure of every contact pair against the number of the step.
void write_steps_plot(const Results& results, GnuplotRuns& runs) {
  const std::size_t num_pairs = results.steps.back().pairs.size();
  double force = 0, pressure = 0, area = 0;
  std::string data;
  for (std::size_t p = 0; p < num_pairs; ++p) {
    for (std::size_t k = 0; k < results.steps.size(); ++k) {
      const PairFigures& pair = results.steps[k].pairs[p];
      force = std::max(force, told_force(pair));
      pressure = std::max(pressure, pair.max_pressure);
      area = std::max(area, pair.area);
      fmt::format_to(std::back_inserter(data), "{} {} {} {}\n", k + 1, told_force(pair), pair.area, pair.max_pressure);
    }
    data += "\n\n";
  }
  const DisplayUnit stress = stress_unit(pressure), newton = force_unit(force), square = area_unit(area);
  write_text(runs.directory() + "/plots/steps.dat", data);
  const std::tuple<const char*, std::string, double> panels[] = {{"force", newton.name, newton.factor},
                                                                 {"area", square.name, square.factor},
                                                                 {"largest pressure", stress.name, stress.factor}};
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size 1080,420 fixed noenhanced font 'sans-serif,13' background 'white'\n"
      "set output '../steps.svg'\nset multiplot layout 1,3 title {}\nset border 3 lw 1 lc rgb '#404040'\n"
      "set tics nomirror out\nset grid lc rgb '#e4e4e4' lw 1 dt 1\nset xlabel 'step'\nset xrange [0.5:{}]\n"
      "set xtics {}\nset yrange [0:*]\n"
      "set key outside bottom center horizontal Left reverse\n",
      gnuplot_title("Contact in steps: " + results.title, 1000, 15).text,
      static_cast<double>(results.steps.size()) + 0.5, 1 + results.steps.size() / 12);
  int column = 2;
  for (const auto& [name, unit, factor] : panels) {
    script += fmt::format("set ylabel '{} [{}]'\nplot ", name, unit);
    for (std::size_t p = 0; p < num_pairs; ++p)
      script += fmt::format("{}'steps.dat' index {} using 1:(${}*{}) with linespoints lw 2 pt 7 ps 0.6 title {}",
                            p == 0 ? "" : ", ", p, column, factor,
                            gnuplot_text(shortened_name(results.steps.back().pairs[p].name, longest_entry)));
    script += "\n";
    ++column;
  }
  runs.start("steps", script + "unset multiplot\n", {"steps.svg"});
}

}  // namespace

const char* name_of_pressure(bool on_face) { return on_face ? "on the face" : "SPR-C"; }

const char* name_of_pressure(const Results& results) {
  return name_of_pressure(std::all_of(results.pairs.begin(), results.pairs.end(),
                                      [](const PairFigures& pair) { return pair.pressure_on_face; }));
}

std::string path_picture(std::size_t pair) {
  return pair == 0 ? "pressure.svg" : fmt::format("pressure_{}.svg", pair + 1);
}

void write_plots(const Results& results, const Scene& scene, GnuplotRuns& runs) {
  std::filesystem::create_directory(runs.directory() + "/plots");
  write_pressure_plots(results, scene, runs);
  write_stress_error_plot(results, runs);
  write_accuracy_plot(results, runs);
  write_probe_plots(results, runs);
  if (!results.steps.empty() && !results.pairs.empty()) write_steps_plot(results, runs);
}

}  // namespace cgcontact
