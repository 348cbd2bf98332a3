#include "core/output/report/output_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <numeric>

#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/drawing/extremes.hpp"
#include "core/output/pictures/output_plots.hpp"
#include "core/output/pictures/output_probes.hpp"
#include "core/output/report/asked_accuracy.hpp"
#include "core/output/report/output_page_style.hpp"
#include "core/output/view/output_view.hpp"

namespace cgcontact {

namespace {

/// Fraction of the largest resultant: a component below is rounding, or what the linear solver leaves.
constexpr double no_force = 1e-6;

struct Explanation {
  const char *name, *text;
};

constexpr Explanation patch_kinds[] = {{"interior", "inside a body, touches no face"},
                                       {"boundary", "touches a free face, or a contact face where it is open"},
                                       {"loaded", "touches a face with a load"},
                                       {"symmetry", "touches a face with symmetry or a prescribed normal displacement"},
                                       {"support", "touches another support"},
                                       {"contact", "touches closed contact"},
                                       {"contact_edge", "the edge of the contact zone runs through it"}};

constexpr Explanation patch_statuses[] = {
    {"exact", "equilibrium, loads and contact conditions are met exactly"},
    {"truncated", "redundant conditions were dropped, the others are met exactly; usual at edges and corners"},
    {"degree_lowered", "too little material for a polynomial of degree 2, degree 1 was used"},
    {"conflicting",
     "the conditions contradict each other (loads that disagree at an edge) and are met in the mean only: "
     "look at the stress there with care"},
    {"uncoupled", "closed contact, but too little material of the other body: no pressure was taken from there"},
    {"edge_unclear", "the edge of the contact zone runs through the patch but could not be placed"},
    {"balanced",
     "the pressure did not carry the forces that the solution transmits (corners, knife edges, fillets of few cells) "
     "and was changed until it does: smaller cells are needed for its details"},
    {"singular", "too little material for a polynomial: the mean stress was used"}};

template <std::size_t n>
std::string explain(const Explanation (&table)[n], const std::string& name) {
  for (const Explanation& entry : table)
    if (name == entry.name) return entry.text;
  return "";
}

/// The name of a unit as people write it.
std::string pretty(const std::string& unit) {
  std::string text = unit;
  if (text.size() > 2 && text.compare(text.size() - 2, 2, "^2") == 0) text.replace(text.size() - 2, 2, "²");
  if (text[0] == 'u') text.replace(0, 1, "µ");
  return text;
}

/// Figure with its value in SI as data.
std::string figure(double si, const std::string& shown) {
  return fmt::format("<data value=\"{}\">{}</data>", si, std::isfinite(si) ? shown : "not a number");
}

std::string figure(double si, const DisplayUnit& unit, int digits = 4) {
  return figure(si, short_number(si * unit.factor, digits) + "&#160;" + pretty(unit.name));
}

std::string count(long long n) { return fmt::format("<data value=\"{}\">{}</data>", n, grouped(n)); }

/// Nobody wants to read the digits of rounding.
std::string percent_figure(double fraction) {
  return figure(fraction, std::abs(fraction) < rounding ? "below 1e-7&#160;%" : percent_number(fraction) + "&#160;%");
}

/// The estimated error of a pair's force or pressure, as far as there is one.
std::string estimate(const Results& results, const PairFigures& pair, const std::optional<double>& error) {
  const std::size_t k = static_cast<std::size_t>(&pair - results.pairs.data());
  if (pair.active_points == 0) return "-";
  const bool coarse =
      k < results.verdict.pairs.size() && results.verdict.pairs[k].closed_state() == Verdict::State::not_resolved;
  if (!error) return coarse ? "not resolved" : "none";
  if (error == 0 && pair.force_given_by_loads) return figure(0, "given by the loads");
  return coarse ? figure(*error, "not resolved") : percent_figure(*error);
}

/// Returns the largest of all forces: of loads, supports, pairs, and the sum of a pair's pressures regardless of
/// direction (a shrink fit).
double force_scale(const Results& results) {
  double scale = 0;
  for (const PairFigures& pair : results.pairs)
    scale = std::max({scale, pair.force_on_first.norm(), pair.max_pressure * pair.area});
  for (const LoadFigures& load : results.loads) scale = std::max(scale, load.force.norm());
  for (const SupportFigures& support : results.supports) scale = std::max(scale, support.force.norm());
  return scale;
}

std::string stress(double pa) { return figure(pa, stress_unit(std::abs(pa)), 4); }
std::string force_figure(double newton, double scale = 0) {
  return std::abs(newton) <= no_force * scale ? figure(newton, "0") : figure(newton, force_unit(std::abs(newton)), 5);
}
std::string seconds(double s) { return figure(s, fmt::format("{:.2f}&#160;s", s)); }

/// Cells of a table for the components of a force, all in one unit; those that are rounding of `scale` are zero.
std::string components(const Vec3& f, double scale) {
  const DisplayUnit unit = force_unit(f.cwiseAbs().maxCoeff() <= no_force * scale ? 0 : f.cwiseAbs().maxCoeff());
  std::string cells;
  for (double c : f)
    cells +=
        "<td>" +
        figure(c, std::abs(c) <= no_force * scale ? "0" : short_number(c * unit.factor, 5) + "&#160;" + unit.name) +
        "</td>";
  return cells;
}

/// "(12.5, 0, -3) mm"; the value in SI of each component as data. Components that are rounding beside the others are 0.
std::string html_position(const Vec3& x) {
  const double size = x.cwiseAbs().maxCoeff();
  const DisplayUnit unit = length_unit(size);
  std::string text = "(";
  for (int k = 0; k < 3; ++k)
    text +=
        (k ? ", " : "") + figure(x[k], std::abs(x[k]) <= rounding * size ? "0" : short_number(x[k] * unit.factor, 4));
  return text + ")&#160;" + pretty(unit.name);
}

/// The pages's building blocks. All take HTML; names and titles go through html_text before.
std::string section(const std::string& id, const std::string& title, const std::string& content) {
  return content.empty() ? "" : fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, content);
}

std::string paragraph(const std::string& text) { return "<p>" + text + "</p>\n"; }
std::string note(const std::string& text) { return "<p class=\"note\">" + text + "</p>\n"; }
std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }
std::string name_cell(const std::string& text) { return "<th scope=\"row\">" + text + "</th>"; }

