/// Control groups of this process (containers, batch jobs): where their files are.
#pragma once

#include <functional>
#include <string>

namespace cgcontact {

/// Reads /proc/self/cgroup.
std::string own_control_groups();

/// Calls visit(directory, is_version_2) for the group that has the controller ("cpu", "memory") and for all above it,
/// which limit as well. `groups` is the text of /proc/self/cgroup, `root` the mount point of the hierarchies. In a
/// container the group's own directory may be the mount itself.
void each_control_group(const std::string& groups, const std::string& root, const std::string& controller,
                        const std::function<void(const std::string& directory, bool version_2)>& visit);

}  // namespace cgcontact
