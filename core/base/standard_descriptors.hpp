/// Standard input, output and error of a process that was started without them.
#pragma once

namespace cgcontact {

/// Opens /dev/null for those of the descriptors 0, 1, 2 that are closed ("2>&-" in a shell, some batch systems): the
/// next file that is opened would take their number, and messages would be written into it.
void open_standard_descriptors();

}  // namespace cgcontact
