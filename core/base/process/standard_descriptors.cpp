#include "core/base/process/standard_descriptors.hpp"

#include <fcntl.h>

#include <cerrno>

namespace cgcontact {

void open_standard_descriptors() {
  for (int descriptor = 0; descriptor <= 2; ++descriptor)
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
      if (open("/dev/null", O_RDWR) != descriptor) return;  // the lowest free number: those below are open
}

}  // namespace cgcontact
