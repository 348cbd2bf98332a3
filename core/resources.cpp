#include "core/resources.hpp"

#include <sys/resource.h>

namespace cgcontact {

long long peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024LL * usage.ru_maxrss;
}

}  // namespace cgcontact
