#include "contact/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace cgcontact {

ReferenceTable::ReferenceTable(const std::string& file, int min_columns) {
  std::ifstream in(file);
  if (!in) throw InputError(fmt::format("{}: cannot be read (reference table)", file));
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<double> row;
    std::istringstream fields(line);
    std::string field;
    while (std::getline(fields, field, ',')) {
      try {
        row.push_back(std::stod(field));
      } catch (const std::exception&) {
        throw InputError(fmt::format("{}:{}: \"{}\" is not a number", file, number, field));
      }
    }
    if (static_cast<int>(row.size()) < min_columns)
      throw InputError(fmt::format("{}:{}: {} columns (allowed: at least {})", file, number, row.size(), min_columns));
    if (!rows_.empty() && row[0] < rows_.back()[0])
      throw InputError(fmt::format("{}:{}: the first column must not decrease", file, number));
    rows_.push_back(std::move(row));
  }
  if (rows_.empty()) throw InputError(fmt::format("{}: the reference table is empty", file));
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
  axis_ = spec_.coordinate == "x" ? 0 : spec_.coordinate == "y" ? 1 : 2;
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
