#include "recovery/constrained/patch_assembly.hpp"

#include <algorithm>

#include "recovery/constrained/divergence.hpp"
#include "recovery/patch/edge_moments.hpp"

namespace cgcontact {
namespace {

/// Contact points lie on the same side of the body as a constraint point if the cosine between the normals is more.
constexpr double same_side = 0.5;

/// Contact points are equally far from a place if they are so up to this (squared, cells of the patch): of those the
/// one with the smallest gap counts, whatever the rounding and their order.
constexpr double same_distance = 1e-9;

/// Unit directions orthogonal to all held ones: those in which the traction at a point (m, global axes) with normal n
/// is known. Returns their number.
int known_directions(const TractionCondition& condition, const Vec3& x, const Vec3& n, const Mat3& rotation,
                     Vec3 directions[3]) {
  Vec3 basis[3];
  int count = 0;
  const auto extend = [&](Vec3 v) {
    for (int i = 0; i < count; ++i) v -= basis[i].dot(v) * basis[i];
    if (count < 3 && v.norm() >= 0.1) basis[count++] = v.normalized();
  };
  if (condition.normal_held) extend(n);
  for (int i = 0; i < 3; ++i)
    if (condition.component_held[i]) extend(rotation.row(i).transpose());
  if (condition.held)
    for (const Vec3& direction : condition.held(x, rotation * n)) extend(rotation.transpose() * direction);
  const int num_held = count;
  const auto [t1, t2] = tangents(n);
  for (const Vec3& v : {n, t1, t2}) extend(v);
  for (int i = num_held; i < count; ++i) directions[i - num_held] = basis[i];
  return count - num_held;
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

PatchRow& add_traction_row(std::vector<PatchRow>& rows, int body, const Vec3& place, const Vec3& n, const Vec3& e,
                           double value = 0) {
  PatchRow& row = rows.emplace_back();
  set_traction(row, body, place, n, e);
  row.value = value;
  return row;
}

const PairState* find_state(const std::vector<PairState>& states, int pair) {
  for (const PairState& state : states)
    if (state.pair == pair) return &state;
  return nullptr;
}

bool is_on_face_of(const ContactEdge& edge, const ConstraintGroup& group) {
  return edge.orientation * edge.surface.gradient(edge.origin).dot(group.normal[0]) >= same_side;
}

/// The row holds for the whole stress: what the term of the edge contributes goes to the right-hand side.
void subtract_term_of_row(const ContactEdge& edge, double factor, const PatchFit& own, PatchRow& row) {
  double s[6];
  edge.stress(own.centre + own.unit * Vec3(row.place[0]), s);
  for (int k = 0; k < 6; ++k) row.value -= factor * row.weight[0][k] * s[k];
}

}  // namespace

bool PairState::is_closed(double fraction) const {
  return closed_area > 0 && closed_area > fraction * area * (1 - 1e-9);
}

PatchAssembly::PatchAssembly(const std::vector<RecoveryBody>& bodies, const std::vector<StressIntegrals>& integrals,
                             const std::vector<std::vector<PatchPolynomial>>& polynomials, int index,
                             const Scales& scales, const RecoveryOptions& options, const KnownPressures* known)
    : bodies_(bodies),
      integrals_(integrals),
      body_(bodies[index]),
      polynomials_(polynomials[index]),
      index_(index),
      arrays_(host_arrays(*body_.mesh, *body_.patches)),
      grid_(body_.mesh->cut_cells->grid),
      scales_(scales),
      options_(options),
      pieces_(*body_.mesh->cut_cells, *body_.boundary),
      known_(known),
      contact_(bodies, integrals, index, options.auxiliary_depth, known) {}

Vec3 PatchAssembly::divergence(const RecoveryBody& body, const Vec3& centre, double unit) const {
  return divergence_at(*body.boundary, body.mesh->cut_cells->grid, scales_.stress, centre, unit);
}

/// Centred differences over one unit: exact for forces up to degree 2.
void PatchAssembly::interior_values(const RecoveryBody& body, const PatchFit& fit, double* values) const {
  double f[3], df[3][3] = {};
  const Vec3 force = -divergence(body, fit.centre, fit.unit);
  for (int i = 0; i < 3; ++i) f[i] = force[i];
  if (fit.degree == 1) {
    Polynomial<1>::interior_values(f, df, 0, values);
    return;
  }
  for (int k = 0; k < 3 && body.boundary->body_force_at; ++k) {
    const Vec3 half = 0.5 * fit.unit * Vec3::Unit(k);
    const Vec3 change = divergence(body, fit.centre - half, fit.unit) - divergence(body, fit.centre + half, fit.unit);
    for (int i = 0; i < 3; ++i) df[i][k] = change[i];
  }
  Polynomial<2>::interior_values(f, df, body.mesh->poisson_ratio(), values);
}

void PatchAssembly::pair_states(int node, std::vector<PairState>& states) const {
  states.clear();
  const PatchSet& patches = *body_.patches;
  const int begin = patches.begin[node];
  contact_.each(&patches.cells[begin], patches.begin[node + 1] - begin, -1, [&](const ContactPiece& piece) {
    auto state = std::lower_bound(states.begin(), states.end(), piece.pair,
                                  [](const PairState& s, int pair) { return s.pair < pair; });
    if (state == states.end() || state->pair != piece.pair)
      state = states.insert(state, PairState{piece.pair, piece.other_body});
    state->area += piece.area;
    state->closed_area += piece.closed_area;
    state->unknown_area += piece.unknown_area;
  });
}

/// Equation 5 in the directions that no support holds.
void PatchAssembly::add_known_traction(const ConstraintGroup& group, const PatchFit& own,
                                       std::vector<PatchRow>& rows) const {
  const TractionCondition& condition = body_.boundary->conditions[group.condition];
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 d = own.place(group.position[p]), n = group.normal[p];
    const Vec3 x = grid_.to_global(group.position[p]);
    Vec3 t = Vec3::Zero(), directions[3];
    if (condition.traction) t = grid_.rotation.transpose() * condition.traction(x, grid_.rotation * n) / scales_.stress;
    const int count = known_directions(condition, x, n, grid_.rotation, directions);
    for (int i = 0; i < count; ++i) add_traction_row(rows, 0, d, n, directions[i], directions[i].dot(t));
  }
}

/// In plane strain the shear stresses across are zero in the whole patch: at the points that determine a polynomial,
/// the corners of a tetrahedron and for a quadratic one the middles of its edges. On uniform grids the two ends say so.
void PatchAssembly::add_plane_strain(int degree, std::vector<PatchRow>& rows) const {
  constexpr double corner[4][3] = {
      {0, -0.5, -0.5}, {0, 0.5, -0.5}, {0, 0, 0.5}, {1, 0, 0}};  // across, and in the plane
  const int x = grid_.plane_strain, y = (x + 1) % 3, z = (x + 2) % 3;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k <= (degree == 2 ? i : 0); ++k) {
      const int j = degree == 2 ? k : i;
      Vec3 place;
      place[x] = 0.5 * (corner[i][0] + corner[j][0]);
      place[y] = 0.5 * (corner[i][1] + corner[j][1]);
      place[z] = 0.5 * (corner[i][2] + corner[j][2]);
      for (const int e : {y, z}) add_traction_row(rows, 0, place, Vec3::Unit(x), Vec3::Unit(e));
    }
}

