#include "contact/results/reference/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

namespace cgcontact {

namespace {

/// Fields between commas, or semicolons or tabs if there are any, without blanks around them.
std::vector<std::string> fields_of(const std::string& line) {
  const char separator = line.find(';') != std::string::npos ? ';' : line.find('\t') != std::string::npos ? '\t' : ',';
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, separator);) {
    const std::size_t first = field.find_first_not_of(" \t\r"), last = field.find_last_not_of(" \t\r");
    fields.push_back(first == std::string::npos ? "" : field.substr(first, last - first + 1));
  }
  return fields;
}

/// Finite number, nothing else.
std::optional<double> number_in(const std::string& field) {
  double value = 0;
  const char* const begin = field.data() + (!field.empty() && field[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, field.data() + field.size(), value);
  const bool whole = error == std::errc() && end == field.data() + field.size() && std::isfinite(value);
  return whole ? std::optional<double>(value) : std::nullopt;
}

}  // namespace

ReferenceTable::ReferenceTable(const std::string& file, int min_columns) {
  std::ifstream in(file);
  if (!in) throw InputError(fmt::format("{}: cannot be read (reference table)", file));
  const auto fail = [&](int line, const std::string& value, const std::string& problem, const std::string& allowed) {
    throw InputError(SourceLocation{file, line, ""}, value, problem + " (reference table)", allowed);
  };
  std::string line;
  bool names_allowed = true;  // in the first line that is no comment
  for (int number = 1; std::getline(in, line); ++number) {
    if (number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    const std::vector<std::string> fields = fields_of(line);
    std::vector<double> row;
    for (const std::string& field : fields)
      if (const auto value = number_in(field)) row.push_back(*value);
    const bool names = names_allowed && row.empty();
    names_allowed = false;
    if (names) continue;
    if (row.size() != fields.size()) {
      const auto bad = std::find_if(fields.begin(), fields.end(), [](const auto& field) { return !number_in(field); });
      fail(number, '"' + *bad + '"', "is not a number", "finite numbers with a decimal point, commas between them");
    }
    if (static_cast<int>(row.size()) < min_columns)
      fail(number, "", fmt::format("{} column{}", row.size(), row.size() == 1 ? "" : "s"),
           fmt::format("at least {}, with commas between them", min_columns));
    if (!rows_.empty() && row.size() != rows_.back().size())
      fail(number, "", fmt::format("{} columns, the line before has {}", row.size(), rows_.back().size()),
           "the same number in every line");
    if (!rows_.empty() && row[0] < rows_.back()[0])
      fail(number, fmt::format("{:g}", row[0]), fmt::format("is less than {:g} before it", rows_.back()[0]),
           "a first column that does not decrease");
    rows_.push_back(std::move(row));
  }
  if (rows_.size() < 2)
    fail(0, "", fmt::format("{} row{} of numbers", rows_.size(), rows_.size() == 1 ? "" : "s"), "two or more");
}

double ReferenceTable::operator()(double s, int column) const {
  const auto above = std::lower_bound(rows_.begin(), rows_.end(), s,
                                      [](const std::vector<double>& row, double value) { return row[0] < value; });
  if (above == rows_.begin()) return rows_.front()[column];
  if (above == rows_.end()) return rows_.back()[column];
  const auto below = above - 1;
  const double span = (*above)[0] - (*below)[0];
  const double t = span > 0 ? (s - (*below)[0]) / span : 0;
  return (1 - t) * (*below)[column] + t * (*above)[column];
}

Reference::Reference(const Scene& scene, const ReferenceSpec& spec) : scene_(scene), spec_(spec) {
  axis_ = static_cast<int>(spec_.coordinate);
  if (!spec_.pressure_file.empty()) pressure_table_.emplace(spec_.pressure_file, 2);
  if (!spec_.stress_file.empty()) stress_table_.emplace(spec_.stress_file, 7);
}

double Reference::pressure(const Vec3& x) const {
  return pressure_table_ ? (*pressure_table_)(x[axis_], 1) : (*spec_.pressure)(x);
}

Sym3 Reference::stress(int body, const Vec3& x) const {
  Sym3 s = Sym3::Zero();
  if (!spec_.stress_of_body.empty()) {
    for (int k = 0; k < 6; ++k) s[k] = spec_.stress_of_body[body][k](x);
    return s;
  }
  const int first = scene_.contacts.front().first.body == body ? 1 : 4;
  const double y = x[axis_], nu = scene_.bodies[body].material.poisson_ratio;
  s[1] = (*stress_table_)(y, first);
  s[2] = (*stress_table_)(y, first + 1);
  s[4] = (*stress_table_)(y, first + 2);
  s[0] = nu * (s[1] + s[2]);
  return s;
}

}  // namespace cgcontact
