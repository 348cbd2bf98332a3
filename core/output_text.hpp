/// Plain files and numbers as text, with every write checked.
#pragma once

#include <string>

namespace cgcontact {

/// Writes the whole file; throws InputError that names the file and the system's reason (disk full, no permission).
void write_text(const std::string& file_name, const std::string& text);

/// Whole file; throws InputError.
std::string read_text(const std::string& file_name);

/// A field of a CSV file: quoted if it holds a comma, a quote or a line break.
std::string csv_text(const std::string& text);

/// A number for people: `digits` significant digits, e.g. "9.37", "1.6e-06".
std::string short_number(double value, int digits = 4);

/// A value with the unit scaled by powers of 1000, e.g. scaled(9.4e6, "Pa") = "9.4 MPa".
std::string scaled(double value, const std::string& unit, int digits = 4);

}  // namespace cgcontact
