/// Arrays of numbers as short text for a page: 16 bits for a value, about one byte for a corner of a triangle.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cgcontact {

/// Steps from the smallest to the largest value of a column; one more number is left for "no value".
constexpr int packed_steps = 65534;
constexpr std::uint16_t packed_none = 65535;

/// Rows of values: value = low + step * number, by column.
struct PackedValues {
  std::vector<double> low, step;
  std::string data;  ///< base64 of 16-bit integers, little-endian, row by row; packed_none: not finite
};
PackedValues pack_values(const std::vector<double>& rows, std::size_t columns);

/// Adds an integer in groups of seven bits, the lowest first; the highest bit of a byte says that more follow.
void append_varint(std::uint32_t number, std::string& bytes);

/// Base64 of the differences between ascending numbers as varints.
std::string pack_ascending(const std::vector<int>& numbers);

/// Base64 of point numbers as varints, each as its distance below the lowest number that has not been used before: 0 is
/// a new point. Points must be numbered in the order of their first use.
std::string pack_corners(const std::vector<int>& points);

/// Base64 of bytes.
std::string pack_bytes(const std::vector<unsigned char>& bytes);

}  // namespace cgcontact
