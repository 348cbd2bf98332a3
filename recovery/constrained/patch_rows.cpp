#include "recovery/constrained/patch_rows.hpp"

#include <algorithm>

#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/tangents.hpp"

namespace cgcontact {
namespace {

/// Cells: centres of patches nearer to an axis of revolution lie on it.
constexpr double on_axis = 1e-6;

/// Contact points are equally far from a point if they are so up to this (squared, cells of the patch): of those the
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

bool is_on_face_of(const ContactEdge& edge, const ConstraintGroup& group) {
  return edge.orientation * edge.surface.gradient(edge.origin).dot(group.normal[0]) >= same_side;
}

/// Sets the component along e of the traction on the normal n at a point of one of the bodies of a row (unit of its
/// polynomial, from the centre).
template <int bodies>
void set_traction(FitRow<bodies>& row, int body, const Vec3& position, const Vec3& n, const Vec3& e, double sign = 1) {
  traction_weight(n.data(), e.data(), row.weight[body]);
  if (sign != 1)
    for (double& w : row.weight[body]) w *= sign;
  for (int i = 0; i < 3; ++i) row.position[body][i] = position[i];
}

/// Rows of one patch.
template <int bodies>
class RowWriter {
 public:
  RowWriter(const PatchContext& context, PatchLists& lists, std::size_t patch, RowList<bodies>& to)
      : context_(context),
        body_(context.body),
        grid_(context.grid),
        lists_(lists),
        patch_(patch),
        cells_(context.cells_of(lists.node[patch])),
        states_(lists.pairs[patch]),
        term_(lists.edge[patch] < 0 ? nullptr : &lists.edges[lists.edge[patch]]),
        to_(to) {
    if constexpr (bodies == 2) {
      coupled_ = &lists.other(patch);
      other_grid_ = &context.bodies[coupled_->other_body].mesh->cut_cells->grid;
      to_other_ = other_grid_->rotation.transpose() * grid_.rotation;
    }
  }

  void add(const std::vector<ConstraintGroup>& groups) {
    if (grid_.is_axisymmetric()) {
      add_revolution(0, grid_, lists_.centre[patch_], lists_.unit[patch_]);
      if constexpr (bodies == 2)
        add_revolution(1, *other_grid_, lists_.auxiliary_centre[patch_], lists_.auxiliary_unit[patch_]);
    } else if (grid_.is_quadtree()) {
      add_plane_strain();
    }
    for (const ConstraintGroup& group : groups) add_group(group, groups);
  }

 private:
  void add_group(const ConstraintGroup& group, const std::vector<ConstraintGroup>& groups);
  void add_plane_strain();
  void add_revolution(int body, const Grid& grid, const Vec3& centre, double unit);
  void add_known_traction(const ConstraintGroup& group);
  void add_zero_shear(const ConstraintGroup& group);
  void add_contact(const ConstraintGroup& group, bool with_other, ContactMode mode);
  void add_friction(const ConstraintGroup& group, bool with_other);
  void add_other_side(const Vec3& x, const Vec3& n, bool free);
  void add_known_pressure(const ConstraintGroup& group);
  void add_bond(const ConstraintGroup& group);
  bool has_closed_points(const ConstraintGroup& group) const;
  const PatchContactPoint* nearest_point(int pair, const Vec3& x, const Vec3& n) const;
  void subtract_term(std::size_t first);

  Vec3 position_in_patch(const Vec3& x) const {
    return in_half_plane(grid_, (x - lists_.centre[patch_]) / lists_.unit[patch_]);
  }
  Vec3 position_in_other(const Vec3& x, const Vec3& n, double distance) const {
    const Vec3 y = other_grid_->to_grid(grid_.to_global(x) + distance * (grid_.rotation * n));
    return in_half_plane(*other_grid_, (y - lists_.auxiliary_centre[patch_]) / lists_.auxiliary_unit[patch_]);
  }
  /// Puts a point of a body of revolution at 0 across, where all its cells and points lie.
  static Vec3 in_half_plane(const Grid& grid, Vec3 position) {
    if (grid.is_axisymmetric()) position[grid.plane_strain] = 0;
    return position;
  }
  FitRow<bodies>& add_row(int body, const Vec3& at, const Vec3& n, const Vec3& e, double value = 0) {
    FitRow<bodies>& row = to_.rows.emplace_back();
    set_traction(row, body, at, n, e);
    row.value = value;
    to_.firm.push_back(0);
    return row;
  }
  void set_kind(PatchKind kind) { lists_.kind[patch_] = std::max(lists_.kind[patch_], kind); }
  const PairState* find_state(int pair) const {
    for (const PairState& state : states_)
      if (state.pair == pair) return &state;
    return nullptr;
  }
  /// Area on the side that a group lies on, where a pair is closed.
  double closed_beside(const ConstraintGroup& group, const std::vector<ConstraintGroup>& groups) const {
    double area = 0;
    for (const ConstraintGroup& other : groups) {
      const PairState* state = find_state(other.pair);
      if (other.normal[0].dot(group.normal[0]) >= same_side && state && state->mode != ContactMode::open)
        area += other.area;
    }
    return area;
  }
  double bonded_on(int surface, const std::vector<ConstraintGroup>& groups) const {
    double area = 0;
    for (const ConstraintGroup& group : groups)
      if (group.surface == surface && body_.boundary->is_bonded(group.pair)) area += group.area;
    return area;
  }
  bool is_most(double area, double whole) const { return area > context_.options.closed_fraction * whole; }

