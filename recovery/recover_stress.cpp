#include "recovery/recover_stress.hpp"

#include <algorithm>

#include "recovery/constrained_fit.hpp"
#include "recovery/constraints.hpp"

namespace cgcontact {
namespace {

constexpr int num_unknowns = 6 * num_terms;

/// Rows collected for one patch; `second` rows are those of the auxiliary body.
class RowSet {
 public:
  void add(const Row24& own, double value) { add(own, Row24::Zero(), value); }
  void add(const Row24& own, const Row24& other, double value) {
    own_.push_back(own);
    other_.push_back(other);
    value_.push_back(value);
  }
  Eigen::MatrixXd matrix(bool with_auxiliary) const {
    Eigen::MatrixXd C(own_.size(), with_auxiliary ? 2 * num_unknowns : num_unknowns);
    for (std::size_t r = 0; r < own_.size(); ++r) {
      C.row(r).head<num_unknowns>() = own_[r];
      if (with_auxiliary) C.row(r).tail<num_unknowns>() = other_[r];
    }
    return C;
  }
  std::size_t size() const { return value_.size(); }
  Eigen::VectorXd values() const { return Eigen::Map<const Eigen::VectorXd>(value_.data(), value_.size()); }

 private:
  std::vector<Row24> own_, other_;
  std::vector<double> value_;
};

/// Unit directions orthogonal to all held ones: those in which the traction at a point with normal n is known.
std::vector<Vec3> known_directions(const TractionCondition& condition, const Vec3& n, const Mat3& rotation) {
  std::vector<Vec3> basis;
  const auto extend = [&](Vec3 v) {
    for (const Vec3& b : basis) v -= b.dot(v) * b;
    if (v.norm() < 0.1) return false;
    basis.push_back(v.normalized());
    return true;
  };
  if (condition.normal_held) extend(n);
  for (int i = 0; i < 3; ++i)
    if (condition.component_held[i]) extend(rotation.row(i).transpose());
  const std::size_t num_held = basis.size();
  const auto [t1, t2] = tangents(n);
  for (const Vec3& v : {n, t1, t2}) extend(v);
  return {basis.begin() + num_held, basis.end()};
}

/// A fit before constraints: mass matrix and coefficients about a centre.
struct PatchFit {
  MassMatrix mass;
  Eigen::Matrix<double, num_unknowns, 1> a;
  Vec3 centre;  ///< grid coordinates
  bool regular = false;
};

PatchFit fit_cells(const RecoveryBody& body, const std::vector<int>& cells, const Vec3& centre) {
  const auto offset = [&](int c, double d[3]) {
    for (int i = 0; i < 3; ++i) d[i] = body.mesh->cut_cells->cells[c][i] + 0.5 - centre[i];
  };
  double m[num_terms][num_terms], H[6][num_terms];
  const auto list = [&](int i) { return cells[i]; };
  gather_patch(list, 0, static_cast<int>(cells.size()), offset, body.patches->mass, body.stress, m, H);
  PatchFit fit;
  fit.centre = centre;
  for (int i = 0; i < num_terms; ++i)
    for (int j = 0; j < num_terms; ++j) fit.mass(i, j) = m[i][j];
  fit.regular = cholesky(m);
  for (int k = 0; k < 6 && fit.regular; ++k) {
    cholesky_solve(m, H[k]);
    for (int t = 0; t < num_terms; ++t) fit.a[num_terms * k + t] = H[k][t];
  }
  return fit;
}

/// A patch counts as closed when more than this part of its contact area is. Measured on the paper's scene, geometric
/// mean over 7 grid offsets, error of the pressure at n = 8, 16, 32: any closed point .159 .080 .038, a quarter .149
/// .067 .035, half .216 .097 .041.
constexpr double closed_fraction = 0.25;

/// Contact points of one pair inside a patch.
struct PairState {
  double area = 0, closed_area = 0;
  std::vector<int> links;
  bool is_closed() const { return closed_area > closed_fraction * area; }
  bool is_mixed() const { return closed_area > 0 && closed_area < area * (1 - 1e-12); }
};

/// Recovers the patches of one body; holds what is common to them.
class BodyRecovery {
 public:
  BodyRecovery(const std::vector<RecoveryBody>& bodies, int index, const Scales& scales, const RecoveryOptions& options)
      : bodies_(bodies), body_(bodies[index]), grid_(body_.mesh->cut_cells->grid), scales_(scales), options_(options) {}

