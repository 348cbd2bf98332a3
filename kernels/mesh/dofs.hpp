/// Degrees of freedom of a node: the three components of its displacement in grid axes, node by node. Whatever turns
/// nodes into degrees of freedom or back goes through here; DofMap defines the active nodes.
#pragma once

#include <Kokkos_Core.hpp>

namespace cgcontact {

constexpr int dofs_per_node = 3;

/// Returns the index of a component of a node: in the vector of all nodes, or in that of one element (node: corner).
KOKKOS_INLINE_FUNCTION constexpr int dof_of(int node, int component = 0) { return dofs_per_node * node + component; }

/// Returns the same as an offset into an array.
KOKKOS_INLINE_FUNCTION constexpr std::size_t dof_offset(std::size_t node, int component = 0) {
  return dofs_per_node * node + component;
}

KOKKOS_INLINE_FUNCTION constexpr int node_of_dof(int dof) { return dof / dofs_per_node; }
KOKKOS_INLINE_FUNCTION constexpr int component_of_dof(int dof) { return dof % dofs_per_node; }

}  // namespace cgcontact
