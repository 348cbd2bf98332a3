/// error_time.svg and error_unknowns.svg: the error of the contact pressure against what it costs; figures.svg: force,
/// largest pressure and area over what the study varies.
#pragma once

#include <string>
#include <vector>

#include "core/output/study/study_table.hpp"

namespace cgcontact {

/// Draws both into `directory`, which has a folder `plots`. Warns if gnuplot fails or without any error to draw.
void write_study_plots(const Study& study, const std::string& directory, std::vector<std::string>& warnings);

}  // namespace cgcontact
