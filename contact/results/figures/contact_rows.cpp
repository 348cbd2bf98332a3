#include "contact/results/figures/contact_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "contact/results/figures/pair_figures.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {
namespace {

double pressure(const Sym3& s, const Vec3& n) { return -n.dot(tensor(s) * n); }

/// Contact pair whose faces contain a boundary point of a body (index), or -1.
int pair_of_face(const SolvedState& state, int body, int boundary_point) {
  const BodyModel& model = state.bodies[body];
  const Grid& grid = model.cut_cells.grid;
  const BoundaryPoints& points = model.cut_cells.boundary;
  const Vec3 x = grid.to_global(points.position_of_facet(boundary_point)),
             n = grid.rotation * points.normal_of_facet(boundary_point);
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const ContactPair& pair = state.pairs[p];
    if ((pair.primary == body || pair.secondary == body) &&
        pair.face(body).contains(model.surface_names(boundary_point), x, n))
      return static_cast<int>(p);
  }
  return -1;
}

/// Contact point nearest to a grid position in the same cell and on the same side of the body, or nullptr. `n`: grid
/// axes.
const ContactLink* nearest_link(const BodyModel& body, int cell, const Vec3& position, const Vec3& n, int pair) {
  const ContactLink* nearest = nullptr;
  for (int l : body.boundary.links_of_cell[cell]) {
    const ContactLink& link = body.boundary.links[l];
    if (link.pair != pair || link.normal.dot(n) < same_side) continue;
    if (!nearest || (link.position - position).squaredNorm() < (nearest->position - position).squaredNorm())
      nearest = &link;
  }
  return nearest;
}

/// Returns false if all patches around are open on that side (position: grid coordinates): the traction is zero there.
bool carries_pressure(const SolvedState& state, int body, int cell, int pair, const Vec3& position, const Vec3& n) {
  if (state.patch_states.empty()) return true;
  const BodyModel& model = state.bodies[body];
  const PatchStates& states = state.patch_states[body];
  const int surface = states.open_sides.empty()
                          ? -1
                          : model.cut_cells.solid.surface_at(position, model.cut_cells.grid.rotation.transpose() * n);
  return states.presses(state.system.meshes[body], cell, pair, surface);
}

void set_stresses(const SolvedState& state, int body, int cell, const Vec3& xi, const Vec3& n, ContactRow& row) {
  row.stress_raw = raw_stress(state, body, cell, xi);
  row.stress_spr = recovered_stress(state, state.spr[body], body, cell, xi);
  row.stress_sprc = recovered_stress(state, state.sprc[body], body, cell, xi);
  row.pressure_raw = pressure(row.stress_raw, n);
  row.pressure_spr = pressure(row.stress_spr, n);
  row.pressure_sprc = pressure(row.stress_sprc, n);
}

/// Finds the gap after deformation, the other body's pressure and the larger cell, seen from x along n; infinite and
/// NaN if nothing is opposite. On a rigid body the pressure is NaN, the stress that of the other one.
void look_across(const SolvedState& state, int cell, const Vec3& xi, ContactRow& row) {
  const ContactPair& pair = state.pairs[row.pair];
  const int other = pair.other(row.body);
  const auto opposite = find_opposite(state.bodies, pair, row.body, row.x, row.normal);
  row.gap = row.distance = std::numeric_limits<double>::infinity();
  row.pressure_opposite = std::numeric_limits<double>::quiet_NaN();
  const double own = state.bodies[row.body].cut_cells.h(cell);
  row.larger_cell = opposite ? std::max(own, state.bodies[other].cut_cells.h(opposite->cell)) : pair.largest_cell;
  if (!opposite) return;
  const Vec3 other_xi = cell_coordinates(state.bodies[other].cut_cells, opposite->cell, opposite->position);
  const Vec3 relative = displacement(state, other, opposite->cell, other_xi) - displacement(state, row.body, cell, xi);
  row.distance = opposite->distance;
  // As the law counts it: bodies that move along a face do not part where normals of the other face lean.
  const Vec3 along = row.body == pair.primary ? row.normal : Vec3(-opposite->normal);
  row.gap = opposite->distance - pair.interference + relative.dot(along);
  if (state.bodies[other].spec->rigid()) return;
  const bool carries = carries_pressure(state, other, opposite->cell, row.pair, opposite->position, -row.normal);
  if (state.bodies[row.body].spec->rigid()) {
    set_stresses(state, other, opposite->cell, other_xi, opposite->normal, row);
    if (!carries) row.pressure_sprc = 0;
    return;
  }
  row.pressure_opposite =
      carries ? pressure(recovered_stress(state, state.sprc[other], other, opposite->cell, other_xi), row.normal) : 0.0;
}

bool pairs_rub(const SolvedState& state, int pair) { return state.pairs[pair].num_tangents > 0; }

/// Shear of the stress along the face, and what the nearest contact point has done.
void set_friction(const BodyModel& model, const ContactLink* link, const Vec3& n, ContactRow& row) {
  const auto shear = [&](const Sym3& stress) {
    const Vec3 traction = tensor(stress) * n;
    return Vec3(traction - n * n.dot(traction));
  };
  if (!row.active) return;
  row.shear_transmitted = model.cut_cells.grid.rotation * link->shear;
  row.shear_sprc = shear(row.stress_sprc);
  row.slip = model.cut_cells.grid.rotation * link->slip;
  row.travelled = link->travelled;
  row.wear = link->wear;
  row.slips = link->slips;
}

