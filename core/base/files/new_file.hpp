/// Files that must not exist yet.
#pragma once

#include <string>

namespace cgcontact {

/// Creates the file; what exists is not touched. Throws InputError.
void write_new_file(const std::string& file, const std::string& text);

/// Throws, before the work, what write_new_file would for an existing file.
void expect_new_file(const std::string& file);

}  // namespace cgcontact
