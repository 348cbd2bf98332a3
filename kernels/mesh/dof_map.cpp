#include "kernels/mesh/dof_map.hpp"

#include <fmt/format.h>

#include <Tpetra_Map.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/base/errors/errors.hpp"
#include "kernels/mesh/halo.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/sparse_rows.hpp"

namespace cgcontact {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;

int checked_count(long long num_nodes) {
  constexpr long long most = std::numeric_limits<int>::max() / dofs_per_node;
  if (num_nodes > most)
    throw InputError(
        fmt::format("the bodies have {} grid nodes, more than one process can number (allowed: up to {}; larger cells)",
                    num_nodes, most));
  return static_cast<int>(num_nodes);
}

[[noreturn]] void refuse(int node, const std::string& problem) {
  throw std::invalid_argument(fmt::format("constraint of node {}: {}", node, problem));
}

void check(const std::vector<NodeConstraint>& constraints, int num_nodes) {
  std::vector<char> constrained(num_nodes, 0);
  for (const NodeConstraint& c : constraints) {
    if (c.node < 0 || c.node >= num_nodes) refuse(c.node, fmt::format("there are nodes 0 to {} only", num_nodes - 1));
    if (constrained[c.node]) refuse(c.node, "it has a constraint already");
    constrained[c.node] = 1;
  }
  for (const NodeConstraint& c : constraints) {
    if (c.masters.empty()) refuse(c.node, "it has no masters");
    std::vector<int> seen;
    for (const auto& [master, weight] : c.masters) {
      if (master < 0 || master >= num_nodes) refuse(c.node, fmt::format("master {} does not exist", master));
      if (constrained[master])
        refuse(c.node, fmt::format("master {} is constrained itself (allowed: free nodes, chains resolved)", master));
      if (!std::isfinite(weight)) refuse(c.node, fmt::format("the weight of master {} is not finite", master));
      if (std::find(seen.begin(), seen.end(), master) != seen.end())
        refuse(c.node, fmt::format("master {} comes twice", master));
      seen.push_back(master);
    }
  }
}

ConstraintRows make_rows(const std::vector<NodeConstraint>& constraints) {
  std::vector<int> node;
  for (const NodeConstraint& c : constraints) node.push_back(c.node);
  const auto [direct, transposed] = compress_rows(
      constraints.size(), [&](std::size_t i) -> const SparseRow& { return constraints[i].masters; },
      [&](std::size_t i) { return node[i]; });
  ConstraintRows rows;
  rows.node = copy_to_view<IntView>("cgcontact::dof_map::node", node);
  rows.begin = copy_to_view<IntView>("cgcontact::dof_map::begin", direct.begin);
  rows.master = copy_to_view<IntView>("cgcontact::dof_map::master", direct.number);
  rows.weight = copy_to_view<RealView>("cgcontact::dof_map::weight", direct.coefficient);
  rows.master_node = copy_to_view<IntView>("cgcontact::dof_map::master_node", transposed.column);
  rows.master_begin = copy_to_view<IntView>("cgcontact::dof_map::master_begin", transposed.rows.begin);
  rows.constrained = copy_to_view<IntView>("cgcontact::dof_map::constrained", transposed.rows.number);
  rows.master_weight = copy_to_view<RealView>("cgcontact::dof_map::master_weight", transposed.rows.coefficient);
  return rows;
}

}  // namespace

DofMap::DofMap(long long num_nodes, const std::vector<NodeConstraint>& constraints, const std::vector<int>& zero_dofs,
               std::shared_ptr<const Halo> halo)
    : num_nodes_(checked_count(num_nodes)), halo_(std::move(halo)) {
  check(constraints, num_nodes_);
  set_constraints(constraints);
  for (const int dof : zero_dofs)
    if (dof < 0 || dof >= num_dofs())
      throw std::invalid_argument(fmt::format("degree of freedom {} is to be zero: it does not exist", dof));
  if (!zero_dofs.empty()) zero_dofs_ = copy_to_view<IntView>("cgcontact::dof_map::zero_dofs", zero_dofs);
}

void DofMap::set_constraints(const std::vector<NodeConstraint>& constraints) {
  if (constraints.empty()) return;
  std::vector<int> dependent(num_nodes_, 0);
  for (const NodeConstraint& c : constraints)
    for (const auto& [master, weight] : c.masters) ++dependent[master];
  std::vector<std::array<int, 2>> across_nodes;
  std::vector<NodeConstraint> sums;
  for (const NodeConstraint& c : constraints) {
    const auto& [master, weight] = c.masters.front();
    if (c.masters.size() == 1 && weight == 1 && dependent[master] == 1)
      across_nodes.push_back({master, c.node});
    else
      sums.push_back(c);
  }
  if (!across_nodes.empty())
    across_nodes_ = copy_rows_to_view<AcrossNodesView>("cgcontact::dof_map::across_nodes", across_nodes);
  if (!sums.empty()) sums_ = make_rows(sums);
}

namespace {

RCP<const DofMap::Map> map_of(int num_entries, const DofMap::Comm& comm) {
  return rcp(new DofMap::Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                             static_cast<std::size_t>(num_entries), 0, comm));
}

}  // namespace

RCP<const DofMap::Map> DofMap::vector_map(const Comm& comm) const { return map_of(num_dofs(), comm); }
RCP<const DofMap::Map> DofMap::node_map(const Comm& comm) const { return map_of(num_nodes(), comm); }

}  // namespace cgcontact