/// `rows`: cells of each row; a class may be given to the whole table.
std::string table(const std::vector<std::string>& head, const std::vector<std::string>& rows,
                  const std::string& style = "") {
  std::string text = "<div class=\"wide\"><table" + (style.empty() ? "" : " class=\"" + style + "\"") + "><thead><tr>";
  for (const std::string& title : head) text += "<th scope=\"col\">" + title + "</th>";
  text += "</tr></thead><tbody>\n";
  for (const std::string& row : rows) text += "<tr>" + row + "</tr>\n";
  return text + "</tbody></table></div>\n";
}

/// Cell with a bar of this fraction of its width.
std::string bar(double fraction, const std::string& style = "bar") {
  return fmt::format("<td class=\"{}\"><span style=\"width:{:.1f}%\"></span></td>", style,
                     std::isfinite(fraction) ? 100 * std::clamp(fraction, 0.0, 1.0) : 0.0);
}

/// Picture itself as data; empty if the file is missing.
std::string picture(const PageContents& contents, const std::string& file, const std::string& description,
                    const std::string& caption) {
  if (contents.beside.count(file)) return note("The view above shows this; " + file + " lies beside the page.");
  const std::filesystem::path path = std::filesystem::path(contents.directory) / file;
  if (file.empty() || !std::filesystem::exists(path)) return "";
  const char* const type = path.extension() == ".svg" ? "svg+xml" : "png";
  return fmt::format("<figure><img alt=\"{}\" src=\"data:image/{};base64,{}\"/>", html_text(description), type,
                     base64(read_text(path.string()))) +
         (caption.empty() ? "" : "<figcaption>" + caption + "</figcaption>") + "</figure>\n";
}

/// Class and heading of the verdict's box: only contact that is resolved is green.
std::pair<const char*, const char*> verdict_heading(const Results& results) {
  switch (results.verdict.state) {
    case Verdict::State::not_resolved:
      return {"doubtful", "Solved, but not resolved"};
    case Verdict::State::contact_missed:
      return {"bad", "Contact missed"};
    case Verdict::State::no_contact:
      if (results.pairs.empty()) return {"good", "Solved"};
      return {"doubtful", "Solved, without contact"};
    default:
      if (results.accuracy.asked && !results.accuracy.reached)
        return {"doubtful", "Solved, but not as accurate as asked"};
      if (results.verdict.spring_share > 0) return {"doubtful", "Solved, but springs take a part of the load"};
      return {"good", "Solved"};
  }
}

/// "the zone ..." -> "The zone ..."
std::string sentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// Says whether the accuracy asked for is reached, with every target and its estimate.
std::string accuracy_verdict(const AccuracyFigures& accuracy) {
  std::string errors;
  for (const AskedError& error : asked_errors(accuracy))
    errors += fmt::format("{}{} {} (asked: {})", errors.empty() ? "" : ", of the ", error.name,
                          error.estimate ? figure(*error.estimate, fine_percent(*error.estimate))
                                         : "not known, the contact zone is not resolved",
                          figure(error.target, fine_percent(error.target)));
  const std::size_t count = accuracy.solves.size();
  const bool stopped = !accuracy.reached && !accuracy.text.empty();
  return fmt::format("The accuracy asked for is {} after {} solve{}: estimated error of the {}{}. ",
                     accuracy.reached ? "reached" : "<b>not reached</b>", count, count == 1 ? "" : "s", errors,
                     stopped ? "; " + html_text(accuracy.text) : "");
}

std::string verdict(const Results& results, const std::vector<std::string>& warnings) {
  std::string text;
  if (results.converged) {
    const auto [style, heading] = verdict_heading(results);
    text += fmt::format("<div class=\"verdict {}\"><strong>{}.</strong> ", style, heading);
    if (results.accuracy.asked) text += accuracy_verdict(results.accuracy);
    if (!results.verdict.text.empty()) text += html_text(sentence(results.verdict.text)) + ". ";
    text += fmt::format("Converged after {} outer iteration{}", results.outer_iterations,
                        results.outer_iterations == 1 ? "" : "s");
    if (!results.outer_residuals.empty()) text += fmt::format("; last residual {:.1e}", results.outer_residuals.back());
    text += ".</div>\n";
  } else {
    text += "<div class=\"verdict bad\"><strong>Did not converge.</strong> " + html_text(results.diagnosis) +
            ". The figures below are those of the last iteration: do not use them as results.</div>\n";
  }
  if (warnings.empty()) return text + note("No warnings.");
  text += fmt::format("<div class=\"warnings\"><strong>{} warning{}</strong><ul>\n", warnings.size(),
                      warnings.size() == 1 ? "" : "s");
  for (const std::string& warning : warnings) text += "<li>" + html_text(warning) + "</li>\n";
  return text + "</ul></div>\n";
}

std::string tile(const std::string& label, const std::string& value, const std::string& remark) {
  return "<div class=\"tile\"><span>" + label + "</span><b>" + value + "</b><span>" + remark + "</span></div>\n";
}

/// Returns the pair with the largest of a figure, one in contact before those that are bonded.
template <class Figure>
const PairFigures& pair_with_largest(const Results& results, const Figure& figure) {
  const auto value = [&](const PairFigures& pair) {
    const double of_pair = figure(pair);
    return std::isfinite(of_pair) ? of_pair : -1;
  };
  return *std::max_element(results.pairs.begin(), results.pairs.end(), [&](const PairFigures& a, const PairFigures& b) {
    return a.bonded != b.bonded ? a.bonded : value(a) < value(b);
  });
}

