#include "core/output/study/study_table.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

namespace {

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// The solved row of the same variant with the next larger cells.
const StudyRow* next_coarser(const Study& study, const StudyRow& row) {
  const StudyRow* found = nullptr;
  for (const StudyRow& other : study.rows)
    if (other.variant == row.variant && other.status == StudyRow::Status::solved && !other.errors.empty() &&
        other.cell_size > row.cell_size * (1 + 1e-9) && (!found || other.cell_size < found->cell_size))
      found = &other;
  return found;
}

}  // namespace

const std::vector<PressureKind>& pressure_kinds() {
  static const std::vector<PressureKind> kinds{{"raw stress", "raw", "#909090", &ZoneError::raw},
                                               {"SPR", "spr", "#2070b8", &ZoneError::spr},
                                               {"result", "sprc", "#d2501e", &ZoneError::sprc}};
  return kinds;
}

const char* status_name(StudyRow::Status status) {
  static const char* const names[] = {"not run", "solved", "not converged", "failed"};
  return names[static_cast<int>(status)];
}

const StudyRow* finest_row(const Study& study) {
  const StudyRow* finest = nullptr;
  for (const StudyRow& row : study.rows)
    if (row.status == StudyRow::Status::solved && (!finest || row.cell_size < finest->cell_size * (1 - 1e-9)))
      finest = &row;
  return finest;
}

std::vector<std::string> zone_names(const Study& study) {
  std::vector<std::string> names;
  for (const StudyRow& row : study.rows)
    for (const ZoneError& zone : row.errors) add_once(names, zone.zone);
  return names;
}

std::vector<std::string> phase_names(const Study& study) {
  std::vector<std::string> names;
  for (const StudyRow& row : study.rows)
    for (const auto& [phase, seconds] : row.figures.times_s) add_once(names, phase);
  return names;
}

std::optional<double> pressure_error(const StudyRow& row, const std::string& zone, const PressureKind& kind) {
  for (const ZoneError& error : row.errors)
    if (error.zone == zone) return error.*kind.error;
  return std::nullopt;
}

std::optional<double> error_ratio(const StudyRow& row, const std::string& zone) {
  for (const ZoneError& error : row.errors)
    if (error.zone == zone && error.sprc > min_error) return error.spr / error.sprc;
  return std::nullopt;
}

std::optional<double> force_error(const StudyRow& row) {
  if (!row.force_reference || !row.figures.force || *row.force_reference == 0) return std::nullopt;
  return std::abs(*row.figures.force / std::abs(*row.force_reference) - 1);
}

std::optional<double> observed_rate(const Study& study, const StudyRow& row, const std::string& zone,
                                    const PressureKind& kind) {
  const StudyRow* const coarse = next_coarser(study, row);
  if (!coarse || row.status != StudyRow::Status::solved) return std::nullopt;
  const auto before = pressure_error(*coarse, zone, kind), after = pressure_error(row, zone, kind);
  if (!before || !after || !(std::min(*before, *after) > min_error)) return std::nullopt;
  return std::log(*before / *after) / std::log(coarse->cell_size / row.cell_size);
}

}  // namespace cgcontact
