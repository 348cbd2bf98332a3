#include "recovery/constrained/recover_stress.hpp"

#include <algorithm>
#include <tuple>

#include "core/base/parallel.hpp"
#include "recovery/batched/batched_fit.hpp"
#include "recovery/constrained/force_balance.hpp"
#include "recovery/constrained/patch_assembly.hpp"
#include "recovery/zone_edge/edge_search.hpp"

namespace cgcontact {
namespace {

/// Patches per chunk of the parallel loops.
constexpr std::size_t grain = 128, interior_grain = 4096;

/// The mass matrix of a full patch is diagonal and the same for all slopes: each row of the equilibrium is corrected on
/// its own, its three terms alike.
void recover_interior(const PatchAssembly& assembly, int n) {
  constexpr int term[3][3] = {{1, 14, 23}, {13, 6, 19}, {21, 18, 11}};  // slope along j of component (i, j)
  const RecoveryBody& body = assembly.body();
  const Index3& node = body.mesh->nodes[n];
  const Vec3 value = assembly.divergence(body, Vec3(node[0], node[1], node[2]));
  double* a = &body.field.values(n, 0, 0);
  for (int i = 0; i < 3; ++i) {
    const int* t = term[i];
    const double correction = (value[i] - (a[t[0]] + a[t[1]] + a[t[2]])) / 3;
    for (int j = 0; j < 3; ++j) a[t[j]] += correction;
  }
}

/// Residual of normalised rows over the stress level of the patch above which the data contradict each other.
constexpr double conflict = 0.01;
/// The same below which all rows are met.
constexpr double met = 1e-12;

/// The same of the firm rows when they are enforced alone.
constexpr double held = 1e-8;

/// Rank tolerance of the firm rows alone: they agree with each other.
constexpr double firm_tolerance = 1e-3;

/// Of the forces around the edges of a contact zone, smoothed over some cells, that the pressure may miss in size or
/// place. Where it misses more the edges are not where they were found, or the pressure there does not end like a
/// square root: it is recovered without (docs/recovery.md, "Transmitted forces").
constexpr double largest_misfit = 0.04;

/// How much more one body's misfit may count than the other's in a coupled patch.
constexpr double most_weight = 1e4;

/// What the misfit of the auxiliary body weighs: inverse variances, as in any least squares of data of unequal quality.
/// A body whose stress the polynomials follow well is not spoilt by one whose stress they do not (docs/recovery.md).
double auxiliary_weight(const PatchFit& own, const PatchFit& other) {
  if (!(own.variance > 0 && other.variance > 0)) return 1;
  return std::clamp(own.variance / other.variance, 1 / most_weight, most_weight);
}

/// Rows of most patches of degree 2 with contact, for the memory of a batch.
constexpr std::size_t usual_rows = 36;

/// Patches of one chunk: assembled one by one, solved in batches by degree and number of bodies.
class PatchBatch {
 public:
  PatchBatch(const PatchAssembly& assembly, const EdgeMap* edges, const RecoveryOptions& options, std::size_t patches)
      : assembly_(assembly), edges_(edges), options_(options) {
    problems_.reserve(patches);
    rows_.reserve(patches * usual_rows);
  }

  void add(int node) { assembly_.assemble(node, edges_, workspace_, rows_, problems_.emplace_back()); }
  void solve() {
    solve_all<1, 1>();
    solve_all<1, 2>();
    solve_all<2, 1>();
    solve_all<2, 2>();
    hold_firm_rows<1>();
    hold_firm_rows<2>();
  }
  const std::vector<PatchProblem>& problems() const { return problems_; }
  long long truncated_rows() const { return truncated_rows_; }

