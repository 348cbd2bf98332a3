#include "recovery/recover_stress.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "recovery/constrained_fit.hpp"
#include "recovery/constraints.hpp"

namespace cgcontact {
namespace {

constexpr int num_unknowns = 6 * num_terms;

/// Patches per chunk of the parallel loop.
constexpr std::size_t grain = 128;

enum class PatchKind { interior, boundary, support, contact, contact_edge };
constexpr int num_kinds = 5;
constexpr const char* kind_names[num_kinds] = {"interior", "boundary", "support", "contact", "contact_edge"};

/// Rows collected for one patch; `second` rows are those of the auxiliary body.
class RowSet {
 public:
  void add(const Row24& own, double value) {
    own_.push_back(own);
    other_.push_back(-1);
    value_.push_back(value);
  }
  void add(const Row24& own, const Row24& other, double value) {
    own_.push_back(own);
    other_.push_back(static_cast<int>(auxiliary_.size()));
    auxiliary_.push_back(other);
    value_.push_back(value);
  }
  Eigen::MatrixXd matrix(bool with_auxiliary) const {
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(own_.size(), with_auxiliary ? 2 * num_unknowns : num_unknowns);
    for (std::size_t r = 0; r < own_.size(); ++r) {
      C.row(r).head<num_unknowns>() = own_[r];
      if (with_auxiliary && other_[r] >= 0) C.row(r).tail<num_unknowns>() = auxiliary_[other_[r]];
    }
    return C;
  }
  std::size_t size() const { return value_.size(); }
  Eigen::VectorXd values() const { return Eigen::Map<const Eigen::VectorXd>(value_.data(), value_.size()); }

 private:
  std::vector<Row24> own_, auxiliary_;
  std::vector<int> other_;  ///< index into auxiliary_, or -1
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

MassMatrix to_matrix(const double m[num_terms][num_terms]) {
  MassMatrix matrix;
  for (int i = 0; i < num_terms; ++i)
    for (int j = 0; j < num_terms; ++j) matrix(i, j) = m[i][j];
  return matrix;
}

/// The unconstrained fit of a node.
PatchFit own_fit(const RecoveryBody& body, int n) {
  const PatchSet& patches = *body.patches;
  const Index3& node = body.mesh->nodes[n];
  PatchFit fit;
  fit.centre = Vec3(node[0], node[1], node[2]);
  double m[num_terms][num_terms];
  gather_mass(*body.mesh, patches, patches.cells.data() + patches.begin[n], patches.begin[n + 1] - patches.begin[n],
              fit.centre.data(), m);
  fit.mass = to_matrix(m);
  fit.a = Eigen::Map<const Eigen::Matrix<double, num_unknowns, 1>>(body.field.at(n));
  fit.regular = cholesky(m);
  return fit;
}

/// Integrals of sigma_h over the cells of one body that auxiliary patches may consist of.
struct AuxiliaryCells {
  Subset cells;
  CellStressView stress;
};

/// Cells near the contact points, as far as the auxiliary depth and two cells more.
AuxiliaryCells auxiliary_cells(const RecoveryBody& body, const RealView& u, double depth) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<int> touched;
  for (const ContactLink& link : body.boundary->links) touched.push_back(link.cell);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  const int reach = static_cast<int>(std::ceil(depth)) + 2, width = 2 * reach + 1;
  std::vector<char> marked(cc.cells.size(), 0);
  for (int t : touched)
    for (int n = 0; n < width * width * width; ++n) {
      const Index3& c = cc.cells[t];
      const int near =
          cc.find({c[0] + n % width - reach, c[1] + n / width % width - reach, c[2] + n / width / width - reach});
      if (near >= 0) marked[near] = 1;
    }
  AuxiliaryCells auxiliary{Subset(marked), {}};
  auxiliary.stress = CellStressView("cgcontact::recover_stress::auxiliary", auxiliary.cells.size());
  integrate_cell_stress(*body.mesh, *body.patches, auxiliary.cells, u, auxiliary.stress);
  return auxiliary;
}

/// The fit over some cells of an auxiliary patch.
PatchFit fit_cells(const RecoveryBody& body, const AuxiliaryCells& auxiliary, const std::vector<int>& cells,
                   const Vec3& centre) {
  PatchSums sums = gather_patch(*body.mesh, *body.patches, cells.data(), static_cast<int>(cells.size()), centre.data(),
                                auxiliary.stress, auxiliary.cells);
  PatchFit fit;
  fit.centre = centre;
  fit.mass = to_matrix(sums.m);
  fit.regular = cholesky(sums.m);
  for (int k = 0; k < 6 && fit.regular; ++k) {
    cholesky_solve(sums.m, sums.H[k]);
    for (int t = 0; t < num_terms; ++t) fit.a[num_terms * k + t] = sums.H[k][t];
  }
  return fit;
}

/// A patch counts as closed when more than this part of its contact area is. Measured on the paper's scene, geometric
/// mean over 7 grid offsets, error of the pressure at n = 8, 16, 32: any closed point .159 .080 .038, a quarter .149
/// .067 .035, half .216 .097 .041.
constexpr double closed_fraction = 0.25;

/// Of contact points equally far from a place (cell units squared) the first counts, whatever the rounding.
constexpr double same_distance = 1e-9;

/// Contact points of one pair inside a patch.
struct PairState {
  int pair;
  double area = 0, closed_area = 0;
  std::vector<int> links;
  bool is_closed() const { return closed_area > closed_fraction * area; }
  bool is_mixed() const { return closed_area > 0 && closed_area < area * (1 - 1e-12); }
};

/// Recovers the patches of one body; holds what is common to them.
class BodyRecovery {
 public:
  BodyRecovery(const std::vector<RecoveryBody>& bodies, const std::vector<AuxiliaryCells>& auxiliary, int index,
               const Scales& scales, const RecoveryOptions& options)
      : bodies_(bodies),
        auxiliary_(auxiliary),
        body_(bodies[index]),
        grid_(body_.mesh->cut_cells->grid),
        scales_(scales),
        options_(options),
        pieces_(*body_.mesh->cut_cells, *body_.boundary) {}

