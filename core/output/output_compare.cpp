#include "core/output/output_compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>

#include "core/base/errors/errors.hpp"
#include "core/base/files/json.hpp"
#include "core/base/files/text.hpp"
#include "core/output/fields/output_csv.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/report/read_report.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

/// A figure that both have.
struct ComparedFigure {
  std::string name, unit;
  double a, b;

  double difference() const { return b - a; }
  /// None where the first one is zero.
  std::optional<double> relative() const {
    return a != 0 ? std::optional<double>((b - a) / std::abs(a)) : std::nullopt;
  }
};

/// The elements of a list by their names.
std::map<std::string, const Json*> by_name(const Json& list) {
  std::map<std::string, const Json*> elements;
  for (const Json& element : list)
    if (element.is_object() && element.value("name", Json()).is_string()) elements[element.at("name")] = &element;
  return elements;
}

std::optional<double> number(const Json& json) {
  return json.is_number() ? std::optional<double>(json.get<double>()) : std::nullopt;
}

/// Returns the number at a path such as "/zone/half_axes/0".
std::optional<double> number(const Json& json, const std::string& path) {
  const Json::json_pointer pointer(path);
  return json.contains(pointer) ? number(json.at(pointer)) : std::nullopt;
}

/// Returns the magnitude of a pair's force on its first body.
std::optional<double> force_of(const Json& pair) {
  const Json forces = pair.value("force", Json());
  if (!forces.is_object() || forces.empty()) return std::nullopt;
  const Json& force = forces.front();
  double squares = 0;
  for (const Json& component : force) squares += std::pow(number(component).value_or(0), 2);
  return std::sqrt(squares);
}

/// Quantity compared between two elements of the same name.
struct ReportEntry {
  const char *name, *path, *unit;
};
constexpr ReportEntry run_entries[] = {{"unknowns", "/unknowns", ""},
                                       {"est. error of the stress", "/estimated_error/relative", ""}};
constexpr ReportEntry pair_entries[] = {{"normal force", "/normal_force", "N"},
                                        {"largest pressure", "/max_pressure", "Pa"},
                                        {"mean pressure", "/mean_pressure", "Pa"},
                                        {"area", "/area", "m^2"},
                                        {"half axis a", "/zone/half_axes/0", "m"},
                                        {"half axis b", "/zone/half_axes/1", "m"},
                                        {"est. error of the pressure", "/pressure_error_estimate", ""}};
constexpr ReportEntry body_entries[] = {{"von Mises", "/max_von_mises", "Pa"},
                                        {"largest principal", "/max_principal", "Pa"},
                                        {"smallest principal", "/min_principal", "Pa"},
                                        {"displacement", "/max_displacement", "m"}};

class Comparer {
 public:
  Comparer(const std::string& first, const std::string& second)
      : names_{first, second}, reports_{read_report(first), read_report(second)} {
    add(reports_[0], reports_[1], "", run_entries);
    compare_lists("contact", "pair", [this](const std::string& name, const Json& a, const Json& b) {
      const auto force_a = force_of(a), force_b = force_of(b);
      if (force_a && force_b) lines_.push_back({name + ": force", "N", *force_a, *force_b});
      add(a, b, name + ": ", pair_entries);
      pairs_.push_back(name);
    });
    const std::size_t before = lines_.size();
    compare_lists("bodies", "body", [this](const std::string& name, const Json& a, const Json& b) {
      add(a, b, name + ": ", body_entries);
    });
    if (pairs_.empty() && lines_.size() == before)
      throw InputError(
          fmt::format("{} and {} do not fit together: they have neither a contact pair nor a body of the same name",
                      first, second));
  }

