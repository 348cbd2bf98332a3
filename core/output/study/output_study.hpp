/// Writes the table of a study and reads it back.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/output/study/study_table.hpp"

namespace cgcontact {

/// Writes study.csv, study.json and the plots (output_study_plots.hpp) of all runs that have ended. Each file is
/// replaced at once; an old plot that cannot be drawn any more goes. Returns warnings.
std::vector<std::string> write_study(const Study& study, const std::string& directory);

/// Throws InputError unless `directory` is missing, empty, or that of an earlier study.
void check_study_directory(const std::string& directory);

/// Returns the runs in the study.json of a directory that gave a report, by fingerprint; empty if there is no
/// study.json.
std::map<std::string, StudyRow> earlier_rows(const std::string& directory);

/// Returns the tables for the terminal: cost of each run, error of the pressure in each zone, what failed.
std::string study_summary(const Study& study, const std::string& directory);

}  // namespace cgcontact