  /// Constrains the coefficients of node n; adds to the counts.
  PatchKind recover(int n, RecoveryCounts& counts) const;

 private:
  bool is_interior(int n) const;
  Vec3 divergence(const RecoveryBody& body, const Vec3& centre) const;
  void recover_interior(int n) const;
  void add_equilibrium(const RecoveryBody& body, const Vec3& centre, bool auxiliary, RowSet& rows) const;
  void add_known_traction(const ConstraintGroup& group, const Vec3& centre, RowSet& rows) const;
  static void add_zero_shear(const ConstraintGroup& group, const Vec3& centre, RowSet& rows) {
    for (int p = 0; p < group.num_points; ++p) {
      const auto [t1, t2] = tangents(group.normal[p]);
      rows.add(traction_row(group.position[p] - centre, group.normal[p], t1), 0);
      rows.add(traction_row(group.position[p] - centre, group.normal[p], t2), 0);
    }
  }
  void add_contact(const ConstraintGroup& group, const PatchFit& own, const PatchFit* auxiliary, const PairState& state,
                   RowSet& rows) const;
  void enforce_free_contact(const std::vector<ConstraintGroup>& groups, const std::vector<PairState>& states,
                            const PatchFit& own, Eigen::VectorXd& unknowns) const;
  std::vector<PairState> pair_states(const int* cells, int num_cells) const;
  PatchFit auxiliary_fit(const PairState& state) const;
  int other_index(const PairState& state) const { return body_.boundary->links[state.links.front()].other_body; }
  const RecoveryBody& other_body(const PairState& state) const { return bodies_[other_index(state)]; }