/// Shortens the recovered shear to what friction can carry under the recovered pressure.
void limit_shear(double friction, ContactRow& row) {
  const double limit = friction * std::max(0.0, row.pressure_sprc), size = row.shear_sprc.norm();
  if (size > limit) row.shear_sprc *= limit / size;
}

/// Open for certain: nothing lies opposite, or more than the larger one of both cells away.
bool is_far_from_contact(const ContactRow& row) { return !(row.gap < row.larger_cell); }

/// Clears rounding that patches with closed points leave at open ones, where they carry nothing.
void clear_rounding(const SolvedState& state, std::vector<ContactRow>& rows) {
  if (!state.scene.recovery.spr_c) return;
  std::vector<double> largest(state.pairs.size(), 0.0);
  for (const ContactRow& r : rows) largest[r.pair] = std::max(largest[r.pair], std::abs(r.pressure_sprc));
  for (ContactRow& r : rows)
    if (!r.active && std::abs(r.pressure_sprc) < rounding * largest[r.pair]) r.pressure_sprc = 0;
}

/// The items of all chunks, of which this rank has its own.
template <class T>
void append_of_all_ranks(const std::vector<std::vector<T>>& chunks, std::vector<T>& all) {
  std::vector<T> own;
  for (const std::vector<T>& chunk : chunks) own.insert(own.end(), chunk.begin(), chunk.end());
  if (num_ranks() > 1) {
    const std::vector<char> bytes = gather_bytes(own.data(), own.size() * sizeof(T));
    own.resize(bytes.size() / sizeof(T));
    std::memcpy(static_cast<void*>(own.data()), bytes.data(), bytes.size());
  }
  all.insert(all.end(), own.begin(), own.end());
}

}  // namespace

ContactRow contact_row(const SolvedState& state, int body, int pair, int cell, const Vec3& position, const Vec3& n) {
  const BodyModel& model = state.bodies[body];
  ContactRow row;
  row.body = body;
  row.pair = pair;
  row.cell = cell;
  row.x = model.cut_cells.grid.to_global(position);
  row.normal = n;
  const Vec3 xi = cell_coordinates(model.cut_cells, cell, position);
  if (!model.spec->rigid()) set_stresses(state, body, cell, xi, n, row);
  look_across(state, cell, xi, row);
  const bool far = is_far_from_contact(row);
  const ContactLink* link = nearest_link(model, cell, position, model.cut_cells.grid.rotation.transpose() * n, pair);
  row.active = link && link->active && !far;
  row.pressure_transmitted = !link ? std::numeric_limits<double>::quiet_NaN() : row.active ? link->pressure : 0.0;
  if (pairs_rub(state, pair)) set_friction(model, link, n, row);
  const bool carries = model.spec->rigid() || carries_pressure(state, body, cell, pair, position, n);
  const bool pulls = !row.active && row.pressure_sprc < 0;  // beside the zone, where the stress overshoots
  if (state.scene.recovery.spr_c && (far || !carries || pulls)) row.pressure_sprc = 0;
  if (const auto face = state.faces.at(pair, body, row.x, n)) row.pressure_sprc = face->pressure;
  limit_shear(state.pairs[pair].friction(), row);
  return row;
}

double size_of_traction(const ContactRow& row, bool bonded) {
  return bonded ? (tensor(row.stress_sprc) * row.normal).norm() : row.pressure_sprc;
}

std::vector<ContactRow> contact_rows(const SolvedState& state) {
  std::vector<ContactRow> rows;
  std::vector<int> boundary_point;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    const BodyModel& body = state.bodies[b];
    const BoundaryPoints& boundary = body.cut_cells.boundary;
    std::vector<std::vector<int>> points(num_chunks(boundary.size(), grain_of_medium));
    std::vector<std::vector<ContactRow>> chunks(num_chunks(boundary.size(), grain_of_medium));
    // Each rank makes the rows of its own chunks.
    const std::size_t first = share_out(chunks.size()).first, last = share_out(chunks.size()).second;
    dispatch_chunks("cgcontact::postprocess::contact_rows", last - first, [&](std::size_t own) {
      const std::size_t chunk = first + own, end = std::min(boundary.size(), (chunk + 1) * grain_of_medium);
      for (int p = static_cast<int>(chunk * grain_of_medium); p < static_cast<int>(end); ++p) {
        int pair = body.boundary.pair_of_point[p];
        if (pair < 0) pair = pair_of_face(state, b, p);
        if (pair < 0 || (body.boundary.pair_of_point[p] < 0 && state.pairs[pair].spec->automatic)) continue;
        ContactRow row = contact_row(state, b, pair, boundary.cell[p], boundary.position[p], body.normal(p));
        row.weight = body.area(p);
        chunks[chunk].push_back(row);
        points[chunk].push_back(p);
      }
    });
    append_of_all_ranks(chunks, rows);
    append_of_all_ranks(points, boundary_point);
  }
  clear_rounding(state, rows);
  mark_touching_rows(state, boundary_point, rows);
  return rows;
}

}  // namespace cgcontact
