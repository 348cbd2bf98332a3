/// The warning that decides whether a result can be used comes first.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

/// Returns the severity of a warning: 0 the figures mean nothing, 1 some are far off, 2 something was assumed or left
/// out, 3 of the surroundings (threads, pictures, repairs).
int warning_severity(const std::string& warning);

/// Sorts by severity; those of the same severity stay in their order.
void decisive_first(std::vector<std::string>& warnings);

}  // namespace cgcontact
