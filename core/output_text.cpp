#include "core/output_text.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "core/errors.hpp"

namespace cgcontact {

void write_text(const std::string& file_name, const std::string& text) {
  errno = 0;
  std::FILE* file = std::fopen(file_name.c_str(), "wb");
  bool ok = file != nullptr;
  if (ok) {
    ok = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    int reason = errno;
    if (std::fclose(file) != 0 && ok) {
      ok = false;
      reason = errno;
    }
    errno = reason;
  }
  if (!ok) throw InputError(fmt::format("cannot write {}: {}", file_name, std::strerror(errno)));
}

std::string read_text(const std::string& file_name) {
  std::FILE* file = std::fopen(file_name.c_str(), "rb");
  if (!file) throw InputError(fmt::format("cannot read {}: {}", file_name, std::strerror(errno)));
  std::string text;
  char buffer[1 << 14];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) text.append(buffer, n);
  const bool ok = !std::ferror(file);
  std::fclose(file);
  if (!ok) throw InputError(fmt::format("cannot read {}", file_name));
  return text;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string short_number(double value, int digits) { return fmt::format("{:.{}g}", value, digits); }

std::string scaled(double value, const std::string& unit, int digits) {
  static const char* const prefixes[] = {"n", "u", "m", "", "k", "M", "G", "T"};
  int power = 0;
  if (value != 0 && std::isfinite(value)) power = static_cast<int>(std::floor(std::log10(std::abs(value)) / 3 + 1e-9));
  power = std::max(-3, std::min(4, power));
  return fmt::format("{:.{}g} {}{}", value / std::pow(1000.0, power), digits, prefixes[power + 3], unit);
}

}  // namespace cgcontact