  const PatchContext& context_;
  const RecoveryBody& body_;
  const Grid& grid_;
  PatchLists& lists_;
  const std::size_t patch_;
  const ListRange<int> cells_;
  const ListRange<PairState> states_;
  const EdgeTerms::Term* const term_;   ///< null: none
  const PairState* coupled_ = nullptr;  ///< with the auxiliary patch
  const Grid* other_grid_ = nullptr;    ///< of that
  Mat3 to_other_ = Mat3::Identity();    ///< axes
  RowList<bodies>& to_;
};

/// Equation 5 in the directions that no support holds.
template <int bodies>
void RowWriter<bodies>::add_known_traction(const ConstraintGroup& group) {
  const TractionCondition& condition = body_.boundary->conditions[group.condition];
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 d = position_in_patch(group.position[p]), n = group.normal[p];
    const Vec3 x = grid_.to_global(group.position[p]);
    Vec3 t = Vec3::Zero(), directions[3];
    if (condition.traction)
      t = grid_.rotation.transpose() * condition.traction(x, grid_.rotation * n) / context_.scales.stress;
    const int count = known_directions(condition, x, n, grid_.rotation, directions);
    for (int i = 0; i < count; ++i) add_row(0, d, n, directions[i], directions[i].dot(t));
  }
}

/// In plane strain the shear stresses across are zero in the whole patch: at the points that determine a polynomial,
/// the corners of a tetrahedron and for a quadratic one the middles of its edges. On uniform grids the two ends say so.
template <int bodies>
void RowWriter<bodies>::add_plane_strain() {
  constexpr double corner[4][3] = {
      {0, -0.5, -0.5}, {0, 0.5, -0.5}, {0, 0, 0.5}, {1, 0, 0}};  // across, and in the plane
  const bool quadratic = lists_.polynomial[patch_].degree == 2;
  const int x = grid_.plane_strain, y = (x + 1) % 3, z = (x + 2) % 3;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k <= (quadratic ? i : 0); ++k) {
      const int j = quadratic ? k : i;
      Vec3 at;
      at[x] = 0.5 * (corner[i][0] + corner[j][0]);
      at[y] = 0.5 * (corner[i][1] + corner[j][1]);
      at[z] = 0.5 * (corner[i][2] + corner[j][2]);
      for (const int e : {y, z}) add_row(0, at, Vec3::Unit(x), Vec3::Unit(e));
    }
}

/// Around an axis of revolution the stress turns with the angle: on planes through the axis beside the half-plane there
/// is no shear either. So the components that are zero in the half-plane grow beside it, d s_xy / dy = (s_rr -
/// s_around) / r and d s_yz / dy = s_rz / r, with which the equations of equilibrium in space are those of the body of
/// revolution; also on the axis, where nothing is divided by r.
template <int bodies>
void RowWriter<bodies>::add_revolution(int body, const Grid& grid, const Vec3& centre, double unit) {
  constexpr double corner[3][2] = {{0, 0.5}, {0.5, -0.5}, {-0.5, -0.5}};  // away from the axis, along it
  constexpr double beside = 0.125;
  const bool quadratic = lists_.polynomial[patch_].degree == 2;
  const int away = grid.radial_axis(), along = grid.axis_of_revolution(), across = grid.plane_strain;
  const double middle = grid.radius(centre) / (unit * grid.cell_size);
  for (int i = 0; i < (quadratic ? 3 : 1); ++i)
    for (const int side : {-1, 1}) {
      Vec3 at = Vec3::Zero();
      at[across] = side * beside;
      if (quadratic) {
        at[away] = corner[i][0];
        at[along] = corner[i][1];
      }
      const double x = middle + at[away], r = std::hypot(x, beside);
      Vec3 out = Vec3::Zero(), around = Vec3::Zero();
      out[away] = around[across] = x / r;
      out[across] = at[across] / r;
      around[away] = -at[across] / r;
      for (const Vec3& e : {out, Vec3(Vec3::Unit(along))}) {
        FitRow<bodies>& row = to_.rows.emplace_back();
        set_traction(row, body, at, around, e, 1 / beside);
        row.value = 0;
        to_.firm.push_back(0);
      }
    }
}

