#include "recovery/patch_assembly.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "recovery/edge_moments.hpp"

namespace cgcontact {
namespace {

/// A patch counts as closed when more than this part of its contact area is. Measured on the paper's scene, geometric
/// mean over 7 grid offsets, error of the pressure at n = 8, 16, 32: any closed point .159 .080 .038, a quarter .149
/// .067 .035, half .216 .097 .041.
constexpr double closed_fraction = 0.25;

/// Closed patches whose contact face begins closer than this to the edge (own cells) carry its term as well.
constexpr double edge_reach = 2;

/// Of contact points equally far from a place (cell units squared) the first counts, whatever the rounding.
constexpr double same_distance = 1e-9;

/// Least volume of an auxiliary patch, cells: less carries no linear polynomial of six components.
constexpr double least_auxiliary_volume = 0.25;

/// Unit directions orthogonal to all held ones: those in which the traction at a point with normal n is known.
/// Returns their number.
int known_directions(const TractionCondition& condition, const Vec3& n, const Mat3& rotation, Vec3 directions[3]) {
  Vec3 basis[3];
  int count = 0;
  const auto extend = [&](Vec3 v) {
    for (int i = 0; i < count; ++i) v -= basis[i].dot(v) * basis[i];
    if (count < 3 && v.norm() >= 0.1) basis[count++] = v.normalized();
  };
  if (condition.normal_held) extend(n);
  for (int i = 0; i < 3; ++i)
    if (condition.component_held[i]) extend(rotation.row(i).transpose());
  const int num_held = count;
  const auto [t1, t2] = tangents(n);
  for (const Vec3& v : {n, t1, t2}) extend(v);
  for (int i = num_held; i < count; ++i) directions[i - num_held] = basis[i];
  return count - num_held;
}

Eigen::Matrix<double, num_terms, num_terms> to_matrix(const double m[num_terms][num_terms]) {
  Eigen::Matrix<double, num_terms, num_terms> matrix;
  for (int i = 0; i < num_terms; ++i)
    for (int j = 0; j < num_terms; ++j) matrix(i, j) = m[i][j];
  return matrix;
}

/// The component along e of the traction on the normal n, in one of the bodies of a row.
void set_traction(PatchRow& row, int body, const Vec3& place, const Vec3& n, const Vec3& e, double sign = 1) {
  constexpr int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
  for (int k = 0; k < 6; ++k) {
    const int i = first[k], j = second[k];
    row.weight[body][k] = sign * (k < 3 ? e[i] * n[i] : e[i] * n[j] + e[j] * n[i]);
  }
  for (int i = 0; i < 3; ++i) row.place[body][i] = place[i];
}

PatchRow traction_row_at(int body, const Vec3& place, const Vec3& n, const Vec3& e, double value) {
  PatchRow row;
  set_traction(row, body, place, n, e);
  row.value = value;
  return row;
}

const PairState* find_state(const std::vector<PairState>& states, int pair) {
  for (const PairState& state : states)
    if (state.pair == pair) return &state;
  return nullptr;
}

/// The polynomial that is left when the term of the edge is taken out of sigma_h.
void subtract_term(const RecoveryBody& body, const int* cells, int num_cells, const ContactEdge& edge, double factor,
                   PatchFit& fit) {
  fit.a -= factor * edge_polynomial(*body.mesh, cells, num_cells, edge, fit);
}

/// The row holds for the whole stress: what the term of the edge contributes goes to the right-hand side.
void subtract_term_of_row(const ContactEdge& edge, double factor, const PatchFit& own, PatchRow& row) {
  double s[6];
  edge.stress(own.centre + Vec3(row.place[0]), s);
  for (int k = 0; k < 6; ++k) row.value -= factor * row.weight[0][k] * s[k];
}

/// Integral of sigma_h : sigma_h (sum of the squares of six components) over the body's part of a cell.
double stress_square(const BodyMesh& mesh, int cell, const RealView& u) {
  const CutCells& cc = *mesh.cut_cells;
  const int cut = cc.cut_of_active[cell];
  double weights[27], corner[8][3], sum = 0;
  fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], 3, weights);
  for (int a = 0; a < 8; ++a)
    for (int k = 0; k < 3; ++k) corner[a][k] = u(3 * mesh.cell_nodes[cell][a] + k);
  for (int q = 0; q < 27; ++q) {
    const double xi[3] = {Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]};
    double s[6];
    hex_stress(mesh.law, corner, xi, s);
    for (double v : s) sum += weights[q] / 8 * v * v;
  }
  return mesh.stress_factor() * mesh.stress_factor() * sum;
}

