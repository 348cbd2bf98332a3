/// The summary of a run on the terminal.
#pragma once

#include <string>

#include "core/results/results.hpp"

namespace cgcontact {

/// Summarises a run in at most 24 lines of 80 columns, whatever the number of pairs and warnings: what does not fit is
/// in the report. Words longer than a line (paths) are not divided. `directory` holds the results.
std::string summary(const Results& results, const std::string& directory);

}  // namespace cgcontact
