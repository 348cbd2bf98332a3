#include "core/base/files/hdf_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {

constexpr hsize_t rows_per_chunk = 1 << 16;

/// Fails on the negative values by which HDF5 reports errors; they mean lack of memory or a mistake of ours.
template <class Id>
Id check(Id id, const char* what) {
  if (id < 0) throw std::runtime_error(fmt::format("HDF5 could not {}", what));
  return id;
}

/// An HDF5 handle and the function that closes it.
struct Handle {
  hid_t id;
  herr_t (*close)(hid_t);
  Handle(hid_t id_, herr_t (*close_)(hid_t), const char* what) : id(check(id_, what)), close(close_) {}
  ~Handle() { close(id); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
};

template <class T>
hid_t type_of();
template <>
hid_t type_of<unsigned char>() {
  return H5T_NATIVE_UCHAR;
}
template <>
hid_t type_of<int>() {
  return H5T_NATIVE_INT;
}
template <>
hid_t type_of<long long>() {
  return H5T_NATIVE_LLONG;
}
template <>
hid_t type_of<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}

/// Before all else. At the end of the program HDF5 would close a file once more that it could not write (and crash).
void begin_hdf() {
  static const herr_t once = H5dont_atexit();
  static_cast<void>(once);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace

/// Checks an HDF5 id; failures of a file on disk are reported as those of the disk.
template <class Id>
Id HdfFile::check(Id id, const char* what) {
  if (id < 0 && !on_disk_.empty()) {
    is_broken_ = true;
    throw InputError(fmt::format("cannot write {}: {}", on_disk_,
                                 errno != 0 ? std::strerror(errno) : fmt::format("HDF5 could not {}", what).c_str()));
  }
  return cgcontact::check(id, what);
}

HdfFile::HdfFile() {
  begin_hdf();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare a file");
  check(H5Pset_fapl_core(access.id, std::size_t{1} << 22, 0), "prepare a file in memory");
  file_ = check(H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access.id), "create a file in memory");
}

HdfFile::HdfFile(const std::string& file_name) : on_disk_(file_name), file_(-1) {
  begin_hdf();
  errno = 0;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare a file");
  check(H5Pset_file_locking(access.id, false, true), "prepare a file");  // some network disks have no locks
  check(H5Pset_cache(access.id, 0, 0, 0, 0), "prepare a file");          // so that no write fails later
  check(H5Pset_sieve_buf_size(access.id, 0), "prepare a file");
  file_ = check(H5Fcreate(file_name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id), "create a file");
}

HdfFile::~HdfFile() {
  if (file_ >= 0 && !is_broken_) H5Fclose(file_);
}

void HdfFile::make_group(const std::string& path) {
  Handle(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "create a group");
}

void HdfFile::set_attribute(const std::string& group, const std::string& name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "copy a type");
  check(H5Tset_size(type.id, value.size()), "set a string's length");
  check(H5Tset_strpad(type.id, H5T_STR_NULLPAD), "set a string's padding");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "create a space");
  const Handle attribute(
      H5Acreate_by_name(file_, group.c_str(), name.c_str(), type.id, space.id, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose, "create an attribute");
  check(H5Awrite(attribute.id, type.id, value.data()), "write an attribute");
}

