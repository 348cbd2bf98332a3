#include "core/output/report/asked_accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/files/text.hpp"
#include "core/results/answer.hpp"

namespace cgcontact {

std::vector<AskedError> asked_errors(const AccuracyFigures& accuracy) {
  const SolveFigures last = accuracy.solves.empty() ? SolveFigures() : accuracy.solves[answer_of(accuracy)];
  std::vector<AskedError> errors;
  if (accuracy.pressure) errors.push_back({"pressure", *accuracy.pressure, last.pressure});
  if (accuracy.force) errors.push_back({"force", *accuracy.force, last.force});
  if (accuracy.shear)
    errors.push_back({"shear", *accuracy.shear, last.pressure ? std::optional(last.shear.value_or(0)) : std::nullopt});
  if (accuracy.stress) errors.push_back({"stress", *accuracy.stress, last.stress});
  for (std::size_t k = 0; k < accuracy.stress_of_body.size(); ++k) {
    const BodyTarget& target = accuracy.stress_of_body[k];
    std::optional<double> estimate;
    if (k < last.stress_of_body.size()) estimate = last.stress_of_body[k];
    errors.push_back({"stress in " + target.body, target.error, estimate});
  }
  for (std::size_t k = 0; k < accuracy.named.size(); ++k)
    errors.push_back(
        {accuracy.named[k].text(), accuracy.named[k].error, k < last.named.size() ? last.named[k] : std::nullopt});
  return errors;
}

bool has_shear(const AccuracyFigures& accuracy) {
  return std::any_of(accuracy.solves.begin(), accuracy.solves.end(),
                     [](const SolveFigures& solve) { return solve.shear.has_value(); });
}

std::string fine_percent(double fraction) {
  return (fraction < 0.001 ? percent_number(fraction) : short_number(100 * fraction, 3)) + " %";
}

std::string solves_text(const AccuracyFigures& accuracy) {
  double seconds = 0;
  for (const SolveFigures& solve : accuracy.solves) seconds += solve.seconds;
  const std::size_t count = accuracy.solves.size();
  std::string text =
      fmt::format("{} solve{}, {:.1f} s", count, count == 1 ? "" : "s", std::max(seconds, accuracy.seconds));
  const double unused = accuracy.seconds - seconds;
  if (unused > std::max(0.1, 0.01 * seconds))
    text += fmt::format(" ({:.1f} s of them for grids without a solve)", unused);
  return text;
}

}  // namespace cgcontact
