/// Arrays of a VTKHDF file of a run, read with every size checked.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/files/hdf_file.hpp"

namespace cgcontact {

class VtkArrays {
 public:
  /// Throws InputError that names the file if it is damaged or none of a run.
  explicit VtkArrays(const std::string& file_name);

  const std::string& file() const { return file_; }
  /// Names lie in the group VTKHDF: "Points", "PointData/displacement".
  bool has(const std::string& name) const { return arrays_.count(name) > 0; }
  std::size_t rows(const std::string& name) const { return array(name).rows; }
  /// Read rows of an array that must have so many columns, one row behind the other. count = all: up to the last one.
  std::vector<double> numbers(const std::string& name, std::size_t columns, std::size_t first = 0,
                              std::size_t count = all) const;
  std::vector<long long> integers(const std::string& name, std::size_t first = 0, std::size_t count = all) const;
  /// Throws the InputError of a file that does not hold what it should.
  [[noreturn]] void damaged(const std::string& what) const;

  static constexpr std::size_t all = static_cast<std::size_t>(-1);

 private:
  const HdfReader::Array& array(const std::string& name) const;
  template <class T>
  std::vector<T> values(const std::string& name, std::size_t columns, std::size_t first, std::size_t count) const;

  std::string file_;
  HdfReader reader_;
  std::map<std::string, HdfReader::Array> arrays_;
};

}  // namespace cgcontact