template <int bodies>
void RowWriter<bodies>::add_zero_shear(const ConstraintGroup& group) {
  for (int p = 0; p < group.num_points; ++p) {
    const auto [t1, t2] = tangents(group.normal[p]);
    for (const Vec3& t : {t1, t2}) add_row(0, position_in_patch(group.position[p]), group.normal[p], t);
  }
}

/// Equation 12: zero shear on both bodies, equal normal traction. Open patches are free surfaces, and so are the
/// polynomials beside the edge's term; a closed group without an auxiliary patch keeps the zero shear only.
template <int bodies>
void RowWriter<bodies>::add_contact(const ConstraintGroup& group, bool with_other, ContactMode mode) {
  const bool free = mode == ContactMode::open || mode == ContactMode::edge;
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p], d = position_in_patch(x);
    const auto [t1, t2] = tangents(n);
    add_row(0, d, n, t1);
    add_row(0, d, n, t2);
    if (free) {
      add_row(0, d, n, n);
      to_.firm.back() = 1;
    }
    if (with_other) add_other_side(x, n, free);
  }
}

/// Auxiliary body at a contact point: zero shear, and the normal traction of both.
template <int bodies>
void RowWriter<bodies>::add_other_side(const Vec3& x, const Vec3& n, bool free) {
  if constexpr (bodies == 2) {
    const PatchContactPoint* nearest = nearest_point(coupled_->pair, x, n);
    if (!nearest) return;
    const auto [t1, t2] = tangents(n);
    const Vec3 e = position_in_other(x, n, nearest->distance), m = to_other_ * n;
    add_row(1, e, m, to_other_ * t1);
    add_row(1, e, m, to_other_ * t2);
    if (free)
      add_row(1, e, m, m);
    else
      set_traction(add_row(0, position_in_patch(x), n, n), 1, e, m, m, -1);
  }
}

/// Closed contact with friction: the normal traction of both bodies is equal; where it sticks the shear too; where it
/// slips the shear of each body is mu times its own pressure, along friction's force. Without the other body nothing is
/// known where it sticks.
template <int bodies>
void RowWriter<bodies>::add_friction(const ConstraintGroup& group, bool with_other) {
  const double mu = body_.boundary->friction_of(group.pair);
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p], d = position_in_patch(x);
    const PatchContactPoint* nearest = nearest_point(group.pair, x, n);
    if (!nearest) continue;
    const auto [t1, t2] = tangents(n);
    const bool slips = !nearest->shear.isZero(0);
    const auto slip_direction = [&, s = nearest->shear](const Vec3& t) { return Vec3(t + mu * t.dot(s) * n); };
    if (slips)
      for (const Vec3& t : {t1, t2}) add_row(0, d, n, slip_direction(t));
    if constexpr (bodies == 2) {
      if (!with_other) continue;
      const Vec3 there = position_in_other(x, n, nearest->distance), m = to_other_ * n;
      set_traction(add_row(0, d, n, n), 1, there, m, m, -1);
      for (const Vec3& t : {t1, t2}) {
        if (slips)
          add_row(1, there, m, to_other_ * slip_direction(t));
        else
          set_traction(add_row(0, d, n, t), 1, there, m, to_other_ * t, -1);
      }
    }
  }
}

/// The contact point of a pair that is nearest to a constraint point on the same side of the body; null: none.
template <int bodies>
const PatchContactPoint* RowWriter<bodies>::nearest_point(int pair, const Vec3& x, const Vec3& n) const {
  const double unit = lists_.unit[patch_], alike = same_distance * unit * unit;
  const PatchContactPoint* nearest = nullptr;
  double least = 0;
  context_.contact.each(cells_, pair, [&](const ContactFacet& facet) {
    if (nearest && (x.cwiseMax(facet.low).cwiseMin(facet.high) - x).squaredNorm() > least + alike) return;
    for (const PatchContactPoint& point : context_.contact.points(facet)) {
      const double distance = (point.position - x).squaredNorm();
      if (nearest && distance > least + alike) continue;
      if (point.normal.dot(n) < same_side) continue;
      if (nearest && distance > least - alike && point.distance >= nearest->distance) continue;
      nearest = &point, least = distance;
    }
  });
  return nearest;
}