/// Mean square of what a fit leaves of sigma_h; not less than the part of it that rounding may leave of a good fit.
double fit_variance(const BodyMesh& mesh, const AuxiliaryCells& near, const int* cells, int num_cells,
                    const PatchFit& fit) {
  constexpr double least = 1e-8;
  double square = 0, volume = 0, fitted = 0;
  for (int i = 0; i < num_cells; ++i) {
    const int row = near.cells.row(cells[i]);
    if (row < 0) return 0;
    square += near.square[row];
    volume += mesh.cut_cells->volume_fraction(cells[i]);
  }
  for (int k = 0; k < 6; ++k) {
    const auto a = fit.a.segment<num_terms>(num_terms * k);
    fitted += a.dot(fit.mass * a);
  }
  return std::max(square - fitted, least * square) / volume;
}

}  // namespace

bool PairState::is_closed() const { return closed_area > closed_fraction * area; }

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
  AuxiliaryCells auxiliary{Subset(marked), {}, {}};
  auxiliary.stress = CellStressView("cgcontact::recovery::auxiliary", auxiliary.cells.size());
  integrate_cell_stress(*body.mesh, *body.patches, auxiliary.cells, u, auxiliary.stress);
  auxiliary.square.resize(auxiliary.cells.size());
  parallel_for(auxiliary.square.size(), 64, [&](std::size_t row) {
    auxiliary.square[row] = stress_square(*body.mesh, auxiliary.cells.number(static_cast<int>(row)), u);
  });
  return auxiliary;
}

PatchAssembly::PatchAssembly(const std::vector<RecoveryBody>& bodies, const std::vector<AuxiliaryCells>& auxiliary,
                             int index, const Scales& scales, const RecoveryOptions& options)
    : bodies_(bodies),
      auxiliary_(auxiliary),
      body_(bodies[index]),
      index_(index),
      grid_(body_.mesh->cut_cells->grid),
      scales_(scales),
      options_(options),
      pieces_(*body_.mesh->cut_cells, *body_.boundary) {}

bool PatchAssembly::is_interior(int n) const {
  const PatchSet& patches = *body_.patches;
  if (!patches.full[n]) return false;
  for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p)
    if (!body_.boundary->links_of_cell[patches.cells[p]].empty()) return false;
  return true;
}

Vec3 PatchAssembly::divergence(const RecoveryBody& body, const Vec3& centre) const {
  if (!body.boundary->body_force_at) return Vec3::Zero();
  const Grid& grid = body.mesh->cut_cells->grid;
  return -grid.cell_size / scales_.stress *
         (grid.rotation.transpose() * body.boundary->body_force_at(grid.to_global(centre)));
}

void PatchAssembly::pair_states(int node, std::vector<PairState>& states) const {
  states.clear();
  const PatchSet& patches = *body_.patches;
  for (int p = patches.begin[node]; p < patches.begin[node + 1]; ++p)
    for (int l : body_.boundary->links_of_cell[patches.cells[p]]) {
      const ContactLink& link = body_.boundary->links[l];
      auto state = std::lower_bound(states.begin(), states.end(), link.pair,
                                    [](const PairState& s, int pair) { return s.pair < pair; });
      if (state == states.end() || state->pair != link.pair)
        state = states.insert(state, PairState{link.pair, link.other_body, 0, 0});
      state->area += link.weight;
      if (link.active) state->closed_area += link.weight;
    }
}

