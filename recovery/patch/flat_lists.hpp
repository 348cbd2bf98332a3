/// Lists of many patches, one after the other in one array.
#pragma once

#include <vector>

namespace cgcontact {

/// Range of an array.
template <class T>
struct ListRange {
  const T *first, *last;
  const T* begin() const { return first; }
  const T* end() const { return last; }
  const T& operator[](int i) const { return first[i]; }
  int size() const { return static_cast<int>(last - first); }
  bool empty() const { return first == last; }
};

/// List i: items[begin[i] .. begin[i + 1]).
template <class T>
struct FlatLists {
  std::vector<int> begin{0};
  std::vector<T> items;

  ListRange<T> operator[](std::size_t i) const { return {items.data() + begin[i], items.data() + begin[i + 1]}; }
  void add(const std::vector<T>& list) {
    items.insert(items.end(), list.begin(), list.end());
    begin.push_back(static_cast<int>(items.size()));
  }
  void append(const FlatLists& other) {
    const int before = static_cast<int>(items.size());
    items.insert(items.end(), other.items.begin(), other.items.end());
    for (std::size_t i = 1; i < other.begin.size(); ++i) begin.push_back(before + other.begin[i]);
  }
  void clear() {
    begin.assign(1, 0);
    items.clear();
  }
};

}  // namespace cgcontact
