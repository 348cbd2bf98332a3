#include "core/output/fields/output_vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/files/hdf_file.hpp"

namespace cgcontact {

namespace {

/// An array of the file and its first row that is copied.
struct Copied {
  HdfReader::Array array;
  std::size_t first_row = 0;

  std::size_t bytes() const { return (array.rows - first_row) * array.columns * array.bytes; }
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
      for (std::size_t row = copied.first_row; row < copied.array.rows; row += rows_per_block) {
        const std::string block = file.read(copied.array, row, std::min(rows_per_block, copied.array.rows - row));
        out.write(block.data(), static_cast<std::streamsize>(block.size()));
      }
    }
  }

 private:
  std::vector<Copied> all_;
  std::size_t offset_ = 0;
};

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
  const auto group = [&](const char* name) {
    std::string elements;
    for (const HdfReader::Array& array : file.arrays(std::string("/VTKHDF/") + name))
      elements += appended.element({array}, name_of(array));
    return section(name, elements);
  };
  const HdfReader::Array points = named("Points"), types = named("Types");
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      points.rows, types.rows);
  header += group("PointData") + group("CellData");
  header += section("Points", appended.element({points}, "Points"));
  header += section("Cells", appended.element({named("Connectivity")}, "connectivity") +
                                 appended.element({named("Offsets"), 1}, "offsets") +  // ends of cells, without a zero
                                 appended.element({types}, "types"));
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
