/// Constraints of nodes: where cells of different size meet, and across a body in plane strain. With cells that differ
/// by one level at most, corners included (CellTree), no master is constrained itself.
#pragma once

#include <vector>

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// Returns how often a cell of one grid is halved to be as large as one of the other; both descend from the same grid.
int halvings(const Grid& larger, const Grid& smaller);

/// Returns constraints of the nodes of a body's levels, whose cells descend in size (or are equal), ascending in node:
///   a node that an earlier level also has is that node;
///   a node on an edge or a face of a larger cell is the mean of that edge's or face's corners;
///   a node of a virtual child is interpolated in the larger cell;
///   on a quadtree (Grid::slice) a node of the upper side is what the one opposite is.
std::vector<NodeConstraint> constrain_nodes(const std::vector<BodyMesh>& levels);

/// Constrains a body of one layer of cells across an axis of its grid (Grid::plane_strain): each node of the upper side
/// is the one opposite, ascending in node. Throws std::logic_error if there are more layers.
std::vector<NodeConstraint> constrain_across(const BodyMesh& mesh);

}  // namespace cgcontact