/// Returns the tiles of the pairs with the largest force and pressure, and of the bodies.
std::string tiles(const Results& results) {
  std::string text = "<div class=\"tiles\">\n";
  if (!results.pairs.empty()) {
    const PairFigures &pair = pair_with_largest(results, told_force),
                      &pressed = pair_with_largest(results, [](const PairFigures&p) { return p.max_pressure; });
    const auto of = [&](const PairFigures& p) {
      return results.pairs.size() > 1 ? "of " + html_text(p.name) + ", " : std::string();
    };
    text += tile("Contact force", force_figure(told_force(pair)),
                 of(pair) + "estimated error " + estimate(results, pair, pair.force_error_estimate));
    text += tile("Largest contact pressure", stress(pressed.max_pressure),
                 of(pressed) + "estimated error " + estimate(results, pressed, pressed.max_pressure_error_estimate));
    text += tile("Contact area", figure(pair.area, area_unit(pair.area)),
                 of(pair) + (pair.bonded ? "bonded"
                                         : fmt::format("{} of {} points closed", grouped(pair.active_points),
                                                       grouped(pair.points))));
  }
  if (!results.extremes.empty() && results.extremes.size() == results.bodies.size()) {
    const int s = body_with_largest(results.extremes, &Extremes::von_mises);
    const int u = body_with_largest(results.extremes, &Extremes::displacement);
    const Extreme &stressed = results.extremes[s].body.von_mises, &moved = results.extremes[u].body.displacement;
    text += tile("Largest von Mises stress", stress(stressed.value),
                 "recovered, in " + html_text(results.bodies[s].name) + " at " + html_position(stressed.at));
    text += tile("Largest displacement", figure(moved.value, length_unit(moved.value)),
                 "in " + html_text(results.bodies[u].name) + " at " + html_position(moved.at));
  }
  text +=
      tile("Error of the stress", percent_figure(results.estimated_error_relative), "estimate, mean over the bodies");
  return text + "</div>\n";
}

/// Says what the estimates mean, for somebody who has to trust or refine.
std::string reliability(const Results& results) {
  std::string text;
  double pressure = 0, forces = 0;
  std::size_t unresolved = 0;
  bool given_by_loads = true;
  for (std::size_t k = 0; k < results.pairs.size(); ++k) {
    const PairFigures& pair = results.pairs[k];
    if (k < results.verdict.pairs.size() && results.verdict.pairs[k].closed_state() == Verdict::State::not_resolved) {
      ++unresolved;
      continue;
    }
    pressure = std::max(pressure, pair.pressure_error_estimate);
    forces = std::max(forces, pair.force_error_estimate.value_or(0));
    given_by_loads &= pair.force_given_by_loads && pair.force_error_estimate == 0.0;
  }
  if (unresolved > 0)
    text += paragraph(fmt::format(
        "<b>Not resolved:</b> the zone{} of {} contact pair{} {} too few cells across. No figure tells how far "
        "pressure "
        "and force are off there; refine until the zone is resolved.",
        unresolved == 1 ? "" : "s", unresolved, unresolved == 1 ? "" : "s", unresolved == 1 ? "has" : "have"));
  const char* const which = results.pairs.size() - unresolved > 1 ? ", for the worst of all resolved pairs" : "";
  if (results.pairs.size() > unresolved)
    text += paragraph(
        (given_by_loads ? std::string("<b>Contact force:</b> given by the loads. ")
         : forces == 0  ? ""
                        : fmt::format("<b>Contact force:</b> off by about {}{}. ", percent_figure(forces), which)) +
        fmt::format("<b>Contact pressure:</b> off by about {} in the mean over the contact face{} (root mean square).",
                    percent_figure(pressure), which));
  text += paragraph(fmt::format(
      "<b>Stress in the bodies:</b> the finite element stress differs from the recovered one, which is shown here, by "
      "{} "
      "in the mean (energy norm). Half the cell size about halves this. Where the shape has a sharp inner edge or a "
      "load ends, the largest stress grows with every refinement: judge it at some distance.",
      percent_figure(results.estimated_error_relative)));
  if (results.has_effectivity)
    text +=
        paragraph(fmt::format("<b>Against the exact stress of the scene:</b> the estimate is {} times the true error "
                              "(effectivity index; 1 is "
                              "perfect).",
                              figure(results.effectivity, fmt::format("{:.3f}", results.effectivity))));
  return text;
}

/// The solves of a run to an accuracy.
std::string accuracy_section(const Results& results, const PageContents& contents) {
  const AccuracyFigures& accuracy = results.accuracy;
  if (!accuracy.asked) return "";
  std::vector<std::string> rows;
  double most = 0;
  for (const SolveFigures& solve : accuracy.solves) most = std::max(most, solve.seconds);
  const auto error = [](const std::optional<double>& e) { return cell(e ? percent_figure(*e) : "not resolved"); };
  std::vector<std::string> heads{"Solve",      "Unknowns",         "Smallest cell",
                                 "Levels",     "Outer iterations", "Est. error of the pressure",
                                 "its change", "of the force"};
  const bool with_shear = has_shear(accuracy);
  if (with_shear) heads.emplace_back("of the shear");
  heads.emplace_back("of the stress");
  for (const BodyTarget& target : accuracy.stress_of_body) heads.push_back("of that in " + html_text(target.body));
  for (const NamedTarget& target : accuracy.named) heads.push_back("of the " + html_text(target.text()));
  heads.insert(heads.end(), {"Time", ""});
  const auto of_bodies = [&](const SolveFigures& solve) {
    std::string cells;
    for (const double e : solve.stress_of_body) cells += cell(solve.converged ? percent_figure(e) : "-");
    for (std::size_t k = 0; k < accuracy.named.size(); ++k)
      cells += error(k < solve.named.size() ? solve.named[k] : std::nullopt);
    return cells;
  };
  for (std::size_t k = 0; k < accuracy.solves.size(); ++k) {
    const SolveFigures& solve = accuracy.solves[k];
    rows.push_back(
        name_cell(fmt::format("{}{}", k + 1, solve.converged ? "" : " (did not converge)")) +
        cell(count(solve.unknowns)) + cell(figure(solve.smallest_cell, length_unit(solve.smallest_cell), 3)) +
        cell(count(solve.levels)) + cell(count(solve.outer_iterations)) + error(solve.pressure) +
        cell(solve.change ? percent_figure(*solve.change) : "-") + error(solve.force) +
        (with_shear ? cell(solve.shear ? percent_figure(*solve.shear) : "-") : "") +
        cell(solve.converged ? percent_figure(solve.stress) : "-") + of_bodies(solve) + "<td class=\"run\">" +
        seconds(solve.seconds) + "</td>" + bar(most > 0 ? solve.seconds / most : 0, "bar run"));
  }
  std::string targets;
  for (const AskedError& asked : asked_errors(accuracy))
    targets += fmt::format("{}{} {}", targets.empty() ? "" : ", ", asked.name, fine_percent(asked.target));
  return paragraph("Asked for: " + targets +
                   ". Each solve has smaller cells where the estimates of the one before asked for them; the figures, "
                   "pictures and files are those of the last one.") +
         table(heads, rows) +
         picture(contents, "accuracy.svg", "Estimated errors and time over the unknowns of the solves",
                 "The errors are estimates; a target is the dashed line in the colour of its error. The change of the "
                 "pressure since the solve before tells how far to trust them.");
}

