/// HDF5 files, for VTKHDF. A file is built in memory and written in one go, so that a full disk is one plain error, or,
/// if larger than memory, array by array on the disk. One that is there is read array by array.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

/// Rows of an array that are in memory at a time where it is copied by blocks.
constexpr std::size_t rows_per_block = 1 << 16;

/// How an array lies in the file. Compression takes most of the time of writing, and leaves real numbers that differ
/// from row to row 60 to 80 % of their size; numbers that repeat themselves nearly nothing.
enum class HdfStorage { compressed, plain };

class HdfFile {
 public:
  HdfFile();
  /// Opens a file on the disk.
  explicit HdfFile(const std::string& file_name);
  ~HdfFile();
  HdfFile(const HdfFile&) = delete;
  HdfFile& operator=(const HdfFile&) = delete;

  void make_group(const std::string& path);
  /// Sets an attribute of a group or an array.
  void set_attribute(const std::string& group, const std::string& name, const std::string& value);
  void set_attribute(const std::string& group, const std::string& name, const std::vector<long long>& values);
  void set_attribute(const std::string& group, const std::string& name, long long value);
  /// Writes a compressed array of values.size() / columns rows; columns = 0: one-dimensional. T: unsigned char, int,
  /// long long, float or double.
  template <class T>
  void write(const std::string& path, const std::vector<T>& values, int columns = 0);
  /// Reads rows of an array of floats.
  std::vector<float> read(const std::string& path, std::size_t first_row, std::size_t num_rows);
  /// Writes the whole file; throws InputError if that fails.
  void save(const std::string& file_name);
  /// Ends a file on the disk.
  void finish();

 private:
  template <class T>
  friend class HdfRows;

  template <class Id>
  Id check(Id id, const char* what);
  /// Adds rows to an existing array. Returns the first new one.
  template <class T>
  std::size_t make_rows(const std::string& path, std::size_t num_rows, int columns, HdfStorage storage, bool can_grow);
  template <class T>
  void write_rows(const std::string& path, std::size_t first, const T* values, std::size_t num_rows, int columns);

  const std::string on_disk_;  ///< its name; empty: in memory
  long long file_;             ///< hid_t
  bool is_broken_ = false;     ///< could not be written: closing it would try again
};

/// The arrays of a file that has been written, for other formats and later runs.
class HdfReader {
 public:
  struct Array {
    std::string path;
    std::string type;  ///< as VTK names it: UInt8, Int32, Int64, Float32, Float64
    std::size_t bytes = 0, rows = 0, columns = 1;
  };

  /// Throws InputError if the file cannot be opened.
  explicit HdfReader(const std::string& file_name);
  ~HdfReader();
  HdfReader(const HdfReader&) = delete;
  HdfReader& operator=(const HdfReader&) = delete;

  /// Lists those in a group, in the order of their names.
  std::vector<Array> arrays(const std::string& group) const;
  /// Reads some of the rows, as they lie in memory.
  std::string read(const Array& array, std::size_t first_row, std::size_t num_rows) const;

 private:
  long long file_;  ///< hid_t
};

/// Array written in chunks, of which no more than one is in memory.
template <class T>
class HdfRows {
 public:
  /// Creates the array; one that can grow and is there already gets num_rows more.
  HdfRows(HdfFile& file, const std::string& path, std::size_t num_rows, int columns = 0,
          HdfStorage storage = HdfStorage::compressed, bool can_grow = false);
  /// Adds the next rows; after the last ones all are in the file.
  void add(const std::vector<T>& values);

 private:
  HdfFile& file_;
  std::string path_;
  int columns_;
  std::size_t next_, end_;  ///< row that `waiting_` begins with, and the one behind the last
  std::vector<T> waiting_;
};

}  // namespace cgcontact
