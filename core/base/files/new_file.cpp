#include "core/base/files/new_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

void write_new_file(const std::string& file, const std::string& text) {
  std::FILE* const out = std::fopen(file.c_str(), "wx");
  if (!out && errno == EEXIST)
    throw InputError(file + ": exists already, and init does not overwrite (allowed: the name of a new file)");
  if (!out) throw InputError(fmt::format("{}: cannot be written: {}", file, std::strerror(errno)));
  const bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size();
  if (std::fclose(out) == 0 && written) return;
  const int reason = errno;
  std::remove(file.c_str());
  throw InputError(fmt::format("{}: cannot be written: {}", file, std::strerror(reason)));
}

void expect_new_file(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::symlink_status(file, ignored).type() != std::filesystem::file_type::not_found)
    throw InputError(file + ": exists already, and init does not overwrite (allowed: the name of a new file)");
}

}  // namespace cgcontact