std::string length_figure(double metres) { return figure(metres, length_unit(std::abs(metres))); }

std::string zone_of(const ZoneFigures& zone) {
  if (!zone.extent) return cell("-") + cell("-");
  const auto& [longer, shorter] = zone.extent->half_axes;
  return cell(name_of(zone.extent->shape)) + cell(length_figure(longer) + " × " + length_figure(shorter));
}

std::string hertz_of(const ZoneFigures& zone) {
  if (!zone.hertz) return cell("-") + cell("-");
  return cell(zone.hertz->a ? length_figure(*zone.hertz->a) + " × " + length_figure(zone.hertz->b)
                            : "half width " + length_figure(zone.hertz->b)) +
         cell(stress(zone.hertz->p0));
}

/// Lists zones of which planes of symmetry leave a fraction in the model.
std::string whole_zones(const Results& results) {
  std::vector<std::string> rows;
  for (const PairFigures& pair : results.pairs)
    if (const int sectors = pair.zone.sectors; sectors > 1)
      rows.push_back(name_cell(html_text(pair.name)) + cell("1/" + std::to_string(sectors)) +
                     cell(force_figure(sectors * pair.zone.normal_force)) +
                     cell(figure(sectors * pair.area, area_unit(sectors * pair.area))));
  return rows.empty() ? ""
                      : "<h3>With what lies behind planes of symmetry</h3>\n" +
                            table({"Pair", "Modelled", "Normal force in all", "Area in all"}, rows);
}

std::string newton_metres(double moment) { return figure(moment, scaled(moment, "N m", 5)); }

/// Lists what friction could carry, a row for every pair that has some.
std::string friction_of_pairs(const Results& results) {
  std::vector<std::string> rows;
  const auto error = [](const std::optional<double>& e) { return cell(e ? percent_figure(*e) : "none"); };
  for (const PairFigures& pair : results.pairs) {
    if (!pair.friction) continue;
    const FrictionFigures& friction = *pair.friction;
    const bool is_sector = pair.zone.sectors > 1;
    std::string row = name_cell(html_text(pair.name)) + cell(fmt::format("{:g}", friction.coefficient)) +
                      cell(force_figure(friction.capacity)) + error(friction.error) +
                      cell(is_sector ? force_figure(friction.whole) : "-");
    if (const auto& torque = friction.torque)
      row += cell(newton_metres(torque->capacity)) + error(torque->error) +
             cell(is_sector ? newton_metres(torque->whole) : "-") + "<td class=\"text\">" +
             fmt::format("{}: ({}) through ", name_of(torque->from), components_text(torque->axis.direction)) +
             html_position(torque->axis.point) + "</td>";
    else
      row += cell("none") + cell("-") + cell("-") + "<td class=\"text\">" + html_text(friction.why_no_torque) + "</td>";
    rows.push_back(row + cell(friction.use ? figure(*friction.use, use_text(*friction.use)) : "-") +
                   cell(force_figure(friction.force.norm())) + error(friction.shear_error) +
                   cell(length_figure(friction.max_slip)) + cell(figure(friction.work, scaled(friction.work, "J", 4))) +
                   "<td class=\"text\">" + html_text(verdict_on(friction)) + "</td>");
  }
  return rows.empty()
             ? ""
             : "<h3>Friction</h3>\n" + note(sentence(friction_note) + ".") +
                   table({"Pair", "mu", "Capacity", "est. error", "in all", "Torque capacity", "est. error", "in all",
                          "about", "Use", "Force", "Shear, est. error", "Largest slip", "Work", "Verdict"},
                         rows);
}

/// Zones with Hertz's answer beside them, and moments about the points of the scene.
std::string zones_of_pairs(const Results& results) {
  std::vector<std::string> zones, moments;
  bool any_hertz = false;
  const auto in_newton_metres = [](double moment) {
    return figure(moment, short_number(moment, 5) + "&#160;N&#160;m");
  };
  for (const PairFigures& pair : results.pairs) {
    const ZoneFigures& zone = pair.zone;
    any_hertz |= zone.hertz.has_value();
    zones.push_back(name_cell(html_text(pair.name)) + cell(force_figure(zone.normal_force)) +
                    cell(stress(zone.mean_pressure)) + zone_of(zone) + hertz_of(zone));
    if (!zone.moment) continue;
    std::string row =
        name_cell(html_text(pair.name)) + cell(html_text(pair.body_first)) + cell(html_position(zone.moment->point));
    for (const double component : zone.moment->on_first) row += cell(in_newton_metres(component));
    moments.push_back(row + cell(zone.moment->axis ? in_newton_metres(*zone.moment->about_axis_first) : "-"));
  }
  std::string text =
      table({"Pair", "Normal force", "Mean pressure", "Zone", "Half axes", "Hertz: half axes", "Hertz: p0"}, zones);
  if (!moments.empty()) text += table({"Pair", "Moment on", "about", "x", "y", "z", "about the axis"}, moments);
  if (any_hertz)
    text +=
        note("Hertz: half-spaces with the curvatures of the faces, for the computed force; information, not a bound.");
  return text;
}

std::string pairs_section(const Results& results) {
  if (results.pairs.empty()) return paragraph("The scene has no contact pair.");
  std::vector<std::string> rows;
  for (const PairFigures& pair : results.pairs) {
    const double size = told_force(pair);
    rows.push_back(name_cell(html_text(pair.name)) + cell(force_figure(size)) +
                   cell(estimate(results, pair, pair.force_error_estimate)) + cell(stress(pair.max_pressure)) +
                   cell(estimate(results, pair, pair.max_pressure_error_estimate)) +
                   cell(estimate(results, pair, pair.pressure_error_estimate)) +
                   cell(figure(pair.area, area_unit(pair.area))) +
                   cell(pair.bonded ? "bonded" : count(pair.active_points) + " of " + count(pair.points)));
  }
  std::vector<std::string> forces;
  for (const PairFigures& pair : results.pairs)
    forces.push_back(name_cell(html_text(pair.name)) + cell(html_text(pair.body_first)) +
                     components(pair.force_on_first, pair.force_on_first.norm()) + cell(html_position(pair.centre)) +
                     cell(html_position(pair.max_pressure_at)));
  return table(
             {"Pair", "Force", "est. error", "Max. pressure", "est. error", "est. error (L2)", "Area", "Closed points"},
             rows) +
         table({"Pair", "Force on", "x", "y", "z", "acts at", "Max. pressure at"}, forces) + zones_of_pairs(results) +
         whole_zones(results) + friction_of_pairs(results);
}

