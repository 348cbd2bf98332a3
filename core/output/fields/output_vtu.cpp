#include "core/output/fields/output_vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/files/hdf_file.hpp"

namespace cgcontact {

namespace {

/// Rows of an array, one behind the other.
struct Rows {
  std::size_t first = 0, count = 0;
};

/// Array of the new file: rows of one of the old file in their new order, or bytes of its own.
struct Copied {
  HdfReader::Array array;
  std::vector<Rows> rows;
  std::string own;

  std::size_t bytes() const {
    std::size_t count = 0;
    for (const Rows& r : rows) count += r.count;
    return count * array.columns * array.bytes + own.size();
  }
};

/// Arrays as XML that refers to the bytes behind it.
class Appended {
 public:
  std::string element(const Copied& copied, const std::string& name) {
    static const char* const of_tensors[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    const std::size_t columns = copied.array.columns;
    std::string text = fmt::format("        <DataArray type=\"{}\" Name=\"{}\"", copied.array.type, name);
    if (columns > 1) text += fmt::format(" NumberOfComponents=\"{}\"", columns);
    if (columns == std::size(of_tensors))
      for (std::size_t k = 0; k < std::size(of_tensors); ++k)
        text += fmt::format(" ComponentName{}=\"{}\"", k, of_tensors[k]);
    text += fmt::format(" format=\"appended\" offset=\"{}\"/>\n", offset_);
    offset_ += sizeof(std::uint64_t) + copied.bytes();
    all_.push_back(copied);
    return text;
  }

  void write(const HdfReader& file, std::ostream& out) const {
    for (const Copied& copied : all_) {
      const std::uint64_t bytes = copied.bytes();
      out.write(reinterpret_cast<const char*>(&bytes), sizeof bytes);
      out.write(copied.own.data(), static_cast<std::streamsize>(copied.own.size()));
      for (const Rows& rows : copied.rows)
        for (std::size_t k = 0; k < rows.count; k += rows_per_block) {
          const std::string block = file.read(copied.array, rows.first + k, std::min(rows_per_block, rows.count - k));
          out.write(block.data(), static_cast<std::streamsize>(block.size()));
        }
    }
  }

 private:
  std::vector<Copied> all_;
  std::size_t offset_ = 0;
};

/// Cells in the order of their types: meshio makes a block of successive cells of a type, and MED takes one block each.
struct CellOrder {
  std::vector<Rows> cells, corners;
  std::string ends;  ///< bytes: the last corner of each cell and one, in their new order
};

template <class T>
std::vector<T> read_all(const HdfReader& file, const HdfReader::Array& array) {
  const std::string bytes = file.read(array, 0, array.rows);
  std::vector<T> values(array.rows);
  if (bytes.size() != values.size() * sizeof(T))
    throw InputError(fmt::format("{}: not of the type expected", array.path));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

CellOrder order_by_type(const HdfReader& file, const HdfReader::Array& types, const HdfReader::Array& offsets) {
  const std::vector<std::uint8_t> type = read_all<std::uint8_t>(file, types);
  const std::vector<std::int64_t> offset = read_all<std::int64_t>(file, offsets);
  std::vector<std::uint8_t> wanted = type;
  std::sort(wanted.begin(), wanted.end(), std::greater<>());  // hexahedra before tetrahedra, as in a body
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  CellOrder order;
  std::vector<std::int64_t> ends;
  std::int64_t end = 0;
  for (const std::uint8_t t : wanted)
    for (std::size_t first = 0, last = 0; first < type.size(); first = last) {
      for (last = first + 1; last < type.size() && type[last] == type[first];) ++last;
      if (type[first] != t) continue;
      order.cells.push_back({first, last - first});
      order.corners.push_back(
          {static_cast<std::size_t>(offset[first]), static_cast<std::size_t>(offset[last] - offset[first])});
      for (std::size_t c = first; c < last; ++c) ends.push_back(end += offset[c + 1] - offset[c]);
    }
  order.ends.assign(reinterpret_cast<const char*>(ends.data()), ends.size() * sizeof ends[0]);
  return order;
}

std::string name_of(const HdfReader::Array& array) { return array.path.substr(array.path.rfind('/') + 1); }

}  // namespace

void write_vtu(const std::string& vtkhdf_file, const std::string& file_name) {
  const HdfReader file(vtkhdf_file);
  const std::vector<HdfReader::Array> grid = file.arrays("/VTKHDF");
  const auto named = [&](const std::string& name) {
    const auto found =
        std::find_if(grid.begin(), grid.end(), [&](const auto& array) { return name_of(array) == name; });
    if (found == grid.end()) throw InputError(fmt::format("cannot read {}: it has no {}", vtkhdf_file, name));
    return *found;
  };
  Appended appended;
  const auto section = [&](const char* name, const std::string& elements) {
    return fmt::format("      <{0}>\n{1}      </{0}>\n", name, elements);
  };
  const auto group = [&](const char* name, const std::vector<Rows>& rows) {
    std::string elements;
    for (const HdfReader::Array& array : file.arrays(std::string("/VTKHDF/") + name))
      elements += appended.element({array, rows, ""}, name_of(array));
    return section(name, elements);
  };
  const HdfReader::Array points = named("Points"), types = named("Types"), offsets = named("Offsets");
  const std::vector<Rows> all_points{{0, points.rows}};
  const CellOrder order = order_by_type(file, types, offsets);
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      points.rows, types.rows);
  header += group("PointData", all_points) + group("CellData", order.cells);
  header += section("Points", appended.element({points, all_points, ""}, "Points"));
  header += section("Cells", appended.element({named("Connectivity"), order.corners, ""}, "connectivity") +
                                 appended.element({offsets, {}, order.ends}, "offsets") +
                                 appended.element({types, order.cells, ""}, "types"));
  header += "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
  errno = 0;
  std::ofstream out(file_name, std::ios::binary);
  out << header;
  appended.write(file, out);
  out << "\n  </AppendedData>\n</VTKFile>\n";
  out.close();
  if (!out) throw InputError(fmt::format("cannot write {}: {}", file_name, std::strerror(errno)));
}

}  // namespace cgcontact
