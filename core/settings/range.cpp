#include "core/settings/range.hpp"

namespace cgcontact {

namespace {

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

}  // namespace

Range Range::any(const std::string& unit) {
  Range range;
  range.text = with_unit("a finite number", unit.empty() ? "" : "(" + unit + ")");
  range.unit = unit;
  return range;
}

Range Range::positive(const std::string& unit) {
  Range range;
  range.min = 0;
  range.min_allowed = false;
  range.text = with_unit("> 0", unit);
  range.unit = unit;
  return range;
}

Range Range::not_negative(const std::string& unit) {
  Range range;
  range.min = 0;
  range.text = with_unit(">= 0", unit);
  range.unit = unit;
  return range;
}

Range Range::from_to(double min, double max, const std::string& text, const std::string& unit) {
  Range range;
  range.min = min;
  range.max = max;
  range.text = text;
  range.unit = unit;
  return range;
}

Range Range::integers(int min, int max) {
  return from_to(min, max, "an integer from " + std::to_string(min) + " to " + std::to_string(max));
}

Range Range::fraction() {
  Range range = positive();
  range.max = 1;
  range.max_allowed = false;
  range.text = "> 0 and < 1";
  return range;
}

Range Range::tolerance() {
  Range range = from_to(1e-15, 1, ">= 1e-15 and < 1");
  range.max_allowed = false;
  return range;
}

}  // namespace cgcontact
