/// The accuracy that [accuracy] asks for beside the one that a run estimates, for people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results/results.hpp"

namespace cgcontact {

/// One target; relative errors.
struct AskedError {
  std::string name;  ///< "pressure", "force", "stress", "stress in NAME"
  double target;
  std::optional<double> estimate;  ///< of answer_of(accuracy); none: the contact zone is not resolved
};

std::vector<AskedError> asked_errors(const AccuracyFigures& accuracy);

/// Returns whether any solve has an error of friction's shear.
bool has_shear(const AccuracyFigures& accuracy);

/// Formats "0.783 %": with the digits that distinguish an estimate from its target.
std::string fine_percent(double fraction);

/// "4 solves, 19.4 s".
std::string solves_text(const AccuracyFigures& accuracy);

}  // namespace cgcontact
