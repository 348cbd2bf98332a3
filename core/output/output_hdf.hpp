/// A small HDF5 writer for VTKHDF files. A file is built in memory and written in one go, so that a full disk is one
/// plain write error, or, if it can be larger than the memory, on the disk, array by array.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

class HdfFile {
 public:
  HdfFile();
  /// On the disk.
  explicit HdfFile(const std::string& file_name);
  ~HdfFile();
  HdfFile(const HdfFile&) = delete;
  HdfFile& operator=(const HdfFile&) = delete;

  void make_group(const std::string& path);
  /// Of a group or an array.
  void set_attribute(const std::string& group, const std::string& name, const std::string& value);
  void set_attribute(const std::string& group, const std::string& name, const std::vector<long long>& values);
  void set_attribute(const std::string& group, const std::string& name, long long value);
  /// A compressed array of values.size() / columns rows; columns = 0: one-dimensional. T: unsigned char, int,
  /// long long, float or double.
  template <class T>
  void write(const std::string& path, const std::vector<T>& values, int columns = 0);
  /// The same behind the rows that are there already, if any.
  template <class T>
  void append(const std::string& path, const std::vector<T>& values, int columns = 0);
  /// Rows of an array of floats, one after the other.
  std::vector<float> read(const std::string& path, std::size_t first_row, std::size_t num_rows);
  /// Writes the whole file; throws InputError if that fails.
  void save(const std::string& file_name);
  /// Ends a file on the disk, which nothing can be added to any more.
  void finish();

 private:
  template <class Id>
  Id check(Id id, const char* what);
  template <class T>
  void create(const std::string& path, const std::vector<T>& values, int columns, bool can_grow);

  const std::string on_disk_;  ///< its name; empty: in memory
  long long file_;             ///< hid_t
  bool is_broken_ = false;     ///< could not be written: closing it would try again
};

}  // namespace cgcontact
