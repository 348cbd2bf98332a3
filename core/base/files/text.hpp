/// Plain files and numbers as text, with every write checked.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Writes the whole file; throws InputError that names the file and the system's reason (disk full, no permission).
void write_text(const std::string& file_name, const std::string& text);

/// Reads a whole file; throws InputError.
std::string read_text(const std::string& file_name);

/// Formats a field of a CSV file: quoted if it holds a comma, a quote or a line break.
std::string csv_text(const std::string& text);

/// Returns a text without the blanks, tabs and carriage returns at both ends.
std::string trimmed(std::string_view text);

/// Rounds down to 1, 2 or 5 times a power of ten.
double round_down(double value);

/// Rounds a number above zero to two significant digits.
double two_digits(double value);

/// Formats a number with `digits` significant digits, e.g. "9.37", "1.6e-06".
std::string short_number(double value, int digits = 4);

/// Formats a fraction in per cent with two digits and no exponent above 1 %, e.g. "0.41", "12", "340", "over 9999".
std::string percent_number(double fraction);

/// "2 threads", "4 ranks of 1 thread".
std::string processors_text(int ranks, int threads);

/// Formats a value with the unit scaled by powers of 1000, e.g. scaled(9.4e6, "Pa") = "9.4 MPa".
std::string scaled(double value, const std::string& unit, int digits = 4);

/// Escapes <, >, &, quotes and control characters for a page.
std::string html_text(const std::string& text);

/// Quotes a word of a command line for a shell where needed.
std::string shell_word(const std::string& word);

std::string base64(const std::string& bytes);

/// Wraps `text` to lines of at most `width` columns (Chinese, Japanese and Korean letters take two); the first line
/// starts with `first`, the others with blanks of its width. Words longer than a line are not divided.
std::vector<std::string> wrapped(const std::string& text, const std::string& first, int width);

/// Returns the columns that a text in UTF-8 takes on a terminal.
int columns_of(const std::string& text);

/// Shortens a name of a scene (one byte per letter) to at most `columns`: its beginning and its end, with two dots
/// between.
std::string shortened_name(const std::string& name, int columns);

/// Formats an integer with groups of three digits: "28,764".
std::string grouped(long long value);

/// Multiply a value in SI by `factor` to have it in the unit `name`.
struct DisplayUnit {
  double factor = 1;
  std::string name;
};
DisplayUnit length_unit(double largest);  ///< m, mm or um
DisplayUnit area_unit(double largest);    ///< m^2, mm^2 or um^2
DisplayUnit stress_unit(double largest);  ///< Pa, kPa, MPa or GPa
DisplayUnit force_unit(double largest);   ///< N, kN, MN or mN

/// Formats a vector in SI, e.g. "(1.2, 0, 3) mm"; components that are rounding beside the others are 0.
std::string vector_text(const Vec3& v, const DisplayUnit& unit, int digits = 4);
/// Formats a position with the unit that fits it.
std::string position_text(const Vec3& x, int digits = 4);
/// Formats a position in metres, "at (0.0012, 0, 0.003) m".
std::string at_position(const Vec3& x);

}  // namespace cgcontact
