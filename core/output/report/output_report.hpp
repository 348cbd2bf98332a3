/// report.json.
#pragma once

#include <string>
#include <vector>

#include "core/results/results.hpp"

namespace cgcontact {

/// Returns the text of write_report.
std::string report_text(const Results& results, const std::vector<std::string>& files,
                        const std::vector<std::string>& warnings);

/// Writes the figures of a run; `files` lists what lies beside the report, `warnings` are added to those of the
/// results.
void write_report(const Results& results, const std::vector<std::string>& files,
                  const std::vector<std::string>& warnings, const std::string& file_name);

/// Files that the report in a result directory lists. Throws InputError if it is not a report of this program.
std::vector<std::string> files_of_report(const std::string& file_name);

}  // namespace cgcontact
