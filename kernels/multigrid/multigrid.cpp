#include "kernels/multigrid/multigrid.hpp"

#include <Eigen/Eigenvalues>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <array>

#include "core/base/numbers/decompositions.hpp"
#include "core/base/process/ranks.hpp"
#include "kernels/assembled/muelu.hpp"
#include "kernels/mesh/dot.hpp"
#include "kernels/mesh/launch.hpp"
#include "kernels/multigrid/coarsen.hpp"
#include "kernels/multigrid/rank_levels.hpp"
#include "kernels/multigrid/smoother.hpp"
#include "kernels/operator/fast_operator.hpp"

namespace cgcontact {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;
using Real = float;
using LevelVector = Kokkos::View<Real*, MemSpace>;

/// Steps of the Lanczos estimate of the largest eigenvalue, and its margin. In two dimensions 8 steps found 0.98 of it,
/// and 20 % too low took twice the iterations.
constexpr int lanczos_steps = 10;
constexpr double eigenvalue_margin = 1.1;
/// lambda / mu (nu = 0.495) beyond which factors of what can be factorised cost less than the iterations, which grow
/// like it: docs/decisions.md, "Linear solves".
constexpr double hard_to_smooth = 100;

/// One grid of the hierarchy; the finest refers to the solver's own system.
struct Level {
  std::vector<CutCells> cells;  // owned, coarse levels only
  ElasticSystem own_system;
  const ElasticSystem* whole = nullptr;   // of all ranks
  const ElasticSystem* system = nullptr;  // that this rank computes: its share, or the whole
  std::unique_ptr<RankShare> share;       // of several ranks; where `system` is the whole, vectors are passed by it
  std::unique_ptr<FastOperator<Real>> op;
  std::unique_ptr<SurfaceSmoother<Real>> smoother;
  Transfer transfer;             // to the next coarser level; of this rank
  RowCoarsening row_coarsening;  // of all ranks
  double largest_eigenvalue = 0;
  LevelVector b, x, r, d;
  LevelVector passed;             // where `system` is the whole: b or x in the numbers of the share
  std::vector<LevelVector> p, q;  // directions of CG on the level, and the operator applied to them

  bool is_worked_on = true;  // the others only pass vectors on
  int max_steps = 0;         // of flexible CG per visit; 0: a V-cycle

  bool is_shared() const { return system->dofs.halo() != nullptr; }
};

/// More than half of the coarse cells are cells of the fine grid as they are.
bool mostly_repeats(const ElasticSystem& fine, const ElasticSystem& coarse) {
  const CoarseCells cells(fine, coarse);
  const std::vector<const BodyMesh*> fine_levels = fine.level_meshes();
  std::size_t all = 0, repeated = 0;
  for (const BodyMesh* level : coarse.level_meshes()) all += level->cell_nodes.size();
  for (std::size_t p = 0; p < fine_levels.size(); ++p)
    for (std::size_t e = 0; e < fine_levels[p]->cell_nodes.size(); ++e)
      repeated += !cells.of(static_cast<int>(p), static_cast<int>(e)).larger;
  return 2 * repeated > all;
}

}  // namespace

struct Multigrid::Impl {
  const ElasticSystem& fine;
  bool by_ranks;  // whether the fine grids are divided among the ranks
  Halo::Comm comm;
  RCP<const TpetraMap> map, coarsest_map;
  MultigridSettings settings;
  mutable MultigridReport report;
  std::vector<std::unique_ptr<Level>> levels;
  RCP<TpetraOperator> coarsest;
  RCP<TpetraVector> coarsest_b, coarsest_x;
  std::vector<double> full_stiffness;   // contact groups closed, finest level
  std::vector<double> coarsest_groups;  // stiffness that `coarsest` was set up with
  ExecSpace exec;