void PatchAssembly::add_zero_shear(const ConstraintGroup& group, const PatchFit& own,
                                   std::vector<PatchRow>& rows) const {
  for (int p = 0; p < group.num_points; ++p) {
    const auto [t1, t2] = tangents(group.normal[p]);
    for (const Vec3& t : {t1, t2}) add_traction_row(rows, 0, own.place(group.position[p]), group.normal[p], t);
  }
}

/// Equation 12: zero shear on both bodies, equal normal traction. Open patches are free surfaces, and so are the
/// polynomials beside the edge's term; a closed group without an auxiliary patch keeps the zero shear only.
void PatchAssembly::add_contact(const ConstraintGroup& group, int node, const PatchFit& own, const PatchFit* auxiliary,
                                const PairState* state, ContactMode mode, std::vector<PatchRow>& rows) const {
  const bool free = mode == ContactMode::open || mode == ContactMode::edge;
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p], d = own.place(x);
    const auto [t1, t2] = tangents(n);
    add_traction_row(rows, 0, d, n, t1);
    add_traction_row(rows, 0, d, n, t2);
    if (free) add_traction_row(rows, 0, d, n, n).firm = true;
    if (!auxiliary) continue;
    const PatchContactPoint* nearest = nearest_point(node, state->pair, x, n, own.unit);
    if (!nearest) continue;
    const Grid& other_grid = bodies_[state->other_body].mesh->cut_cells->grid;
    const Mat3 to_other = other_grid.rotation.transpose() * grid_.rotation;
    const Vec3 y = other_grid.to_grid(grid_.to_global(x) + nearest->distance * (grid_.rotation * n));
    const Vec3 e = auxiliary->place(y), m = to_other * n;
    add_traction_row(rows, 1, e, m, to_other * t1);
    add_traction_row(rows, 1, e, m, to_other * t2);
    if (free)
      add_traction_row(rows, 1, e, m, m);
    else
      set_traction(add_traction_row(rows, 0, d, n, n), 1, e, m, m, -1);
  }
}

