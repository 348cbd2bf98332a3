#include "recovery/constrained/constrained_fits.hpp"

#include <algorithm>

#include "core/base/process/parallel.hpp"
#include "recovery/constrained/fit_kernels.hpp"
#include "recovery/patch/edge_moments.hpp"

namespace cgcontact {
namespace {

using HostMemory = Kokkos::HostSpace;
using Numbers = SubsetArrays<HostMemory>;

/// Residual of normalised rows over the stress level of the patch below which all rows are met.
constexpr double met = 1e-12;

/// The same of the firm rows when they are enforced alone.
constexpr double held = 1e-8;

/// Fraction of the rank tolerance that counts in patches coupled by bonded faces: three rows per point instead of the
/// five of contact, and the truncation takes more of what matters (docs/recovery.md, "Truncation").
constexpr double bonded_tolerance = 0.5;

/// A view of new memory that every kernel writes before it is read.
template <class View>
View new_view(const char* label, std::size_t size) {
  return View(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), size);
}

/// Patches of one degree and number of bodies.
template <int degree, int bodies>
class PatchClass {
 public:
  /// patches: numbers in the lists.
  PatchClass(const PatchContext& context, PatchLists& lists, std::vector<int> patches)
      : context_(context), lists_(lists), patches_(std::move(patches)) {
    // Those with bonded faces come last: they have a tolerance of their own.
    num_unbonded_ = std::stable_partition(patches_.begin(), patches_.end(), [&](int i) { return !is_bonded(i); }) -
                    patches_.begin();
    const std::size_t size = patches_.size();
    inputs_ = new_view<decltype(inputs_)>("cgcontact::constrained_fits::inputs", size);
    regular_ = decltype(regular_)("cgcontact::constrained_fits::regular", size);
    variance_ = decltype(variance_)("cgcontact::constrained_fits::variance", size);
    status_ = new_view<decltype(status_)>("cgcontact::constrained_fits::status", size);
  }

  /// Fits without constraints. Patches whose cells do not carry the polynomial leave this class: without even a linear
  /// one they are singular, else go to `others`.
  void fit(std::vector<int>& others);
  /// Adds the rows and enforces them.
  void constrain(const PatchRows& rows);
  void store(PatchResults& results) const;

 private:
  using Arrays = ClassArrays<HostMemory, degree, bodies>;
  using P = Polynomial<degree>;

  Arrays arrays() const { return {view_of<decltype(Arrays::patch)>(patches_), inputs_, regular_, variance_}; }
  bool is_bonded(int patch) const { return bodies == 2 && context_.body.boundary->is_bonded(lists_.other(patch).pair); }
  void keep_regular(std::vector<int>& others);
  void set_interior(const PatchRows& rows);
  void subtract_edge_terms();
  void add_rows(const PatchRows& rows);
  void solve(std::size_t first, std::size_t count, double rank_tolerance);
  void hold_firm_rows();