/// Lists loads with a moment about the point where their force is said to act, or about their centroid.
std::string moments_of_loads(const Results& results) {
  std::vector<std::string> rows;
  for (const LoadFigures& load : results.loads) {
    const double size = load.moment.norm();
    if (size == 0) continue;
    std::string cells;
    for (const double c : load.moment)
      cells += cell(figure(c, std::abs(c) <= no_force * size ? "0" : scaled(c, "N m", 5)));
    rows.push_back(name_cell(html_text(load.face)) + cell(html_position(load.about)) + cells);
  }
  return rows.empty() ? "" : "<h3>Moments of loads</h3>\n" + table({"Face or body", "About", "x", "y", "z"}, rows);
}

/// Supports, loads and interferences with their resultants; every face of the picture by its number.
std::string conditions_section(const Results& results, const PageContents& contents) {
  const double scale = force_scale(results);
  std::vector<std::string> rows;
  const auto text_cell = [](const std::string& text) { return "<td class=\"text\">" + html_text(text) + "</td>"; };
  for (const SupportFigures& support : results.supports)
    rows.push_back(name_cell(html_text(support.face)) + text_cell("support: " + support.condition) +
                   cell(figure(support.area, area_unit(support.area))) + components(support.force, scale));
  for (const LoadFigures& load : results.loads)
    rows.push_back(name_cell(html_text(load.face)) +
                   text_cell(load.of_body ? load.condition : "load: " + load.condition) +
                   cell(load.of_body ? "" : figure(load.area, area_unit(load.area))) + components(load.force, scale));
  std::string text;
  if (!rows.empty()) text += table({"Face", "Condition", "Area", "Resultant x", "y", "z"}, rows);
  text += moments_of_loads(results);
  std::vector<std::string> fits;
  for (const PairFigures& pair : results.pairs)
    if (pair.interference != 0)
      fits.push_back(name_cell(html_text(pair.name)) +
                     cell(figure(std::abs(pair.interference), length_unit(std::abs(pair.interference)))) +
                     text_cell(std::string(pair.interference > 0 ? "interference" : "clearance") +
                               (pair.preload ? ", found for a preload of " + scaled(*pair.preload, "N") : "")) +
                     cell(force_figure(pair.force_on_first.norm())));
  if (!fits.empty())
    text += "<h3>Interferences</h3>\n" + table({"Pair", "Amount", "Given as", "Resultant of the pressure"}, fits);
  const std::string shown =
      picture(contents, "conditions.png", "Faces of the bodies, numbered, in the colour of what holds there",
              "Each body from above in front and from below behind.");
  if (shown.empty()) return text;
  std::vector<std::string> faces;
  for (const ConditionFace& face : contents.faces)
    faces.push_back(cell(std::to_string(face.number)) + "<th scope=\"row\">" + html_text(face.name) + "</th>" +
                    text_cell(face.condition) + cell(figure(face.area, area_unit(face.area))));
  return text + shown + table({"No.", "Face in the picture", "What holds there", "Area"}, faces);
}

constexpr double seconds_per_picture = 0.8;

/// Pictures of the steps in turn, without a script: they lie on the last one and are seen in turn.
std::string film(const PageContents& contents) {
  if (!contents.steps.empty() && contents.beside.count(contents.steps.front()))
    return note("The view above shows the steps as a film; their pictures, " + contents.steps.front() + " to " +
                contents.steps.back() + ", lie beside this page.");
  std::string images;
  for (std::size_t k = 0; k < contents.steps.size(); ++k) {
    const std::filesystem::path path = std::filesystem::path(contents.directory) / contents.steps[k];
    if (!std::filesystem::exists(path)) return "";
    images += fmt::format(
        "<img alt=\"Deformed bodies, {}\" style=\"animation-delay:{:.1f}s\" src=\"data:image/png;base64,{}\"/>",
        html_text(path.stem().string()), static_cast<double>(k) * seconds_per_picture,
        base64(read_text(path.string())));
  }
  if (images.empty()) return "";
  return "<figure class=\"film\"><div>" + images +
         "</div><figcaption>The steps in turn, all with the same colours and exaggeration; the pointer on the picture "
         "stops them.</figcaption></figure>\n";
}

/// Sets how long each picture of the film is seen.
std::string film_style(std::size_t pictures) {
  if (pictures == 0) return "";
  return fmt::format(
      ".film img:not(:last-child) {{ animation: film {:.1f}s step-end infinite; }}\n"
      "@keyframes film {{ 0% {{ opacity: 1; }} {:.4f}% {{ opacity: 0; }} 100% {{ opacity: 0; }} }}\n"
      "@media print {{ .film img:not(:last-child) {{ animation: none; }} }}\n"
      "@media (prefers-reduced-motion: reduce) {{ .film img:not(:last-child) {{ animation: none; }} }}\n",
      static_cast<double>(pictures) * seconds_per_picture, 100.0 / static_cast<double>(pictures));
}

std::string steps_section(const Results& results, const PageContents& contents) {
  std::vector<std::string> rows;
  for (std::size_t k = 0; k < results.steps.size(); ++k) {
    const StepFigures& s = results.steps[k];
    const std::string step = name_cell(fmt::format("{}{}", k + 1, s.converged ? "" : " (did not converge)")) +
                             cell(fmt::format("{:g}", s.step.loads)) + cell(fmt::format("{:g}", s.step.displacements)) +
                             cell(fmt::format("{:g}", s.step.interference));
    for (const PairFigures& pair : s.pairs)
      rows.push_back(step + cell(html_text(pair.name)) + cell(force_figure(told_force(pair))) +
                     cell(stress(pair.max_pressure)) + cell(figure(pair.area, area_unit(pair.area))));
    if (s.pairs.empty()) rows.push_back(step + cell("") + cell("") + cell("") + cell(""));
  }
  if (rows.empty()) return "";
  return table({"Step", "loads times", "displacements times", "interference times", "Pair", "Force", "Max. pressure",
                "Area"},
               rows) +
         picture(contents, "steps.svg", "Force, area and largest pressure over the steps", "") +
         picture(contents, "force_displacement.svg", "Contact force over the largest displacement", "") +
         film(contents);
}

