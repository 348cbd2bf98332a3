#include "kernels/multigrid/rank_levels.hpp"

#include <stdexcept>

#include "core/base/process/ranks.hpp"

namespace cgcontact {
namespace {

/// A cell has the owner of the first of its children.
Owners coarse_owners(const ElasticSystem& fine, const Owners& owners, const ElasticSystem& coarse,
                     const std::vector<std::vector<int>>& together) {
  Owners result;
  for (const BodyMesh* level : coarse.level_meshes()) result.of_cell.emplace_back(level->cell_nodes.size(), -1);
  const CoarseCells cells(fine, coarse);
  for (std::size_t p = 0; p < owners.of_cell.size(); ++p)
    for (std::size_t e = 0; e < owners.of_cell[p].size(); ++e) {
      const CoarseCells::CoarseCell to_cell = cells.of(static_cast<int>(p), static_cast<int>(e));
      int& owner = result.of_cell[to_cell.level][to_cell.cell];
      if (owner < 0) owner = owners.of_cell[p][e];
    }
  own_nodes(coarse, together, result);
  return result;
}

/// use(fine node) for all fine nodes that a coarse node gives to; use(coarse node) for all that a fine node takes from.
class Relatives {
 public:
  explicit Relatives(const Transfer& transfer)
      : by_rows_(transfer.by_rows),
        parents_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parents)),
        children_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.children)),
        parent_begin_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parent_rows.begin)),
        parent_node_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parent_rows.node)),
        child_begin_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.child_rows.begin)),
        child_node_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.child_rows.node)) {}

  template <class Use>
  void each_child(int coarse, const Use& use) const {
    if (by_rows_)
      for (int e = child_begin_(coarse); e < child_begin_(coarse + 1); ++e) use(child_node_(e));
    else
      for (int c = 0; c < 27; ++c)
        if (children_(coarse, c) >= 0) use(children_(coarse, c));
  }
  template <class Use>
  void each_parent(int fine, const Use& use) const {
    if (by_rows_)
      for (int e = parent_begin_(fine); e < parent_begin_(fine + 1); ++e) use(parent_node_(e));
    else
      for (int a = 0; a < 8; ++a) use(parents_(fine, a));
  }

 private:
  bool by_rows_;
  decltype(Transfer::parents)::HostMirror parents_;
  decltype(Transfer::children)::HostMirror children_;
  IntView::HostMirror parent_begin_, parent_node_, child_begin_, child_node_;
};

int local_or_throw(const RankShare& share, int node) {
  const int local = share.local(node);
  if (local < 0) throw std::logic_error("transfer: a node of a row is not local");
  return local;
}

/// Rows of the local nodes that `has_row` takes, the others empty.
template <class HasRow>
Transfer::Rows rows_of_rank(const Transfer::Rows& whole, const RankShare& from, const RankShare& to,
                            const HasRow& has_row) {
  const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole.begin);
  const auto node = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole.node);
  const auto weight = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole.weight);
  std::vector<int> own_begin{0}, own_node;
  std::vector<double> own_weight;
  for (std::size_t n = 0; n < from.whole_nodes().size(); ++n) {
    const int row = from.whole_nodes()[n];
    for (int e = begin(row); e < begin(row + 1) && has_row(static_cast<int>(n)); ++e) {
      own_node.push_back(local_or_throw(to, node(e)));
      own_weight.push_back(weight(e));
    }
    own_begin.push_back(static_cast<int>(own_node.size()));
  }
  return {copy_to_view<IntView>("cgcontact::rank_levels::begin", own_begin),
          copy_to_view<IntView>("cgcontact::rank_levels::node", own_node),
          copy_to_view<RealView>("cgcontact::rank_levels::weight", own_weight)};
}

}  // namespace

std::vector<std::unique_ptr<RankShare>> make_shares(const std::vector<const ElasticSystem*>& systems,
                                                    const std::vector<Transfer>& transfers,
                                                    const std::vector<NodeColumns<float>>& columns,
                                                    const Halo::Comm& comm) {
  std::vector<Owners> owners;
  for (std::size_t l = 0; l < systems.size(); ++l) {
    const auto together = nodes_of_columns(columns[l]);
    owners.push_back(l == 0 ? partition(*systems[0], num_ranks(), together)
                            : coarse_owners(*systems[l - 1], owners.back(), *systems[l], together));
  }
  std::vector<std::vector<char>> more;
  for (const ElasticSystem* system : systems) more.emplace_back(system->num_nodes, 0);
  for (std::size_t l = 0; l + 1 < systems.size(); ++l) {
    const Relatives relatives(transfers[l]);
    for (int n = 0; n < systems[l]->num_nodes; ++n)
      if (owners[l].of_node[n] == this_rank()) relatives.each_parent(n, [&](int parent) { more[l + 1][parent] = 1; });
    const std::vector<char> needed = needed_nodes(*systems[l + 1], owners[l + 1], this_rank());
    for (int n = 0; n < systems[l + 1]->num_nodes; ++n)
      if (needed[n]) relatives.each_child(n, [&](int child) { more[l][child] = 1; });
  }
  std::vector<std::unique_ptr<RankShare>> shares;
  for (std::size_t l = 0; l < systems.size(); ++l)
    shares.push_back(std::make_unique<RankShare>(*systems[l], std::move(owners[l]), more[l], comm));
  return shares;
}

Transfer transfer_of_rank(const Transfer& whole, const RankShare& fine, const RankShare& coarse) {
  const Halo& coarse_halo = *coarse.system().dofs.halo();
  const auto is_own = [&](int n) { return fine.owns(fine.whole_nodes()[n]); };
  const auto is_needed = [&](int n) { return coarse_halo.needs(n); };
  Transfer transfer;
  transfer.by_rows = whole.by_rows;
  if (whole.by_rows) {
    transfer.parent_rows = rows_of_rank(whole.parent_rows, fine, coarse, is_own);
    transfer.child_rows = rows_of_rank(whole.child_rows, coarse, fine, is_needed);
    return transfer;
  }
  transfer.parents = decltype(transfer.parents)("cgcontact::rank_levels::parents", fine.whole_nodes().size());
  transfer.children = decltype(transfer.children)("cgcontact::rank_levels::children", coarse.whole_nodes().size());
  const auto all_parents = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole.parents);
  const auto all_children = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole.children);
  auto parents = Kokkos::create_mirror_view(transfer.parents);
  auto children = Kokkos::create_mirror_view(transfer.children);
  for (std::size_t n = 0; n < fine.whole_nodes().size(); ++n)
    for (int a = 0; a < 8; ++a)
      parents(n, a) = is_own(static_cast<int>(n)) ? local_or_throw(coarse, all_parents(fine.whole_nodes()[n], a)) : -1;
  for (std::size_t n = 0; n < coarse.whole_nodes().size(); ++n)
    for (int c = 0; c < 27; ++c) {
      const int child = all_children(coarse.whole_nodes()[n], c);
      children(n, c) = child >= 0 && is_needed(static_cast<int>(n)) ? local_or_throw(fine, child) : -1;
    }
  Kokkos::deep_copy(transfer.parents, parents);
  Kokkos::deep_copy(transfer.children, children);
  return transfer;
}

}  // namespace cgcontact
