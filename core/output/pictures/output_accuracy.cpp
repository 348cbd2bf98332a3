#include "core/output/pictures/output_accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {

/// Room beyond the values on a logarithmic axis, factor.
constexpr double room_across = 1.3, room_above = 1.5;

/// One kind of error over the solves; none: not known, or zero by equilibrium, which a logarithmic axis cannot show.
struct ErrorCurve {
  std::string name;
  const char* colour;
  std::optional<double> target;
  std::vector<std::optional<double>> errors;
};

bool has_errors(const ErrorCurve& curve) {
  return std::any_of(curve.errors.begin(), curve.errors.end(), [](const auto& error) { return error.has_value(); });
}

std::vector<ErrorCurve> curves_of(const AccuracyFigures& accuracy) {
  ErrorCurve pressure{"pressure", "#d2501e", accuracy.pressure, {}}, force{"force", "#2070b8", accuracy.force, {}},
      shear{"shear", "#505050", accuracy.shear, {}}, stress{"stress", "#6a9a3a", accuracy.stress, {}};
  for (const SolveFigures& solve : accuracy.solves) {
    pressure.errors.push_back(solve.pressure);
    force.errors.push_back(solve.force);
    shear.errors.push_back(solve.shear);
    stress.errors.push_back(solve.converged ? std::optional(solve.stress) : std::nullopt);
  }
  std::vector<ErrorCurve> all{pressure, force, shear, stress};
  constexpr const char* colours[] = {"#8a4fb0", "#b08a20", "#208a8a", "#b0406a"};
  for (std::size_t k = 0; k < accuracy.stress_of_body.size(); ++k) {
    const BodyTarget& target = accuracy.stress_of_body[k];
    ErrorCurve& curve =
        all.emplace_back(ErrorCurve{"stress in " + target.body, colours[k % std::size(colours)], target.error, {}});
    for (const SolveFigures& solve : accuracy.solves)
      curve.errors.emplace_back(
          solve.converged && k < solve.stress_of_body.size() ? std::optional(solve.stress_of_body[k]) : std::nullopt);
  }
  for (std::size_t k = 0; k < accuracy.named.size(); ++k) {
    const std::size_t colour = accuracy.stress_of_body.size() + k;
    ErrorCurve& curve = all.emplace_back(
        ErrorCurve{accuracy.named[k].text(), colours[colour % std::size(colours)], accuracy.named[k].error, {}});
    for (const SolveFigures& solve : accuracy.solves)
      curve.errors.push_back(k < solve.named.size() ? solve.named[k] : std::nullopt);
  }
  std::vector<ErrorCurve> curves;
  for (ErrorCurve& curve : all) {
    for (std::optional<double>& error : curve.errors)
      if (error && !(*error > 0 && std::isfinite(*error))) error.reset();
    if (curve.target || has_errors(curve)) curves.push_back(std::move(curve));
  }
  return curves;
}

struct PlottedRange {
  double low = std::numeric_limits<double>::max(), high = 0;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// Labels at 1, 2 and 5 times powers of ten (on a range of more than three decades at the powers only).
std::string tics(const PlottedRange& range) {
  const bool wide = range.high > 1000 * range.low;
  std::string text;
  for (int power = static_cast<int>(std::floor(std::log10(range.low))); std::pow(10.0, power) <= range.high; ++power)
    for (const int digit : {1, 2, 5}) {
      const double value = digit * std::pow(10.0, power);
      if (value < range.low || value > range.high || (wide && digit > 1)) continue;
      const std::string label = value < 1e4 ? short_number(value) : grouped(std::llround(value));
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", gnuplot_text(label), value);
    }
  return "(" + text + ")";
}

/// One row per solve: number, unknowns, time since the beginning, errors in per cent.
std::string data_of(const AccuracyFigures& accuracy, const std::vector<ErrorCurve>& curves) {
  std::string data;
  double time = 0;
  for (std::size_t k = 0; k < accuracy.solves.size(); ++k) {
    time += accuracy.solves[k].seconds;
    fmt::format_to(std::back_inserter(data), "{} {} {}", k + 1, accuracy.solves[k].unknowns, time);
    for (const ErrorCurve& curve : curves)
      data += curve.errors[k] ? fmt::format(" {:.6g}", 100 * *curve.errors[k]) : std::string(" NaN");
    data += "\n";
  }
  return data;
}

std::string script_of(const Results& results, const std::vector<ErrorCurve>& curves) {
  PlottedRange unknowns, errors;
  for (const SolveFigures& solve : results.accuracy.solves)
    unknowns.add(std::max(1.0, static_cast<double>(solve.unknowns)));
  for (const ErrorCurve& curve : curves) {
    if (curve.target) errors.add(100 * *curve.target);
    for (const auto& error : curve.errors)
      if (error) errors.add(100 * *error);
  }
  unknowns = {unknowns.low / room_across, unknowns.high * room_across};
  errors = {errors.low / room_above, errors.high * room_above};
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size 1080,480 fixed noenhanced font 'sans-serif,13' background 'white'\n"
      "set output '../accuracy.svg'\nset multiplot layout 1,2 title {}\nset border 3 lw 1 lc rgb '#404040'\n"
      "set tics nomirror out\nset grid lc rgb '#e4e4e4' lw 1 dt 1\nset xlabel 'unknowns'\nset logscale x\n"
      "set xrange [{}:{}]\nset xtics {}\nset bmargin 7\nset key outside bottom center horizontal Left reverse\n",
      gnuplot_title("Solves to the accuracy: " + results.title, 1000, 15).text, unknowns.low, unknowns.high,
      tics(unknowns));
  script += fmt::format("set logscale y\nset yrange [{}:{}]\nset ytics {}\nset ylabel 'estimated error [%]'\nplot ",
                        errors.low, errors.high, tics(errors));
  for (std::size_t c = 0; c < curves.size(); ++c)
    script += fmt::format("{}'accuracy.dat' using 2:{} with linespoints lc rgb '{}' lw 2 pt 7 ps 0.6 title '{}'",
                          c ? ", " : "", c + 4, curves[c].colour, curves[c].name);
  for (const ErrorCurve& curve : curves)
    if (curve.target)
      script += fmt::format(", {} with lines lc rgb '{}' lw 1.5 dt (8,5) title '{} asked for'", 100 * *curve.target,
                            curve.colour, curve.name);
  script +=
      "\nunset logscale y\nset yrange [0:*]\nset ytics auto\nset ylabel 'time of all solves so far [s]'\n"
      "plot 'accuracy.dat' using 2:3 with linespoints lc rgb '#606060' lw 2 pt 7 ps 0.6 notitle, "
      "'' using 2:3:1 with labels offset 0,0.9 notitle\n";
  return script + "unset multiplot\n";
}

}  // namespace

void write_accuracy_plot(const Results& results, GnuplotRuns& runs) {
  if (!results.accuracy.asked) return;
  const std::vector<ErrorCurve> curves = curves_of(results.accuracy);
  if (std::none_of(curves.begin(), curves.end(), has_errors)) return;
  write_text(runs.directory() + "/plots/accuracy.dat", data_of(results.accuracy, curves));
  runs.start("accuracy", script_of(results, curves), {"accuracy.svg"});
}

}  // namespace cgcontact
