/// Host vectors copied into new views.
#pragma once

#include <string>
#include <vector>

#include "kernels/mesh/views.hpp"

namespace cgcontact {

template <class View, class T>
View copy_to_view(const char* label, const std::vector<T>& values) {
  View view(std::string(label), values.size());
  auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < values.size(); ++i) host(i) = values[i];
  Kokkos::deep_copy(view, host);
  return view;
}

/// Arrays become the rows of a two-dimensional view.
template <class View, class T>
View copy_rows_to_view(const char* label, const std::vector<T>& rows) {
  View view(std::string(label), rows.size());
  auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < host.extent(1); ++j) host(i, j) = rows[i][j];
  Kokkos::deep_copy(view, host);
  return view;
}

}  // namespace cgcontact
