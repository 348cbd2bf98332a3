/// Work that may crash, never end or need all memory, done in a child process: here it can only fail.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/process/packing.hpp"

namespace cgcontact {

struct ChildLimits {
  double seconds = 0;      ///< of the wall clock
  double cpu_seconds = 0;  ///< of the processor: whole ones
  double bytes = 0;        ///< of memory beyond what this process has
};

/// Returns what the work has packed. The child copies this process, with one thread and without standard input and
/// output: the work must take no lock of another thread. Throws InputError: the one that the work has thrown, or
/// `failure` ("... cannot ...") with how the child ended.
std::vector<char> in_child(const std::string& failure, const ChildLimits& limits,
                           const std::function<void(Packing&)>& work);

}  // namespace cgcontact