  /// Constrained coefficients of node n; adds to the counts.
  PatchKind recover(int n, RecoveryCounts& counts, Eigen::VectorXd& a) const;

 private:
  void add_equilibrium(const RecoveryBody& body, const Vec3& centre, bool auxiliary, RowSet& rows) const;
  void add_known_traction(const ConstraintGroup& group, const Vec3& centre, RowSet& rows) const;
  static void add_zero_shear(const ConstraintGroup& group, const Vec3& centre, RowSet& rows) {
    for (std::size_t p = 0; p < group.position.size(); ++p) {
      const auto [t1, t2] = tangents(group.normal[p]);
      rows.add(traction_row(group.position[p] - centre, group.normal[p], t1), 0);
      rows.add(traction_row(group.position[p] - centre, group.normal[p], t2), 0);
    }
  }
  void add_contact(const ConstraintGroup& group, const PatchFit& own, const PatchFit* auxiliary, const PairState& state,
                   RowSet& rows) const;
  void enforce_free_contact(const std::vector<ConstraintGroup>& groups, const std::map<int, PairState>& states,
                            const PatchFit& own, Eigen::VectorXd& unknowns) const;
  std::map<int, PairState> pair_states(const std::vector<int>& cells) const;
  PatchFit auxiliary_fit(const PairState& state) const;
  const RecoveryBody& other_body(const PairState& state) const {
    return bodies_[body_.boundary->links[state.links.front()].other_body];
  }