PatchFit PatchAssembly::own_fit(int n) const {
  const PatchSet& patches = *body_.patches;
  const Index3& node = body_.mesh->nodes[n];
  PatchFit fit;
  fit.centre = Vec3(node[0], node[1], node[2]);
  double m[num_terms][num_terms];
  gather_mass(*body_.mesh, patches, patches.cells.data() + patches.begin[n], patches.begin[n + 1] - patches.begin[n],
              fit.centre.data(), m);
  fit.mass = to_matrix(m);
  fit.a = Eigen::Map<const Eigen::Matrix<double, 6 * num_terms, 1>>(body_.field.at(n));
  fit.regular = cholesky(m);
  return fit;
}

/// Fit over whole active cells of the other body under the patch's contact points, down to the auxiliary depth
/// (equation 13).
PatchFit PatchAssembly::auxiliary_fit(int node, const PairState& state, std::vector<int>& cells) const {
  const RecoveryBody& other = bodies_[state.other_body];
  const AuxiliaryCells& auxiliary = auxiliary_[state.other_body];
  const CutCells& cc = *other.mesh->cut_cells;
  const Mat3 to_other = cc.grid.rotation.transpose() * grid_.rotation;
  const PatchSet& patches = *body_.patches;
  PatchFit fit;
  fit.centre = Vec3::Zero();
  cells.clear();
  for (int p = patches.begin[node]; p < patches.begin[node + 1]; ++p)
    for (int l : body_.boundary->links_of_cell[patches.cells[p]]) {
      const ContactLink& link = body_.boundary->links[l];
      if (link.pair != state.pair) continue;
      fit.centre += link.weight / state.area * link.other_position;
      const Vec3 inward = to_other * link.normal;
      for (double depth : {0.05, 0.35, 0.65, 0.95}) {
        const Vec3 x = link.other_position + depth * options_.auxiliary_depth * inward;
        const int c = cc.find({static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                               static_cast<int>(std::floor(x[2]))});
        if (c >= 0 && auxiliary.cells.row(c) >= 0) cells.push_back(c);
      }
    }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  double volume = 0;
  for (int c : cells) volume += cc.volume_fraction(c);
  if (volume < least_auxiliary_volume) return fit;
  PatchSums sums = gather_patch(*other.mesh, *other.patches, cells.data(), static_cast<int>(cells.size()),
                                fit.centre.data(), auxiliary.stress, auxiliary.cells);
  fit.mass = to_matrix(sums.m);
  fit.regular = cholesky(sums.m);
  for (int k = 0; k < 6 && fit.regular; ++k) {
    cholesky_solve(sums.m, sums.H[k]);
    for (int t = 0; t < num_terms; ++t) fit.a[num_terms * k + t] = sums.H[k][t];
  }
  return fit;
}

/// Equation 5 in the directions that no support holds.
void PatchAssembly::add_known_traction(const ConstraintGroup& group, const Vec3& centre,
                                       std::vector<PatchRow>& rows) const {
  const TractionCondition& condition = body_.boundary->conditions[group.condition];
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 d = group.position[p] - centre, n = group.normal[p];
    Vec3 t = Vec3::Zero(), directions[3];
    if (condition.traction)
      t = grid_.rotation.transpose() * condition.traction(grid_.to_global(group.position[p]), grid_.rotation * n) /
          scales_.stress;
    const int count = known_directions(condition, n, grid_.rotation, directions);
    for (int i = 0; i < count; ++i) rows.push_back(traction_row_at(0, d, n, directions[i], directions[i].dot(t)));
  }
}

