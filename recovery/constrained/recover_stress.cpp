#include "recovery/constrained/recover_stress.hpp"

#include <algorithm>
#include <tuple>

#include "core/base/packing.hpp"
#include "core/base/parallel.hpp"
#include "core/base/ranks.hpp"
#include "recovery/batched/batched_fit.hpp"
#include "recovery/constrained/force_balance.hpp"
#include "recovery/constrained/interior_patches.hpp"
#include "recovery/constrained/patch_assembly.hpp"

namespace cgcontact {
namespace {

/// Patches that are assembled and solved at a time: enough to fill the lanes of the batched fits whatever kinds they
/// come in, and some 15 MB where all are coupled and of degree 2.
constexpr std::size_t patches_per_part = 1024;

using Host = Kokkos::DefaultHostExecutionSpace;

/// Corrects the interior patches of a body's field; returns the nodes of the others.
std::vector<int> recover_interior(const PatchAssembly& assembly, const RecoveryOptions& options) {
  const RecoveryBody& body = assembly.body();
  const Subset& nodes = body.field.nodes;
  const std::size_t num_nodes = nodes.size();
  std::vector<char> interior(num_nodes, 0);
  if (options.degree.interior == 1) {
    std::vector<char> in_contact(body.mesh->cell_nodes.size());
    for (std::size_t c = 0; c < in_contact.size(); ++c)
      in_contact[c] = !body.boundary->links_of_cell[static_cast<int>(c)].empty();
    Kokkos::View<double* [3], Kokkos::LayoutRight, Kokkos::HostSpace> divergence;
    if (body.boundary->body_force_at) {
      divergence = decltype(divergence)("cgcontact::recover_stress::divergence", num_nodes);
      parallel_for("cgcontact::recover_stress::divergence", num_nodes, grain_of_light, [&](std::size_t row) {
        const int node = nodes.number(static_cast<int>(row));
        if (!body.patches->full[node]) return;
        const Vec3 value = assembly.divergence(body, body.mesh->node_position(node), unit_of(*body.mesh, node));
        for (int i = 0; i < 3; ++i) divergence(row, i) = value[i];
      });
    }
    const Host exec;
    using Marks = Kokkos::View<char*, Kokkos::HostSpace>;
    correct_interior(exec, host_arrays(*body.mesh, *body.patches), host_arrays(nodes),
                     Marks(in_contact.data(), in_contact.size()), divergence, body.field.values,
                     Marks(interior.data(), num_nodes));
    exec.fence();
  }
  std::vector<int> others;
  for (std::size_t row = 0; row < num_nodes; ++row)
    if (const int node = nodes.number(static_cast<int>(row)); !interior[row] && body.mesh->is_free(node))
      others.push_back(node);
  return others;
}

/// Residual of normalised rows over the stress level of the patch below which all rows are met.
constexpr double met = 1e-12;

/// The same of the firm rows when they are enforced alone.
constexpr double held = 1e-8;

/// Of the rank tolerance, in patches coupled by bonded faces: three rows per point instead of the five of contact, and
/// the truncation takes more of what matters (docs/recovery.md, "Truncation").
constexpr double bonded_tolerance = 0.5;

/// What the misfit of the auxiliary body weighs: inverse variances, as in any least squares of data of unequal quality.
/// A body whose stress the polynomials follow well is not spoilt by one whose stress they do not (docs/recovery.md).
double auxiliary_weight(const PatchFit& own, const PatchFit& other, double most_weight) {
  if (!(own.variance > 0 && other.variance > 0)) return 1;
  return std::clamp(own.variance / other.variance, 1 / most_weight, most_weight);
}

/// Some patches of a body: assembled side by side, then solved in batches by degree and number of bodies.
class PatchBatch {
 public:
  PatchBatch(const PatchAssembly& assembly, const RecoveryOptions& options) : assembly_(assembly), options_(options) {}