  const std::vector<RecoveryBody>& bodies_;
  const RecoveryBody& body_;
  const Grid& grid_;
  const Scales& scales_;
  const RecoveryOptions& options_;
};

void BodyRecovery::add_equilibrium(const RecoveryBody& body, const Vec3& centre, bool auxiliary, RowSet& rows) const {
  static const auto divergence = divergence_rows();
  const Grid& grid = body.mesh->cut_cells->grid;
  Vec3 value = Vec3::Zero();
  if (body.boundary->body_force_at)
    value = -grid.cell_size / scales_.stress *
            (grid.rotation.transpose() * body.boundary->body_force_at(grid.to_global(centre)));
  for (int i = 0; i < 3; ++i) {
    const Row24 row = divergence.row(i);
    if (auxiliary)
      rows.add(Row24::Zero(), row, value[i]);
    else
      rows.add(row, value[i]);
  }
}

/// Equation 5 in the directions that no support holds.
void BodyRecovery::add_known_traction(const ConstraintGroup& group, const Vec3& centre, RowSet& rows) const {
  const TractionCondition& condition = body_.boundary->conditions[group.condition];
  for (std::size_t p = 0; p < group.position.size(); ++p) {
    const Vec3 d = group.position[p] - centre, n = group.normal[p];
    Vec3 t = Vec3::Zero();
    if (condition.traction)
      t = grid_.rotation.transpose() * condition.traction(grid_.to_global(group.position[p]), grid_.rotation * n) /
          scales_.stress;
    for (const Vec3& e : known_directions(condition, n, grid_.rotation)) rows.add(traction_row(d, n, e), e.dot(t));
  }
}

std::map<int, PairState> BodyRecovery::pair_states(const std::vector<int>& cells) const {
  std::map<int, PairState> states;
  for (int c : cells)
    for (int l : body_.boundary->links_of_cell[c]) {
      const ContactLink& link = body_.boundary->links[l];
      PairState& state = states[link.pair];
      state.links.push_back(l);
      state.area += link.weight;
      if (link.active) state.closed_area += link.weight;
    }
  return states;
}

/// Fit over whole active cells of the other body under the patch's contact points, down to the auxiliary depth
/// (equation 13).
PatchFit BodyRecovery::auxiliary_fit(const PairState& state) const {
  const RecoveryBody& other = other_body(state);
  const CutCells& cc = *other.mesh->cut_cells;
  const Mat3 to_other = cc.grid.rotation.transpose() * grid_.rotation;
  std::vector<int> cells;
  Vec3 centre = Vec3::Zero();
  for (int l : state.links) {
    const ContactLink& link = body_.boundary->links[l];
    centre += link.weight / state.area * link.other_position;
    const Vec3 inward = to_other * link.normal;
    for (double depth : {0.05, 0.35, 0.65, 0.95}) {
      const Vec3 x = link.other_position + depth * options_.auxiliary_depth * inward;
      const int c = cc.find(
          {static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])), static_cast<int>(std::floor(x[2]))});
      if (c >= 0) cells.push_back(c);
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  PatchFit fit = fit_cells(other, cells, centre);
  double volume = 0;
  for (int c : cells) volume += cc.volume_fraction(c);
  if (volume < 0.25) fit.regular = false;  // too little to carry six linear components
  return fit;
}

/// Equation 12: zero shear on both bodies, equal normal traction. Open patches are free surfaces; a closed group
/// without an auxiliary patch keeps the zero shear only.
void BodyRecovery::add_contact(const ConstraintGroup& group, const PatchFit& own, const PatchFit* auxiliary,
                               const PairState& state, RowSet& rows) const {
  for (std::size_t p = 0; p < group.position.size(); ++p) {
    const Vec3 x = group.position[p], n = group.normal[p], d = x - own.centre;
    const auto [t1, t2] = tangents(n);
    rows.add(traction_row(d, n, t1), 0);
    rows.add(traction_row(d, n, t2), 0);
    if (!state.is_closed()) {
      rows.add(traction_row(d, n, n), 0);
      continue;
    }
    if (!auxiliary) continue;
    const auto& links = body_.boundary->links;
    int nearest = state.links.front();
    for (int l : state.links)
      if ((links[l].position - x).squaredNorm() < (links[nearest].position - x).squaredNorm()) nearest = l;
    const Grid& other_grid = other_body(state).mesh->cut_cells->grid;
    const Mat3 to_other = other_grid.rotation.transpose() * grid_.rotation;
    const Vec3 y = other_grid.to_grid(grid_.to_global(x) + links[nearest].distance * (grid_.rotation * n));
    const Vec3 e = y - auxiliary->centre, m = to_other * n;
    rows.add(Row24::Zero(), traction_row(e, m, to_other * t1), 0);
    rows.add(Row24::Zero(), traction_row(e, m, to_other * t2), 0);
    rows.add(traction_row(d, n, n), -traction_row(e, m, m), 0);
  }
}

/// Where contact is open the pressure is exactly zero: conflicting data elsewhere in the patch (a load on a face that
/// meets the contact face at an edge) must not leak into it through the least-squares solution.
void BodyRecovery::enforce_free_contact(const std::vector<ConstraintGroup>& groups,
                                        const std::map<int, PairState>& states, const PatchFit& own,
                                        Eigen::VectorXd& unknowns) const {
  RowSet rows;
  for (const ConstraintGroup& group : groups) {
    const auto state = states.find(group.pair);
    if (state == states.end() || state->second.is_closed()) continue;
    for (std::size_t p = 0; p < group.position.size(); ++p)
      rows.add(traction_row(group.position[p] - own.centre, group.normal[p], group.normal[p]), 0);
  }
  if (rows.size() == 0) return;
  Eigen::VectorXd a = unknowns.head<num_unknowns>();
  constrain_fit({own.mass}, rows.matrix(false), rows.values(), options_.rank_tolerance, a);
  unknowns.head<num_unknowns>() = a;
}

PatchKind BodyRecovery::recover(int n, RecoveryCounts& counts, Eigen::VectorXd& a) const {
  const PatchSet& patches = *body_.patches;
  const std::vector<int> cells(patches.cells.begin() + patches.begin[n], patches.cells.begin() + patches.begin[n + 1]);
  const Index3& node = body_.mesh->nodes[n];
  const PatchFit own = fit_cells(body_, cells, Vec3(node[0], node[1], node[2]));
  if (!own.regular) return PatchKind::interior;  // keeps the unconstrained value; counted by the caller's fit

  const auto groups =
      constraint_groups(*body_.mesh->cut_cells, *body_.boundary, cells.data(), static_cast<int>(cells.size()));
  const std::map<int, PairState> states = pair_states(cells);
  const PairState* closed = nullptr;  // the pair with the largest closed area gets the auxiliary patch
  for (const auto& [pair, state] : states)
    if (state.is_closed() && (!closed || state.closed_area > closed->closed_area)) closed = &state;
  PatchFit auxiliary;
  if (closed) auxiliary = auxiliary_fit(*closed);
  const bool coupled = closed && auxiliary.regular;
  if (closed && !coupled) ++counts.without_auxiliary;

  RowSet rows;
  PatchKind kind = PatchKind::interior;
  add_equilibrium(body_, own.centre, false, rows);
  if (coupled) add_equilibrium(other_body(*closed), auxiliary.centre, true, rows);
  std::map<int, double> closed_on_surface;
  for (const ConstraintGroup& group : groups) {
    const auto state = states.find(group.pair);
    if (state != states.end() && state->second.is_closed()) closed_on_surface[group.surface] += group.area;
  }
  for (const ConstraintGroup& group : groups) {
    const auto state = states.find(group.pair);
    // The rim of a contact face that reaches beyond the other body (rounding, an overhang of a small part of the
    // patch): the closed part decides, as among contact points.
    const auto closed_part = closed_on_surface.find(group.surface);
    if (state == states.end() &&
        (group.pair >= 0 || (closed_part != closed_on_surface.end() &&
                             closed_part->second > closed_fraction * (closed_part->second + group.area)))) {
      add_zero_shear(group, own.centre, rows);
      continue;
    }
    if (state == states.end()) {
      add_known_traction(group, own.centre, rows);
      kind = std::max(
          kind, body_.boundary->conditions[group.condition].is_support() ? PatchKind::support : PatchKind::boundary);
    } else {
      const bool here = coupled && &state->second == closed;
      add_contact(group, own, here ? &auxiliary : nullptr, state->second, rows);
      if (state->second.is_mixed())
        kind = std::max(kind, PatchKind::contact_edge);
      else
        kind = std::max(kind, state->second.is_closed() ? PatchKind::contact : PatchKind::boundary);
    }
  }
  std::vector<MassMatrix> mass{own.mass};
  Eigen::VectorXd unknowns(coupled ? 2 * num_unknowns : num_unknowns);
  unknowns.head<num_unknowns>() = own.a;
  if (coupled) {
    mass.push_back(auxiliary.mass);
    unknowns.tail<num_unknowns>() = auxiliary.a;
  }
  const ConstrainedFitStatus status =
      constrain_fit(mass, rows.matrix(coupled), rows.values(), options_.rank_tolerance, unknowns);
  enforce_free_contact(groups, states, own, unknowns);
  counts.truncated_rows += status.truncated;
  counts.inconsistent += status.inconsistent;
  counts.grown += patches.grown[n];
  a = unknowns.head<num_unknowns>();
  return kind;
}

const char* kind_name(PatchKind kind) {
  constexpr const char* names[] = {"interior", "boundary", "support", "contact", "contact_edge"};
  return names[static_cast<int>(kind)];
}

}  // namespace

RecoveryCounts recover_constrained(const std::vector<RecoveryBody>& bodies, const Scales& scales,
                                   const RecoveryOptions& options, std::vector<CoefficientView>& coefficients,
                                   std::vector<std::vector<int>>& kinds) {
  RecoveryCounts counts;
  coefficients.clear();
  kinds.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const int num_nodes = bodies[b].mesh->num_nodes;
    CoefficientView out("cgcontact::recover_stress::coefficients", num_nodes);
    Kokkos::deep_copy(out, bodies[b].unconstrained);
    std::vector<int> kind_of_node(num_nodes);
    const BodyRecovery recovery(bodies, static_cast<int>(b), scales, options);
    Eigen::VectorXd a;
    for (int n = 0; n < num_nodes; ++n) {
      a.resize(0);
      const PatchKind kind = recovery.recover(n, counts, a);
      kind_of_node[n] = static_cast<int>(kind);
      ++counts.patches_by_kind[kind_name(kind)];
      for (int i = 0; i < a.size(); ++i) out(n, i / num_terms, i % num_terms) = a[i];
    }
    coefficients.push_back(out);
    kinds.push_back(std::move(kind_of_node));
  }
  return counts;
}

}  // namespace cgcontact
