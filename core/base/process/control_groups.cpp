#include "core/base/process/control_groups.hpp"

#include <fstream>
#include <iterator>
#include <sstream>

namespace cgcontact {

std::string own_control_groups() {
  std::ifstream file("/proc/self/cgroup");
  return {std::istreambuf_iterator<char>(file), {}};
}

void each_control_group(const std::string& groups, const std::string& root, const std::string& controller,
                        const std::function<void(const std::string& directory, bool version_2)>& visit) {
  std::istringstream lines(groups);
  for (std::string line; std::getline(lines, line);) {  // number:controllers:/group
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool version_2 = controllers.empty();
    if (!version_2 && ("," + controllers + ",").find("," + controller + ",") == std::string::npos) continue;
    const std::string mount = version_2 ? root : root + "/" + controllers;
    for (std::string group = line.substr(second + 1);; group.resize(group.rfind('/'))) {
      while (!group.empty() && group.back() == '/') group.pop_back();
      visit(mount + group, version_2);
      if (group.find('/') == std::string::npos) break;
    }
  }
}

}  // namespace cgcontact
