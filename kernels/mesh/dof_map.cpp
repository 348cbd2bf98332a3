#include "kernels/mesh/dof_map.hpp"

#include <fmt/format.h>

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_set>

#include "core/base/errors.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/sparse_rows.hpp"

namespace cgcontact {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;
using GlobalDof = Tpetra::Map<>::global_ordinal_type;

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

DofMap::DofMap(long long num_nodes, const std::vector<NodeConstraint>& constraints, const std::vector<int>& zero_dofs)
    : num_owned_(checked_count(num_nodes)), num_nodes_(num_owned_) {
  check(constraints, num_nodes_);
  set_constraints(constraints);
  for (const int dof : zero_dofs)
    if (dof < 0 || dof >= num_dofs())
      throw std::invalid_argument(fmt::format("degree of freedom {} is to be zero: it does not exist", dof));
  if (!zero_dofs.empty()) zero_dofs_ = copy_to_view<IntView>("cgcontact::dof_map::zero_dofs", zero_dofs);
}

DofMap::DofMap(const std::vector<long long>& owned, const std::vector<long long>& ghosts,
               const std::vector<NodeConstraint>& constraints)
    : num_owned_(checked_count(static_cast<long long>(owned.size()))),
      num_nodes_(checked_count(static_cast<long long>(owned.size() + ghosts.size()))),
      one_rank_(false),
      global_(owned) {
  global_.insert(global_.end(), ghosts.begin(), ghosts.end());
  std::unordered_set<long long> seen;
  for (int n = 0; n < num_nodes_; ++n) {
    if (global_[n] < 0) throw std::invalid_argument(fmt::format("node {} has the global number {}", n, global_[n]));
    if (n < num_owned_ && !seen.insert(global_[n]).second)
      throw std::invalid_argument(fmt::format("global node {} is owned twice", global_[n]));
  }
  check(constraints, num_nodes_);
  set_constraints(constraints);
}

void DofMap::set_constraints(const std::vector<NodeConstraint>& constraints) {
  if (constraints.empty()) return;
  std::vector<int> dependent(num_nodes_, 0);
  for (const NodeConstraint& c : constraints)
    for (const auto& [master, weight] : c.masters) ++dependent[master];
  std::vector<std::array<int, 2>> twins;
  std::vector<NodeConstraint> sums;
  for (const NodeConstraint& c : constraints) {
    const auto& [master, weight] = c.masters.front();
    if (c.masters.size() == 1 && weight == 1 && dependent[master] == 1)
      twins.push_back({master, c.node});
    else
      sums.push_back(c);
  }
  if (!twins.empty()) twins_ = copy_rows_to_view<TwinsView>("cgcontact::dof_map::twins", twins);
  if (!sums.empty()) sums_ = make_rows(sums);
}

RCP<const DofMap::Map> DofMap::map_of(int num_nodes, int per_node, const Comm& comm) const {
  if (one_rank_) return rcp(new Map(static_cast<Tpetra::global_size_t>(num_nodes) * per_node, 0, comm));
  std::vector<GlobalDof> entries;
  entries.reserve(static_cast<std::size_t>(num_nodes) * per_node);
  for (int n = 0; n < num_nodes; ++n)
    for (int i = 0; i < per_node; ++i) entries.push_back(per_node * static_cast<GlobalDof>(global_[n]) + i);
  return rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                     Teuchos::ArrayView<const GlobalDof>(entries.data(), entries.size()), 0, comm));
}

RCP<const DofMap::Map> DofMap::owned_map(const Comm& comm) const { return map_of(num_owned_, dofs_per_node, comm); }
RCP<const DofMap::Map> DofMap::local_map(const Comm& comm) const { return map_of(num_nodes_, dofs_per_node, comm); }
RCP<const DofMap::Map> DofMap::owned_node_map(const Comm& comm) const { return map_of(num_owned_, 1, comm); }

RCP<const DofMap::Import> DofMap::importer(const Comm& comm) const {
  return rcp(new Import(owned_map(comm), local_map(comm)));
}

}  // namespace cgcontact
