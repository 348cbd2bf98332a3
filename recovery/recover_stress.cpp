#include "recovery/recover_stress.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "recovery/constrained_fit.hpp"
#include "recovery/edge_search.hpp"

namespace cgcontact {
namespace {

constexpr int num_unknowns = 6 * num_terms;

/// Patches per chunk of the parallel loop.
constexpr std::size_t grain = 128;

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

/// Solves one patch; returns the number of truncated rows.
int solve_patch(PatchProblem& problem, const std::vector<FitRow>& rows, double rank_tolerance) {
  const int num_bodies = problem.coupled ? 2 : 1;
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(3 * num_bodies + problem.num_rows, num_bodies * num_unknowns);
  Eigen::VectorXd value(C.rows()), a(C.cols());
  std::vector<MassMatrix> mass;
  int firm = 0;
  for (int b = 0; b < num_bodies; ++b) {
    C.block<3, num_unknowns>(3 * b, num_unknowns * b) = divergence_rows();
    value.segment<3>(3 * b) = problem.divergence[b];
    a.segment<num_unknowns>(num_unknowns * b) = problem.fit[b].a;
    mass.push_back(problem.fit[b].mass);
    for (int r = 0; r < problem.num_rows; ++r)
      C.block<1, num_unknowns>(3 * num_bodies + r, num_unknowns * b) = full_row(rows[problem.first_row + r], b);
  }
  for (int r = 0; r < problem.num_rows; ++r) {
    value[3 * num_bodies + r] = rows[problem.first_row + r].value;
    firm += rows[problem.first_row + r].firm;
  }
  const ConstrainedFitStatus status = constrain_fit(mass, C, value, rank_tolerance, a);
  problem.fit[0].a = a.head<num_unknowns>();
  if (status.truncated > 0) problem.status = std::max(problem.status, PatchStatus::truncated);
  if (status.inconsistent) problem.status = std::max(problem.status, PatchStatus::conflicting);
  if (firm > 0) {
    // Where contact is open the pressure is exactly zero: conflicting data elsewhere in the patch (a load on a face that
    // meets the contact face at an edge) must not leak into it through the least-squares solution.
    Eigen::MatrixXd F(firm, num_unknowns);
    int i = 0;
    for (int r = 0; r < problem.num_rows; ++r)
      if (rows[problem.first_row + r].firm) F.row(i++) = full_row(rows[problem.first_row + r], 0);
    Eigen::VectorXd own = problem.fit[0].a;
    constrain_fit({mass[0]}, F, Eigen::VectorXd::Zero(firm), rank_tolerance, own);
    problem.fit[0].a = own;
  }
  return status.truncated;
}

/// What one chunk of patches leaves behind.
struct ChunkResult {
  RecoveryCounts counts;
  std::vector<std::pair<int, EdgeTerms::Term>> terms;  ///< node, term
};

void recover_chunk(const PatchAssembly& assembly, const EdgeMap* edges, double rank_tolerance, std::size_t begin,
                   std::size_t end, PatchStates& states, ChunkResult& result) {
  const RecoveryBody& body = assembly.body();
  PatchWorkspace workspace;
  std::vector<FitRow> rows;
  for (std::size_t node = begin; node < end; ++node) {
    const int n = static_cast<int>(node);
    PatchProblem problem;
    if (assembly.is_interior(n)) {
      recover_interior(assembly, n);
    } else {
      rows.clear();
      problem = assembly.assemble(n, edges, workspace, rows);
      result.counts.grown += body.patches->grown[n];
      if (problem.status != PatchStatus::singular) {
        result.counts.truncated_rows += solve_patch(problem, rows, rank_tolerance);
        for (int i = 0; i < num_unknowns; ++i) body.field.values(n, i / num_terms, i % num_terms) = problem.fit[0].a[i];
        if (problem.has_edge) result.terms.push_back({n, {problem.edge[0], problem.factor}});
      }
    }
    states.kind[n] = problem.kind;
    states.status[n] = problem.status;
    ++result.counts.kinds[static_cast<int>(problem.kind)];
    ++result.counts.statuses[static_cast<int>(problem.status)];
  }
}

void add(const RecoveryCounts& from, RecoveryCounts& to) {
  for (int k = 0; k < num_patch_kinds; ++k) to.kinds[k] += from.kinds[k];
  for (int k = 0; k < num_patch_statuses; ++k) to.statuses[k] += from.statuses[k];
  to.grown += from.grown;
  to.truncated_rows += from.truncated_rows;
}

}  // namespace

ConstrainedRecovery recover_constrained(const std::vector<RecoveryBody>& bodies, const RealView& u,
                                        const Scales& scales, const RecoveryOptions& options) {
  ConstrainedRecovery recovery;
  std::vector<AuxiliaryCells> auxiliary;
  for (const RecoveryBody& body : bodies) auxiliary.push_back(auxiliary_cells(body, u, options.auxiliary_depth));
  std::vector<PatchAssembly> assemblies;
  assemblies.reserve(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    assemblies.emplace_back(bodies, auxiliary, static_cast<int>(b), scales, options, u);
  const FoundEdges edges = find_contact_edges(assemblies, u, options);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t num_nodes = bodies[b].mesh->num_nodes;
    PatchStates states{std::vector<PatchKind>(num_nodes), std::vector<PatchStatus>(num_nodes)};
    std::vector<ChunkResult> chunks(num_chunks(num_nodes, grain));
    parallel_chunks(num_nodes, grain, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      recover_chunk(assemblies[b], options.contact_edge ? &edges : nullptr, options.rank_tolerance, begin, end, states,
                    chunks[chunk]);
    });
    EdgeTerms terms;
    for (const ChunkResult& chunk : chunks) {
      add(chunk.counts, recovery.counts);
      for (const auto& [node, term] : chunk.terms) {
        if (terms.row_of_node.empty()) terms.row_of_node.assign(num_nodes, -1);
        terms.row_of_node[node] = static_cast<int>(terms.terms.size());
        terms.terms.push_back(term);
      }
    }
    recovery.states.push_back(std::move(states));
    recovery.edges.push_back(std::move(terms));
  }
  return recovery;
}

}  // namespace cgcontact
