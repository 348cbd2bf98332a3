#include "recovery/constrained/recover_stress.hpp"

#include <algorithm>

#include "core/base/process/packing.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "recovery/constrained/constrained_fits.hpp"
#include "recovery/constrained/force_balance.hpp"
#include "recovery/constrained/interior_patches.hpp"
#include "recovery/constrained/patch_polynomials.hpp"

namespace cgcontact {
namespace {

/// Patches that are listed, fitted and constrained at a time. From 256 to all at once the time is the same within 4 %
/// (docs/decisions.md); this many fill the lanes and threads and take 45 MB where all are coupled and of degree 2.
constexpr std::size_t patches_per_chunk = 4096;

/// Corrects the interior patches of a body's field; returns the nodes of the others.
std::vector<int> recover_interior(const PatchContext& context) {
  const RecoveryBody& body = context.body;
  const Subset& nodes = body.field.nodes;
  const std::size_t num_nodes = nodes.size();
  std::vector<char> interior(num_nodes, 0);
  if (context.options.degree.interior == 1) {
    std::vector<char> in_contact(body.mesh->cell_nodes.size());
    for (std::size_t c = 0; c < in_contact.size(); ++c)
      in_contact[c] = !body.boundary->links_of_cell[static_cast<int>(c)].empty();
    Kokkos::View<double* [3], Kokkos::LayoutRight, Kokkos::HostSpace> divergence;
    if (body.boundary->body_force_at) {
      divergence = decltype(divergence)("cgcontact::recover_stress::divergence", num_nodes);
      parallel_for("cgcontact::recover_stress::divergence", num_nodes, grain_of_light, [&](std::size_t row) {
        const int node = nodes.number(static_cast<int>(row));
        if (!body.patches->full[node]) return;
        const Vec3 value = context.divergence(context.index, body.mesh->node_position(node), unit_of(*body.mesh, node));
        for (int i = 0; i < 3; ++i) divergence(row, i) = value[i];
      });
    }
    using Marks = Kokkos::View<char*, Kokkos::HostSpace>;
    correct_interior(context.exec, host_arrays(*body.mesh, *body.patches), host_arrays(nodes),
                     Marks(in_contact.data(), in_contact.size()), divergence, body.field.values,
                     Marks(interior.data(), num_nodes));
    context.exec.fence();
  }
  std::vector<int> others;
  for (std::size_t row = 0; row < num_nodes; ++row)
    if (const int node = nodes.number(static_cast<int>(row)); !interior[row] && body.mesh->is_free(node))
      others.push_back(node);
  return others;
}

/// Solves the patches of these nodes, some thousand at a time; lowers the degree where the cells do not carry what was
/// asked for.
void recover_patches_of(const PatchContext& context, const std::vector<int>& nodes,
                        const std::vector<PatchPolynomial>& polynomials, PatchResults& results) {
  const PatchRows rows(context);
  PatchLists lists;
  std::vector<PatchLists> chunks;
  const auto solve = [&](const std::vector<int>& some, PatchStatus least, const auto& polynomial_of) {
    std::vector<int> lowered;
    for (std::size_t begin = 0; begin < some.size(); begin += patches_per_chunk) {
      const std::size_t count = std::min(patches_per_chunk, some.size() - begin);
      list_patches(context, &some[begin], count, polynomial_of, chunks, lists);
      for (std::size_t i = 0; i < count; ++i) lists.raise(i, least);
      const std::vector<int> of_chunk = fit_constrained(context, rows, lists, results);
      lowered.insert(lowered.end(), of_chunk.begin(), of_chunk.end());
    }
    return lowered;
  };
  const std::vector<int> lowered = solve(nodes, PatchStatus::exact, [&](int node) { return polynomials[node]; });
  solve(lowered, PatchStatus::degree_lowered, [](int) { return PatchPolynomial{}; });
  results.lowered += static_cast<long long>(lowered.size());
  results.states.sort();
}

/// Values of all ranks, one rank after the other.
template <class T>
std::vector<T> gather_packed(const std::vector<T>& own) {
  Packing mine;
  mine.put(own);
  const std::vector<char> bytes = gather_bytes(mine.bytes().data(), mine.bytes().size());
  Unpacking from(bytes);
  std::vector<T> all;
  for (int rank = 0; rank < num_ranks(); ++rank) {
    std::vector<T> share;
    from.take(share);
    all.insert(all.end(), share.begin(), share.end());
  }
  return all;
}

/// Recovers on several ranks: groups of neighbouring patches are interleaved over the ranks, and all take over all
/// results. Every rank finds again the edge of a contact zone in a patch, of which there are few.
void recover_patches_by_rank(const PatchContext& context, const std::vector<int>& nodes,
                             const std::vector<PatchPolynomial>& polynomials, PatchResults& results) {
  constexpr std::size_t group = 64;
  std::vector<int> own;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (i / group % num_ranks() == static_cast<std::size_t>(this_rank())) own.push_back(nodes[i]);
  recover_patches_of(context, own, polynomials, results);

  struct Patch {
    int node;
    PatchKind kind;
    PatchStatus status;
    bool has_edge;
    double values[6][num_terms];
  };
  struct Quadratic {
    int node;
    QuadraticTerms::Values values;
  };
  const RecoveredField& field = context.body.field;
  std::vector<Patch> patches;
  std::vector<Quadratic> quadratic;
  for (const int n : own) {
    Patch& patch = patches.emplace_back();
    patch.node = n, patch.kind = results.states.kind[n], patch.status = results.states.status[n];
    patch.has_edge = results.edges.of_node(n) != nullptr;
    std::copy_n(field.at(n), 6 * num_terms, patch.values[0]);
    if (const QuadraticTerms::Values* values = results.quadratic.of_node(n)) quadratic.push_back({n, *values});
  }
  const std::size_t num_nodes = results.states.kind.size();
  results.edges = {};
  results.quadratic = {};
  PatchLists lists;
  for (const Patch& patch : gather_packed(patches)) {
    results.states.kind[patch.node] = patch.kind;
    results.states.status[patch.node] = patch.status;
    std::copy_n(patch.values[0], 6 * num_terms, &field.values(field.nodes.row(patch.node), 0, 0));
    if (!patch.has_edge) continue;
    lists.clear();
    add_patch(context, patch.node, polynomials[patch.node], lists);
    results.edges.add(patch.node, num_nodes, lists.edges.front());
  }
  for (const Quadratic& terms : gather_packed(quadratic)) {
    if (results.quadratic.row_of_node.empty()) results.quadratic.row_of_node.assign(num_nodes, -1);
    results.quadratic.row_of_node[terms.node] = static_cast<int>(results.quadratic.values.size());
    results.quadratic.values.push_back(terms.values);
  }
  for (auto* list : {&results.states.pressed, &results.states.known, &results.states.open_sides}) {
    std::vector<std::array<int, 2>> pairs;
    for (const auto& [node, other] : *list) pairs.push_back({node, other});
    list->clear();
    for (const auto& [node, other] : gather_packed(pairs)) list->emplace_back(node, other);
  }
  results.states.sort();
  double counts[2] = {static_cast<double>(results.truncated_rows), static_cast<double>(results.lowered)};
  sum_over_ranks(counts, 2);
  results.truncated_rows = static_cast<long long>(counts[0]);
  results.lowered = static_cast<long long>(counts[1]);
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

/// The patches of one body, before the forces are balanced.
void recover_body(const PatchContext& context, const std::vector<PatchPolynomial>& polynomials, PatchResults& results,
                  RecoveryCounts& counts) {
  const std::vector<int> others = recover_interior(context);
  if (num_ranks() == 1)
    recover_patches_of(context, others, polynomials, results);
  else
    recover_patches_by_rank(context, others, polynomials, results);
  for (const int n : others) counts.grown += context.body.patches->grown[n];
  counts.lowered += results.lowered;
  counts.truncated_rows += results.truncated_rows;
  counts.quadratic += static_cast<long long>(results.quadratic.values.size());
}

/// The patches of all bodies one by one, before the forces are balanced.
ConstrainedRecovery recover_patches(const HostExec& exec, const std::vector<RecoveryBody>& bodies, const HostVector& u,
                                    const Scales& scales, const RecoveryOptions& options, const KnownPressures* known) {
  ConstrainedRecovery recovery;
  std::vector<StressIntegrals> integrals;
  std::vector<std::vector<PatchPolynomial>> polynomials;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RecoveryBody& body = bodies[b];
    const CellStress stress = body.stress ? body.stress : stress_of_displacements(*body.mesh, u);
    polynomials.push_back(patch_polynomials(bodies, b, known, options));
    integrals.push_back(integrate_stress(body, polynomials.back(), stress, options));
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t num_nodes = bodies[b].mesh->num_nodes;
    recovery.states.push_back({std::vector<PatchKind>(num_nodes), std::vector<PatchStatus>(num_nodes), {}, {}, {}});
    recovery.edges.emplace_back();
    recovery.quadratic.emplace_back();
    if (!bodies[b].mesh->rigid) {
      PatchResults results{bodies[b].field, recovery.states[b], recovery.edges[b], recovery.quadratic[b]};
      recover_body({exec, bodies, integrals, static_cast<int>(b), scales, options, known}, polynomials[b], results,
                   recovery.counts);
    }
    set_constrained_nodes(bodies[b], recovery.states[b], recovery.quadratic[b]);
  }
  return recovery;
}

/// Body's field with its terms; refers to `recovery`.
RecoveredField field_of(const RecoveryBody& body, const ConstrainedRecovery& recovery, std::size_t index) {
  RecoveredField field = body.field;
  if (!recovery.edges[index].terms.empty()) field.edge = {std::shared_ptr<void>(), &recovery.edges[index]};
  if (!recovery.quadratic[index].values.empty())
    field.quadratic = {std::shared_ptr<void>(), &recovery.quadratic[index]};
  return field;
}

}  // namespace

ConstrainedRecovery recover_constrained(const HostExec& exec, const std::vector<RecoveryBody>& bodies,
                                        const RealView& u, const Scales& scales, const RecoveryOptions& options,
                                        const KnownPressures* known) {
  std::vector<std::vector<double>> plain;  // before the polynomials are replaced
  for (const RecoveryBody& body : bodies) plain.push_back(contact_pressures(body, body.field));
  const HostVector host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u);
  ConstrainedRecovery recovery = recover_patches(exec, bodies, host, scales, options, known);
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