  const PatchContext& context_;
  PatchLists& lists_;
  std::vector<int> patches_;
  std::size_t num_unbonded_;
  Kokkos::View<FitInput<degree, bodies>*, Kokkos::LayoutRight, HostMemory> inputs_;
  Kokkos::View<char* [2], Kokkos::LayoutRight, HostMemory> regular_;
  Kokkos::View<double* [2], Kokkos::LayoutRight, HostMemory> variance_;
  Kokkos::View<FitStatus*, HostMemory> status_;
  std::vector<RowList<bodies>> rows_;  ///< of each chunk of patches
  long long truncated_rows_ = 0;
};

template <int degree, int bodies>
void PatchClass<degree, bodies>::fit(std::vector<int>& others) {
  const RecoveryBody& body = context_.body;
  const auto own = host_arrays(lists_.centre, lists_.unit, lists_.cells);
  const auto integrals_of = [&](int b) { return host_arrays(*context_.bodies[b].mesh, context_.integrals[b]); };
  if constexpr (degree == 1)
    take_plain_fits(context_.exec, host_arrays(*body.mesh, *body.patches), own,
                    view_of<Kokkos::View<const int*, Kokkos::LayoutRight, HostMemory>>(lists_.node),
                    host_arrays(body.field.nodes), body.field.values, arrays());
  else
    fit_sums(context_.exec, integrals_of(context_.index), own, Numbers{{}, {}, static_cast<int>(patches_.size())}, 0,
             arrays());
  if constexpr (bodies == 2) {
    const auto auxiliary = host_arrays(lists_.auxiliary_centre, lists_.auxiliary_unit, lists_.auxiliary_cells);
    std::vector<std::vector<int>> entries(context_.bodies.size());  // by the body of the auxiliary patch
    for (std::size_t k = 0; k < patches_.size(); ++k)
      entries[lists_.other(patches_[k]).other_body].push_back(static_cast<int>(k));
    for (std::size_t b = 0; b < entries.size(); ++b) {
      if (entries[b].empty()) continue;
      fit_sums(context_.exec, integrals_of(static_cast<int>(b)), auxiliary,
               Numbers{view_of<decltype(Numbers::numbers)>(entries[b]), {}, static_cast<int>(entries[b].size())}, 1,
               arrays());
    }
    if constexpr (degree == 1) find_plain_variances(context_.exec, integrals_of(context_.index), own, arrays());
  }
  context_.exec.fence();
  keep_regular(others);
}

template <int degree, int bodies>
void PatchClass<degree, bodies>::keep_regular(std::vector<int>& others) {
  std::size_t kept = 0;
  const std::size_t unbonded = num_unbonded_;
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    if (!regular_(k, 0) || (bodies == 2 && !regular_(k, 1))) {
      if (degree == 1 && !regular_(k, 0))
        lists_.raise(patches_[k], PatchStatus::singular);
      else
        others.push_back(patches_[k]);
      if (k < unbonded) --num_unbonded_;
      continue;
    }
    if (kept < k) {
      patches_[kept] = patches_[k];
      inputs_(kept) = inputs_(k);
      for (int b = 0; b < bodies; ++b) variance_(kept, b) = variance_(k, b);
    }
    ++kept;
  }
  patches_.resize(kept);
  const auto first = std::pair<std::size_t, std::size_t>(0, kept);
  inputs_ = Kokkos::subview(inputs_, first);
  status_ = Kokkos::subview(status_, first);
}

template <int degree, int bodies>
void PatchClass<degree, bodies>::set_interior(const PatchRows& rows) {
  parallel_for("cgcontact::constrained_fits::interior", patches_.size(), grain_of_medium, [&](std::size_t k) {
    const int i = patches_[k];
    FitInput<degree, bodies>& input = inputs_(k);
    rows.interior_values<degree>(context_.index, lists_.centre[i], lists_.unit[i], input.interior[0]);
    input.poisson_ratio[0] = context_.body.mesh->poisson_ratio();
    if constexpr (bodies == 2) {
      const int other = lists_.other(i).other_body;
      rows.interior_values<degree>(other, lists_.auxiliary_centre[i], lists_.auxiliary_unit[i], input.interior[1]);
      input.poisson_ratio[1] = context_.bodies[other].mesh->poisson_ratio();
    }
  });
}

template <int degree, int bodies>
void PatchClass<degree, bodies>::subtract_edge_terms() {
  if (lists_.edges.empty()) return;
  parallel_for("cgcontact::constrained_fits::edges", patches_.size(), grain_of_heavy, [&](std::size_t k) {
    const int i = patches_[k];
    if (lists_.edge[i] < 0) return;
    const EdgeTerms::Term& term = lists_.edges[lists_.edge[i]];
    const ListRange<int> cells = lists_.cells[i];
    subtract_edge_term<degree>(*context_.body.mesh, cells.first, cells.size(), lists_.centre[i], lists_.unit[i],
                               term.edge, term.factor, inputs_(k).mass[0], inputs_(k).a[0][0]);
  });
}

template <int degree, int bodies>
void PatchClass<degree, bodies>::add_rows(const PatchRows& rows) {
  rows_.resize(num_chunks(patches_.size(), grain_of_heavy));
  parallel_chunks("cgcontact::constrained_fits::rows", patches_.size(), grain_of_heavy,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    static thread_local std::vector<ConstraintGroup> groups;
                    RowList<bodies>& to = rows_[chunk];
                    for (std::size_t k = begin; k < end; ++k) {
                      const std::size_t before = to.rows.size();
                      rows.add(lists_, patches_[k], groups, to);
                      inputs_(k).num_rows = static_cast<int>(to.rows.size() - before);
                    }
                    const FitRow<bodies>* next = to.rows.data();
                    for (std::size_t k = begin; k < end; next += inputs_(k).num_rows, ++k) inputs_(k).rows = next;
                  });
}

