/// error_time.svg and error_unknowns.svg: the error of the contact pressure against what it costs; figures.svg: force,
/// largest pressure and area over what the study varies.
#pragma once

#include <string>
#include <vector>

#include "core/output/study_table.hpp"

namespace cgcontact {

/// Draws both into `directory`, which has a folder `plots`. Without any error there is nothing to draw; then, and if
/// gnuplot fails, there is a warning.
void write_study_plots(const Study& study, const std::string& directory, std::vector<std::string>& warnings);

}  // namespace cgcontact
