#include "core/results/warning_order.hpp"

#include <algorithm>

namespace cgcontact {

namespace {

struct Phrase {
  const char* text;  ///< anywhere in the warning
  int severity;
};

constexpr int assumed = 2;  ///< warnings without any of the phrases

const Phrase phrases[] = {
    {"although the faces overlap", 0},
    {"small strain", 1},
    {"adds up to", 1},
    {"elements lock", 1},
    {"has no finite value", 1},
    {"bending and the stress", 1},
    {"not resolved", 0},
    {"slides: ", 0},
    {"were singular", 1},
    {"is its unit right", 1},
    {"a number without a unit", 1},
    {"is a unit wrong", 1},
    {"goes into the support", 1},
    {"springs of the scene take", 1},
    {"cells wide", 1},
    {"repaired", 3},
    {"were joined", 3},
    {"hardware thread", 3},
    {"runs on 1 thread", 3},
    {"no pictures", 3},
    {"gnuplot", 3},
    {"no pressure.svg", 3},
};

}  // namespace

int warning_severity(const std::string& warning) {
  for (const Phrase& phrase : phrases)
    if (warning.find(phrase.text) != std::string::npos) return phrase.severity;
  return assumed;
}

void decisive_first(std::vector<std::string>& warnings) {
  std::stable_sort(warnings.begin(), warnings.end(), [](const std::string& a, const std::string& b) {
    return warning_severity(a) < warning_severity(b);
  });
}

}  // namespace cgcontact