std::string probes_section(const Results& results, const PageContents& contents) {
  std::vector<std::string> rows;
  std::string pictures;
  for (const ProbeFigures& probe : results.probes) {
    const auto value = [&](std::size_t f, const Extreme& extreme) {
      const bool is_metres = is_length(probe.fields[f]);
      return cell((is_metres ? length_figure(extreme.value) : stress(extreme.value)) + "<br/><small>" +
                  html_position(extreme.at) + "</small>");
    };
    for (std::size_t f = 0; f < probe.fields.size(); ++f) {
      const auto range = range_of(probe, f);
      rows.push_back(name_cell(html_text(probe.name)) + cell(name_of(probe.fields[f])) +
                     (range ? value(f, range->smallest) + value(f, range->largest) : cell("-") + cell("-")) +
                     cell(count(static_cast<long long>(probe.points))) +
                     cell(count(static_cast<long long>(probe.outside))));
    }
    pictures += picture(contents, probe_picture(probe), "Values along the probe " + probe.name, "");
  }
  if (rows.empty()) return "";
  return table({"Probe", "Field", "Smallest", "Largest", "Points", "of them outside"}, rows) + pictures +
         note("Every value is in probes.csv. Points outside of the bodies have none.");
}

std::string sections_section(const PageContents& contents) {
  std::string text;
  for (const auto& [name, file] : contents.sections)
    text += picture(contents, file, "Section " + name, "Section " + html_text(name) + ", undeformed.");
  return text;
}

/// Says what scene.png shows, for those who do not see it.
std::string words_of_scene(const Results& results, const std::string& zone) {
  const std::string near = zone.empty() ? "" : ", and the contact zone of " + zone + " from nearby";
  return "Deformed bodies" + near + ": " + result_in_words(results);
}

std::string maps_section(const Results& results, const PageContents& contents) {
  std::string text;
  for (const PressureMap& map : contents.pressure_maps)
    text += picture(contents, map.file,
                    "Contact pressure of " + results.pairs[map.pair].name + ": at most " +
                        scaled(results.pairs[map.pair].max_pressure, "Pa"),
                    html_text(map.caption));
  if (!text.empty() && contents.pressure_maps.size() < results.pairs.size())
    text += note(fmt::format("Shown are the {} pairs with the largest forces of {}; all are in contact.vtkhdf.",
                             contents.pressure_maps.size(), results.pairs.size()));
  return text;
}

std::string profile_section(const Results& results, const PageContents& contents) {
  std::string text;
  const std::string from = results.path_from_largest ? "The line follows the face through the largest pressure. " : "";
  for (std::size_t pair = 0; pair < results.pairs.size(); ++pair)
    text += picture(contents, path_picture(pair), "Contact pressure along the path",
                    fmt::format("{}The pressure \"{}\" is the result; the raw finite element stress and the plain "
                                "recovery (SPR) show what it gains.",
                                from, name_of_pressure(results.pairs[pair].pressure_on_face)));
  text += picture(contents, "stress_error.svg", "Error of the stress on the contact face",
                  "Error of the whole stress tensor against the scene's reference.");
  return text;
}

/// Displacements and rotations of rigid bodies, and the moments on them.
std::string rigid_section(const Results& results) {
  std::vector<std::string> motions, moments;
  double length = 0, largest = 0;
  for (const BodyFields& body : results.bodies)
    if (body.rigid) {
      length = std::max(length, body.rigid->displacement.norm());
      for (const Vec3& m : {body.rigid->loads, body.rigid->supports, body.rigid->contact})
        largest = std::max(largest, m.norm());
    }
  const DisplayUnit unit = length_unit(length);
  for (const BodyFields& body : results.bodies) {
    if (!body.rigid) continue;
    const RigidFigures& rigid = *body.rigid;
    std::string row = name_cell(html_text(body.name));
    for (const double u : rigid.displacement)
      row += cell(figure(u, short_number(unit.factor * u) + "&#160;" + pretty(unit.name)));
    for (const double angle : rigid.rotation) row += cell(figure(angle, short_number(1e3 * angle) + "&#160;mrad"));
    motions.push_back(row);
    const std::pair<const char*, Vec3> contributions[] = {
        {"loads", rigid.loads}, {"supports", rigid.supports}, {"contact", rigid.contact}};
    for (const auto& [name, m] : contributions) {
      std::string moment = name_cell(html_text(body.name)) + cell(name);
      for (const double component : m)
        moment += cell(figure(
            component, short_number(std::abs(component) < no_force * largest ? 0 : component) + "&#160;N&#160;m"));
      moments.push_back(moment);
    }
  }
  if (motions.empty()) return "";
  return "<h3>Rigid bodies</h3>\n" + table({"Body", "Displacement x", "y", "z", "Rotation x", "y", "z"}, motions) +
         table({"Body", "Moment of", "x", "y", "z"}, moments) +
         note("Displacements are those of the centroid, which the moments are about as well.");
}

std::string balance_section(const Results& results) {
  double scale = force_scale(results), worst = 0;
  for (const BodyBalance& body : results.balance)
    for (const Vec3& f : {body.loads, body.supports, body.contact}) scale = std::max(scale, f.norm());
  std::vector<std::string> rows;
  for (const BodyBalance& body : results.balance) {
    const std::pair<const char*, Vec3> contributions[] = {
        {"loads", body.loads}, {"supports", body.supports}, {"contact", body.contact}};
    for (const auto& [name, f] : contributions)
      rows.push_back(name_cell(html_text(body.body)) + cell(name) + components(f, scale));
    worst = std::max(worst, (body.loads + body.supports + body.contact).norm());
  }
  std::string text;
  if (!results.balance.empty() && scale > 0)
    text += paragraph(
        fmt::format("Loads, support reactions and contact forces of each body sum to {} of the largest of them.",
                    figure(worst / scale, fmt::format("{:.1e}", worst / scale))));
  if (!rows.empty()) text += table({"Body", "Resultant of", "x", "y", "z"}, rows);
  std::vector<std::string> supports;
  for (const SupportFigures& support : results.supports)
    supports.push_back(name_cell(html_text(support.face)) + cell(force_figure(support.force.norm(), scale)) +
                       components(support.force, scale));
  if (!supports.empty())
    text += "<h3>Reactions of the supports</h3>\n" + table({"Face", "Force", "x", "y", "z"}, supports);
  text += rigid_section(results);
  return text;
}

