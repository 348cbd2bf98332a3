#include "core/output/view/packed_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/files/text.hpp"

namespace cgcontact {

PackedValues pack_values(const std::vector<double>& rows, std::size_t columns) {
  PackedValues packed;
  packed.low.assign(columns, std::numeric_limits<double>::max());
  std::vector<double> high(columns, -std::numeric_limits<double>::max());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!std::isfinite(rows[i])) continue;
    packed.low[i % columns] = std::min(packed.low[i % columns], rows[i]);
    high[i % columns] = std::max(high[i % columns], rows[i]);
  }
  for (std::size_t k = 0; k < columns; ++k) {
    const bool any = packed.low[k] <= high[k];
    if (!any) packed.low[k] = 0;
    packed.step.push_back(any ? high[k] / packed_steps - packed.low[k] / packed_steps : 0);
  }
  std::string bytes(2 * rows.size(), '\0');
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double step = packed.step[i % columns];
    const double quotient = step > 0 ? (rows[i] - packed.low[i % columns]) / step : 0;
    const std::uint16_t number =
        std::isfinite(rows[i])
            ? static_cast<std::uint16_t>(std::clamp(std::lround(quotient), 0L, static_cast<long>(packed_steps)))
            : packed_none;
    bytes[2 * i] = static_cast<char>(number & 0xff);
    bytes[2 * i + 1] = static_cast<char>(number >> 8);
  }
  packed.data = base64(bytes);
  return packed;
}

void append_varint(std::uint32_t number, std::string& bytes) {
  for (; number >= 0x80; number >>= 7) bytes += static_cast<char>((number & 0x7f) | 0x80);
  bytes += static_cast<char>(number);
}

std::string pack_ascending(const std::vector<int>& numbers) {
  std::string bytes;
  int last = 0;
  for (const int number : numbers) append_varint(static_cast<std::uint32_t>(number - last), bytes), last = number;
  return base64(bytes);
}

std::string pack_corners(const std::vector<int>& points) {
  std::string bytes;
  int next = 0;
  for (const int point : points) {
    append_varint(static_cast<std::uint32_t>(next - point), bytes);
    if (point == next) ++next;
  }
  return base64(bytes);
}

std::string pack_bytes(const std::vector<unsigned char>& bytes) { return base64({bytes.begin(), bytes.end()}); }

}  // namespace cgcontact
