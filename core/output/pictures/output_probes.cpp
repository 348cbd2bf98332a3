#include "core/output/pictures/output_probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/base/files/text.hpp"
#include "core/output/fields/output_csv.hpp"

namespace cgcontact {

namespace {

const char* const line_colours[] = {"#2070b8", "#d2501e", "#3a9a50", "#8a5fb0",
                                    "#b08a20", "#20a0a8", "#c04a80", "#606060"};

/// One panel of a plot: the lengths or the stresses.
struct PlotPanel {
  std::vector<std::size_t> fields;
  DisplayUnit unit;
  const char* name;
};

double largest_value(const ProbeFigures& probe, const std::vector<std::size_t>& fields) {
  double largest = 0;
  for (const std::size_t f : fields)
    if (const auto range = range_of(probe, f))
      largest = std::max({largest, std::abs(range->smallest.value), std::abs(range->largest.value)});
  return largest;
}

std::vector<PlotPanel> panels_of(const ProbeFigures& probe) {
  PlotPanel lengths{{}, {}, "displacement"}, stresses{{}, {}, "stress"};
  for (std::size_t f = 0; f < probe.fields.size(); ++f)
    if (range_of(probe, f)) (is_length(probe.fields[f]) ? lengths : stresses).fields.push_back(f);
  lengths.unit = length_unit(largest_value(probe, lengths.fields));
  stresses.unit = stress_unit(largest_value(probe, stresses.fields));
  std::vector<PlotPanel> panels;
  for (const PlotPanel& panel : {lengths, stresses})
    if (!panel.fields.empty()) panels.push_back(panel);
  return panels;
}

/// One block per body: way, values in SI; a line without numbers where points are missing.
std::string plot_data(const ProbeFigures& probe, const std::vector<int>& bodies, double way_factor) {
  std::string data;
  for (const int body : bodies) {
    int last = -1;
    for (const ProbeSample& sample : probe.samples) {
      if (sample.body != body) continue;
      if (last >= 0 && sample.point != last + 1) data += "\n";
      last = sample.point;
      fmt::format_to(std::back_inserter(data), "{}", sample.way * way_factor);
      for (const double value : sample.values)
        data += std::isfinite(value) ? fmt::format(" {}", value) : std::string(" NaN");
      data += "\n";
    }
    data += "\n\n";
  }
  return data;
}

void write_plot(const Results& results, const ProbeFigures& probe, GnuplotRuns& runs) {
  const std::vector<PlotPanel> panels = panels_of(probe);
  if (panels.empty()) return;
  std::set<int> found;
  for (const ProbeSample& sample : probe.samples) found.insert(sample.body);
  const std::vector<int> bodies(found.begin(), found.end());
  const bool on_circle = probe.kind == ProbeSpec::Kind::circle;
  const DisplayUnit way = on_circle ? DisplayUnit{1, "degrees"} : length_unit(probe.samples.back().way);
  const std::string name = "probe_" + probe.name, data = name + ".dat";
  write_text(runs.directory() + "/plots/" + data, plot_data(probe, bodies, way.factor));
  const int width = panels.size() == 1 ? 800 : 1300;
  const GnuplotTitle title = gnuplot_title(probe.name + ": " + results.title, width - 40, 15);
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size {},{} fixed noenhanced font 'sans-serif,14' background 'white'\n"
      "set output '../{}'\nset multiplot layout 1,{} title {}\nset border 3 lw 1 lc rgb '#404040'\n"
      "set tics nomirror out\nset grid lc rgb '#e4e4e4' lw 1 dt 1\nset xlabel '{} [{}]'\n"
      "set key outside bottom center horizontal Left reverse samplen 2\nset xzeroaxis lc rgb '#808080' lw 1 dt 1\n",
      width, 500 + 20 * (title.lines - 1), probe_picture(probe), panels.size(), title.text,
      on_circle ? "angle" : "position on the line", way.name);
  for (const PlotPanel& panel : panels) {
    script += fmt::format("set ylabel '{} [{}]'\nplot ", panel.name, panel.unit.name);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (const std::size_t f : panel.fields) {
        const std::string entry =
            name_of(probe.fields[f]) + (bodies.size() > 1 ? ", " + results.bodies[bodies[b]].name : "");
        script += fmt::format("'{}' index {} using 1:(${}*{}) with lines lc rgb '{}' lw 2 dt {} title {}, \\\n", data,
                              b, f + 2, panel.unit.factor, line_colours[f % std::size(line_colours)],
                              b == 0 ? "1" : fmt::format("({},4)", 2 + 4 * b),
                              gnuplot_text(shortened_name(entry, longest_entry)));
      }
    script += "  NaN notitle\n";
  }
  runs.start(name, script + "unset multiplot\n", {probe_picture(probe)});
}

}  // namespace

std::optional<ProbeRange> range_of(const ProbeFigures& probe, std::size_t field) {
  std::optional<ProbeRange> range;
  for (const ProbeSample& sample : probe.samples) {
    const Extreme here{sample.values[field], sample.x};
    if (!std::isfinite(here.value)) continue;
    if (!range) range = ProbeRange{here, here};
    if (here.value < range->smallest.value) range->smallest = here;
    if (here.value > range->largest.value) range->largest = here;
  }
  return range;
}

void write_probes_csv(const Results& results, const std::string& file_name) {
  std::vector<ScalarField> columns;
  for (int k = 0; k < static_cast<int>(scalar_field_names().size()); ++k)
    for (const ProbeFigures& probe : results.probes)
      if (std::find(probe.fields.begin(), probe.fields.end(), static_cast<ScalarField>(k)) != probe.fields.end()) {
        columns.push_back(static_cast<ScalarField>(k));
        break;
      }
  std::string text = "probe,point,body,way,x,y,z,weight";
  for (const ScalarField field : columns) text += "," + name_of(field);
  text += "\n";
  for (const ProbeFigures& probe : results.probes)
    for (const ProbeSample& sample : probe.samples) {
      text += fmt::format("{},{},{}", csv_text(probe.name), sample.point, csv_text(results.bodies[sample.body].name));
      for (const double value : {sample.way, sample.x[0], sample.x[1], sample.x[2], sample.weight})
        fmt::format_to(std::back_inserter(text), ",{:.{}g}", value, csv_digits);
      for (const ScalarField field : columns) {
        const auto found = std::find(probe.fields.begin(), probe.fields.end(), field);
        const double value = found == probe.fields.end()
                                 ? std::nan("")
                                 : sample.values[static_cast<std::size_t>(found - probe.fields.begin())];
        text += std::isfinite(value) ? fmt::format(",{:.{}g}", value, csv_digits) : ",";
      }
      text += "\n";
    }
  write_text(file_name, text);
}

std::string probe_picture(const ProbeFigures& probe) { return "probe_" + probe.name + ".svg"; }

void write_probe_plots(const Results& results, GnuplotRuns& runs) {
  for (const ProbeFigures& probe : results.probes)
    if ((probe.kind == ProbeSpec::Kind::line || probe.kind == ProbeSpec::Kind::circle) && probe.samples.size() > 1)
      write_plot(results, probe, runs);
}

}  // namespace cgcontact
