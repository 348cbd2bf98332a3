/// Memory of this process, for benchmarks that report it.
#pragma once

#include <fstream>
#include <string>

namespace cgcontact::perf {

/// A line "VmHWM: 123 kB" of the process's status, in bytes (VmRSS: held now, VmHWM: the peak); 0 if there is none.
inline double status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == key + ":") {
      status >> word;
      return 1024 * std::stod(word);
    }
  return 0;
}

/// The peak starts anew from what is held now.
inline void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << 5; }

}  // namespace cgcontact::perf