  void assemble(const int* nodes, std::size_t count) {
    problems_.clear();  // new ones where they lie: they are 4 kB each
    problems_.resize(count);
    rows_.resize(num_chunks(count, grain_of_heavy));
    parallel_chunks("cgcontact::recover_stress::assemble", count, grain_of_heavy,
                    [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      static thread_local PatchWorkspace workspace;
                      rows_[chunk].clear();
                      for (std::size_t i = begin; i < end; ++i)
                        assembly_.assemble(nodes[i], workspace, rows_[chunk], problems_[i]);
                    });
  }
  void solve() {
    truncated_rows_ = 0;
    solve_all<1, 1>(false);
    solve_all<1, 2>(false);
    solve_all<1, 2>(true);
    solve_all<2, 1>(false);
    solve_all<2, 2>(false);
    solve_all<2, 2>(true);
    hold_firm_rows<1>();
    hold_firm_rows<2>();
  }
  const std::vector<PatchProblem>& problems() const { return problems_; }
  long long truncated_rows() const { return truncated_rows_; }

 private:
  template <class T>
  using HostView = Kokkos::View<T*, Kokkos::HostSpace>;

  const PatchRow* rows_of(std::size_t i) const { return rows_[i / grain_of_heavy].data() + problems_[i].first_row; }

  template <int degree, int bodies>
  void fill(const PatchProblem& problem, FitInput<degree, bodies>& input) const {
    using P = Polynomial<degree>;
    const int body[2] = {assembly_.index(), problem.other_body};
    for (int b = 0; b < bodies; ++b) {
      const PatchFit& fit = problem.fit[b];
      const double weight = b == 1 && options_.inverse_variance
                                ? auxiliary_weight(problem.fit[0], problem.fit[1], options_.most_weight)
                                : 1.0;
      for (int i = 0, entry = 0; i < P::num_terms; ++i)
        for (int j = 0; j <= i; ++j) input.mass[b][entry++] = weight * fit.mass(i, j);
      std::copy_n(fit.a.data(), 6 * P::num_terms, input.a[b][0]);
      std::copy_n(problem.interior[b].data(), P::num_interior, input.interior[b]);
      input.poisson_ratio[b] = assembly_.body_of(body[b]).mesh->poisson_ratio();
    }
  }

  template <int bodies>
  static void copy_row(const PatchRow& from, FitRow<bodies>& to) {
    for (int b = 0; b < bodies; ++b) {
      std::copy_n(from.weight[b], 6, to.weight[b]);
      std::copy_n(from.place[b], 3, to.place[b]);
    }
    to.value = from.value;
  }

  /// A view of at least that size, kept from list to list.
  template <class T>
  static void reserve(HostView<T>& view, const char* label, std::size_t size) {
    if (view.extent(0) < size)
      view = HostView<T>(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), size + size / 4);
  }

  /// Solves the patches numbered in list_ with those of their rows that `use` selects.
  template <int degree, int bodies, class Use>
  void solve_list(const Use& use, double rank_tolerance) {
    if (list_.empty()) return;
    const std::size_t size = list_.size();
    HostView<FitInput<degree, bodies>>& inputs = std::get<HostView<FitInput<degree, bodies>>>(inputs_);
    HostView<FitRow<bodies>>& rows = std::get<HostView<FitRow<bodies>>>(fit_rows_);
    reserve(inputs, "cgcontact::recover_stress::inputs", size);
    reserve(status_, "cgcontact::recover_stress::status", size);
    row_begin_.assign(size + 1, 0);
    for (std::size_t i = 0; i < size; ++i) {
      const PatchRow* const from = rows_of(list_[i]);
      row_begin_[i + 1] = row_begin_[i] + std::count_if(from, from + problems_[list_[i]].num_rows, use);
    }
    reserve(rows, "cgcontact::recover_stress::rows", row_begin_[size]);
    parallel_for("cgcontact::recover_stress::fill", size, grain_of_heavy, [&](std::size_t i) {
      const PatchProblem& problem = problems_[list_[i]];
      fill(problem, inputs(i));
      FitRow<bodies>* to = rows.data() + row_begin_[i];
      inputs(i).rows = to;
      inputs(i).num_rows = static_cast<int>(row_begin_[i + 1] - row_begin_[i]);
      const PatchRow* const from = rows_of(list_[i]);
      for (int r = 0; r < problem.num_rows; ++r)
        if (use(from[r])) copy_row(from[r], *to++);
    });
    fit_batch(Host(), inputs.data(), static_cast<int>(size), rank_tolerance, status_.data());
    parallel_for("cgcontact::recover_stress::take", size, grain_of_heavy, [&](std::size_t i) {
      std::copy_n(inputs(i).a[0][0], 6 * Polynomial<degree>::num_terms, problems_[list_[i]].fit[0].a.data());
    });
  }

