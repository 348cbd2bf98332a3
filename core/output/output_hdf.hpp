/// A small HDF5 writer for VTKHDF files. The file is built in memory and written in one go, so that a full disk is
/// one plain write error.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

class HdfFile {
 public:
  HdfFile();
  ~HdfFile();
  HdfFile(const HdfFile&) = delete;
  HdfFile& operator=(const HdfFile&) = delete;

  void make_group(const std::string& path);
  /// Of a group or an array.
  void set_attribute(const std::string& group, const std::string& name, const std::string& value);
  void set_attribute(const std::string& group, const std::string& name, const std::vector<long long>& values);
  /// A compressed array of values.size() / columns rows; columns = 0: one-dimensional. T: unsigned char, int,
  /// long long, float or double.
  template <class T>
  void write(const std::string& path, const std::vector<T>& values, int columns = 0);
  /// Writes the whole file; throws InputError if that fails.
  void save(const std::string& file_name);

 private:
  long long file_;  ///< hid_t
};

}  // namespace cgcontact