void PatchAssembly::add_zero_shear(const ConstraintGroup& group, const Vec3& centre,
                                   std::vector<PatchRow>& rows) const {
  for (int p = 0; p < group.num_points; ++p) {
    const auto [t1, t2] = tangents(group.normal[p]);
    for (const Vec3& t : {t1, t2})
      rows.push_back(traction_row_at(0, group.position[p] - centre, group.normal[p], t, 0));
  }
}

/// Equation 12: zero shear on both bodies, equal normal traction. Open patches are free surfaces, and so are the
/// polynomials beside the edge's term; a closed group without an auxiliary patch keeps the zero shear only.
void PatchAssembly::add_contact(const ConstraintGroup& group, int node, const PatchFit& own, const PatchFit* auxiliary,
                                const PairState& state, ContactMode mode, std::vector<PatchRow>& rows) const {
  const bool free = mode == ContactMode::open || mode == ContactMode::edge;
  const PatchSet& patches = *body_.patches;
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p], d = x - own.centre;
    const auto [t1, t2] = tangents(n);
    rows.push_back(traction_row_at(0, d, n, t1, 0));
    rows.push_back(traction_row_at(0, d, n, t2, 0));
    if (free) {
      rows.push_back(traction_row_at(0, d, n, n, 0));
      rows.back().firm = true;
    }
    if (!auxiliary) continue;
    const ContactLink* nearest = nullptr;
    double least = 0;
    for (int c = patches.begin[node]; c < patches.begin[node + 1]; ++c)
      for (int l : body_.boundary->links_of_cell[patches.cells[c]]) {
        const ContactLink& link = body_.boundary->links[l];
        if (link.pair != state.pair) continue;
        const double distance = (link.position - x).squaredNorm();
        if (!nearest || distance < least - same_distance) nearest = &link, least = distance;
      }
    const Grid& other_grid = bodies_[state.other_body].mesh->cut_cells->grid;
    const Mat3 to_other = other_grid.rotation.transpose() * grid_.rotation;
    const Vec3 y = other_grid.to_grid(grid_.to_global(x) + nearest->distance * (grid_.rotation * n));
    const Vec3 e = y - auxiliary->centre, m = to_other * n;
    rows.push_back(traction_row_at(1, e, m, to_other * t1, 0));
    rows.push_back(traction_row_at(1, e, m, to_other * t2, 0));
    if (free) {
      rows.push_back(traction_row_at(1, e, m, m, 0));
    } else {
      PatchRow row = traction_row_at(0, d, n, n, 0);
      set_traction(row, 1, e, m, m, -1);
      rows.push_back(row);
    }
  }
}

ContactEdge PatchAssembly::seen_from(const RecoveryBody& body, const Vec3& face_point, const Vec3& normal,
                                     const EdgePiece& piece, double unit) const {
  const BodyMesh& mesh = *body.mesh;
  const Grid& grid = mesh.cut_cells->grid;
  ContactEdge edge;
  edge.origin = grid.to_grid(piece.origin);
  edge.closed = grid.rotation.transpose() * piece.closed;
  edge.along = grid.rotation.transpose() * piece.along;
  edge.curvature = piece.curvature * grid.cell_size;
  edge.inverse_width = piece.inverse_width * grid.cell_size;
  const Vec3 x = grid.to_grid(face_point), n = grid.rotation.transpose() * normal;
  double least = 1e300;
  for (const Surface& surface : mesh.cut_cells->solid.surfaces()) {
    const double distance = std::abs(surface.signed_distance(x)) + (1 - std::abs(surface.gradient(x).dot(n)));
    if (distance >= least) continue;
    least = distance;
    edge.surface = surface;
    edge.orientation = surface.gradient(x).dot(n) < 0 ? -1 : 1;
  }
  edge.scale = grid.cell_size / unit;
  edge.poisson_ratio = mesh.law.lambda / (2 * (mesh.law.lambda + mesh.law.mu));
  return edge;
}