  template <int degree, int bodies>
  void solve_all(bool bonded) {
    list_.clear();
    for (std::size_t i = 0; i < problems_.size(); ++i)
      if (problems_[i].status != PatchStatus::singular && problems_[i].coupled == (bodies == 2) &&
          problems_[i].bonded == bonded && problems_[i].degree() == degree)
        list_.push_back(static_cast<int>(i));
    solve_list<degree, bodies>([](const PatchRow&) { return true; },
                               (bonded ? bonded_tolerance : 1) * options_.rank_tolerance_of(degree));
    for (std::size_t i = 0; i < list_.size(); ++i) {
      PatchProblem& problem = problems_[list_[i]];
      const FitStatus& status = status_(i);
      const auto at_least = [&](PatchStatus least) { problem.status = std::max(problem.status, least); };
      if (status.truncated > 0) at_least(PatchStatus::truncated);
      if (status.residual > options_.conflict) at_least(PatchStatus::conflicting);
      if (!status.finite) at_least(PatchStatus::singular);
      problem.loose = status.residual > met;
      truncated_rows_ += status.truncated;
    }
  }

  /// Where contact is open the pressure is exactly zero: conflicting data elsewhere in the patch (a load on a face that
  /// meets the contact face at an edge) must not leak into it through the least-squares solution.
  template <int degree>
  void hold_firm_rows() {
    const auto is_firm = [](const PatchRow& row) { return row.firm; };
    list_.clear();
    for (std::size_t i = 0; i < problems_.size(); ++i) {
      const PatchProblem& problem = problems_[i];
      if (problem.loose && problem.degree() == degree &&
          std::any_of(rows_of(i), rows_of(i) + problem.num_rows, is_firm))
        list_.push_back(static_cast<int>(i));
    }
    solve_list<degree, 1>(is_firm, options_.firm_tolerance);
    for (std::size_t i = 0; i < list_.size(); ++i)
      if (status_(i).residual > held) {
        PatchStatus& status = problems_[list_[i]].status;
        status = std::max(status, PatchStatus::conflicting);
      }
  }