  const std::vector<RecoveryBody>& bodies_;
  const std::vector<AuxiliaryCells>& auxiliary_;  ///< by body
  const RecoveryBody& body_;
  const Grid& grid_;
  const Scales& scales_;
  const RecoveryOptions& options_;
  const BoundaryPieces pieces_;
};

/// Eight full cells without contact: only equilibrium is known there.
bool BodyRecovery::is_interior(int n) const {
  const PatchSet& patches = *body_.patches;
  if (!patches.full[n]) return false;
  for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p)
    if (!body_.boundary->links_of_cell[patches.cells[p]].empty()) return false;
  return true;
}

/// What div sigma* must be at a place, per cell unit.
Vec3 BodyRecovery::divergence(const RecoveryBody& body, const Vec3& centre) const {
  if (!body.boundary->body_force_at) return Vec3::Zero();
  const Grid& grid = body.mesh->cut_cells->grid;
  return -grid.cell_size / scales_.stress *
         (grid.rotation.transpose() * body.boundary->body_force_at(grid.to_global(centre)));
}

/// The mass matrix of a full patch is diagonal and the same for all slopes: each row of the equilibrium is corrected on
/// its own, its three terms alike.
void BodyRecovery::recover_interior(int n) const {
  constexpr int term[3][3] = {{1, 14, 23}, {13, 6, 19}, {21, 18, 11}};  // slope along j of component (i, j)
  const Index3& node = body_.mesh->nodes[n];
  const Vec3 value = divergence(body_, Vec3(node[0], node[1], node[2]));
  double* a = &body_.field.values(n, 0, 0);
  for (int i = 0; i < 3; ++i) {
    const int* t = term[i];
    const double correction = (value[i] - (a[t[0]] + a[t[1]] + a[t[2]])) / 3;
    for (int j = 0; j < 3; ++j) a[t[j]] += correction;
  }
}

void BodyRecovery::add_equilibrium(const RecoveryBody& body, const Vec3& centre, bool auxiliary, RowSet& rows) const {
  static const auto divergence_of = divergence_rows();
  const Vec3 value = divergence(body, centre);
  for (int i = 0; i < 3; ++i) {
    const Row24 row = divergence_of.row(i);
    if (auxiliary)
      rows.add(Row24::Zero(), row, value[i]);
    else
      rows.add(row, value[i]);
  }
}

/// Equation 5 in the directions that no support holds.
void BodyRecovery::add_known_traction(const ConstraintGroup& group, const Vec3& centre, RowSet& rows) const {
  const TractionCondition& condition = body_.boundary->conditions[group.condition];
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 d = group.position[p] - centre, n = group.normal[p];
    Vec3 t = Vec3::Zero();
    if (condition.traction)
      t = grid_.rotation.transpose() * condition.traction(grid_.to_global(group.position[p]), grid_.rotation * n) /
          scales_.stress;
    for (const Vec3& e : known_directions(condition, n, grid_.rotation)) rows.add(traction_row(d, n, e), e.dot(t));
  }
}

/// By pair.
std::vector<PairState> BodyRecovery::pair_states(const int* cells, int num_cells) const {
  std::vector<PairState> states;
  for (int c = 0; c < num_cells; ++c)
    for (int l : body_.boundary->links_of_cell[cells[c]]) {
      const ContactLink& link = body_.boundary->links[l];
      auto state = std::lower_bound(states.begin(), states.end(), link.pair,
                                    [](const PairState& s, int pair) { return s.pair < pair; });
      if (state == states.end() || state->pair != link.pair)
        state = states.insert(state, PairState{link.pair, 0, 0, {}});
      state->links.push_back(l);
      state->area += link.weight;
      if (link.active) state->closed_area += link.weight;
    }
  return states;
}

const PairState* find_state(const std::vector<PairState>& states, int pair) {
  for (const PairState& state : states)
    if (state.pair == pair) return &state;
  return nullptr;
}

/// Fit over whole active cells of the other body under the patch's contact points, down to the auxiliary depth
/// (equation 13).
PatchFit BodyRecovery::auxiliary_fit(const PairState& state) const {
  const RecoveryBody& other = other_body(state);
  const AuxiliaryCells& auxiliary = auxiliary_[other_index(state)];
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
      if (c >= 0 && auxiliary.cells.row(c) >= 0) cells.push_back(c);
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  PatchFit fit = fit_cells(other, auxiliary, cells, centre);
  double volume = 0;
  for (int c : cells) volume += cc.volume_fraction(c);
  if (volume < 0.25) fit.regular = false;  // too little to carry six linear components
  return fit;
}

