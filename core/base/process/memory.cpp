#include "core/base/process/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <new>

#include "core/base/errors/errors.hpp"
#include "core/base/process/control_groups.hpp"
#include "core/base/process/ranks.hpp"

namespace cgcontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// First number in a file; `otherwise` if none ("max").
double number_in(const std::string& file, double otherwise) {
  double value = otherwise;
  std::ifstream stream(file);
  return stream >> value ? value : otherwise;
}

/// Number after a word ("MemAvailable: 123 kB"), `otherwise` if the file has no such word.
double number_after(const std::string& file, const std::string& word, double otherwise) {
  std::ifstream stream(file);
  for (std::string found; stream >> found;)
    if (double value = 0; found == word && stream >> value) return value;
  return otherwise;
}

double left_in_group(const std::string& directory, bool version_2) {
  const double limit = number_in(directory + (version_2 ? "/memory.max" : "/memory.limit_in_bytes"), infinite);
  const double used = number_in(directory + (version_2 ? "/memory.current" : "/memory.usage_in_bytes"), 0);
  const double cache = number_after(directory + "/memory.stat", "inactive_file", 0);
  return std::max(0.0, limit - std::max(0.0, used - cache));
}

double left_of_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return infinite;
  const double used = number_in("/proc/self/statm", 0) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - used);
}

/// The option has been read before.
double parse_limit(const char* text) try { return parse_memory(text); } catch (const InputError& error) {
  throw InputError(fmt::format("the environment variable CGCONTACT_MEMORY_LIMIT: {}", error.what()));
}

}  // namespace

double group_memory(const std::string& groups, const std::string& root) {
  double least = infinite;
  each_control_group(groups, root, "memory", [&](const std::string& directory, bool version_2) {
    least = std::min(least, left_in_group(directory, version_2));
  });
  return least;
}

namespace {

/// Memory of one rank, bytes; negative: not agreed on.
double agreed_bytes = -1;

MemoryBudget budget_of_process() {
  if (const char* given = std::getenv("CGCONTACT_MEMORY_LIMIT"))
    return {parse_limit(given), "as --memory-limit or CGCONTACT_MEMORY_LIMIT says", "", true};
  MemoryBudget budget{1024 * number_after("/proc/meminfo", "MemAvailable:", infinite), "free on this machine", ""};
  const double in_group = group_memory(own_control_groups(), "/sys/fs/cgroup");
  if (in_group < budget.bytes) budget = {in_group, "left by the limit of the control group (container, job)", ""};
  const double address_space = left_of_address_space();
  if (address_space < budget.bytes)
    budget = {address_space, "left by the limit of address space (ulimit -v)", address_space_remedy()};
  return budget;
}

}  // namespace

void agree_on_memory() {
  agreed_bytes = num_ranks() == 1 ? -1 : -largest_over_ranks(-budget_of_process().bytes / ranks_on_this_machine());
}

MemoryBudget memory_budget() {
  MemoryBudget budget = budget_of_process();
  if (num_ranks() == 1 || agreed_bytes < 0) return budget;
  budget.bytes = agreed_bytes;
  budget.source += ", for each of the ranks";
  return budget;
}

std::string address_space_remedy() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  const char* const who = limit.rlim_max == RLIM_INFINITY ? "" : " where the system allows it";
  return fmt::format(
      "\"ulimit -v unlimited\"{} lifts the limit of {} (ulimit -v {}), of which the program and its libraries alone "
      "take some 250 MB",
      who, memory_text(static_cast<double>(limit.rlim_cur)), limit.rlim_cur / 1024);
}

double parse_memory(const std::string& text) {
  static const std::map<std::string, double> units = {
      {"", 1},         {"b", 1},        {"kb", 1e3},     {"mb", 1e6}, {"gb", 1e9}, {"tb", 1e12}, {"kib", 0x1p10},
      {"mib", 0x1p20}, {"gib", 0x1p30}, {"tib", 0x1p40}, {"m", 1e6},  {"g", 1e9},  {"t", 1e12}};
  if (text == "none") return infinite;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  unit.erase(0, std::min(unit.find_first_not_of(' '), unit.size()));
  for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto found = units.find(unit);
  if (error != std::errc() || found == units.end() || !(value > 0) || !std::isfinite(value * found->second))
    throw InputError(SourceLocation{}, '"' + text + '"', "is no amount of memory",
                     "for example 8GB, 500MB, 16GiB, or none");
  return value * found->second;
}

void return_freed_memory() {
#ifdef __GLIBC__
  constexpr std::size_t worth_it = std::size_t{1} << 26;  // what is taken again costs time
  if (mallinfo2().fordblks > worth_it) malloc_trim(0);
#endif
}

bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) ||
         std::string(error.what()).find("failed to allocate memory") != std::string::npos;
}

std::string memory_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

}  // namespace cgcontact
