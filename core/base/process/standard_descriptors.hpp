/// Standard input, output and error of a process that was started without them.
#pragma once

namespace cgcontact {

/// Opens /dev/null for those of the descriptors 0, 1, 2 that are closed ("2>&-" in a shell, some batch systems): the
/// next opened file would take their number and receive messages.
void open_standard_descriptors();

}  // namespace cgcontact