template <int degree, int bodies>
void PatchClass<degree, bodies>::solve(std::size_t first, std::size_t count, double rank_tolerance) {
  if (count == 0) return;
  fit_batch(context_.exec, inputs_.data() + first, static_cast<int>(count), rank_tolerance, status_.data() + first);
  for (std::size_t k = first; k < first + count; ++k) {
    const FitStatus& status = status_(k);
    if (status.truncated > 0) lists_.raise(patches_[k], PatchStatus::truncated);
    if (status.residual > context_.options.conflict) lists_.raise(patches_[k], PatchStatus::conflicting);
    if (!status.finite) lists_.raise(patches_[k], PatchStatus::singular);
    truncated_rows_ += status.truncated;
  }
}

/// Makes the pressure exactly zero where contact is open: conflicting data elsewhere in the patch (a load on a face
/// that meets the contact face at an edge) must not leak into it through the least-squares solution.
template <int degree, int bodies>
void PatchClass<degree, bodies>::hold_firm_rows() {
  std::vector<int> loose;
  std::vector<FitRow<1>> rows;
  std::vector<int> begin{0};
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    if (!(status_(k).residual > met)) continue;
    const RowList<bodies>& of = rows_[k / grain_of_heavy];
    const std::ptrdiff_t first = inputs_(k).rows - of.rows.data();
    for (std::ptrdiff_t r = first; r < first + inputs_(k).num_rows; ++r) {
      if (!of.firm[r]) continue;
      FitRow<1>& row = rows.emplace_back();
      std::copy_n(of.rows[r].weight[0], 6, row.weight[0]);
      std::copy_n(of.rows[r].position[0], 3, row.position[0]);
      row.value = of.rows[r].value;
    }
    if (static_cast<int>(rows.size()) == begin.back()) continue;
    loose.push_back(static_cast<int>(k));
    begin.push_back(static_cast<int>(rows.size()));
  }
  if (loose.empty()) return;
  const auto inputs =
      new_view<Kokkos::View<FitInput<degree, 1>*, HostMemory>>("cgcontact::constrained_fits::firm", loose.size());
  const auto status =
      new_view<Kokkos::View<FitStatus*, HostMemory>>("cgcontact::constrained_fits::firm_status", loose.size());
  for (std::size_t l = 0; l < loose.size(); ++l) {
    const FitInput<degree, bodies>& from = inputs_(loose[l]);
    FitInput<degree, 1>& to = inputs(l);
    std::copy_n(from.mass[0], P::num_packed, to.mass[0]);
    std::copy_n(from.a[0][0], 6 * P::num_terms, to.a[0][0]);
    std::copy_n(from.interior[0], P::num_interior, to.interior[0]);
    to.poisson_ratio[0] = from.poisson_ratio[0];
    to.rows = rows.data() + begin[l];
    to.num_rows = begin[l + 1] - begin[l];
  }
  fit_batch(context_.exec, inputs.data(), static_cast<int>(loose.size()), context_.options.firm_tolerance,
            status.data());
  for (std::size_t l = 0; l < loose.size(); ++l) {
    std::copy_n(inputs(l).a[0][0], 6 * P::num_terms, inputs_(loose[l]).a[0][0]);
    if (status(l).residual > held) lists_.raise(patches_[loose[l]], PatchStatus::conflicting);
  }
}

template <int degree, int bodies>
void PatchClass<degree, bodies>::constrain(const PatchRows& rows) {
  if (patches_.empty()) return;
  set_interior(rows);
  subtract_edge_terms();
  add_rows(rows);
  if constexpr (bodies == 2)
    if (context_.options.inverse_variance) weigh_auxiliary(context_.exec, context_.options.max_weight, arrays());
  const double tolerance = context_.options.rank_tolerance_of(degree, context_.grid.is_axisymmetric());
  solve(0, num_unbonded_, tolerance);
  solve(num_unbonded_, patches_.size() - num_unbonded_, bonded_tolerance * tolerance);
  hold_firm_rows();
}

/// Leaves of a polynomial what it is in the half-plane of a body of revolution: nothing across, where cells have a
/// size.
template <int degree>
void keep_half_plane(int across, double a[6][Polynomial<degree>::num_terms]) {
  constexpr int terms[3][4] = {{1, 4, 7, 9}, {2, 5, 7, 8}, {3, 6, 8, 9}};  // of Polynomial<2> with x, y, z
  constexpr int shears[3][2] = {{3, 5}, {3, 4}, {4, 5}};
  for (int c = 0; c < 6; ++c)
    for (const int t : terms[across])
      if (t < Polynomial<degree>::num_terms) a[c][t] = 0;
  for (const int c : shears[across]) std::fill_n(a[c], Polynomial<degree>::num_terms, 0.0);
}

