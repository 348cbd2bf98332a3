/// Values and lists of values as bytes, to pass them to other ranks (ranks.hpp), and back.
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <type_traits>
#include <vector>

namespace cgcontact {

/// Numbers, plain structs, fixed-size matrices.
template <class T>
struct IsPlain : std::is_trivially_copyable<T> {};
template <class T, int rows, int columns, int options>
struct IsPlain<Eigen::Matrix<T, rows, columns, options>> : std::bool_constant<(rows > 0 && columns > 0)> {};

class Packing {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(IsPlain<T>::value);
    put_bytes(&value, sizeof(T));
  }
  template <class T>
  void put(const std::vector<T>& values) {
    static_assert(IsPlain<T>::value);
    put(values.size());
    put_bytes(values.data(), values.size() * sizeof(T));
  }
  const std::vector<char>& bytes() const { return bytes_; }
  void reserve(std::size_t size) { bytes_.reserve(size); }

 private:
  void put_bytes(const void* from, std::size_t size) {
    const char* bytes = static_cast<const char*>(from);
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }

  std::vector<char> bytes_;
};

/// Takes the values in the order in which they were put. The bytes must outlive it.
class Unpacking {
 public:
  explicit Unpacking(const std::vector<char>& bytes) : next_(bytes.data()) {}
  template <class T>
  void take(T& value) {
    static_assert(IsPlain<T>::value);
    take_bytes(&value, sizeof(T));
  }
  template <class T>
  void take(std::vector<T>& values) {
    static_assert(IsPlain<T>::value);
    std::size_t size = 0;
    take(size);
    values.resize(size);
    take_bytes(values.data(), size * sizeof(T));
  }
  void skip(std::size_t size) { next_ += size; }

 private:
  void take_bytes(void* to, std::size_t size) {
    if (size > 0) std::memcpy(to, next_, size);
    next_ += size;
  }

  const char* next_;
};

}  // namespace cgcontact
