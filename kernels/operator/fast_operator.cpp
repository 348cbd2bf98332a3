#include "kernels/operator/fast_operator.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/base/process/parallel.hpp"
#include "kernels/mesh/halo.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/launch.hpp"
#include "kernels/mesh/row_sums.hpp"

namespace cgcontact {
namespace {

/// Returns the nodes that the stencil serves: eight active cells, at least one full, so that what cut cells take back
/// is never much larger than what remains. On several ranks: those where forces are needed.
std::vector<char> classify(const ElasticSystem& system) {
  std::vector<char> by_stencil(system.num_nodes, 0);
  for (const BodyMesh* level : system.level_meshes()) {
    const BodyMesh& mesh = *level;
    const CutCells& cc = *mesh.cut_cells;
    std::vector<char> is_full(cc.cells.size());
    parallel_for("cgcontact::fast_operator::full_cells", cc.cells.size(), 4096,
                 [&](std::size_t e) { is_full[e] = counts_as_full(cc, static_cast<int>(e)); });
    GridNumbers full(cc.grid.num_cells);
    for (std::size_t e = 0; e < cc.cells.size(); ++e)
      if (is_full[e]) full.insert(cc.cells[e]);
    // 64 nodes along x at a time: bit i of `all` is that of the cells around node i.
    mesh.node_numbers.each_word([&](const Index3& first, std::uint64_t nodes, int number) {
      std::uint64_t all = ~std::uint64_t{0}, some = 0;
      for (int a = 0; a < 8; ++a) {
        const Index3 cell{first[0] - (a & 1), first[1] - (a >> 1 & 1), first[2] - (a >> 2)};
        all &= cc.numbers.bits(cell);
        some |= full.bits(cell);
      }
      for (; nodes != 0; nodes &= nodes - 1, ++number)
        by_stencil[mesh.first_node + number] = (all & some) >> __builtin_ctzll(nodes) & 1;
    });
  }
  if (const Halo* halo = system.dofs.halo())
    for (int n = 0; n < system.num_nodes; ++n) by_stencil[n] = by_stencil[n] && halo->needs(n);
  return by_stencil;
}

std::vector<std::array<int, 2>> ranges_outside(const std::vector<char>& by_stencil) {
  constexpr int longest = 512;
  std::vector<std::array<int, 2>> ranges;
  for (int n = 0; n < static_cast<int>(by_stencil.size()); ++n) {
    if (by_stencil[n]) continue;
    if (!ranges.empty() && ranges.back()[0] + ranges.back()[1] == n && ranges.back()[1] < longest)
      ++ranges.back()[1];
    else
      ranges.push_back({n, 1});
  }
  return ranges;
}

template <class To, class From>
To convert(const char* label, const From& from) {
  To to(std::string(label), from.extent(0));
  auto a = Kokkos::create_mirror_view(from);
  auto b = Kokkos::create_mirror_view(to);
  Kokkos::deep_copy(a, from);
  for (std::size_t i = 0; i < from.extent(0); ++i) b(i) = static_cast<typename To::value_type>(a(i));
  Kokkos::deep_copy(to, b);
  return to;
}

constexpr int ranges_at_once = 64;

using Dynamic = Kokkos::Schedule<Kokkos::Dynamic>;
Kokkos::RangePolicy<ExecSpace, Dynamic> one_by_one(const ExecSpace& exec, int n) {
  return Kokkos::RangePolicy<ExecSpace, Dynamic>(exec, 0, n, Kokkos::ChunkSize(1));
}

}  // namespace

template <class Real>
FastOperator<Real>::FastOperator(const ElasticSystem& system) : num_nodes_(system.num_nodes), dofs_(system.dofs) {
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (const BodyMesh* level : levels)
    if (level->cut_cells->grid.num_levels != 1) throw std::logic_error("fast operator: a part has more than one level");
  const std::vector<char> by_stencil = classify(system);
  const SlabPartition slabs = make_slabs(levels);
  tiles_ = make_stencil_tiles<Real>(levels, by_stencil);
  cells_ = make_band_cells<Real>(system, by_stencil, slabs);
  ghosts_ = make_ghost_chains<Real>(system, slabs);
  other_nodes_ =
      copy_rows_to_view<decltype(other_nodes_)>("cgcontact::fast_operator::other_nodes", ranges_outside(by_stencil));
  for (int colour = 0; colour < 2; ++colour) {
    std::vector<int> list;
    for (std::size_t s = 0; s < slabs.colour_of_slab.size(); ++s)
      if (slabs.colour_of_slab[s] == colour) list.push_back(static_cast<int>(s));
    // The longest first: threads finish together.
    auto work = [&](int s) {
      return 8 * (cells_.chunk_begin(s + 1) - cells_.chunk_begin(s)) + ghosts_.chunk_begin(s + 1) -
             ghosts_.chunk_begin(s);
    };
    std::stable_sort(list.begin(), list.end(), [&](int a, int b) { return work(a) > work(b); });
    slabs_[colour] = copy_to_view<IntView>("cgcontact::fast_operator::slabs", list);
  }
  std::vector<Real> diagonal;
  std::vector<int> first_node;
  stencil_next_ = decltype(stencil_next_)("cgcontact::fast_operator::next", levels.size());
  auto next = Kokkos::create_mirror_view(stencil_next_);
  for (const BodyMesh* level : levels) {
    const BodyMesh& mesh = *level;
    const StencilCoefficients<double> stencil(mesh, 1);
    for (int c = 0; c < 3; ++c) {
      next(diagonal.size(), 0, c) = static_cast<Real>(stencil.outer[c][3]);
      next(diagonal.size(), 1, c) = static_cast<Real>(stencil.inner[c][1]);
      next(diagonal.size(), 2, c) = static_cast<Real>(stencil.inner[c][2]);
    }
    diagonal.push_back(static_cast<Real>(StencilCoefficients<double>::diagonal(mesh)));
    first_node.push_back(mesh.first_node);
  }
  Kokkos::deep_copy(stencil_next_, next);
  stencil_diagonal_ = copy_to_view<decltype(stencil_diagonal_)>("cgcontact::fast_operator::diagonal", diagonal);
  body_first_node_ = copy_to_view<IntView>("cgcontact::fast_operator::first_node", first_node);
  by_stencil_ = copy_to_view<decltype(by_stencil_)>("cgcontact::fast_operator::by_stencil", by_stencil);
  rings_ = decltype(rings_)("cgcontact::fast_operator::rings", ExecSpace::concurrency(), StencilRing<Real>::size);

  set_groups(system);

  sizes_.num_nodes = num_nodes_;
  sizes_.stencil_nodes = tiles_.num_nodes;
  sizes_.cut_cells = cells_.num_cut;
  sizes_.full_cells = cells_.num_full;
  sizes_.supported_cells = cells_.num_supported;
  sizes_.ghost_faces = ghosts_.num_faces;
  sizes_.ghost_chains = static_cast<long long>(ghosts_.chains.extent(0));
  sizes_.bytes = tiles_.bytes() + cells_.bytes() + ghosts_.bytes() + other_nodes_.size() * sizeof(int) +
                 by_stencil_.size() + rings_.size() * sizeof(Real);
}

template <class Real>
void FastOperator<Real>::set_groups(const ElasticSystem& system) {
  const GroupRows& g = system.groups;
  group_sums_ = system.group_sums;
  groups_.row_begin = g.row_begin;
  groups_.row_dof = g.row_dof;
  groups_.dof_begin = g.dof_begin;
  groups_.dof_list = g.dof_list;
  groups_.column_group = g.column_group;
  groups_.row_value = convert<VectorView>("cgcontact::fast_operator::row_value", g.row_value);
  groups_.column_value = convert<VectorView>("cgcontact::fast_operator::column_value", g.column_value);
  groups_.stiffness = convert<VectorView>("cgcontact::fast_operator::stiffness", g.stiffness);
  groups_.coupled_row = IntView();
  groups_.coupling = VectorView();
  if (std::is_same_v<Real, double> && g.coupling.extent(0) > 0) {
    groups_.coupled_row = g.coupled_row;
    groups_.coupling = convert<VectorView>("cgcontact::fast_operator::coupling", g.coupling);
  }
  groups_.scratch = VectorView("cgcontact::fast_operator::scratch", g.stiffness.extent(0));
  sizes_.groups = static_cast<long long>(groups_.stiffness.extent(0));
  sizes_.group_entries = static_cast<long long>(groups_.row_value.extent(0));
}

template <class Real>
template <bool subtract>
void FastOperator<Real>::stencil(const ExecSpace& exec, const Real* x, const Real* base, Real* y) const {
  const auto tiles = tiles_;
  const auto ranges = other_nodes_;
  const auto rings = rings_;
  const int num_tiles = tiles.num_tiles(), num_ranges = static_cast<int>(ranges.extent(0));
  const Kokkos::Experimental::UniqueToken<ExecSpace> token;
  launch(
      "cgcontact::fast_operator::stencil",
      one_by_one(exec, num_tiles + (num_ranges + ranges_at_once - 1) / ranges_at_once), num_nodes_, grain_of_light,
      KOKKOS_LAMBDA(const int t) {
        if (t < num_tiles) {
          const int thread = token.acquire();
          stencil::apply_tile<subtract>(tiles, t, x, base, y, &rings(thread, 0));
          token.release(thread);
          return;
        }
        const int first = (t - num_tiles) * ranges_at_once;
        const int last = first + ranges_at_once < num_ranges ? first + ranges_at_once : num_ranges;
        for (int r = first; r < last; ++r) {
          const std::size_t begin = dof_offset(ranges(r, 0)), end = begin + dof_of(ranges(r, 1));
          for (std::size_t i = begin; i < end; ++i) y[i] = subtract ? base[i] : Real(0);
        }
      });
}

template <class Real>
template <bool subtract>
void FastOperator<Real>::band(const ExecSpace& exec, const Real* x, Real* y, bool with_cells, bool with_ghosts) const {
  const auto cells = cells_;
  const auto ghosts = ghosts_;
  if (cells.num_cut + cells.num_full == 0) return;
  for (int colour = 0; colour < 2; ++colour) {
    const IntView slabs = slabs_[colour];
    launch(
        "cgcontact::fast_operator::band", one_by_one(exec, static_cast<int>(slabs.extent(0))),
        cells.num_cut + cells.num_full, grain_of_medium, KOKKOS_LAMBDA(const int s) {
          if (with_cells) band::apply_chunk<subtract>(cells, slabs(s), x, y);
          if (with_ghosts) ghost::apply_chunk<subtract>(ghosts, slabs(s), x, y);
        });
  }
}

template <class Real>
void FastOperator<Real>::groups(const ExecSpace& exec, const Real* x, Real* y, Real sign) const {
  const Groups r = groups_;
  if (r.stiffness.extent(0) == 0) return;
  const bool coupled = r.coupling.extent(0) > 0;
  launch(
      "cgcontact::fast_operator::group_gaps",
      Kokkos::RangePolicy<ExecSpace>(exec, 0, static_cast<int>(r.stiffness.extent(0))), grain_of_medium,
      KOKKOS_LAMBDA(const int g) {
        Real force = r.stiffness(g) != 0 ? r.stiffness(g) * r.gap(g, x) : 0;
        if (coupled && r.coupling(g) != 0) force += r.coupling(g) * r.gap(r.coupled_row(g), x);
        r.scratch(g) = sign * force;
      });
  if (group_sums_) group_sums_->sum(exec, r.scratch.data());
  const int num_dofs = static_cast<int>(r.dof_list.extent(0));
  launch(
      "cgcontact::fast_operator::group_forces", Kokkos::RangePolicy<ExecSpace>(exec, 0, num_dofs), grain_of_light,
      KOKKOS_LAMBDA(const int d) {
        Real force = 0;
        for (int e = r.dof_begin(d); e < r.dof_begin(d + 1); ++e)
          force += r.column_value(e) * r.scratch(r.column_group(e));
        y[r.dof_list(d)] += force;
      });
}

template <class Real>
void FastOperator<Real>::apply(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y) const {
  stencil<false>(exec, x.data(), nullptr, y.data());
  band<false>(exec, x.data(), y.data(), true, true);
  groups(exec, x.data(), y.data(), Real(1));
  apply_constraints_transposed(exec, dofs_, y);
}

template <class Real>
void FastOperator<Real>::residual(const ExecSpace& exec, const ConstVectorView& b, const ConstVectorView& x,
                                  const VectorView& r) const {
  stencil<true>(exec, x.data(), b.data(), r.data());
  band<true>(exec, x.data(), r.data(), true, true);
  groups(exec, x.data(), r.data(), Real(-1));
  apply_constraints_transposed(exec, dofs_, r);
}

template <class Real>
void FastOperator<Real>::apply_stencil(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y) const {
  stencil<false>(exec, x.data(), nullptr, y.data());
}

template <class Real>
void FastOperator<Real>::add_band(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y, bool cells,
                                  bool ghosts) const {
  band<false>(exec, x.data(), y.data(), cells, ghosts);
}

template <class Real>
void FastOperator<Real>::add_groups(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y) const {
  groups(exec, x.data(), y.data(), Real(1));
}

template <class Real>
void FastOperator<Real>::diagonal_blocks(const ExecSpace& exec, const BlockView& blocks) const {
  NodeColumns<Real> none;
  none.column_of_node = IntView("cgcontact::fast_operator::no_columns", num_nodes_);
  Kokkos::deep_copy(none.column_of_node, -1);
  diagonal_blocks(exec, blocks, none);
}

template <class Real>
void FastOperator<Real>::diagonal_blocks(const ExecSpace& exec, const BlockView& blocks,
                                         const NodeColumns<Real>& columns) const {
  const auto cells = cells_;
  const auto ghosts = ghosts_;
  const auto by_stencil = by_stencil_;
  const auto diagonal = stencil_diagonal_;
  const auto first_node = body_first_node_;
  const int bodies = static_cast<int>(first_node.extent(0));
  Kokkos::parallel_for(
      "cgcontact::fast_operator::stencil_blocks", Kokkos::RangePolicy<ExecSpace>(exec, 0, num_nodes_),
      KOKKOS_LAMBDA(const int n) {
        int body = 0;
        while (body + 1 < bodies && first_node(body + 1) <= n) ++body;
        for (int p = 0; p < 6; ++p) blocks(n, p) = by_stencil(n) && p < 3 ? diagonal(body) : Real(0);
      });
  const auto next = stencil_next_;
  Kokkos::parallel_for(
      "cgcontact::fast_operator::stencil_columns", Kokkos::RangePolicy<ExecSpace>(exec, 0, columns.num_columns()),
      KOKKOS_LAMBDA(const int c) {
        const auto& column = columns.columns(c);
        for (int row = 0; row < column.size; ++row) {
          if (!by_stencil(columns.nodes(column.first + row))) continue;
          for (int slot = row - 1; slot <= row + 1; slot += 2)
            for (int i = 0; i < 3 && slot >= 0 && slot < column.size; ++i)
              columns.matrices(column.entry(dof_of(row, i), dof_of(slot, i))) += next(column.body, column.axis, i);
        }
      });
  for (int colour = 0; colour < 2; ++colour) {
    const IntView slabs = slabs_[colour];
    Kokkos::parallel_for(
        "cgcontact::fast_operator::band_blocks", one_by_one(exec, static_cast<int>(slabs.extent(0))),
        KOKKOS_LAMBDA(const int s) {
          band::add_diagonal_blocks(cells, slabs(s), blocks, columns);
          ghost::add_diagonal_blocks(ghosts, slabs(s), blocks, columns);
        });
  }
  gather_constrained_blocks(exec, blocks);
}

template <class Real>
void FastOperator<Real>::gather_constrained_blocks(const ExecSpace& exec, const BlockView& blocks) const {
  if (dofs_.halo()) {
    const IntView others = dofs_.halo()->others();
    Kokkos::parallel_for(
        "cgcontact::fast_operator::other_blocks", Kokkos::RangePolicy<ExecSpace>(exec, 0, others.extent(0)),
        KOKKOS_LAMBDA(const int n) {
          for (int p = 0; p < 6; ++p) blocks(others(n), p) = p < 3 ? Real(1) : Real(0);
        });
  }
  const AcrossNodesView across_nodes = dofs_.across_nodes();
  Kokkos::parallel_for(
      "cgcontact::fast_operator::across_node_blocks", Kokkos::RangePolicy<ExecSpace>(exec, 0, across_nodes.extent(0)),
      KOKKOS_LAMBDA(const int t) {
        for (int p = 0; p < 6; ++p) {
          blocks(across_nodes(t, 0), p) += blocks(across_nodes(t, 1), p);
          blocks(across_nodes(t, 1), p) = p < 3 ? Real(1) : Real(0);
        }
      });
  const ConstraintRows rows = dofs_.sums();
  if (rows.num_nodes() == 0) return;
  Kokkos::parallel_for(
      "cgcontact::fast_operator::gather_blocks", Kokkos::RangePolicy<ExecSpace>(exec, 0, rows.num_masters()),
      KOKKOS_LAMBDA(const int m) {
        for (int e = rows.master_begin(m); e < rows.master_begin(m + 1); ++e) {
          const Real weight = static_cast<Real>(rows.master_weight(e) * rows.master_weight(e));
          for (int p = 0; p < 6; ++p) blocks(rows.master_node(m), p) += weight * blocks(rows.constrained(e), p);
        }
      });
  Kokkos::parallel_for(
      "cgcontact::fast_operator::constrained_blocks", Kokkos::RangePolicy<ExecSpace>(exec, 0, rows.num_nodes()),
      KOKKOS_LAMBDA(const int c) {
        for (int p = 0; p < 6; ++p) blocks(rows.node(c), p) = p < 3 ? Real(1) : Real(0);
      });
}

template class FastOperator<double>;
template class FastOperator<float>;

}  // namespace cgcontact
