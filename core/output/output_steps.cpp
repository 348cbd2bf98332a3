#include "core/output/output_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {

/// Most steps with a picture, evenly spread, the last one among them: all of them lie on the page.
constexpr std::size_t max_pictures = 20;

bool has_picture(std::size_t number, std::size_t num_steps) {
  const std::size_t back = num_steps - 1 - number, apart = (num_steps + max_pictures - 1) / max_pictures;
  return back % apart == 0;
}

/// "step_03": the names of a series sort as its steps.
std::string picture_name(std::size_t number, std::size_t num_steps) {
  return fmt::format("step_{:0{}}", number + 1, std::to_string(num_steps).size());
}

/// Returns what the picture of a step needs of its contact: pairs and closed points.
Results closed_contact(const Results& step) {
  Results contact;
  contact.pairs = step.pairs;
  std::copy_if(step.contact_rows.begin(), step.contact_rows.end(), std::back_inserter(contact.contact_rows),
               [](const ContactRow& row) { return row.active; });
  return contact;
}

}  // namespace

void StepFields::add(std::size_t number, const Results& step) {
  if (number == 0) {
    vtk_.reset();
    drawn_.clear();
    largest_.clear();
    looks_.clear();
  }
  const bool with_stress = file_ || number + 1 == num_steps_;
  drawn_.resize(step.bodies.size());
  for (std::size_t b = 0; b < drawn_.size(); ++b) {
    BodyFields fields = step.bodies[b];
    if (!with_stress) fields.stress_recovered = nullptr;
    if (number == 0)
      drawn_[b] = draw_body(fields);
    else
      redraw(fields, drawn_[b]);
  }
  if (number == 0 && file_) vtk_.emplace(drawn_, *file_);
  if (vtk_) vtk_->add(drawn_);
  double largest = 0;
  const auto raise = [&](const PointValues& values) {
    for (const Vec3& u : values.displacement) largest = std::max(largest, u.norm());
  };
  for (const DrawnBody& body : drawn_) {
    raise(body);
    each_interior_block(body, [&](int, const PointValues& values) { raise(values); });
  }
  largest_.push_back(largest);
  if (has_picture(number, num_steps_))
    looks_.push_back({number, picture_name(number, num_steps_), closed_contact(step)});
}

bool StepFields::are_of(const Results& results) const {
  return std::equal(
      drawn_.begin(), drawn_.end(), results.bodies.begin(), results.bodies.end(),
      [](const DrawnBody& drawn, const BodyFields& body) { return drawn.mesh.cut_cells == body.cut_cells; });
}

std::vector<std::string> StepFields::draw(const std::string& title, const SceneView& scene, GnuplotRuns& runs) {
  for (StepLook& look : looks_)
    look.words.title = fmt::format("{}{}step {} of {}", title, title.empty() ? "" : ", ", look.number + 1, num_steps_);
  std::vector<DrawnBody> bodies = drawn_;
  return write_step_pictures(
      looks_, scene, *std::max_element(largest_.begin(), largest_.end()),
      [&](std::size_t number) -> const std::vector<DrawnBody>& {
        vtk_->read(number, bodies);
        return bodies;
      },
      runs);
}

std::vector<ViewStep> StepFields::boundary_fields() {
  std::vector<ViewStep> steps;
  if (!vtk_) return steps;
  std::vector<DrawnBody> bodies = drawn_;
  for (const StepLook& look : looks_) {
    vtk_->read(look.number, bodies);
    ViewStep& step = steps.emplace_back();
    step.number = look.number;
    for (DrawnBody& body : bodies) step.bodies.push_back(std::move(static_cast<PointValues&>(body)));
  }
  return steps;
}

void StepFields::finish() {
  if (vtk_) vtk_->finish();
}

void write_force_displacement_plot(const Results& results, GnuplotRuns& runs) {
  const std::vector<PairFigures>& pairs = results.steps.back().pairs;
  double far = 0, high = 0;
  for (const StepFigures& step : results.steps) {
    if (!step.displacement) return;
    far = std::max(far, *step.displacement);
    for (const PairFigures& pair : step.pairs) high = std::max(high, told_force(pair));
  }
  const DisplayUnit length = length_unit(far), newton = force_unit(high);
  std::string data;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (const StepFigures& step : results.steps)
      fmt::format_to(std::back_inserter(data), "{} {}\n", *step.displacement * length.factor,
                     told_force(step.pairs[p]) * newton.factor);
    data += "\n\n";
  }
  write_text(runs.directory() + "/plots/force_displacement.dat", data);
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size 760,480 fixed noenhanced font 'sans-serif,14' background 'white'\n"
      "set output '../force_displacement.svg'\nset title {}\nset border 3 lw 1 lc rgb '#404040'\n"
      "set tics nomirror out\nset grid lc rgb '#e4e4e4' lw 1 dt 1\nset xrange [0:*]\nset yrange [0:*]\n"
      "set key outside bottom center horizontal Left reverse\n"
      "set xlabel 'largest displacement [{}]'\nset ylabel 'contact force [{}]'\nplot ",
      gnuplot_title("Force over displacement: " + results.title, 720, 15).text, length.name, newton.name);
  for (std::size_t p = 0; p < pairs.size(); ++p)
    script += fmt::format("{}'force_displacement.dat' index {} with linespoints lw 2 pt 7 ps 0.6 title {}",
                          p == 0 ? "" : ", ", p, gnuplot_text(shortened_name(pairs[p].name, longest_entry)));
  runs.start("force_displacement", script + "\n", {"force_displacement.svg"});
}

}  // namespace cgcontact