 private:
  template <int degree, int bodies>
  void fill(const PatchProblem& problem, FitInput<degree, bodies>& input) const {
    using P = Polynomial<degree>;
    const int body[2] = {assembly_.index(), problem.other_body};
    for (int b = 0; b < bodies; ++b) {
      const PatchFit& fit = problem.fit[b];
      const double weight = b == 1 ? auxiliary_weight(problem.fit[0], problem.fit[1]) : 1.0;
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

  /// Solves the patches numbered in `list` with those of their rows that `use` selects.
  template <int degree, int bodies, class Use>
  void solve_list(const std::vector<int>& list, const Use& use, double rank_tolerance, std::vector<FitStatus>& status) {
    std::vector<FitInput<degree, bodies>>& inputs = std::get<std::vector<FitInput<degree, bodies>>>(inputs_);
    std::vector<FitRow<bodies>>& rows = std::get<std::vector<FitRow<bodies>>>(fit_rows_);
    rows.clear();
    inputs.resize(list.size());
    status.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const PatchProblem& problem = problems_[list[i]];
      fill(problem, inputs[i]);
      inputs[i].num_rows = 0;
      for (int r = 0; r < problem.num_rows; ++r) {
        const PatchRow& row = rows_[problem.first_row + r];
        if (!use(row)) continue;
        rows.emplace_back();
        copy_row(row, rows.back());
        ++inputs[i].num_rows;
      }
    }
    const FitRow<bodies>* next = rows.data();
    for (auto& input : inputs) input.rows = next, next += input.num_rows;
    fit_patches(inputs.data(), static_cast<int>(inputs.size()), rank_tolerance, status.data());
    for (std::size_t i = 0; i < list.size(); ++i)
      std::copy_n(inputs[i].a[0][0], 6 * Polynomial<degree>::num_terms, problems_[list[i]].fit[0].a.data());
  }

  template <int degree, int bodies>
  void solve_all() {
    list_.clear();
    for (std::size_t i = 0; i < problems_.size(); ++i)
      if (problems_[i].status != PatchStatus::singular && problems_[i].coupled == (bodies == 2) &&
          problems_[i].degree() == degree)
        list_.push_back(static_cast<int>(i));
    solve_list<degree, bodies>(
        list_, [](const PatchRow&) { return true; }, options_.rank_tolerance_of(degree), status_);
    for (std::size_t i = 0; i < list_.size(); ++i) {
      PatchProblem& problem = problems_[list_[i]];
      const auto at_least = [&](PatchStatus status) { problem.status = std::max(problem.status, status); };
      if (status_[i].truncated > 0) at_least(PatchStatus::truncated);
      if (status_[i].residual > conflict) at_least(PatchStatus::conflicting);
      if (!status_[i].finite) at_least(PatchStatus::singular);
      problem.loose = status_[i].residual > met;
      truncated_rows_ += status_[i].truncated;
    }
  }

  /// Where contact is open the pressure is exactly zero: conflicting data elsewhere in the patch (a load on a face that
  /// meets the contact face at an edge) must not leak into it through the least-squares solution.
  template <int degree>
  void hold_firm_rows() {
    list_.clear();
    for (std::size_t i = 0; i < problems_.size(); ++i) {
      const PatchProblem& problem = problems_[i];
      if (!problem.loose || problem.degree() != degree) continue;
      const auto first = rows_.begin() + static_cast<std::ptrdiff_t>(problem.first_row);
      if (std::any_of(first, first + problem.num_rows, [](const PatchRow& row) { return row.firm; }))
        list_.push_back(static_cast<int>(i));
    }
    solve_list<degree, 1>(
        list_, [](const PatchRow& row) { return row.firm; }, firm_tolerance, status_);
    for (std::size_t i = 0; i < list_.size(); ++i)
      if (status_[i].residual > held) {
        PatchStatus& status = problems_[list_[i]].status;
        status = std::max(status, PatchStatus::conflicting);
      }
  }

  const PatchAssembly& assembly_;
  const EdgeMap* edges_;
  const RecoveryOptions& options_;
  PatchWorkspace workspace_;
  std::vector<PatchProblem> problems_;
  std::vector<PatchRow> rows_;
  std::tuple<std::vector<FitInput<1, 1>>, std::vector<FitInput<1, 2>>, std::vector<FitInput<2, 1>>,
             std::vector<FitInput<2, 2>>>
      inputs_;
  std::tuple<std::vector<FitRow<1>>, std::vector<FitRow<2>>> fit_rows_;
  std::vector<FitStatus> status_;
  std::vector<int> list_;
  long long truncated_rows_ = 0;
};

/// What one chunk of patches leaves behind.
struct ChunkResult {
  RecoveryCounts counts;
  std::vector<std::pair<int, EdgeTerms::Term>> terms;             ///< node, term
  std::vector<std::pair<int, QuadraticTerms::Values>> quadratic;  ///< node, coefficients
  std::vector<std::pair<int, int>> pressed;                       ///< node, pair
  std::vector<std::pair<int, int>> open_sides;                    ///< node, surface
};

void store(const PatchProblem& problem, const CoefficientView& values, ChunkResult& result) {
  const PatchFit& fit = problem.fit[0];
  const int n = problem.node, terms = fit.terms();
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < num_terms; ++t) values(n, k, t) = fit.a[terms * k + t];
  if (fit.degree == 1) return;
  QuadraticTerms::Values quadratic;
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < QuadraticTerms::count; ++t) quadratic[k][t] = fit.a[terms * k + num_terms + t];
  result.quadratic.emplace_back(n, quadratic);
  ++result.counts.quadratic;
}

void recover_chunk(const PatchAssembly& assembly, const EdgeMap* edges, const RecoveryOptions& options,
                   const int* nodes, std::size_t count, PatchStates& states, ChunkResult& result) {
  const RecoveryBody& body = assembly.body();
  PatchBatch batch(assembly, edges, options, count);
  for (std::size_t i = 0; i < count; ++i) batch.add(nodes[i]);
  batch.solve();
  result.counts.truncated_rows += batch.truncated_rows();
  for (const PatchProblem& problem : batch.problems()) {
    const int n = problem.node;
    if (problem.status != PatchStatus::singular) store(problem, body.field.values, result);
    for (const int pair : problem.pressed) result.pressed.emplace_back(n, pair);
    std::vector<int> open_sides = problem.open_sides;
    std::sort(open_sides.begin(), open_sides.end());
    for (const int surface : open_sides) result.open_sides.emplace_back(n, surface);
    if (problem.has_edge) result.terms.push_back({n, {problem.edge[0], problem.factor}});
    result.counts.grown += body.patches->grown[n];
    result.counts.lowered += problem.lowered;
    states.kind[n] = problem.kind;
    states.status[n] = problem.status;
  }
}

void add(const RecoveryCounts& from, RecoveryCounts& to) {
  to.grown += from.grown;
  to.truncated_rows += from.truncated_rows;
  to.quadratic += from.quadratic;
  to.lowered += from.lowered;
}

/// The patches of all bodies one by one, before the forces are balanced.
ConstrainedRecovery recover_patches(const std::vector<RecoveryBody>& bodies, const RealView& u, const Scales& scales,
                                    const RecoveryOptions& options, const EdgeMap* edges) {
  ConstrainedRecovery recovery;
  std::vector<StressIntegrals> integrals;
  std::vector<std::vector<PatchPolynomial>> polynomials;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RecoveryBody& body = bodies[b];
    const CellStress stress = body.stress ? body.stress : stress_of_displacements(*body.mesh, u);
    polynomials.push_back(patch_polynomials(bodies, b, edges, options));
    integrals.push_back(integrate_stress(body, polynomials.back(), stress, options));
  }
  std::vector<PatchAssembly> assemblies;
  assemblies.reserve(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    assemblies.emplace_back(bodies, integrals, polynomials, static_cast<int>(b), scales, options);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PatchAssembly& assembly = assemblies[b];
    const std::size_t num_nodes = bodies[b].mesh->num_nodes;
    PatchStates states{std::vector<PatchKind>(num_nodes), std::vector<PatchStatus>(num_nodes), {}, {}};
    std::vector<char> interior(num_nodes);
    parallel_for("cgcontact::recover_stress::interior_patches", num_nodes, interior_grain, [&](std::size_t n) {
      interior[n] = options.degree.interior == 1 && assembly.is_interior(static_cast<int>(n));
      if (interior[n]) recover_interior(assembly, static_cast<int>(n));
    });
    std::vector<int> others;
    for (std::size_t n = 0; n < num_nodes; ++n)
      if (!interior[n]) others.push_back(static_cast<int>(n));
    std::vector<ChunkResult> chunks(num_chunks(others.size(), grain));
    parallel_chunks("cgcontact::recover_stress::boundary_patches", others.size(), grain,
                    [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      recover_chunk(assembly, edges, options, &others[begin], end - begin, states, chunks[chunk]);
                    });
    EdgeTerms terms;
    QuadraticTerms quadratic_terms;
    for (const ChunkResult& chunk : chunks) {
      add(chunk.counts, recovery.counts);
      for (const auto& [node, term] : chunk.terms) {
        if (terms.row_of_node.empty()) terms.row_of_node.assign(num_nodes, -1);
        terms.row_of_node[node] = static_cast<int>(terms.terms.size());
        terms.terms.push_back(term);
      }
      for (const auto& [node, values] : chunk.quadratic) {
        if (quadratic_terms.row_of_node.empty()) quadratic_terms.row_of_node.assign(num_nodes, -1);
        quadratic_terms.row_of_node[node] = static_cast<int>(quadratic_terms.values.size());
        quadratic_terms.values.push_back(values);
      }
      states.pressed.insert(states.pressed.end(), chunk.pressed.begin(), chunk.pressed.end());
      states.open_sides.insert(states.open_sides.end(), chunk.open_sides.begin(), chunk.open_sides.end());
    }
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

/// Marks the edges in whose zones the pressure does not carry the transmitted forces in one of the bodies.
std::vector<char> wrong_edges(const std::vector<RecoveryBody>& bodies, const ConstrainedRecovery& recovery,
                              const Scales& scales, const FoundEdges& edges) {
  std::vector<char> wrong(edges.num_zones(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (recovery.edges[b].terms.empty()) continue;
    const std::vector<double> misfit =
        zone_misfits(bodies, b, field_of(bodies[b], recovery, b), scales, recovery.states[b], edges);
    for (std::size_t z = 0; z < wrong.size(); ++z) wrong[z] |= misfit[z] > largest_misfit;
  }
  return wrong;
}

}  // namespace

ConstrainedRecovery recover_constrained(const std::vector<RecoveryBody>& bodies, const RealView& u,
                                        const Scales& scales, const RecoveryOptions& options) {
  std::vector<std::vector<double>> plain;  // before the polynomials are replaced
  for (const RecoveryBody& body : bodies) plain.push_back(contact_pressures(body, body.field));
  FoundEdges edges = find_contact_edges(bodies, scales, options);
  ConstrainedRecovery recovery = recover_patches(bodies, u, scales, options, options.contact_edge ? &edges : nullptr);
  // A patch has one edge: without that of one pair it may take that of another.
  for (;;) {
    const std::vector<char> wrong = wrong_edges(bodies, recovery, scales, edges);
    if (std::find(wrong.begin(), wrong.end(), 1) == wrong.end()) break;
    edges = edges.without(wrong);
    recovery = recover_patches(bodies, u, scales, options, &edges);
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PatchStates& states = recovery.states[b];
    balance_forces(bodies, b, field_of(bodies[b], recovery, b), plain[b], scales, states);
    for (std::size_t n = 0; n < states.kind.size(); ++n) {
      ++recovery.counts.kinds[static_cast<int>(states.kind[n])];
      ++recovery.counts.statuses[static_cast<int>(states.status[n])];
    }
  }
  return recovery;
}

}  // namespace cgcontact
