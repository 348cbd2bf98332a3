/// Memory that this process may use.
#pragma once

#include <exception>
#include <string>

namespace cgcontact {

struct MemoryBudget {
  double bytes = 0;    ///< that can still be used; infinite if nothing limits
  std::string source;  ///< what limits it, for messages
  std::string remedy;  ///< how to have more, or empty
  bool given = false;  ///< by the user, as a limit
};

/// Returns the least of: available memory of the system (without swap), what the control group of this process and
/// those above it leave, and its limit of address space (ulimit -v). The environment variable CGCONTACT_MEMORY_LIMIT
/// (as for parse_memory; set by --memory-limit) replaces all of them. With several ranks: that of the rank with the
/// least when the run began, or its share of a machine.
MemoryBudget memory_budget();
/// Agrees on the budget once the ranks run. Collective.
void agree_on_memory();

/// Explains how to lift the limit of address space (ulimit -v) of this process; empty without one.
std::string address_space_remedy();

/// Parses "8GB", "512 MB", "8e9", "16GiB", "none" (infinite): bytes. Throws InputError.
double parse_memory(const std::string& text);

/// Formats "1.4 GB", "85 MB".
std::string memory_text(double bytes);

/// Gives memory that has been freed back to the system, which the C library keeps otherwise, if it is much: after
/// phases that need much for a while.
void return_freed_memory();

/// Returns whether it is std::bad_alloc, or what Kokkos throws instead.
bool is_out_of_memory(const std::exception& error);

/// Returns what a control group and those above it leave, bytes; infinite without a limit. `groups` is the text of
/// /proc/self/cgroup, `root` the mount point of the hierarchies; versions 1 and 2. File caches of the group count as
/// free.
double group_memory(const std::string& groups, const std::string& root);

}  // namespace cgcontact
