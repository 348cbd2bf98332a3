#include "core/base/files/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/rounding.hpp"

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

std::string html_text(const std::string& text) {
  std::string escaped;
  for (char c : printable(text, text.size())) switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

std::string shell_word(const std::string& word) {
  static const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string base64(const std::string& bytes) {
  static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    unsigned block = 0;
    for (std::size_t k = 0; k < 3; ++k) block = block << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? digits[block >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

int columns_of(const std::string& text) {
  int columns = 0;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80) continue;  // goes on with a letter
    columns += byte >= 0xe3 ? 2 : 1;
  }
  return columns;
}

std::vector<std::string> wrapped(const std::string& text, const std::string& first, int width) {
  std::vector<std::string> lines{first};
  const std::string indent(static_cast<std::size_t>(columns_of(first)), ' ');
  bool empty = true;  // no word in the last line yet
  std::istringstream words(text);
  for (std::string word; words >> word; empty = false) {
    if (!empty && columns_of(lines.back()) + 1 + columns_of(word) > width) {
      lines.push_back(indent);
      empty = true;
    }
    lines.back() += (empty ? "" : " ") + word;
  }
  return lines;
}

std::string shortened_name(const std::string& name, int columns) {
  const auto size = static_cast<std::size_t>(columns);
  if (name.size() <= size) return name;
  const std::size_t end = (size - 2) / 2;
  return name.substr(0, size - 2 - end) + ".." + name.substr(name.size() - end);
}

std::string grouped(long long value) {
  std::string text = std::to_string(value);
  const std::ptrdiff_t first = text[0] == '-' ? 1 : 0;
  for (auto k = static_cast<std::ptrdiff_t>(text.size()) - 3; k > first; k -= 3)
    text.insert(static_cast<std::size_t>(k), ",");
  return text;
}

DisplayUnit length_unit(double largest) {
  if (largest >= 1) return {1, "m"};
  if (largest >= 1e-3) return {1e3, "mm"};
  return {1e6, "um"};
}

DisplayUnit area_unit(double largest) {
  if (largest >= 0.01) return {1, "m^2"};
  if (largest >= 1e-8) return {1e6, "mm^2"};
  return {1e12, "um^2"};
}

DisplayUnit stress_unit(double largest) {
  if (largest >= 1e9) return {1e-9, "GPa"};
  if (largest >= 1e6) return {1e-6, "MPa"};
  if (largest >= 1e3) return {1e-3, "kPa"};
  return {1, "Pa"};
}

DisplayUnit force_unit(double largest) {
  if (largest >= 1e6) return {1e-6, "MN"};
  if (largest >= 1e3) return {1e-3, "kN"};
  if (largest >= 0.1 || largest == 0) return {1, "N"};
  return {1e3, "mN"};
}

std::string trimmed(std::string_view text) {
  constexpr const char* blanks = " \t\r";
  const std::size_t first = std::min(text.find_first_not_of(blanks), text.size());
  return std::string(text.substr(first, text.find_last_not_of(blanks) + 1 - first));
}

double round_down(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (double digit : {5.0, 2.0})
    if (digit * power <= value * (1 + 1e-9)) return digit * power;
  return power;
}

double two_digits(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::round(value / unit) * unit;
}

std::string short_number(double value, int digits) { return fmt::format("{:.{}g}", value, digits); }

std::string percent_number(double fraction) {
  const double percent = 100 * fraction;
  if (percent > 9999) return "over 9999";
  return percent < 99.5 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
}

std::string scaled(double value, const std::string& unit, int digits) {
  static const char* const prefixes[] = {"n", "u", "m", "", "k", "M", "G", "T"};
  int power = 0;
  if (value != 0 && std::isfinite(value)) power = static_cast<int>(std::floor(std::log10(std::abs(value)) / 3 + 1e-9));
  power = std::max(-3, std::min(4, power));
  return fmt::format("{:.{}g} {}{}", value / std::pow(1000.0, power), digits, prefixes[power + 3], unit);
}

std::string processors_text(int ranks, int threads) {
  const std::string each = fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
  return ranks == 1 ? each : fmt::format("{} ranks of {}", ranks, each);
}

std::string vector_text(const Vec3& v, const DisplayUnit& unit, int digits) {
  const Vec3 shown = unit.factor * without_rounding(v, v.cwiseAbs().maxCoeff());
  return fmt::format("({}, {}, {}) {}", short_number(shown[0], digits), short_number(shown[1], digits),
                     short_number(shown[2], digits), unit.name);
}

std::string position_text(const Vec3& x, int digits) {
  return vector_text(x, length_unit(x.cwiseAbs().maxCoeff()), digits);
}

std::string at_position(const Vec3& x) { return fmt::format("at ({:.4g}, {:.4g}, {:.4g}) m", x[0], x[1], x[2]); }

}  // namespace cgcontact