  Impl(const ElasticSystem& system, const MultigridSettings& s)
      : fine(system),
        by_ranks(num_ranks() > 1 && system.num_dofs() > s.shared_unknowns && may_coarsen(system, s)),
        settings(s) {
    if (by_ranks || num_ranks() == 1)
      comm = Tpetra::getDefaultComm();
    else
      comm = comm_of_this_rank();
    build_levels();
    map = levels[0]->system->dofs.vector_map(comm);
    update_groups();
    for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
      if (levels[l]->is_worked_on) levels[l]->largest_eigenvalue = eigenvalue_margin * estimate_eigenvalue(*levels[l]);
      report.largest_eigenvalue.push_back(levels[l]->largest_eigenvalue);
    }
  }

  /// The smoother damps motions without dilatation slowly, of nearly incompressible bodies ever less: what can be is
  /// factorised.
  static bool may_coarsen(const ElasticSystem& system, const MultigridSettings& s) {
    const int bodies = static_cast<int>(system.meshes.size());
    const bool nearly_incompressible =
        std::any_of(system.meshes.begin(), system.meshes.end(),
                    [](const BodyMesh& mesh) { return !mesh.rigid && mesh.law.lambda > hard_to_smooth * mesh.law.mu; });
    const int enough = nearly_incompressible ? factorised_unknowns(system) : s.coarsest_unknowns;
    return system.num_dofs() > std::max(enough, s.coarsest_unknowns_per_body * bodies) &&
           std::any_of(system.meshes.begin(), system.meshes.end(),
                       [](const BodyMesh& mesh) { return !is_coarsest(*mesh.cut_cells); });
  }

  void build_levels() {
    build_grids();
    std::vector<NodeColumns<Real>> columns;
    for (const auto& level : levels) columns.push_back(make_node_columns<Real>(*level->whole));
    if (by_ranks) share_levels(columns);
    choose_grids();
    for (const auto& level : levels) report.unknowns.push_back(level->whole->num_dofs());
    report.cycles.assign(levels.size(), 0);
    // Coarse cells go once their operators are made, before the fine ones take most memory; the coarsest is assembled
    // repeatedly.
    for (std::size_t l = levels.size(); l-- > 0;) {
      Level& level = *levels[l];
      const int n = level.system->num_dofs();
      level.b = LevelVector("cgcontact::multigrid::b", n);
      level.x = LevelVector("cgcontact::multigrid::x", n);
      if (l + 1 == levels.size()) continue;
      level.r = LevelVector("cgcontact::multigrid::r", n);
      if (level.is_worked_on) make_smoother(level, columns[l]);
      if (l == 0) continue;
      cgcontact::drop_cells(level.cells, level.own_system);
      if (level.share) level.share->drop_cells();
    }
    const Halo::Comm alone = num_ranks() == 1 ? comm : comm_of_this_rank();
    coarsest_map = levels.back()->whole->dofs.vector_map(alone);
    coarsest_b = rcp(new TpetraVector(coarsest_map, 1));
    coarsest_x = rcp(new TpetraVector(coarsest_map, 1));
  }

  /// Bounds the work: each grid that is worked on may be visited `coarse_steps` times as often as the next finer one. A
  /// grid that mostly repeats those cells and would then cost more than the finest is passed by; in systems small
  /// enough to be factorised, where launching kernels costs more than their work, visited as often as the finer one.
  void choose_grids() {
    const double steps = std::max(settings.coarse_steps, 1), most = levels[0]->whole->num_dofs();
    double visits = steps;
    for (std::size_t l = 1; l + 1 < levels.size(); ++l) {
      Level& level = *levels[l];
      level.max_steps = settings.coarse_steps;
      if (visits * level.whole->num_dofs() <= most || !mostly_repeats(*levels[l - 1]->whole, *level.whole))
        visits *= steps;
      else if (most > factorised_unknowns(fine))
        level.is_worked_on = false;
      else
        level.max_steps = std::min(settings.coarse_steps, 1);
    }
  }

  /// Systems of all grids, and the transfers between them.
  void build_grids() {
    levels.push_back(std::make_unique<Level>());
    levels[0]->whole = levels[0]->system = &fine;
    while (may_coarsen(*levels.back()->whole, settings)) {
      Level& from = *levels.back();
      auto to = std::make_unique<Level>();
      for (const BodyMesh& mesh : from.whole->meshes) to->cells.push_back(next_cut_cells(*mesh.cut_cells));
      std::vector<const CutCells*> cells;
      std::vector<Material> materials;
      for (std::size_t b = 0; b < to->cells.size(); ++b) {
        cells.push_back(&to->cells[b]);
        materials.push_back(fine.materials[b]);
      }
      to->own_system = make_elastic_system(cells, materials, fine.scales, settings.coarse_ghost * fine.ghost_penalty);
      to->whole = to->system = &to->own_system;
      to->own_system.supports = coarse_supports(*from.whole, to->own_system, settings.firm_holds);
      from.transfer = make_transfer(*from.whole, *to->whole);
      const RowCoarsening* const before = levels.size() > 1 ? &levels[levels.size() - 2]->row_coarsening : nullptr;
      from.row_coarsening = RowCoarsening(*from.whole, *to->whole, from.transfer,
                                          before ? before->coarse_rows() : fine.group_rows, before);
      levels.push_back(std::move(to));
    }
  }

  /// The finest levels divided among the ranks, and the first one that every rank computes.
  void share_levels(const std::vector<NodeColumns<Real>>& columns) {
    std::vector<const ElasticSystem*> systems;
    std::vector<Transfer> transfers;
    for (const auto& level : levels) {
      systems.push_back(level->whole);
      if (level->whole->num_dofs() <= settings.shared_unknowns || level == levels.back()) break;
      transfers.push_back(level->transfer);
    }
    auto shares = make_shares(systems, transfers, columns, comm);
    for (std::size_t l = 0; l < shares.size(); ++l) {
      levels[l]->share = std::move(shares[l]);
      if (l > 0) levels[l - 1]->transfer = transfer_of_rank(transfers[l - 1], *levels[l - 1]->share, *levels[l]->share);
      if (l + 1 < shares.size())
        levels[l]->system = &levels[l]->share->system();
      else
        levels[l]->passed = LevelVector("cgcontact::multigrid::passed", levels[l]->share->system().num_dofs());
    }
  }

  void make_smoother(Level& level, const NodeColumns<Real>& whole_columns) {
    const ElasticSystem& system = *level.system;
    const int n = system.num_dofs();
    level.op = std::make_unique<FastOperator<Real>>(system);
    level.d = LevelVector("cgcontact::multigrid::d", n);
    for (int k = 0; k < level.max_steps && level.whole != &fine; ++k) {
      level.p.emplace_back("cgcontact::multigrid::p", n);
      level.q.emplace_back("cgcontact::multigrid::q", n);
    }
    NodeColumns<Real> columns = whole_columns;
    SupportRows supports = make_support_rows(*level.whole, whole_columns);
    if (level.is_shared()) {
      const RankShare& share = *level.share;
      columns = columns_of_rank(whole_columns, system.num_nodes,
                                [&](int node) { return share.owns(node) ? share.local(node) : -1; });
      supports.rows = share.own_entries(supports.rows);
      std::vector<std::pair<int, Mat3>> blocks;
      for (const auto& [node, block] : supports.blocks)
        if (share.owns(node)) blocks.emplace_back(share.local(node), block);
      supports.blocks = std::move(blocks);
    }
    FastOperator<Real>::BlockView blocks("cgcontact::multigrid::blocks", system.num_nodes);
    level.op->diagonal_blocks(exec, blocks, columns);
    level.smoother = std::make_unique<SurfaceSmoother<Real>>(system, blocks, columns, std::move(supports));
  }

  void update_groups() {
    RowCoarsening::Present present{group_stiffness(fine), fine.full_group_stiffness, {}};
    if (present.full_stiffness.empty()) present.full_stiffness.assign(present.stiffness.size(), 1.0);
    const bool first = coarsest.is_null();
    present.changed.assign(present.stiffness.size(), first);
    if (!first && !fine.changed_rows.empty()) present.changed = fine.changed_rows;
    for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
      Level& level = *levels[l];
      const bool same_rows = !first && !present.any_changed();
      if (level.is_worked_on) {
        if (level.is_shared()) level.share->set_groups(level.whole->group_rows, present.stiffness, same_rows);
        if (level.is_shared() && l == 0) level.share->take_coupling(fine);
        level.op->set_groups(*level.system);
        level.smoother->set_groups(level.system->group_rows, present.stiffness);
      }
      Level& next = *levels[l + 1];
      std::vector<GroupRow>& rows = next.own_system.group_rows;
      present = level.row_coarsening.update(level.whole->group_rows, present, next.own_system, rows);
      if (next.is_shared() || !next.is_worked_on) continue;  // the whole one is not computed with
      if (first || present.any_changed()) compress_group_rows(next.own_system);
      set_group_stiffness(next.own_system, present.stiffness);
    }
    const std::vector<double>& stiffness = present.stiffness;
    if (first || changed_much(coarsest_groups, stiffness)) {
      coarsest = make_muelu(*levels.back()->whole, coarsest_map);
      report.muelu_unknowns = muelu_levels(*coarsest);
      coarsest_groups = stiffness;
      ++report.coarsest_setups;
    }
  }

  /// Returns products of pairs of vectors, one of each zero at ghosts, by one sum over all ranks.
  template <std::size_t count>
  std::array<double, count> products(const Level& level,
                                     const std::array<std::pair<LevelVector, LevelVector>, count>& pairs) const {
    std::array<double, count> sums;
    for (std::size_t k = 0; k < count; ++k) sums[k] = dot(exec, pairs[k].first, pairs[k].second);
    if (level.is_shared()) sum_over_ranks(sums.data(), count);
    return sums;
  }
  double product(const Level& level, const LevelVector& x, const LevelVector& y) const {
    return products<1>(level, {{{x, y}}})[0];
  }

  /// Largest eigenvalue of M^-1 A from the Lanczos matrix of CG with a random right-hand side.
  double estimate_eigenvalue(Level& level) const {
    const int n = level.system->num_dofs();
    const LevelVector r = level.r, z = level.d, p = level.x, q = level.b;
    unsigned state = 12345;
    auto host = Kokkos::create_mirror_view(r);
    for (int i = 0, own = 0; own < n; ++i) {  // the same on any number of ranks
      state = 1664525u * state + 1013904223u;
      const int whole =
          level.is_shared() ? dof_of(level.share->whole_nodes()[node_of_dof(own)], component_of_dof(own)) : own;
      if (i == whole) host(own++) = static_cast<Real>(state / 4294967296.0 - 0.5);
    }
    Kokkos::deep_copy(r, host);
    apply_constraints_transposed(exec, level.system->dofs, r);
    std::vector<double> alpha, beta;
    double rz = 0;
    LevelVector ignored("cgcontact::multigrid::ignored", n);
    for (int k = 0; k < lanczos_steps; ++k) {
      level.smoother->step(exec, r, 1, 0, z, ignored, true);
      apply_constraints(exec, level.system->dofs, z);
      const double next = product(level, r, z);
      if (k > 0) beta.push_back(next / rz);
      const Real b = k > 0 ? static_cast<Real>(next / rz) : Real(0);
      rz = next;
      launch(
          "cgcontact::multigrid::direction", Kokkos::RangePolicy<ExecSpace>(exec, 0, n), grain_of_light,
          KOKKOS_LAMBDA(const int i) { p(i) = z(i) + (b != 0 ? b * p(i) : Real(0)); });
      level.op->apply(exec, p, q);
      alpha.push_back(rz / product(level, p, q));
      const Real a = static_cast<Real>(alpha.back());
      launch(
          "cgcontact::multigrid::residual", Kokkos::RangePolicy<ExecSpace>(exec, 0, n), grain_of_light,
          KOKKOS_LAMBDA(const int i) { r(i) -= a * q(i); });
    }
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(lanczos_steps, lanczos_steps);
    for (int k = 0; k < lanczos_steps; ++k) {
      T(k, k) = 1 / alpha[k] + (k > 0 ? beta[k - 1] / alpha[k - 1] : 0);
      if (k > 0) T(k, k - 1) = T(k - 1, k) = std::sqrt(beta[k - 1]) / alpha[k - 1];
    }
    return SymmetricEigen<Eigen::Dynamic>(T).eigenvalues()[lanczos_steps - 1];
  }

  /// Chebyshev iteration on the level; from zero if `start`.
  void smooth(const Level& level, bool start) const {
    const double upper = level.largest_eigenvalue, lower = upper / settings.smoother_ratio;
    const double centre = 0.5 * (upper + lower), half = 0.5 * (upper - lower), sigma = centre / half;
    double rho = 1 / sigma;
    for (int k = 0; k < settings.smoother_degree; ++k) {
      const bool from_b = start && k == 0;
      double alpha = 1 / centre, beta = 0;
      if (k > 0) {
        const double next = 1 / (2 * sigma - rho);
        alpha = 2 * next / half;
        beta = next * rho;
        rho = next;
      }
      const Real a = static_cast<Real>(alpha), b = static_cast<Real>(beta);
      if (from_b) {
        level.smoother->step(exec, level.b, a, b, level.d, level.x, true);
      } else {
        level.op->residual(exec, level.b, level.x, level.r);
        level.smoother->step(exec, level.r, a, b, level.d, level.x, false);
      }
      apply_constraints(exec, level.system->dofs, level.x);
    }
  }

  void solve_coarsest(const Level& level) const {
    const auto b = Kokkos::subview(coarsest_b->getLocalViewDevice(Tpetra::Access::OverwriteAll), Kokkos::ALL, 0);
    Kokkos::deep_copy(exec, b, level.b);
    exec.fence();
    coarsest->apply(*coarsest_b, *coarsest_x);
    const auto x = Kokkos::subview(coarsest_x->getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
    Kokkos::deep_copy(exec, level.x, x);
    apply_constraints(exec, level.system->dofs, level.x);
  }

  /// y += a x.
  void add(double a, const LevelVector& x, const LevelVector& y) const {
    const Real factor = static_cast<Real>(a);
    launch(
        "cgcontact::multigrid::add", Kokkos::RangePolicy<ExecSpace>(exec, 0, static_cast<int>(x.extent(0))),
        grain_of_light, KOKKOS_LAMBDA(const int i) { y(i) += factor * x(i); });
  }

  /// Computes an approximate solution x for b on a coarse level: flexible CG, preconditioned by the cycle from there
  /// on; overwrites b. The residual's norm follows from that before the step: one sum over all ranks serves all
  /// products.
  void solve_coarse(std::size_t l) const {
    const Level& level = *levels[l];
    if (l + 1 == levels.size() || level.max_steps == 0 || !level.is_worked_on) return cycle(l);
    double enough = 0;
    std::vector<double> step, energy;
    for (int k = 0; k < level.max_steps; ++k) {
      cycle(l);
      for (int j = 0; j < k; ++j) add(-product(level, level.x, level.q[j]) / energy[j], level.p[j], level.x);
      Kokkos::deep_copy(exec, level.p[k], level.x);
      const LevelVector &p = level.p[k], &q = level.q[k], &b = level.b;
      level.op->apply(exec, p, q);
      const auto [pq, pb, bb, bq, qq] = products<5>(level, {{{p, q}, {p, b}, {b, b}, {b, q}, {q, q}}});
      if (k == 0) enough = std::pow(settings.coarse_residual, 2) * bb;
      energy.push_back(pq);
      if (!(pq > 0)) break;  // b is zero to rounding
      step.push_back(pb / pq);
      if (k + 1 == level.max_steps || bb + step[k] * (step[k] * qq - 2 * bq) <= enough) break;
      add(-step[k], q, b);
    }
    Kokkos::deep_copy(exec, level.x, Real(0));
    for (std::size_t k = 0; k < step.size(); ++k) add(step[k], level.p[k], level.x);
  }

  void cycle(std::size_t l) const {
    const Level& level = *levels[l];
    report.cycles[l] += level.is_worked_on;
    if (l + 1 == levels.size()) return solve_coarsest(level);
    const Level& next = *levels[l + 1];
    if (level.is_worked_on) {
      smooth(level, true);
      level.op->residual(exec, level.b, level.x, level.r);
    } else {
      Kokkos::deep_copy(exec, level.x, Real(0));
      Kokkos::deep_copy(exec, level.r, level.b);
    }
    if (level.is_shared()) level.system->dofs.halo()->import_ghosts(level.r.data());
    const bool passes = level.is_shared() && !next.is_shared();  // from the next level on every rank has all
    const DofMap& next_dofs = (passes ? next.share->system() : *next.system).dofs;
    restrict_to(exec, level.transfer, next_dofs, level.r, passes ? next.passed : next.b);
    if (passes) next.share->to_whole(next.passed, next.b);
    solve_coarse(l + 1);
    if (passes) next.share->to_local(next.x, next.passed);
    prolongate_add(exec, level.transfer, level.system->dofs, passes ? next.passed : next.x, level.x);
    if (level.is_worked_on) smooth(level, false);
  }
};