  const std::vector<ComparedFigure>& lines() const { return lines_; }
  const std::vector<std::string>& pairs() const { return pairs_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  template <std::size_t n>
  void add(const Json& a, const Json& b, const std::string& of, const ReportEntry (&entries)[n]) {
    for (const ReportEntry& entry : entries) {
      const auto x = number(a, entry.path), y = number(b, entry.path);
      if (x && y) lines_.push_back({of + entry.name, entry.unit, *x, *y});
    }
  }

  template <class Use>
  void compare_lists(const char* key, const char* what, const Use& use) {
    const auto a = by_name(reports_[0].at(key)), b = by_name(reports_[1].at(key));
    for (const auto& [name, json] : a)
      if (const auto other = b.find(name); other != b.end()) use(name, *json, *other->second);
    for (int side = 0; side < 2; ++side)
      for (const auto& [name, json] : side == 0 ? a : b)
        if ((side == 0 ? b : a).count(name) == 0)
          notes_.push_back(fmt::format("only in {}: {} \"{}\"", names_[side], what, name));
  }

  const std::string names_[2];
  const Json reports_[2];
  std::vector<ComparedFigure> lines_;
  std::vector<std::string> pairs_, notes_;
};

std::string relative_percent(const ComparedFigure& line) {
  const auto relative = line.relative();
  return relative ? fmt::format("{:+.3g} %", 100 * *relative) : line.difference() == 0 ? "+0 %" : "-";
}

std::string table(const Comparer& comparer, const std::string& first, const std::string& second) {
  std::size_t widest = 0;
  for (const ComparedFigure& line : comparer.lines()) widest = std::max(widest, line.name.size());
  widest = std::min<std::size_t>(widest, 40);
  std::string text = fmt::format("A: {}\nB: {}\n{:<{}}  {:>14} {:>14} {:>14} {:>11}\n", first, second, "", widest, "A",
                                 "B", "B - A", "of A");
  for (const ComparedFigure& line : comparer.lines()) {
    const auto value = [&](double x) { return fmt::format("{:.5g} {:<3}", x, line.unit); };
    fmt::format_to(std::back_inserter(text), "{:<{}}  {:>14} {:>14} {:>14} {:>11}\n",
                   shortened_name(line.name, static_cast<int>(widest)), widest, value(line.a), value(line.b),
                   value(line.difference()), relative_percent(line));
  }
  for (const std::string& note : comparer.notes()) text += note + "\n";
  return text;
}

/// Position and recovered pressure on the first body of a pair.
using PressureCurve = std::vector<std::array<double, 2>>;

/// By pair, from the pressure.csv of a result; empty without one.
std::map<std::string, PressureCurve> read_curves(const std::string& directory) {
  const fs::path file = fs::path(directory) / "pressure.csv";
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  std::istringstream text(read_text(file.string()));
  std::map<std::string, PressureCurve> curves;
  std::map<std::string, std::string> first_body;
  std::string line;
  std::getline(text, line);  // the heads
  while (std::getline(text, line)) {
    const std::vector<std::string> cells = csv_fields(line);
    constexpr std::size_t coordinate = 2, pressure = 8;  // of write_pressure_csv
    if (cells.size() <= pressure)
      throw InputError(fmt::format("{}: a line has fewer columns than the first", file.string()));
    if (first_body.try_emplace(cells[0], cells[1]).first->second != cells[1]) continue;
    curves[cells[0]].push_back(
        {std::strtod(cells[coordinate].c_str(), nullptr), std::strtod(cells[pressure].c_str(), nullptr)});
  }
  for (auto& [pair, curve] : curves) std::sort(curve.begin(), curve.end());
  return curves;
}

void draw_curves(const std::string& pair, const PressureCurve (&curves)[2], const std::string (&names)[2],
                 GnuplotRuns& runs) {
  double longest = 0, highest = 0;
  std::string data;
  for (const PressureCurve& curve : curves)
    for (const auto& [s, p] : curve) {
      longest = std::max(longest, std::abs(s));
      highest = std::max(highest, std::abs(p));
    }
  const DisplayUnit length = length_unit(longest), stress = stress_unit(highest);
  for (const PressureCurve& curve : curves) {
    for (const auto& [s, p] : curve)
      fmt::format_to(std::back_inserter(data), "{} {}\n", s * length.factor, p * stress.factor);
    data += "\n\n";
  }
  const std::string name = "compare_" + pair;
  write_text(runs.directory() + "/plots/" + name + ".dat", data);
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size 900,560 fixed noenhanced font 'sans-serif,15' background 'white'\n"
      "set output '../{}.svg'\nset title {}\nset border 3 lw 1 lc rgb '#404040'\nset tics nomirror out\n"
      "set grid lc rgb '#e4e4e4' lw 1 dt 1\nset key outside bottom center vertical Left reverse samplen 2.6\n"
      "set xlabel 'along the path [{}]'\nset ylabel 'contact pressure [{}]'\n",
      name, gnuplot_text("Contact pressure: " + pair), length.name, stress.name);
  script += fmt::format(
      "plot '{0}.dat' index 0 with lines lc rgb '#2070b8' lw 2.4 title {1}, \\\n"
      "  '{0}.dat' index 1 with lines lc rgb '#d2501e' lw 2 dt (6,4) title {2}\n",
      name, gnuplot_text("A: " + names[0]), gnuplot_text("B: " + names[1]));
  runs.start(name, script, {name + ".svg"});
}

void write_csv(const std::vector<ComparedFigure>& lines, const std::string& file) {
  std::string text = "figure,unit,a,b,difference,relative\n";
  for (const ComparedFigure& line : lines) {
    const auto relative = line.relative();
    text += fmt::format("{},{},{},{},{},{}\n", csv_text(line.name), line.unit, line.a, line.b, line.difference(),
                        relative ? fmt::format("{}", *relative) : "");
  }
  write_text(file, text);
}

}  // namespace

Comparison compare_results(const std::string& first, const std::string& second, const std::string& out) {
  const Comparer comparer(first, second);
  Comparison comparison;
  comparison.text = table(comparer, first, second);
  if (out.empty()) return comparison;
  std::error_code error;
  const bool had_plots = fs::exists(fs::path(out) / "plots", error);
  fs::create_directories(fs::path(out) / "plots", error);
  if (error) throw InputError(fmt::format("cannot write to {}: {}", out, error.message()));
  write_csv(comparer.lines(), out + "/compare.csv");
  comparison.files.emplace_back("compare.csv");
  const std::string names[2] = {first, second};
  auto a = read_curves(first), b = read_curves(second);
  GnuplotRuns runs(out);
  for (const std::string& pair : comparer.pairs()) {
    if (a.count(pair) == 0 || b.count(pair) == 0) {
      runs.warn(fmt::format("no curves of \"{}\": {} has no pressure.csv with that pair", pair,
                            a.count(pair) == 0 ? first : second));
      continue;
    }
    draw_curves(pair, {a[pair], b[pair]}, names, runs);
    comparison.files.push_back("compare_" + pair + ".svg");
  }
  comparison.warnings = runs.finish();
  const auto missing = [&](const std::string& file) { return !fs::exists(fs::path(out) / file, error); };
  comparison.files.erase(std::remove_if(comparison.files.begin(), comparison.files.end(), missing),
                         comparison.files.end());
  if (!had_plots &&
      std::none_of(comparison.warnings.begin(), comparison.warnings.end(),
                   [](const std::string& warning) { return warning.find("gnuplot") != std::string::npos; }))
    fs::remove_all(fs::path(out) / "plots", error);
  return comparison;
}

}  // namespace cgcontact