std::string convergence_section(const Results& results) {
  std::vector<std::string> rows;
  double lowest = 1;
  for (double r : results.outer_residuals)
    if (r > 0 && std::isfinite(r)) lowest = std::min(lowest, r);
  for (std::size_t i = 0; i < results.linear_iterations.size(); ++i) {
    const bool has_residual = i < results.outer_residuals.size();
    const double residual = has_residual ? results.outer_residuals[i] : 0;
    const double length = residual > 0 && lowest < 1 ? 1 - std::log(residual) / std::log(lowest) : 0;
    rows.push_back(name_cell(has_residual || !results.converged ? std::to_string(i + 1) : "last solve") +
                   cell(has_residual ? figure(residual, fmt::format("{:.1e}", residual)) : "") +
                   bar(0.02 * (has_residual ? 1 : 0) + 0.98 * length) +
                   cell(i < results.active_of_iteration.size() ? count(results.active_of_iteration[i]) : "") +
                   cell(count(results.linear_iterations[i])));
  }
  if (rows.empty()) return "";
  return paragraph(
             "The outer iteration finds which points touch and feeds the recovered stress back; it ends when no point "
             "changes its state and the residual is below solver.tolerance. Bars: logarithm of the residual.") +
         table({"Iteration", "Residual", "", "Closed points", "Linear iterations"}, rows);
}

/// A row for each body and each of its declared faces.
std::string maxima_section(const Results& results) {
  std::vector<std::string> rows;
  bool any_yield = false;
  for (const BodyExtremes& body : results.extremes) any_yield |= body.body.safety_factor.has_value();
  const auto with_position = [](const std::string& value, const Extreme& extreme) {
    return cell(value + "<br/><small>" + html_position(extreme.at) + "</small>");
  };
  const auto add = [&](const std::string& name, const Extremes& most) {
    const Extreme& u = most.displacement;
    std::string row = name_cell(html_text(name));
    for (const Extreme* s : {&most.von_mises, &most.tresca, &most.tension, &most.compression})
      row += with_position(stress(s->value), *s);
    row += with_position(figure(u.value, length_unit(u.value)), u);
    row += most.pressure ? with_position(stress(most.pressure->value), *most.pressure) : cell("");
    if (any_yield)
      row += cell(most.safety_factor ? figure(*most.safety_factor, short_number(*most.safety_factor, 3)) : "");
    rows.push_back(row);
  };
  for (std::size_t b = 0; b < results.extremes.size(); ++b) {
    add(results.bodies[b].name, results.extremes[b].body);
    for (const auto& [face, most] : results.extremes[b].faces) add(results.bodies[b].name + "." + face, most);
  }
  if (rows.empty()) return "";
  std::vector<std::string> heads{"Body or face",       "von Mises",    "Tresca",          "Largest principal",
                                 "Smallest principal", "Displacement", "Contact pressure"};
  if (any_yield) heads.emplace_back("Yield / von Mises");
  return table(heads, rows) +
         note(
             "Recovered stress, tension positive. Where the shape has a sharp inner edge or a load ends, the largest "
             "stress grows with every refinement.");
}

constexpr const char* grid_caption =
    "Every square is the side of a cell. The stress error is the root mean square of the difference between recovered "
    "and finite element stress in a cell; its colours are logarithmic.";

/// "2 mm", "0.25 to 2 mm".
std::string cell_sizes(const CutCells& cells) {
  const double largest = cells.grid.cell_size, smallest = cells.grid.cell_size_of(cells.num_levels() - 1);
  const DisplayUnit unit = length_unit(largest);
  if (cells.num_levels() == 1) return figure(largest, unit);
  return figure(largest, fmt::format("{} to {}&#160;{}", short_number(smallest * unit.factor, 3),
                                     short_number(largest * unit.factor), pretty(unit.name)));
}

std::string bodies_section(const Results& results) {
  std::vector<std::string> rows;
  double total = 0;
  std::vector<double> squared;
  for (const BodyFields& body : results.bodies) {
    double sum = 0;
    for (double e : body.error_of_cell) sum += e * e;
    squared.push_back(sum);
    total += sum;
  }
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    const BodyFields& body = results.bodies[b];
    const CutCells& cells = *body.cut_cells;
    const double e = body.material.youngs_modulus;
    const bool rigid = body.material.is_rigid();
    rows.push_back(name_cell(html_text(body.name)) + cell(rigid ? "rigid" : stress(e)) +
                   cell(rigid ? "" : short_number(body.material.poisson_ratio)) + cell(cell_sizes(cells)) +
                   cell(count(static_cast<long long>(cells.cells.size()))) +
                   cell(count(static_cast<long long>(cells.active_of_cut.size()))) +
                   cell(figure(std::sqrt(squared[b]), short_number(std::sqrt(squared[b]), 3) + "&#160;√J")) +
                   cell(total > 0 ? percent_figure(squared[b] / total) : "") + bar(total > 0 ? squared[b] / total : 0));
  }
  if (rows.empty()) return "";
  return table({"Body", "E", "ν", "Cell", "Cells", "of them cut", "Est. error", "Share", ""}, rows) +
         note(
             "Estimated error: energy norm of the difference between recovered and finite element stress; the share "
             "says which body to refine first.");
}

std::string reference_section(const Results& results) {
  if (results.pressure_errors.empty()) return "";
  std::vector<std::string> rows;
  for (const ZoneError& zone : results.pressure_errors)
    rows.push_back(name_cell(html_text(zone.zone)) + cell(percent_figure(zone.raw)) + cell(percent_figure(zone.spr)) +
                   cell(percent_figure(zone.sprc)));
  return paragraph("Relative error (L2 norm) of the contact pressure against the reference of the scene.") +
         table({"Zone", "raw stress", "SPR", name_of_pressure(results)}, rows);
}

template <std::size_t n>
std::string counts_table(const std::string& title, const std::vector<std::pair<std::string, long long>>& counts,
                         const Explanation (&explanations)[n]) {
  std::vector<std::string> rows;
  for (const auto& [name, number] : counts)
    rows.push_back(name_cell(html_text(name)) + cell(count(number)) + "<td class=\"text\">" +
                   html_text(explain(explanations, name)) + "</td>");
  return rows.empty() ? "" : table({title, "Patches", ""}, rows);
}

