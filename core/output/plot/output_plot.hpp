/// `cgcontact plot`: a picture of a finished result, drawn from its files without a new solve.
#pragma once

#include <string>

#include "core/program/plot_options.hpp"

namespace cgcontact {

/// Draws it into PlotOptions::out, whole or not at all; the result stays as it is. Returns what is to be said: the
/// file, the largest and the smallest value and where they are. Throws InputError that names file or option and what is
/// allowed.
std::string plot_result(const PlotOptions& options);

}  // namespace cgcontact