  const PatchAssembly& assembly_;
  const RecoveryOptions& options_;
  std::vector<PatchProblem> problems_;
  std::vector<std::vector<PatchRow>> rows_;  ///< of each chunk of patches
  std::tuple<HostView<FitInput<1, 1>>, HostView<FitInput<1, 2>>, HostView<FitInput<2, 1>>, HostView<FitInput<2, 2>>>
      inputs_;
  std::tuple<HostView<FitRow<1>>, HostView<FitRow<2>>> fit_rows_;
  HostView<FitStatus> status_;
  std::vector<std::size_t> row_begin_;
  std::vector<int> list_;
  long long truncated_rows_ = 0;
};

/// Solves the patches of these nodes; keep(problem) for each, in the order of the nodes. Returns the rows truncated.
template <class Keep>
long long solve_all_patches(const PatchAssembly& assembly, const RecoveryOptions& options,
                            const std::vector<int>& nodes, std::size_t per_part, const Keep& keep) {
  long long truncated = 0;
  PatchBatch batch(assembly, options);
  for (std::size_t begin = 0; begin < nodes.size(); begin += per_part) {
    batch.assemble(&nodes[begin], std::min(per_part, nodes.size() - begin));
    batch.solve();
    truncated += batch.truncated_rows();
    for (const PatchProblem& problem : batch.problems()) keep(problem);
  }
  return truncated;
}

/// The same on several ranks: each solves every so many groups of neighbouring patches, and all take over what all have
/// found. The edge of a contact zone in a patch, of which there are few, every rank finds again.
template <class Keep>
long long share_all_patches(const PatchAssembly& assembly, const RecoveryOptions& options,
                            const std::vector<int>& nodes, const Keep& keep) {
  constexpr std::size_t group = 64;
  const auto ranks = static_cast<std::size_t>(num_ranks());
  const auto each_of_rank = [&](std::size_t rank, const auto& use) {
    for (std::size_t begin = rank * group; begin < nodes.size(); begin += ranks * group)
      for (std::size_t i = begin; i < std::min(begin + group, nodes.size()); ++i) use(i);
  };
  std::vector<int> own_nodes;
  each_of_rank(this_rank(), [&](std::size_t i) { own_nodes.push_back(nodes[i]); });
  Packing own;
  auto truncated = static_cast<double>(
      solve_all_patches(assembly, options, own_nodes, patches_per_part, [&](const PatchProblem& problem) {
        Packing record;
        record.put(problem.pressed);
        record.put(problem.known);
        record.put(problem.open_sides);
        record.put(std::array<int, 3>{problem.has_edge, problem.lowered, problem.fit[0].degree});
        record.put(problem.factor);
        record.put(problem.kind);
        record.put(problem.status);
        record.put(std::vector<double>(problem.fit[0].a.data(), problem.fit[0].a.data() + 6 * problem.fit[0].terms()));
        own.put(record.bytes());
      }));
  sum_over_ranks(&truncated, 1);
  const std::vector<char> bytes = gather_bytes(own.bytes().data(), own.bytes().size());
  Unpacking all(bytes);
  std::vector<std::vector<char>> records(nodes.size());
  for (std::size_t rank = 0; rank < ranks; ++rank) each_of_rank(rank, [&](std::size_t i) { all.take(records[i]); });
  PatchWorkspace workspace;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    PatchProblem problem;
    std::array<int, 3> marks{};
    std::vector<double> coefficients;
    Unpacking record(records[i]);
    record.take(problem.pressed);
    record.take(problem.known);
    record.take(problem.open_sides);
    record.take(marks);
    record.take(problem.factor);
    record.take(problem.kind);
    record.take(problem.status);
    record.take(coefficients);
    problem.node = nodes[i];
    problem.lowered = marks[1] != 0;
    problem.fit[0].degree = marks[2];
    problem.fit[0].a =
        Eigen::Map<const Eigen::VectorXd>(coefficients.data(), static_cast<Eigen::Index>(coefficients.size()));
    if (marks[0]) {
      PatchProblem again;
      std::vector<PatchRow> rows;
      assembly.assemble(nodes[i], workspace, rows, again);
      problem.has_edge = true;
      problem.edge = again.edge;
    }
    keep(problem);
  }
  return static_cast<long long>(truncated);
}

/// Takes over what a solved patch has become.
void store(const PatchProblem& problem, const RecoveryBody& body, PatchStates& states, ConstrainedRecovery& recovery,
           EdgeTerms& terms, QuadraticTerms& quadratic) {
  const int n = problem.node;
  for (const int pair : problem.pressed) states.pressed.emplace_back(n, pair);
  for (const int pair : problem.known) states.known.emplace_back(n, pair);
  std::vector<int> open_sides = problem.open_sides;
  std::sort(open_sides.begin(), open_sides.end());
  for (const int surface : open_sides) states.open_sides.emplace_back(n, surface);
  if (problem.has_edge) {
    if (terms.row_of_node.empty()) terms.row_of_node.assign(states.kind.size(), -1);
    terms.row_of_node[n] = static_cast<int>(terms.terms.size());
    terms.terms.push_back({problem.edge, problem.factor});
  }
  recovery.counts.grown += body.patches->grown[n];
  recovery.counts.lowered += problem.lowered;
  states.kind[n] = problem.kind;
  states.status[n] = problem.status;
  if (problem.status == PatchStatus::singular) return;
  const PatchFit& fit = problem.fit[0];
  const int num = fit.terms();
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < num_terms; ++t) body.field.values(body.field.nodes.row(n), k, t) = fit.a[num * k + t];
  if (fit.degree == 1) return;
  if (quadratic.row_of_node.empty()) quadratic.row_of_node.assign(states.kind.size(), -1);
  quadratic.row_of_node[n] = static_cast<int>(quadratic.values.size());
  QuadraticTerms::Values& values = quadratic.values.emplace_back();
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < QuadraticTerms::count; ++t) values[k][t] = fit.a[num * k + num_terms + t];
  ++recovery.counts.quadratic;
}