/// Equation 12: zero shear on both bodies, equal normal traction. Open patches are free surfaces; a closed group
/// without an auxiliary patch keeps the zero shear only.
void BodyRecovery::add_contact(const ConstraintGroup& group, const PatchFit& own, const PatchFit* auxiliary,
                               const PairState& state, RowSet& rows) const {
  for (int p = 0; p < group.num_points; ++p) {
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
    double least = (links[nearest].position - x).squaredNorm();
    for (int l : state.links) {
      const double distance = (links[l].position - x).squaredNorm();
      if (distance < least - same_distance) nearest = l, least = distance;
    }
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
                                        const std::vector<PairState>& states, const PatchFit& own,
                                        Eigen::VectorXd& unknowns) const {
  RowSet rows;
  for (const ConstraintGroup& group : groups) {
    const PairState* state = find_state(states, group.pair);
    if (!state || state->is_closed()) continue;
    for (int p = 0; p < group.num_points; ++p)
      rows.add(traction_row(group.position[p] - own.centre, group.normal[p], group.normal[p]), 0);
  }
  if (rows.size() == 0) return;
  Eigen::VectorXd a = unknowns.head<num_unknowns>();
  constrain_fit({own.mass}, rows.matrix(false), rows.values(), options_.rank_tolerance, a);
  unknowns.head<num_unknowns>() = a;
}

PatchKind BodyRecovery::recover(int n, RecoveryCounts& counts) const {
  if (is_interior(n)) {
    recover_interior(n);
    return PatchKind::interior;
  }
  const PatchSet& patches = *body_.patches;
  const int* cells = patches.cells.data() + patches.begin[n];
  const int num_cells = patches.begin[n + 1] - patches.begin[n];
  const PatchFit own = own_fit(body_, n);
  if (!own.regular) return PatchKind::interior;  // keeps the unconstrained value; counted by the caller's fit

  const std::vector<ConstraintGroup> groups = pieces_.groups(cells, num_cells);
  const std::vector<PairState> states = pair_states(cells, num_cells);
  const PairState* closed = nullptr;  // the pair with the largest closed area gets the auxiliary patch
  for (const PairState& state : states)
    if (state.is_closed() && (!closed || state.closed_area > closed->closed_area)) closed = &state;
  PatchFit auxiliary;
  if (closed) auxiliary = auxiliary_fit(*closed);
  const bool coupled = closed && auxiliary.regular;
  if (closed && !coupled) ++counts.without_auxiliary;

  RowSet rows;
  PatchKind kind = PatchKind::interior;
  add_equilibrium(body_, own.centre, false, rows);
  if (coupled) add_equilibrium(other_body(*closed), auxiliary.centre, true, rows);
  const auto closed_on_surface = [&](int surface) {
    double area = 0;
    for (const ConstraintGroup& group : groups) {
      const PairState* state = find_state(states, group.pair);
      if (group.surface == surface && state && state->is_closed()) area += group.area;
    }
    return area;
  };
  for (const ConstraintGroup& group : groups) {
    const PairState* state = find_state(states, group.pair);
    if (state) {
      const bool here = coupled && state == closed;
      add_contact(group, own, here ? &auxiliary : nullptr, *state, rows);
      if (state->is_mixed())
        kind = std::max(kind, PatchKind::contact_edge);
      else
        kind = std::max(kind, state->is_closed() ? PatchKind::contact : PatchKind::boundary);
      continue;
    }
    // The rim of a contact face that reaches beyond the other body (rounding, an overhang of a small part of the
    // patch): the closed part decides, as among contact points.
    const double closed_part = closed_on_surface(group.surface);
    if (group.pair >= 0 || closed_part > closed_fraction * (closed_part + group.area)) {
      add_zero_shear(group, own.centre, rows);
      continue;
    }
    add_known_traction(group, own.centre, rows);
    kind = std::max(
        kind, body_.boundary->conditions[group.condition].is_support() ? PatchKind::support : PatchKind::boundary);
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
  for (int i = 0; i < num_unknowns; ++i) body_.field.values(n, i / num_terms, i % num_terms) = unknowns[i];
  return kind;
}

/// What one chunk of patches counts.
struct ChunkCounts {
  std::array<long long, num_kinds> kinds{};
  RecoveryCounts other;
};

}  // namespace

RecoveryCounts recover_constrained(const std::vector<RecoveryBody>& bodies, const RealView& u, const Scales& scales,
                                   const RecoveryOptions& options) {
  RecoveryCounts counts;
  std::vector<AuxiliaryCells> auxiliary;
  for (const RecoveryBody& body : bodies) auxiliary.push_back(auxiliary_cells(body, u, options.auxiliary_depth));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t num_nodes = bodies[b].mesh->num_nodes;
    const BodyRecovery recovery(bodies, auxiliary, static_cast<int>(b), scales, options);
    std::vector<ChunkCounts> chunks(num_chunks(num_nodes, grain));
    parallel_chunks(num_nodes, grain, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n)
        ++chunks[chunk].kinds[static_cast<int>(recovery.recover(static_cast<int>(n), chunks[chunk].other))];
    });
    for (const ChunkCounts& chunk : chunks) {
      for (int kind = 0; kind < num_kinds; ++kind)
        if (chunk.kinds[kind] > 0) counts.patches_by_kind[kind_names[kind]] += chunk.kinds[kind];
      counts.grown += chunk.other.grown;
      counts.truncated_rows += chunk.other.truncated_rows;
      counts.inconsistent += chunk.other.inconsistent;
      counts.without_auxiliary += chunk.other.without_auxiliary;
    }
  }
  return counts;
}

}  // namespace cgcontact