void HdfFile::set_attribute(const std::string& group, const std::string& name, const std::vector<long long>& values) {
  const hsize_t size = values.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "create a space");
  const Handle attribute(H5Acreate_by_name(file_, group.c_str(), name.c_str(), H5T_NATIVE_LLONG, space.id, H5P_DEFAULT,
                                           H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create an attribute");
  check(H5Awrite(attribute.id, H5T_NATIVE_LLONG, values.data()), "write an attribute");
}

void HdfFile::set_attribute(const std::string& group, const std::string& name, long long value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "create a space");
  const Handle attribute(H5Acreate_by_name(file_, group.c_str(), name.c_str(), H5T_NATIVE_LLONG, space.id, H5P_DEFAULT,
                                           H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create an attribute");
  check(H5Awrite(attribute.id, H5T_NATIVE_LLONG, &value), "write an attribute");
}

template <class T>
std::size_t HdfFile::make_rows(const std::string& path, std::size_t num_rows, int columns, HdfStorage storage,
                               bool can_grow) {
  const hsize_t width = std::max(columns, 1);
  const int rank = columns > 0 ? 2 : 1;
  errno = 0;
  if (can_grow && H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0) {
    const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open a data set");
    hsize_t size[2] = {0, 0};
    const Handle space(H5Dget_space(set.id), H5Sclose, "open a space");
    check(H5Sget_simple_extent_dims(space.id, size, nullptr), "size a data set");
    const std::size_t first = size[0];
    size[0] += num_rows;
    check(H5Dset_extent(set.id, size), "extend a data set");
    return first;
  }
  const hsize_t size[2] = {num_rows, width};
  const hsize_t limit[2] = {can_grow ? H5S_UNLIMITED : size[0], width};
  const Handle space(H5Screate_simple(rank, size, limit), H5Sclose, "create a space");
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare a data set");
  check(H5Pset_obj_track_times(properties.id, false), "leave out the time");  // equal runs give equal files
  const bool compressed = storage == HdfStorage::compressed && size[0] > 1 && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0;
  if (compressed || can_grow) {
    const hsize_t chunk[2] = {std::clamp(size[0], hsize_t{1}, rows_per_chunk), width};
    check(H5Pset_chunk(properties.id, rank, chunk), "set a chunk size");
  }
  if (compressed) {
    check(H5Pset_shuffle(properties.id), "set up compression");
    check(H5Pset_deflate(properties.id, 1), "set up compression");
  }
  Handle(H5Dcreate2(file_, path.c_str(), type_of<T>(), space.id, H5P_DEFAULT, properties.id, H5P_DEFAULT), H5Dclose,
         "create a data set");
  return 0;
}

template <class T>
void HdfFile::write_rows(const std::string& path, std::size_t first, const T* values, std::size_t num_rows,
                         int columns) {
  errno = 0;
  const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open a data set");
  const Handle space(H5Dget_space(set.id), H5Sclose, "open a space");
  const hsize_t begin[2] = {first, 0}, count[2] = {num_rows, static_cast<hsize_t>(std::max(columns, 1))};
  const Handle rows(H5Screate_simple(columns > 0 ? 2 : 1, count, nullptr), H5Sclose, "create a space");
  check(H5Sselect_hyperslab(space.id, H5S_SELECT_SET, begin, nullptr, count, nullptr), "choose rows");
  check(H5Dwrite(set.id, type_of<T>(), rows.id, space.id, H5P_DEFAULT, values), "write a data set");
}

template <class T>
void HdfFile::write(const std::string& path, const std::vector<T>& values, int columns) {
  HdfRows<T>(*this, path, values.size() / std::max(columns, 1), columns).add(values);
}

template <class T>
HdfRows<T>::HdfRows(HdfFile& file, const std::string& path, std::size_t num_rows, int columns, HdfStorage storage,
                    bool can_grow)
    : file_(file),
      path_(path),
      columns_(columns),
      next_(file.make_rows<T>(path, num_rows, columns, storage, can_grow)),
      end_(next_ + num_rows) {}

/// Adds rows; whole chunks are written as soon as they are there: each is compressed once, if at all.
template <class T>
void HdfRows<T>::add(const std::vector<T>& values) {
  const std::size_t width = std::max(columns_, 1);
  std::size_t used = 0;
  while (used < values.size()) {
    const std::size_t end = std::min<std::size_t>(end_, (next_ / rows_per_chunk + 1) * rows_per_chunk);
    const std::size_t missing = (end - next_) * width - waiting_.size();
    const std::size_t taken = std::min(missing, values.size() - used);
    if (taken == 0) throw std::logic_error("HdfRows: more rows than there are");
    if (taken < missing || !waiting_.empty())
      waiting_.insert(waiting_.end(), values.begin() + used, values.begin() + used + taken);
    if (taken == missing) {
      file_.write_rows(path_, next_, waiting_.empty() ? values.data() + used : waiting_.data(), end - next_, columns_);
      waiting_.clear();
      next_ = end;
    }
    used += taken;
  }
}

std::vector<float> HdfFile::read(const std::string& path, std::size_t first_row, std::size_t num_rows) {
  errno = 0;
  const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open a data set");
  const Handle space(H5Dget_space(set.id), H5Sclose, "open a space");
  hsize_t size[2] = {0, 1};
  const int rank = check(H5Sget_simple_extent_dims(space.id, size, nullptr), "size a data set");
  const hsize_t first[2] = {first_row, 0}, count[2] = {num_rows, size[1]};
  check(H5Sselect_hyperslab(space.id, H5S_SELECT_SET, first, nullptr, count, nullptr), "choose rows");
  const Handle rows(H5Screate_simple(rank, count, nullptr), H5Sclose, "create a space");
  std::vector<float> values(num_rows * size[1]);
  check(H5Dread(set.id, H5T_NATIVE_FLOAT, rows.id, space.id, H5P_DEFAULT, values.data()), "read a data set");
  return values;
}

HdfReader::HdfReader(const std::string& file_name) {
  begin_hdf();
  file_ = H5Fopen(file_name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file_ < 0) throw InputError(fmt::format("cannot read {}", file_name));
}

HdfReader::~HdfReader() { H5Fclose(file_); }

std::vector<HdfReader::Array> HdfReader::arrays(const std::string& group) const {
  std::vector<Array> found;
  const Handle opened(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose, "open a group");
  H5G_info_t info;
  check(H5Gget_info(opened.id, &info), "list a group");
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    char name[256] = "";
    check(H5Lget_name_by_idx(opened.id, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT), "name");
    const Handle object(H5Oopen(opened.id, name, H5P_DEFAULT), H5Oclose, "open an object");
    if (H5Iget_type(object.id) != H5I_DATASET) continue;
    const Handle space(H5Dget_space(object.id), H5Sclose, "open a space"),
        type(H5Dget_type(object.id), H5Tclose, "open a type");
    hsize_t size[2] = {0, 1};
    if (H5Sget_simple_extent_ndims(space.id) > 2) throw std::runtime_error("HDF5 found an array of three dimensions");
    check(H5Sget_simple_extent_dims(space.id, size, nullptr), "size a data set");
    Array array{group + "/" + name, "", H5Tget_size(type.id), size[0], size[1]};
    const bool is_real = H5Tget_class(type.id) == H5T_FLOAT;
    const char* const kind = is_real ? "Float" : H5Tget_sign(type.id) == H5T_SGN_NONE ? "UInt" : "Int";
    array.type = fmt::format("{}{}", kind, 8 * array.bytes);
    found.push_back(std::move(array));
  }
  return found;
}

std::string HdfReader::read(const Array& array, std::size_t first_row, std::size_t num_rows) const {
  const Handle set(H5Dopen2(file_, array.path.c_str(), H5P_DEFAULT), H5Dclose, "open a data set");
  const Handle space(H5Dget_space(set.id), H5Sclose, "open a space"),
      type(H5Dget_type(set.id), H5Tclose, "open a type");
  const hsize_t first[2] = {first_row, 0}, count[2] = {num_rows, array.columns};
  check(H5Sselect_hyperslab(space.id, H5S_SELECT_SET, first, nullptr, count, nullptr), "choose rows");
  const Handle rows(H5Screate_simple(H5Sget_simple_extent_ndims(space.id), count, nullptr), H5Sclose, "create a space");
  std::string values(num_rows * array.columns * array.bytes, '\0');
  check(H5Dread(set.id, type.id, rows.id, space.id, H5P_DEFAULT, values.data()), "read a data set");
  return values;
}

template void HdfFile::write(const std::string&, const std::vector<unsigned char>&, int);
template void HdfFile::write(const std::string&, const std::vector<int>&, int);
template void HdfFile::write(const std::string&, const std::vector<long long>&, int);
template void HdfFile::write(const std::string&, const std::vector<float>&, int);
template void HdfFile::write(const std::string&, const std::vector<double>&, int);
template class HdfRows<unsigned char>;
template class HdfRows<int>;
template class HdfRows<long long>;
template class HdfRows<float>;
template class HdfRows<double>;

void HdfFile::save(const std::string& file_name) {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "flush a file");
  const ssize_t size = check(H5Fget_file_image(file_, nullptr, 0), "size a file");
  std::string image(static_cast<std::size_t>(size), '\0');
  check(H5Fget_file_image(file_, image.data(), image.size()), "copy a file");
  write_text(file_name, image);
}

void HdfFile::finish() {
  errno = 0;
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "flush a file");
  check(H5Fclose(std::exchange(file_, -1)), "close a file");
}

}  // namespace cgcontact