/// Coefficients, the terms of edges and quadratic ones beside them; of singular patches the mean stress stays.
template <int degree, int bodies>
void PatchClass<degree, bodies>::store(PatchResults& results) const {
  const RecoveredField& field = results.field;
  std::size_t row = results.quadratic.values.size();
  for (std::size_t k = 0; degree == 2 && k < patches_.size(); ++k) {
    if (lists_.status[patches_[k]] == PatchStatus::singular) continue;
    if (results.quadratic.row_of_node.empty()) results.quadratic.row_of_node.assign(results.states.kind.size(), -1);
    results.quadratic.row_of_node[lists_.node[patches_[k]]] = static_cast<int>(row++);
  }
  results.quadratic.values.resize(row);
  parallel_for("cgcontact::constrained_fits::store", patches_.size(), grain_of_medium, [&](std::size_t k) {
    const int i = patches_[k], n = lists_.node[i], to = field.nodes.row(n);
    lists_.fitted[i] = 1;
    if (lists_.status[i] == PatchStatus::singular) return;
    auto& a = inputs_(k).a[0];
    if (const Grid& grid = context_.grid; grid.is_axisymmetric()) keep_half_plane<degree>(grid.plane_strain, a);
    for (int c = 0; c < 6; ++c)
      for (int t = 0; t < num_terms; ++t) field.values(to, c, t) = a[c][t];
    if constexpr (degree == 2) {
      QuadraticTerms::Values& values = results.quadratic.values[results.quadratic.row_of_node[n]];
      for (int c = 0; c < 6; ++c)
        for (int t = 0; t < QuadraticTerms::count; ++t) values[c][t] = a[c][num_terms + t];
    }
  });
  for (const RowList<bodies>& list : rows_)
    results.states.open_sides.insert(results.states.open_sides.end(), list.open_sides.begin(), list.open_sides.end());
  results.truncated_rows += truncated_rows_;
}

/// Fits and constrains the patches of one class; `others` gets those that are of another one.
template <int degree, int bodies>
void run_class(const PatchContext& context, const PatchRows& rows, PatchLists& lists, std::vector<int> patches,
               PatchResults& results, std::vector<int>& others) {
  if (patches.empty()) return;
  PatchClass<degree, bodies> of_class(context, lists, std::move(patches));
  of_class.fit(others);
  of_class.constrain(rows);
  of_class.store(results);
}

/// Kind, status, pressures and edge of a patch that was fitted.
void store_lists(const PatchLists& lists, std::size_t i, PatchResults& results) {
  const int n = lists.node[i];
  results.states.kind[n] = lists.kind[i];
  results.states.status[n] = lists.status[i];
  for (const PairState& state : lists.pairs[i]) {
    if (state.mode == ContactMode::open) continue;
    results.states.pressed.emplace_back(n, state.pair);
    if (!state.couples) results.states.known.emplace_back(n, state.pair);
  }
  if (lists.edge[i] < 0) return;
  results.edges.add(n, results.states.kind.size(), lists.edges[lists.edge[i]]);
}

}  // namespace

std::vector<int> fit_constrained(const PatchContext& context, const PatchRows& rows, PatchLists& lists,
                                 PatchResults& results) {
  std::vector<int> of_class[2][2];  // by degree and number of bodies
  std::vector<int> lowered, uncoupled, none;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const int patch = static_cast<int>(i), quadratic = lists.polynomial[i].degree == 2;
    if (lists.coupled[i] < 0 || lists.has_auxiliary(i))
      of_class[quadratic][lists.has_auxiliary(i)].push_back(patch);
    else
      (quadratic ? lowered : uncoupled).push_back(patch);
  }
  run_class<2, 1>(context, rows, lists, std::move(of_class[1][0]), results, lowered);
  run_class<2, 2>(context, rows, lists, std::move(of_class[1][1]), results, lowered);
  run_class<1, 2>(context, rows, lists, std::move(of_class[0][1]), results, uncoupled);
  for (const int i : uncoupled) {
    lists.raise(i, PatchStatus::uncoupled);
    of_class[0][0].push_back(i);
  }
  run_class<1, 1>(context, rows, lists, std::move(of_class[0][0]), results, none);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (lists.fitted[i])
      store_lists(lists, i, results);
    else if (lists.status[i] == PatchStatus::singular)
      results.states.status[lists.node[i]] = PatchStatus::singular;
  }
  for (int& i : lowered) i = lists.node[i];
  std::sort(lowered.begin(), lowered.end());
  return lowered;
}

}  // namespace cgcontact
