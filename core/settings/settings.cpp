#include "core/settings/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

/// Returns the present value as TOML; empty: there is none.
std::string value_text(const Setting& setting) {
  struct Text {
    std::string operator()(const double* value) const { return fmt::format("{}", *value); }
    std::string operator()(const int* value) const { return fmt::format("{}", *value); }
    std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
    std::string operator()(const std::string* value) const { return value->empty() ? "" : '"' + *value + '"'; }
    std::string operator()(const Target* value) const { return *value ? fmt::format("{}", **value) : ""; }
    std::string operator()(const std::optional<PathEnds>* value) const {
      if (!*value) return "";
      const auto& [a, b] = **value;
      return fmt::format("{{from = [{}, {}, {}], to = [{}, {}, {}]}}", a[0], a[1], a[2], b[0], b[1], b[2]);
    }
    std::string operator()(const Choice& choice) const { return '"' + choice.names[choice.number()] + '"'; }
    std::string operator()(const OwnForm& form) const { return form.text(); }
  };
  return std::visit(Text{}, setting.value);
}

/// Returns the words for what is allowed; empty: its meaning says it.
std::string allowed_text(const Setting& setting) {
  struct Text {
    const Range& range;
    std::string operator()(const double*) const { return range.text; }
    std::string operator()(const int*) const { return range.text; }
    std::string operator()(const bool*) const { return "true or false"; }
    std::string operator()(const std::string*) const { return ""; }
    std::string operator()(const Target*) const { return range.text; }
    std::string operator()(const std::optional<PathEnds>*) const { return ""; }
    std::string operator()(const Choice& choice) const { return fmt::format("{}", fmt::join(choice.names, ", ")); }
    std::string operator()(const OwnForm&) const { return range.text; }
  };
  return std::visit(Text{setting.range}, setting.value);
}

std::string print_setting(const Setting& setting, const Setting& of_default) {
  const std::string value = value_text(setting), usual = value_text(of_default);
  std::string line = setting.of_scene && !value.empty() ? "" : "# ";
  line += setting.key + " = " + (value.empty() ? setting.if_empty : value) + "  # default";
  if (value != usual) line += " " + (usual.empty() ? of_default.if_empty : usual);
  if (const std::string allowed = allowed_text(setting); !allowed.empty()) line += "; " + allowed;
  return line + "; " + setting.meaning + "\n";
}

}  // namespace

Setting method_constant(const std::string& key, double& value, const std::string& meaning, const Range& range) {
  return {key, &value, meaning, range, {}, {}, false};
}

Setting method_constant(const std::string& key, int& value, const std::string& meaning, const Range& range) {
  return {key, &value, meaning, range, {}, {}, false};
}

void check_settings(const std::string& section, const std::vector<Setting>& settings) {
  for (const Setting& s : settings) {
    bool allowed = true;
    if (const auto* number = std::get_if<double*>(&s.value))
      allowed = std::isfinite(**number) && s.range.contains(**number);
    if (const auto* number = std::get_if<int*>(&s.value))
      allowed = s.range.contains(**number) &&
                (s.only.empty() || std::find(s.only.begin(), s.only.end(), **number) != s.only.end());
    if (const auto* target = std::get_if<Target*>(&s.value)) allowed = !**target || s.range.contains(***target);
    if (!allowed)
      throw InputError(SourceLocation{"", 0, section + "." + s.key}, value_text(s), "out of range", s.range.text);
  }
}

std::string print_settings(const std::string& section, const std::vector<Setting>& settings,
                           const std::vector<Setting>& defaults) {
  std::string of_scene, constants;
  for (std::size_t k = 0; k < settings.size(); ++k)
    (settings[k].of_scene ? of_scene : constants) += print_setting(settings[k], defaults[k]);
  return (of_scene.empty() ? "# [" : "[") + section + "]\n" + of_scene + constants;
}

}  // namespace cgcontact
