#include "core/output/plot/vtk_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

template <class From, class To>
void convert(const std::string& bytes, std::vector<To>& values) {
  values.resize(bytes.size() / sizeof(From));
  for (std::size_t k = 0; k < values.size(); ++k) {
    From value;
    std::memcpy(&value, bytes.data() + k * sizeof(From), sizeof(From));
    values[k] = static_cast<To>(value);
  }
}

/// Converts values of a type that VTK names; returns false for one that no run writes.
template <class To>
bool convert(const std::string& type, const std::string& bytes, std::vector<To>& values) {
  if (type == "Float32")
    convert<float>(bytes, values);
  else if (type == "Float64")
    convert<double>(bytes, values);
  else if (type == "Int32")
    convert<std::int32_t>(bytes, values);
  else if (type == "Int64")
    convert<std::int64_t>(bytes, values);
  else if (type == "UInt8")
    convert<std::uint8_t>(bytes, values);
  else
    return false;
  return true;
}

}  // namespace

VtkArrays::VtkArrays(const std::string& file_name) try : file_(file_name), reader_(file_name) {
  for (const char* group : {"", "/PointData", "/CellData"})
    for (HdfReader::Array& found : reader_.arrays(std::string("/VTKHDF") + group))
      arrays_.emplace(found.path.substr(std::strlen("/VTKHDF/")), found);
  for (const char* name : {"Points", "Types", "Connectivity", "Offsets", "CellData/body"})
    if (!has(name)) throw std::runtime_error(fmt::format("it has no array {}", name));
} catch (const std::runtime_error& error) {
  throw InputError(fmt::format("{}: is damaged, or not a file of a run of cgcontact ({})", file_name, error.what()));
}

void VtkArrays::damaged(const std::string& what) const {
  throw InputError(fmt::format("{}: is damaged: {}", file_, what));
}

const HdfReader::Array& VtkArrays::array(const std::string& name) const {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) damaged(fmt::format("it has no array {}", name));
  return found->second;
}

template <class T>
std::vector<T> VtkArrays::values(const std::string& name, std::size_t columns, std::size_t first,
                                 std::size_t count) const {
  const HdfReader::Array& from = array(name);
  if (first > from.rows) damaged(fmt::format("{} has {} rows only", name, from.rows));
  if (count == all) count = from.rows - first;
  if (from.columns != columns || count > from.rows - first)
    damaged(fmt::format("{} has {} rows of {} values", name, from.rows, from.columns));
  std::vector<T> values;
  if (count == 0) return values;
  try {
    if (!convert(from.type, reader_.read(from, first, count), values))
      damaged(fmt::format("{} is of the type {}", name, from.type));
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    damaged(fmt::format("{} cannot be read ({})", name, error.what()));
  }
  return values;
}

std::vector<double> VtkArrays::numbers(const std::string& name, std::size_t columns, std::size_t first,
                                       std::size_t count) const {
  return values<double>(name, columns, first, count);
}

std::vector<long long> VtkArrays::integers(const std::string& name, std::size_t first, std::size_t count) const {
  if (array(name).type.find("Float") == 0) damaged(fmt::format("{} is of the type {}", name, array(name).type));
  return values<long long>(name, 1, first, count);
}

}  // namespace cgcontact