const PatchContactPoint* PatchAssembly::nearest_point(int node, int pair, const Vec3& x, const Vec3& n,
                                                      double unit) const {
  const PatchSet& patches = *body_.patches;
  const double alike = same_distance * unit * unit;
  const PatchContactPoint* nearest = nullptr;
  double least = 0;
  const int begin = patches.begin[node], num_cells = patches.begin[node + 1] - begin;
  contact_.each(&patches.cells[begin], num_cells, pair, [&](const ContactPiece& piece) {
    if (nearest && (x.cwiseMax(piece.low).cwiseMin(piece.high) - x).squaredNorm() > least + alike) return;
    for (const PatchContactPoint& point : contact_.points(piece)) {
      const double distance = (point.position - x).squaredNorm();
      if (nearest && distance > least + alike) continue;
      if (point.normal.dot(n) < same_side) continue;
      if (nearest && distance > least - alike && point.distance >= nearest->distance) continue;
      nearest = &point, least = distance;
    }
  });
  return nearest;
}

void PatchAssembly::add_known_pressure(const ConstraintGroup& group, const PatchProblem& problem,
                                       std::vector<PatchRow>& rows) const {
  const bool on_face = problem.has_edge && is_on_face_of(problem.edge, group);
  add_zero_shear(group, problem.fit[0], rows);
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p];
    const auto square = known_->square(group.pair, index_, grid_.to_global(x), grid_.rotation * n);
    if (!square) continue;
    double value = -std::sqrt(std::max(*square, 0.0)) / scales_.stress;
    if (on_face) value -= problem.factor * problem.edge.root(problem.edge.inside(x));
    add_traction_row(rows, 0, problem.fit[0].place(x), n, n, value);
  }
}

/// Bonded faces: equal tractions of both bodies, in all directions.
void PatchAssembly::add_bond(const ConstraintGroup& group, int node, const PatchFit& own, const PatchFit& auxiliary,
                             const PairState& state, std::vector<PatchRow>& rows) const {
  const Grid& other_grid = bodies_[state.other_body].mesh->cut_cells->grid;
  const Mat3 to_other = other_grid.rotation.transpose() * grid_.rotation;
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p];
    const PatchContactPoint* nearest = nearest_point(node, state.pair, x, n, own.unit);
    if (!nearest) continue;
    const Vec3 y = other_grid.to_grid(grid_.to_global(x) + nearest->distance * (grid_.rotation * n));
    const auto [t1, t2] = tangents(n);
    for (const Vec3& e : {n, t1, t2})
      set_traction(add_traction_row(rows, 0, own.place(x), n, e), 1, auxiliary.place(y), to_other * n, to_other * e,
                   -1);
  }
}

bool PatchAssembly::has_closed_points(const ConstraintGroup& group, const int* cells, int num_cells) const {
  bool found = false;
  contact_.each(cells, num_cells, group.pair, [&](const ContactPiece& piece) {
    if (found || piece.closed_area == 0) return;
    for (const PatchContactPoint& point : contact_.points(piece))
      for (int p = 0; p < group.num_points && point.pressed && !found; ++p)
        found = point.normal.dot(group.normal[p]) >= same_side;
  });
  return found;
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
  const Solid& solid = mesh.cut_cells->solid;
  edge.surface = solid.surfaces()[solid.surface_at(x, n)].near(x);
  edge.orientation = edge.surface.gradient(x).dot(n) < 0 ? -1 : 1;
  edge.scale = grid.cell_size / unit;
  edge.poisson_ratio = mesh.poisson_ratio();
  return edge;
}