/// Equation 5 with the pressure that the problem on the face gives, less what the term of the edge carries.
template <int bodies>
void RowWriter<bodies>::add_known_pressure(const ConstraintGroup& group) {
  const bool on_face = term_ && is_on_face_of(term_->edge, group);
  add_zero_shear(group);
  for (int p = 0; p < group.num_points; ++p) {
    const Vec3 x = group.position[p], n = group.normal[p];
    const auto square = context_.known->square(group.pair, context_.index, grid_.to_global(x), grid_.rotation * n);
    if (!square) continue;
    double value = -std::sqrt(std::max(*square, 0.0)) / context_.scales.stress;
    if (on_face) value -= term_->factor * term_->edge.root(term_->edge.inside(x));
    add_row(0, position_in_patch(x), n, n, value);
  }
}

/// Bonded faces: equal tractions of both bodies, in all directions.
template <int bodies>
void RowWriter<bodies>::add_bond(const ConstraintGroup& group) {
  if constexpr (bodies == 2)
    for (int p = 0; p < group.num_points; ++p) {
      const Vec3 x = group.position[p], n = group.normal[p];
      const PatchContactPoint* nearest = nearest_point(coupled_->pair, x, n);
      if (!nearest) continue;
      const Vec3 there = position_in_other(x, n, nearest->distance);
      const auto [t1, t2] = tangents(n);
      for (const Vec3& e : {n, t1, t2})
        set_traction(add_row(0, position_in_patch(x), n, e), 1, there, to_other_ * n, to_other_ * e, -1);
    }
}

/// Returns whether any point of the group's pair is closed on the same side of the body.
template <int bodies>
bool RowWriter<bodies>::has_closed_points(const ConstraintGroup& group) const {
  bool found = false;
  context_.contact.each(cells_, group.pair, [&](const ContactFacet& facet) {
    if (found || facet.closed_area == 0) return;
    for (const PatchContactPoint& point : context_.contact.points(facet))
      for (int p = 0; p < group.num_points && point.pressed && !found; ++p)
        found = point.normal.dot(group.normal[p]) >= same_side;
  });
  return found;
}

/// Rows hold for the whole stress: what the term of the edge contributes goes to the right-hand side, of those from
/// `first` on.
template <int bodies>
void RowWriter<bodies>::subtract_term(std::size_t first) {
  if (!term_) return;
  for (std::size_t r = first; r < to_.rows.size(); ++r) {
    FitRow<bodies>& row = to_.rows[r];
    double s[6];
    term_->edge.stress(lists_.centre[patch_] + lists_.unit[patch_] * Vec3(row.position[0]), s);
    for (int k = 0; k < 6; ++k) row.value -= term_->factor * row.weight[0][k] * s[k];
  }
}

