#include "core/settings/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors.hpp"

namespace cgcontact {

namespace {

std::string value_text(const Setting& setting) {
  struct Text {
    const Setting& setting;
    std::string operator()(const double* value) const { return fmt::format("{}", *value); }
    std::string operator()(const int* value) const { return fmt::format("{}", *value); }
    std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
    std::string operator()(const std::string* value) const {
      return value->empty() ? setting.if_empty : '"' + *value + '"';
    }
    std::string operator()(const std::optional<PathEnds>* value) const {
      if (!*value) return setting.if_empty;
      const auto& [a, b] = **value;
      return fmt::format("{{from = [{}, {}, {}], to = [{}, {}, {}]}}", a[0], a[1], a[2], b[0], b[1], b[2]);
    }
    std::string operator()(const Choice& choice) const { return '"' + choice.names[choice.number()] + '"'; }
  };
  return std::visit(Text{setting}, setting.value);
}

}  // namespace

Setting method_constant(const std::string& key, double& value, const Range& range) {
  return {key, &value, range, {}, {}, false};
}

Setting method_constant(const std::string& key, int& value, const Range& range) {
  return {key, &value, range, {}, {}, false};
}

void check_settings(const std::string& section, const std::vector<Setting>& settings) {
  for (const Setting& s : settings) {
    bool allowed = true;
    if (const auto* number = std::get_if<double*>(&s.value))
      allowed = std::isfinite(**number) && s.range.contains(**number);
    if (const auto* number = std::get_if<int*>(&s.value))
      allowed = s.range.contains(**number) &&
                (s.only.empty() || std::find(s.only.begin(), s.only.end(), **number) != s.only.end());
    if (!allowed)
      throw InputError(SourceLocation{"", 0, section + "." + s.key}, value_text(s), "out of range", s.range.text);
  }
}

std::string print_settings(const std::string& section, const std::vector<Setting>& settings) {
  std::string text = "[" + section + "]\n", constants;
  for (const Setting& s : settings)
    (s.of_scene ? text : constants) += (s.of_scene ? "" : "# ") + s.key + " = " + value_text(s) + "\n";
  return text + constants;
}

}  // namespace cgcontact