/// Constrained nodes take over what their masters have.
void set_constrained_nodes(const RecoveryBody& body, PatchStates& states, QuadraticTerms& quadratic) {
  set_constrained_nodes(*body.mesh, body.field, &quadratic);
  for (std::size_t n = 0; n < states.kind.size(); ++n)
    each_master(*body.mesh, static_cast<int>(n), [&](int master, double) {
      states.kind[n] = std::max(states.kind[n], states.kind[master]);
      states.status[n] = std::max(states.status[n], states.status[master]);
    });
}

/// The patches of all bodies one by one, before the forces are balanced.
ConstrainedRecovery recover_patches(const std::vector<RecoveryBody>& bodies, const HostVector& u, const Scales& scales,
                                    const RecoveryOptions& options, const KnownPressures* known) {
  ConstrainedRecovery recovery;
  std::vector<StressIntegrals> integrals;
  std::vector<std::vector<PatchPolynomial>> polynomials;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RecoveryBody& body = bodies[b];
    const CellStress stress = body.stress ? body.stress : stress_of_displacements(*body.mesh, u);
    polynomials.push_back(patch_polynomials(bodies, b, known, options));
    integrals.push_back(integrate_stress(body, polynomials.back(), stress, options));
  }
  std::vector<PatchAssembly> assemblies;
  assemblies.reserve(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    assemblies.emplace_back(bodies, integrals, polynomials, static_cast<int>(b), scales, options, known);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PatchAssembly& assembly = assemblies[b];
    const std::size_t num_nodes = bodies[b].mesh->num_nodes;
    PatchStates states{std::vector<PatchKind>(num_nodes), std::vector<PatchStatus>(num_nodes), {}, {}, {}};
    std::vector<int> others;
    if (!bodies[b].mesh->rigid) others = recover_interior(assembly, options);
    EdgeTerms terms;
    QuadraticTerms quadratic_terms;
    const auto keep = [&](const PatchProblem& problem) {
      store(problem, bodies[b], states, recovery, terms, quadratic_terms);
    };
    recovery.counts.truncated_rows += num_ranks() == 1
                                          ? solve_all_patches(assembly, options, others, patches_per_part, keep)
                                          : share_all_patches(assembly, options, others, keep);
    set_constrained_nodes(bodies[b], states, quadratic_terms);
    recovery.states.push_back(std::move(states));
    recovery.edges.push_back(std::move(terms));
    recovery.quadratic.push_back(std::move(quadratic_terms));
  }
  return recovery;
}

/// A body's field with its terms; refers to `recovery`.
RecoveredField field_of(const RecoveryBody& body, const ConstrainedRecovery& recovery, std::size_t index) {
  RecoveredField field = body.field;
  if (!recovery.edges[index].terms.empty()) field.edge = {std::shared_ptr<void>(), &recovery.edges[index]};
  if (!recovery.quadratic[index].values.empty())
    field.quadratic = {std::shared_ptr<void>(), &recovery.quadratic[index]};
  return field;
}

}  // namespace

ConstrainedRecovery recover_constrained(const std::vector<RecoveryBody>& bodies, const RealView& u,
                                        const Scales& scales, const RecoveryOptions& options,
                                        const KnownPressures* known) {
  std::vector<std::vector<double>> plain;  // before the polynomials are replaced
  for (const RecoveryBody& body : bodies) plain.push_back(contact_pressures(body, body.field));
  const HostVector host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u);
  ConstrainedRecovery recovery = recover_patches(bodies, host, scales, options, known);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PatchStates& states = recovery.states[b];
    if (bodies[b].mesh->rigid) continue;
    balance_forces(bodies, b, field_of(bodies[b], recovery, b), plain[b], scales, options.balance, states);
    set_constrained_nodes(bodies[b], states, recovery.quadratic[b]);
    for (std::size_t n = 0; n < states.kind.size(); ++n) {
      if (!bodies[b].mesh->is_free(static_cast<int>(n))) continue;
      ++recovery.counts.kinds[static_cast<int>(states.kind[n])];
      ++recovery.counts.statuses[static_cast<int>(states.status[n])];
    }
  }
  return recovery;
}

}  // namespace cgcontact