std::string recovery_section(const Results& results) {
  if (results.patches_by_kind.empty()) return "";
  return paragraph(
             "Around every node a polynomial is fitted to the finite element stress, under conditions of equilibrium, "
             "known tractions and continuous contact pressure (SPR-C).") +
         counts_table("A patch", results.patches_by_kind, patch_kinds) +
         counts_table("Its conditions", results.patches_by_status, patch_statuses) +
         note(fmt::format("{} patches joined with a neighbour for lack of material, {} of degree 2, {} redundant "
                          "conditions dropped.",
                          grouped(results.grown_patches), grouped(results.quadratic_patches),
                          grouped(results.truncated_rows)));
}

std::string cost_section(const Results& results) {
  double total = 0;
  for (const auto& [phase, s] : results.times_s) total += s;
  std::vector<std::string> rows;
  for (const auto& [phase, s] : results.times_s)
    rows.push_back(name_cell(html_text(phase)) + "<td class=\"run\">" + seconds(s) + "</td>" +
                   bar(total > 0 ? s / total : 0, "bar run"));
  std::string text =
      paragraph(fmt::format("{} unknowns, {} cells: {} cut by a boundary, {} inside.", count(results.unknowns),
                            count(results.cells.active), count(results.cells.cut), count(results.cells.interior)));
  if (results.cells.joined > 0)
    text +=
        paragraph(fmt::format("{} more cells hold next to nothing (a face lies on a plane of the grid up to rounding); "
                              "it counts as their neighbours'.",
                              count(results.cells.joined)));
  if (results.accuracy.asked)
    text += "<p class=\"run\">All solves: " + html_text(solves_text(results.accuracy)) +
            ". Phases are those of the last one:</p>\n";
  if (!rows.empty()) {
    rows.push_back(name_cell("sum") + "<td class=\"run\">" + seconds(total) + "</td>" + cell(""));
    text += table({"Phase", "Wall time", ""}, rows);
  }
  return text + "<p class=\"run\">Peak memory " +
         figure(static_cast<double>(results.peak_memory_bytes),
                scaled(static_cast<double>(results.peak_memory_bytes), "B", 3)) +
         ".</p>\n";
}

std::string date() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M %z", &local);
  return text;
}

std::string reproduce_section(const Results& results, const PageContents& contents) {
  std::string text;
  if (!results.command.empty()) text += "<pre class=\"run\">" + html_text(results.command) + "</pre>\n";
  text +=
      paragraph(fmt::format("cgcontact {}, backend {}, {}; scene {}.", CGCONTACT_VERSION, html_text(results.backend),
                            processors_text(results.ranks, results.threads), html_text(results.scene_file)));
  text += "<p class=\"run\">Written " + date() + ".</p>\n";
  std::string files;
  for (const std::string& file : contents.files) files += (files.empty() ? "" : ", ") + html_text(file);
  return text + note("Files beside this page: " + files +
                     ". Figures in SI units: report.json; ParaView 5.11 opens the .vtkhdf files.");
}

}  // namespace

std::set<std::string> pictures_for_view(const PageContents& contents) {
  std::set<std::string> beside;
  if (contents.view.json.empty()) return beside;
  std::map<std::string, std::uintmax_t> sizes;
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(contents.directory))
    if (const auto type = entry.path().extension(); type == ".png" || type == ".svg")
      bytes += sizes[entry.path().filename().string()] = entry.file_size();
  const auto leave = [&](const std::string& file) {
    if (sizes.count(file) && beside.insert(file).second) bytes -= sizes[file];
  };
  if (bytes > pictures_beside_view)
    for (const std::string& step : contents.steps) leave(step);
  if (bytes > pictures_beside_view) leave("conditions.png");
  for (std::size_t k = contents.pressure_maps.size(); bytes > pictures_beside_view && k-- > 1;)
    leave(contents.pressure_maps[k].file);
  return beside;
}

std::string page(const Results& results, const PageContents& contents) {
  std::vector<std::string> warnings = results.warnings;
  warnings.insert(warnings.end(), contents.warnings.begin(), contents.warnings.end());
  const std::string title = html_text(results.title.empty() ? results.scene_file : results.title);
  std::string text = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n";
  text += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  text += "<title>" + title + " – cgcontact</title>\n<style>\n" + page_style + film_style(contents.steps.size()) +
          view_style(contents.view) + "</style>\n</head>\n<body>\n";
  text += "<header><h1>" + title + "</h1>\n" + note("Scene " + html_text(results.scene_file)) + "</header>\n<main>\n";
  text += "<section id=\"verdict\">\n" + verdict(results, warnings) + tiles(results) + "</section>\n";
  text += section("reliability", "How accurate is this?", reliability(results));
  text += section("accuracy", "The way to the accuracy", accuracy_section(results, contents));
  text += section("view", "The result in three dimensions", view_content(contents.view));
  text += section("picture", "Deformed bodies",
                  picture(contents, "scene.png", words_of_scene(results, contents.zone_in_scene), ""));
  text += section("maxima", "Largest values", maxima_section(results));
  text += section("contact", "Contact", pairs_section(results));
  text += section("steps", "Steps", steps_section(results, contents));
  text += section("pressure", "Pressure on the contact face", maps_section(results, contents));
  text += section("profile", "Pressure along the path", profile_section(results, contents));
  text += section("sections", "Sections", sections_section(contents));
  text += section("probes", "Probes", probes_section(results, contents));
  text += section("reference", "Against the reference", reference_section(results));
  text += section("conditions", "Supports, loads and interferences", conditions_section(results, contents));
  text += section("balance", "Forces", balance_section(results));
  text += section("grid", "The final grid", picture(contents, "grid.png", "The cells of the bodies", grid_caption));
  text += section("bodies", "Bodies and where the error is", bodies_section(results));
  text += section("convergence", "Convergence", convergence_section(results));
  text += section("recovery", "Recovery of the stress", recovery_section(results));
  text += section("cost", "Size, time and memory", cost_section(results));
  text += section("reproduce", "How to reproduce", reproduce_section(results, contents));
  return text + "</main>\n</body>\n</html>\n";
}

}  // namespace cgcontact