/// How a pair stands in a patch; sets the patch's term if the edge of a zone with a known pressure is near.
PatchAssembly::ContactMode PatchAssembly::mode_of_pair(const PairState& state, const int* cells, int num_cells,
                                                       PatchProblem& problem) const {
  if (body_.boundary->is_bonded(state.pair)) return ContactMode::closed;
  if (state.closed_area == 0) return ContactMode::open;
  if (!knows(state)) return state.is_mixed() ? ContactMode::unclear : ContactMode::closed;
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  contact_.each(cells, num_cells, state.pair, [&](const ContactPiece& part) {
    centroid += part.position / state.area;
    normal += part.normal;
  });
  EdgePiece piece;
  const Vec3 x = grid_.to_global(centroid);
  if (!options_.contact_edge || problem.has_edge || !known_->edge_near(state.pair, x, piece)) {
    if (state.is_mixed()) problem.status = std::max(problem.status, PatchStatus::edge_unclear);
    return ContactMode::closed;
  }
  double least = 1e300;  // cells of the body
  contact_.each(cells, num_cells, state.pair, [&](const ContactPiece& part) {
    for (const PatchContactPoint& point : contact_.points(part))
      least = std::min(least, piece.inside(grid_.to_global(point.position)) / part.cell_size);
  });
  if (least > options_.term_reach) return ContactMode::closed;
  problem.has_edge = true;
  const double h = problem.fit[0].unit * grid_.cell_size;
  problem.edge = seen_from(body_, x, grid_.rotation * normal.normalized(), piece, h);
  problem.factor = -piece.factor / scales_.stress * std::sqrt(h);
  return state.is_mixed() ? ContactMode::edge : ContactMode::closed;
}

void PatchAssembly::assemble(int node, PatchWorkspace& workspace, std::vector<PatchRow>& rows,
                             PatchProblem& problem) const {
  assemble(node, polynomials_[node], workspace, rows, problem);
}

