/// report.json of an earlier run, for the commands that look at results.
#pragma once

#include <string>

#include "core/base/files/json.hpp"

namespace cgcontact {

/// Returns the report in the output directory of a run; its "contact" and "bodies" are arrays. Throws InputError that
/// names the directory if there is none, or no such report in it.
Json read_report(const std::string& directory);

}  // namespace cgcontact