/// How a pair stands by the place of its edge; sets the patch's term if the edge is near.
PatchAssembly::ContactMode PatchAssembly::mode_at_edge(const PairState& state, const EdgeMap& edges, const int* cells,
                                                       int num_cells, PatchProblem& problem) const {
  const ContactMode plain = state.is_mixed()    ? ContactMode::unclear
                            : state.is_closed() ? ContactMode::closed
                                                : ContactMode::open;
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero(), opposite = Vec3::Zero();
  const Grid& other_grid = bodies_[state.other_body].mesh->cut_cells->grid;
  const auto each_link = [&](const auto& use) {
    for (int c = 0; c < num_cells; ++c)
      for (int l : body_.boundary->links_of_cell[cells[c]])
        if (body_.boundary->links[l].pair == state.pair) use(body_.boundary->links[l]);
  };
  each_link([&](const ContactLink& link) {
    centroid += link.weight / state.area * link.position;
    normal += link.weight / state.area * link.normal;
    opposite += link.weight / state.area * link.other_position;
  });
  EdgePiece piece;
  const Vec3 x = grid_.to_global(centroid), n = grid_.rotation * normal.normalized();
  if (!edges.near(state.pair, x, piece)) return plain;
  double least = 1e300, most = -1e300;
  each_link([&](const ContactLink& link) {
    const double inside = piece.inside(grid_.to_global(link.position)) / grid_.cell_size;
    least = std::min(least, inside);
    most = std::max(most, inside);
  });
  if (most <= 0) return ContactMode::open;
  if (least > edge_reach || problem.has_edge) return least > 0 ? ContactMode::closed : plain;
  problem.has_edge = true;
  problem.edge[0] = seen_from(body_, x, n, piece, grid_.cell_size);
  problem.edge[1] = seen_from(bodies_[state.other_body], other_grid.to_global(opposite), -n, piece, grid_.cell_size);
  problem.factor = piece.factor * std::sqrt(grid_.cell_size);
  return least > 0 ? ContactMode::closed : ContactMode::edge;
}

PatchProblem PatchAssembly::assemble(int node, const EdgeMap* edges, PatchWorkspace& workspace,
                                     std::vector<PatchRow>& rows) const {
  return assemble(node, edges, -1, workspace, rows);
}

PatchProblem PatchAssembly::assemble_at_edge(int node, int pair, PatchWorkspace& workspace,
                                             std::vector<PatchRow>& rows) const {
  return assemble(node, nullptr, pair, workspace, rows);
}