void PatchAssembly::assemble(int node, PatchPolynomial polynomial, PatchWorkspace& workspace,
                             std::vector<PatchRow>& rows, PatchProblem& problem) const {
  const PatchSet& patches = *body_.patches;
  const int* cells = patches.cells.data() + patches.begin[node];
  const int num_cells = patches.begin[node + 1] - patches.begin[node];
  problem.node = node;
  problem.first_row = rows.size();
  const int degree = polynomial.degree;
  fit_cells(body_, node, polynomial, workspace.own);
  PatchFit& own = problem.fit[0];
  own_fit(node, degree, workspace.own, own);
  const auto lowered = [&] {
    problem = PatchProblem();
    assemble(node, PatchPolynomial{}, workspace, rows, problem);
    problem.status = std::max(problem.status, PatchStatus::degree_lowered);
    problem.lowered = true;
  };
  if (!own.regular) {
    if (degree == 2) return lowered();
    problem.status = PatchStatus::singular;
    return;
  }
  interior_values(body_, own, problem.interior[0].data());
  std::vector<ConstraintGroup>& groups = workspace.groups;
  const int points = options_.points_per_face;
  pieces_.groups(cells, num_cells, points == 0 ? degree : points == 1 ? 0 : points == 3 ? 1 : 2, groups, own.unit);
  pair_states(node, workspace.states);

  // How each pair stands, and where its edge is.
  std::vector<PairState>& states = workspace.states;
  workspace.modes.assign(states.size(), 0);
  const auto mode_of = [&](const PairState& state) {
    return static_cast<ContactMode>(workspace.modes[&state - states.data()]);
  };
  const PairState* coupled = nullptr;  // the pair with the largest closed area gets the auxiliary patch
  for (const PairState& state : states) {
    const ContactMode mode = mode_of_pair(state, cells, num_cells, problem);
    workspace.modes[&state - states.data()] = static_cast<char>(mode);
    if (mode != ContactMode::open) problem.pressed.push_back(state.pair);
    const bool couples = body_.boundary->is_bonded(state.pair) || !knows(state);
    if (mode != ContactMode::open && !couples) problem.known.push_back(state.pair);
    const bool wants = couples && (mode == ContactMode::closed || mode == ContactMode::unclear) &&
                       (body_.boundary->is_bonded(state.pair) || state.is_closed(options_.closed_fraction));
    if (wants && (!coupled || state.closed_area > coupled->closed_area)) coupled = &state;
  }
  if (coupled && !bodies_[coupled->other_body].mesh->rigid) {  // a rigid body has no stress to be continuous with
    auxiliary_fit(node, *coupled, polynomial, workspace, problem.fit[1]);
    if (degree == 2 && !problem.fit[1].regular) return lowered();
    problem.coupled = problem.fit[1].regular;
    problem.bonded = problem.coupled && body_.boundary->is_bonded(coupled->pair);
    problem.pair = coupled->pair;
    problem.other_body = coupled->other_body;
    if (problem.coupled)
      interior_values(bodies_[coupled->other_body], problem.fit[1], problem.interior[1].data());
    else
      problem.status = PatchStatus::uncoupled;
  }
  if (problem.coupled && degree == 1) own.variance = fit_variance(*body_.mesh, integrals_[index_], workspace.own, own);
  if (problem.has_edge)
    subtract_edge_term(*body_.mesh, workspace.own.data(), static_cast<int>(workspace.own.size()), problem.edge,
                       problem.factor, own);

  // Area on the side that a group lies on, where a pair is closed.
  const auto closed_beside = [&](const ConstraintGroup& group) {
    double area = 0;
    for (const ConstraintGroup& other : groups) {
      const PairState* state = find_state(states, other.pair);
      if (other.normal[0].dot(group.normal[0]) >= same_side && state && mode_of(*state) != ContactMode::open)
        area += other.area;
    }
    return area;
  };
  const auto bonded_on_surface = [&](int surface) {
    double area = 0;
    for (const ConstraintGroup& group : groups)
      if (group.surface == surface && body_.boundary->is_bonded(group.pair)) area += group.area;
    return area;
  };
  const auto set_kind = [&](PatchKind kind) { problem.kind = std::max(problem.kind, kind); };
  const auto subtract_term = [&](std::size_t first) {
    for (std::size_t r = first; r < rows.size() && problem.has_edge; ++r)
      subtract_term_of_row(problem.edge, problem.factor, own, rows[r]);
  };
  if (grid_.is_quadtree()) add_plane_strain(degree, rows);
  for (const ConstraintGroup& group : groups) {
    const std::size_t first = rows.size();
    const TractionCondition& condition = body_.boundary->conditions[group.condition];
    const PairState* state = find_state(states, group.pair);
    if (body_.boundary->is_bonded(group.pair)) {  // without an auxiliary patch nothing is known
      set_kind(PatchKind::contact);
      if (problem.coupled && state && state == coupled) add_bond(group, node, own, problem.fit[1], *state, rows);
      subtract_term(first);
      continue;
    }
    // Free beside a bonded part of the same surface: the traction jumps, which no polynomial follows.
    const double bonded = bonded_on_surface(group.surface);
    if (group.pair < 0 && !condition.traction && !condition.is_support() &&
        bonded > options_.closed_fraction * (bonded + group.area))
      continue;
    const double closed_part = closed_beside(group);
    // Where the pair is closed in the patch (or its edge runs through it), but on another side of the body.
    const bool elsewhere =
        state && mode_of(*state) != ContactMode::open && !has_closed_points(group, cells, num_cells) &&
        (mode_of(*state) == ContactMode::edge ? !is_on_face_of(problem.edge, group) : state->closed_area > 0);
    // Points that see the other body although none of its contact points is here: the rim of what is closed beside
    // them, or open.
    const bool unseen =
        group.pair >= 0 && !state && !(closed_part > options_.closed_fraction * (closed_part + group.area));
    if (elsewhere) problem.open_sides.push_back(group.surface);
    ContactMode mode = state && !elsewhere ? mode_of(*state) : ContactMode::open;
    const bool is_loaded = condition.traction || condition.is_support();
    const bool is_open = (state || unseen) && mode == ContactMode::open;
    if (state || unseen)
      set_kind(mode == ContactMode::open     ? PatchKind::boundary
               : mode == ContactMode::closed ? PatchKind::contact
                                             : PatchKind::contact_edge);
    if (mode == ContactMode::unclear) {
      problem.status = std::max(problem.status, PatchStatus::edge_unclear);
      mode = state->is_closed(options_.closed_fraction) ? ContactMode::closed : ContactMode::open;
    }
    if (state && !elsewhere && mode == ContactMode::closed && knows(*state)) {
      add_known_pressure(group, problem, rows);
      if (problem.has_edge && !is_on_face_of(problem.edge, group)) subtract_term(first);
      continue;
    }
    if (state && !elsewhere && !(is_open && is_loaded)) {
      const bool with_other = problem.coupled && state == coupled;
      add_contact(group, node, own, with_other ? &problem.fit[1] : nullptr, state, mode, rows);
      // On the face of the edge the term has no shear and nothing outside of the zone.
      if (with_other || (problem.has_edge && !is_on_face_of(problem.edge, group))) subtract_term(first);
      continue;
    }
    // The rim of a contact face that reaches beyond the other body (rounding, an overhang of a small part of the
    // patch): the closed part decides, as among contact points.
    if (is_open && !is_loaded) {
      add_contact(group, node, own, nullptr, state, mode, rows);
    } else if (!is_open && (group.pair >= 0 || closed_part > options_.closed_fraction * (closed_part + group.area))) {
      add_zero_shear(group, own, rows);
    } else {
      add_known_traction(group, own, rows);
      set_kind(condition.normal_held    ? PatchKind::symmetry
               : condition.is_support() ? PatchKind::support
               : condition.traction     ? PatchKind::loaded
                                        : PatchKind::boundary);
    }
    subtract_term(first);
  }
  problem.num_rows = static_cast<int>(rows.size() - problem.first_row);
}

}  // namespace cgcontact