Multigrid::Multigrid(const ElasticSystem& system, const MultigridSettings& settings)
    : impl_(std::make_unique<Impl>(system, settings)) {}
Multigrid::~Multigrid() = default;
void Multigrid::update_groups() { impl_->update_groups(); }
bool Multigrid::is_single_grid() const { return impl_->levels.size() == 1; }
const MultigridReport& Multigrid::report() const { return impl_->report; }
void Multigrid::drop_cells() {
  if (impl_->by_ranks) impl_->levels[0]->share->drop_cells();
}
const RankShare* Multigrid::share() const { return impl_->by_ranks ? impl_->levels[0]->share.get() : nullptr; }
RCP<const TpetraMap> Multigrid::getDomainMap() const { return impl_->map; }
RCP<const TpetraMap> Multigrid::getRangeMap() const { return impl_->map; }

void Multigrid::apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp, double, double) const {
  const ExecSpace exec = impl_->exec;
  const auto r = Kokkos::subview(X.getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
  const auto z = Kokkos::subview(Y.getLocalViewDevice(Tpetra::Access::OverwriteAll), Kokkos::ALL, 0);
  const Level& level = *impl_->levels[0];
  const int n = level.system->num_dofs();
  // Single precision has a short range: the residual comes in with a largest entry of 1.
  double largest = 0;
  Kokkos::parallel_reduce(
      "cgcontact::multigrid::largest", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
      KOKKOS_LAMBDA(const int i, double& m) { m = std::max(m, std::abs(r(i))); }, Kokkos::Max<double>(largest));
  if (level.is_shared()) largest = largest_over_ranks(largest);
  const double scale = largest > 0 ? largest : 1.0;
  const auto b = level.b, x = level.x;
  launch(
      "cgcontact::multigrid::in", Kokkos::RangePolicy<ExecSpace>(exec, 0, n), grain_of_light,
      KOKKOS_LAMBDA(const int i) { b(i) = static_cast<Real>(r(i) / scale); });
  impl_->cycle(0);
  launch(
      "cgcontact::multigrid::out", Kokkos::RangePolicy<ExecSpace>(exec, 0, n), grain_of_light,
      KOKKOS_LAMBDA(const int i) { z(i) = scale * x(i); });
  apply_constraints(exec, level.system->dofs, z);  // again, to the precision of CG
  exec.fence();
}

}  // namespace cgcontact
