/// contact.csv: one line per boundary point of the contact faces; pressure.csv: one per point on the paths and body;
/// steps.csv: one per step and contact pair.
#pragma once

#include <string>
#include <vector>

#include "core/results/results.hpp"

namespace cgcontact {

/// Significant digits: results of a scene in other axes, units or on other machines agree to some 1e-9.
constexpr int csv_digits = 10;

/// Divides a line at its commas, those in quotes apart (csv_text).
std::vector<std::string> csv_fields(const std::string& line);

/// Writes SI units (x, y, z, gap: m; weight: m^2; pressures: Pa, positive in compression), with csv_digits.
void write_contact_csv(const Results& results, const std::string& file_name);

/// Writes the paths of the pairs: s, x, y, z (m), pressures (Pa); the reference is empty where there is none.
void write_pressure_csv(const Results& results, const std::string& file_name);

/// Writes force on the first body of the pair (N), area (m^2), largest pressure (Pa).
void write_steps_csv(const Results& results, const std::string& file_name);

}  // namespace cgcontact
