/// What all pictures share: running gnuplot, colours, units.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace cgcontact {

/// Writes `script` as `name`.gp into the folder `plots` of the result directory and runs gnuplot there; `picture` (in
/// the result directory) must exist afterwards. Failures become warnings, the script and its data stay.
void run_gnuplot(const std::string& directory, const std::string& name, const std::string& script,
                 const std::string& picture, std::vector<std::string>& warnings);

/// Colour of a value in [0,1], from blue to red; channels in [0,1].
std::array<double, 3> palette_colour(double value);
/// The same as a gnuplot command.
std::string gnuplot_palette();

/// A unit for axes: multiply a value in SI by `factor`.
struct AxisUnit {
  double factor = 1;
  std::string name;
};
AxisUnit length_unit(double largest);  ///< m, mm or um
AxisUnit stress_unit(double largest);  ///< Pa, kPa, MPa or GPa

/// Text for gnuplot in single quotes: in double quotes it would run commands in backquotes. Nothing in it is
/// interpreted if the terminal is set to noenhanced.
std::string gnuplot_text(const std::string& text);

}  // namespace cgcontact
