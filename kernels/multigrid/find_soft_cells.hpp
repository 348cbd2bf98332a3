/// Which cells of a level are soft (kernels/operator/soft_cells.hpp).
#pragma once

#include "kernels/operator/node_columns.hpp"
#include "kernels/operator/soft_cells.hpp"

namespace cgcontact {

/// Thin cut cells that carry no support, of bodies that are less than three quarters of a cell thick there on average,
/// and not held nearly everywhere. finer: the next finer level and its thin cells, nullptr on the finest.
template <class Real>
SoftCells make_soft_cells(const ElasticSystem& system, const NodeColumns<Real>& columns, const ElasticSystem* finer,
                          const SoftCells* of_finer);

}  // namespace cgcontact