template <int bodies>
void RowWriter<bodies>::add_group(const ConstraintGroup& group, const std::vector<ConstraintGroup>& groups) {
  const std::size_t first = to_.rows.size();
  const TractionCondition& condition = body_.boundary->conditions[group.condition];
  const PairState* const state = find_state(group.pair);
  const bool with_other = bodies == 2 && state && state == coupled_;
  if (body_.boundary->is_bonded(group.pair)) {  // without an auxiliary patch nothing is known
    set_kind(PatchKind::contact);
    if (with_other) add_bond(group);
    return subtract_term(first);
  }
  // Free beside a bonded region of the same surface: the traction jumps, which no polynomial follows.
  const bool is_loaded = condition.traction || condition.is_support();
  const double bonded = bonded_on(group.surface, groups);
  if (group.pair < 0 && !is_loaded && is_most(bonded, bonded + group.area)) return;
  const bool on_term = term_ && is_on_face_of(term_->edge, group);
  // closed in the patch (or its edge runs through it), but on another side of the body
  const bool elsewhere = state && state->mode != ContactMode::open && !has_closed_points(group) &&
                         (state->mode == ContactMode::edge ? !on_term : state->closed_area > 0);
  // Points that see the other body although none of its contact points is here: the rim of what is closed beside
  // them, or open.
  const double closed = closed_beside(group, groups);
  const bool unseen = group.pair >= 0 && !state && !is_most(closed, closed + group.area);
  if (elsewhere) to_.open_sides.emplace_back(lists_.node[patch_], group.surface);
  ContactMode mode = state && !elsewhere ? state->mode : ContactMode::open;
  const bool is_open = (state || unseen) && mode == ContactMode::open;
  if (state || unseen)
    set_kind(mode == ContactMode::open     ? PatchKind::boundary
             : mode == ContactMode::closed ? PatchKind::contact
                                           : PatchKind::contact_edge);
  if (mode == ContactMode::unclear) {
    lists_.raise(patch_, PatchStatus::edge_unclear);
    mode = state->is_closed(context_.options.closed_fraction) ? ContactMode::closed : ContactMode::open;
  }
  if (state && !elsewhere && mode == ContactMode::closed && !state->couples) {
    add_known_pressure(group);
    if (!on_term) subtract_term(first);
  } else if (state && !elsewhere && mode == ContactMode::closed && body_.boundary->friction_of(group.pair) > 0) {
    add_friction(group, with_other);
    subtract_term(first);
  } else if (state && !elsewhere && !(is_open && is_loaded)) {
    add_contact(group, with_other, mode);
    // On the face of the edge the term has no shear and nothing outside of the zone.
    if (with_other || !on_term) subtract_term(first);
  } else if (is_open && !is_loaded) {
    // Rim of a contact face that reaches beyond the other body (rounding, an overhang of a small fraction of the
    // patch): the closed region decides, as among contact points.
    add_contact(group, false, mode);
    subtract_term(first);
  } else if (!is_open && (group.pair >= 0 || is_most(closed, closed + group.area))) {
    if (body_.boundary->friction_of(group.pair) == 0) add_zero_shear(group);
    subtract_term(first);
  } else {
    add_known_traction(group);
    set_kind(condition.normal_held    ? PatchKind::symmetry
             : condition.is_support() ? PatchKind::support
             : condition.traction     ? PatchKind::loaded
                                      : PatchKind::boundary);
    subtract_term(first);
  }
}

/// Degree of the traction that the constraint points of a face determine.
int degree_of_points(int points_per_face, int degree) {
  return points_per_face == 0 ? degree : points_per_face == 1 ? 0 : points_per_face == 3 ? 1 : 2;
}

}  // namespace

template <int bodies>
void PatchRows::add(PatchLists& lists, std::size_t patch, std::vector<ConstraintGroup>& groups,
                    RowList<bodies>& rows) const {
  const ListRange<int> cells = context_.cells_of(lists.node[patch]);
  facets_.groups(cells.first, cells.size(),
                 degree_of_points(context_.options.points_per_face, lists.polynomial[patch].degree), groups,
                 lists.unit[patch]);
  RowWriter<bodies>(context_, lists, patch, rows).add(groups);
}
template void PatchRows::add(PatchLists&, std::size_t, std::vector<ConstraintGroup>&, RowList<1>&) const;
template void PatchRows::add(PatchLists&, std::size_t, std::vector<ConstraintGroup>&, RowList<2>&) const;

/// Centred differences over one unit: exact for forces up to degree 2.
template <int degree>
void PatchRows::interior_values(int of_body, const Vec3& centre, double unit, double* values) const {
  double f[3], df[3][3] = {};
  const Vec3 force = -context_.divergence(of_body, centre, unit);
  for (int i = 0; i < 3; ++i) f[i] = force[i];
  const RecoveryBody& body = context_.bodies[of_body];
  for (int k = 0; degree == 2 && k < 3 && body.boundary->body_force_at; ++k) {
    const Vec3 half = 0.5 * unit * Vec3::Unit(k);
    const Vec3 change =
        context_.divergence(of_body, centre - half, unit) - context_.divergence(of_body, centre + half, unit);
    for (int i = 0; i < 3; ++i) df[i][k] = change[i];
  }
  if (const Grid& grid = body.mesh->cut_cells->grid;
      degree == 2 && grid.is_axisymmetric()) {  // it turns with the angle
    const int across = grid.plane_strain, away = grid.radial_axis();
    const double r = grid.radius(centre) / (unit * grid.cell_size);
    df[across][across] = r > on_axis ? f[away] / r : df[away][away];
  }
  Polynomial<degree>::interior_values(f, df, body.mesh->poisson_ratio(), values);
}
template void PatchRows::interior_values<1>(int, const Vec3&, double, double*) const;
template void PatchRows::interior_values<2>(int, const Vec3&, double, double*) const;

}  // namespace cgcontact
