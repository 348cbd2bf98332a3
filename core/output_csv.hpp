/// contact.csv: one line per boundary point of the contact faces.
#pragma once

#include <string>

#include "core/results.hpp"

namespace cgcontact {

/// SI units, pressure positive in compression, numbers that read back to the same double.
void write_contact_csv(const Results& results, const std::string& file_name);

}  // namespace cgcontact
