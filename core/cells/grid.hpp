/// The Cartesian grid of one body: uniform cubic cells, any origin and rotation, unrelated to the body's faces.
#pragma once

#include "core/base/types.hpp"

namespace cgcontact {

/// Grid coordinates are cell units: cell (i,j,k) is [i,i+1] x [j,j+1] x [k,k+1].
struct Grid {
  Vec3 origin = Vec3::Zero();        ///< position of grid node (0,0,0), m
  Mat3 rotation = Mat3::Identity();  ///< columns: grid axes in global axes
  double cell_size = 1;              ///< m
  Index3 num_cells{0, 0, 0};

  Vec3 to_grid(const Vec3& x) const { return rotation.transpose() * (x - origin) / cell_size; }
  Vec3 to_global(const Vec3& g) const { return origin + cell_size * (rotation * g); }
  long long num_cells_total() const { return static_cast<long long>(num_cells[0]) * num_cells[1] * num_cells[2]; }
  long long cell_index(const Index3& c) const {
    return (static_cast<long long>(c[2]) * num_cells[1] + c[1]) * num_cells[0] + c[0];
  }
  long long node_index(const Index3& n) const {
    return (static_cast<long long>(n[2]) * (num_cells[1] + 1) + n[1]) * (num_cells[0] + 1) + n[0];
  }
};

}  // namespace cgcontact