PatchProblem PatchAssembly::assemble(int node, const EdgeMap* edges, int edge_pair, PatchWorkspace& workspace,
                                     std::vector<PatchRow>& rows) const {
  const PatchSet& patches = *body_.patches;
  const int* cells = patches.cells.data() + patches.begin[node];
  const int num_cells = patches.begin[node + 1] - patches.begin[node];
  PatchProblem problem;
  problem.node = node;
  problem.first_row = rows.size();
  problem.fit[0] = own_fit(node);
  PatchFit& own = problem.fit[0];
  if (!own.regular) {
    problem.status = PatchStatus::singular;
    return problem;
  }
  problem.divergence[0] = divergence(body_, own.centre);
  std::vector<ConstraintGroup>& groups = workspace.groups;
  pieces_.groups(cells, num_cells, groups);
  pair_states(node, workspace.states);

  // How each pair stands, and where its edge is.
  std::vector<PairState>& states = workspace.states;
  workspace.modes.assign(states.size(), 0);
  const auto mode_of = [&](const PairState& state) {
    return static_cast<ContactMode>(workspace.modes[&state - states.data()]);
  };
  const PairState* coupled = nullptr;  // the pair with the largest closed area gets the auxiliary patch
  for (const PairState& state : states) {
    ContactMode mode = state.is_closed() ? ContactMode::closed : ContactMode::open;
    if (state.pair == edge_pair) {
      mode = ContactMode::edge;
    } else if (edges) {
      mode = mode_at_edge(state, *edges, cells, num_cells, problem);
    }
    workspace.modes[&state - states.data()] = static_cast<char>(mode);
    const bool wants =
        mode == ContactMode::closed || (mode == ContactMode::unclear && state.is_closed()) || state.pair == edge_pair;
    if (wants && (!coupled || state.closed_area > coupled->closed_area)) coupled = &state;
  }
  if (coupled) {
    problem.fit[1] = auxiliary_fit(node, *coupled, workspace.auxiliary);
    problem.coupled = problem.fit[1].regular;
    problem.pair = coupled->pair;
    problem.other_body = coupled->other_body;
    if (problem.coupled)
      problem.divergence[1] = divergence(bodies_[coupled->other_body], problem.fit[1].centre);
    else
      problem.status = PatchStatus::uncoupled;
  }
  if (problem.coupled) {
    const auto variance = [&](int body, const int* list, int count, const PatchFit& fit) {
      return fit_variance(*bodies_[body].mesh, auxiliary_[body], list, count, fit);
    };
    own.variance = variance(index_, cells, num_cells, own);
    problem.fit[1].variance = variance(problem.other_body, workspace.auxiliary.data(),
                                       static_cast<int>(workspace.auxiliary.size()), problem.fit[1]);
  }
  if (problem.has_edge) {
    subtract_term(body_, cells, num_cells, problem.edge[0], problem.factor, own);
    if (problem.coupled)
      subtract_term(bodies_[problem.other_body], workspace.auxiliary.data(),
                    static_cast<int>(workspace.auxiliary.size()), problem.edge[1], problem.factor, problem.fit[1]);
  }

  const auto closed_on_surface = [&](int surface) {
    double area = 0;
    for (const ConstraintGroup& group : groups) {
      const PairState* state = find_state(states, group.pair);
      if (group.surface == surface && state && mode_of(*state) != ContactMode::open) area += group.area;
    }
    return area;
  };
  const auto set_kind = [&](PatchKind kind) { problem.kind = std::max(problem.kind, kind); };
  for (const ConstraintGroup& group : groups) {
    const PairState* state = find_state(states, group.pair);
    if (state) {
      const ContactMode mode = mode_of(*state);
      add_contact(group, node, own, problem.coupled && state == coupled ? &problem.fit[1] : nullptr, *state,
                  mode == ContactMode::unclear ? (state->is_closed() ? ContactMode::closed : ContactMode::open) : mode,
                  rows);
      if (mode == ContactMode::unclear) problem.status = std::max(problem.status, PatchStatus::edge_unclear);
      set_kind(mode == ContactMode::open     ? PatchKind::boundary
               : mode == ContactMode::closed ? PatchKind::contact
                                             : PatchKind::contact_edge);
      continue;
    }
    // The rim of a contact face that reaches beyond the other body (rounding, an overhang of a small part of the
    // patch): the closed part decides, as among contact points.
    const double closed_part = closed_on_surface(group.surface);
    const std::size_t first = rows.size();
    if (group.pair >= 0 || closed_part > closed_fraction * (closed_part + group.area)) {
      add_zero_shear(group, own.centre, rows);
    } else {
      const TractionCondition& condition = body_.boundary->conditions[group.condition];
      add_known_traction(group, own.centre, rows);
      set_kind(condition.normal_held    ? PatchKind::symmetry
               : condition.is_support() ? PatchKind::support
               : condition.traction     ? PatchKind::loaded
                                        : PatchKind::boundary);
    }
    if (problem.has_edge)
      for (std::size_t r = first; r < rows.size(); ++r)
        subtract_term_of_row(problem.edge[0], problem.factor, own, rows[r]);
  }
  problem.num_rows = static_cast<int>(rows.size() - problem.first_row);
  return problem;
}

}  // namespace cgcontact
