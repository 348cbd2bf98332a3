/// Grids of the hierarchy on several ranks: who owns what on each, and the transfer in the numbers of a rank. Every
/// rank computes grids of few unknowns whole, from gathered vectors.
#pragma once

#include <memory>
#include <vector>

#include "kernels/multigrid/coarsen.hpp"
#include "kernels/operator/node_columns.hpp"
#include "kernels/ranks/rank_share.hpp"

namespace cgcontact {

/// Shares of the grids systems[0 .. last], finest first; transfers[l]: from grid l to the next. columns: of each.
/// Collective.
std::vector<std::unique_ptr<RankShare>> make_shares(const std::vector<const ElasticSystem*>& systems,
                                                    const std::vector<Transfer>& transfers,
                                                    const std::vector<NodeColumns<float>>& columns,
                                                    const Halo::Comm& comm);

/// Returns a transfer in the numbers of a rank: rows of its own nodes only, both ways.
Transfer transfer_of_rank(const Transfer& whole, const RankShare& fine, const RankShare& coarse);

}  // namespace cgcontact
