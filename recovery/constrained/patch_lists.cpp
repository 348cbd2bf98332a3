#include "recovery/constrained/patch_lists.hpp"

#include <algorithm>

#include "core/base/numbers/rounding.hpp"
#include "recovery/patch/cells_in_box.hpp"

namespace cgcontact {
namespace {

void sort_unique(std::vector<int>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/// Memory that is used again for patch after patch.
struct ListSpace {
  std::vector<int> cells;
  std::vector<PairState> states;
  std::vector<char> box;  ///< marks of the cells in a box
};

/// Adds the cells at most `reach` cells away from any of the given ones along every axis, those with integrals.
void add_rings(const StressIntegrals& integrals, const CutCells& cc, int reach, std::vector<char>& box,
               std::vector<int>& cells) {
  if (cells.empty()) return;
  if (!cc.level_cells.empty()) {
    const std::vector<int> inner = cells;
    for (int c : inner) {
      const Vec3 low = cc.corner(c), width = Vec3::Constant(reach * cc.size(c));
      each_cell_within(cc, low - width, low + Vec3::Constant(cc.size(c)) + width, [&](int cell) {
        if (integrals.hold(cell)) cells.push_back(cell);
      });
    }
    sort_unique(cells);
    return;
  }
  Index3 low = cc.cells[cells.front()], size;
  Index3 high = low;
  for (int c : cells)
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], cc.cells[c][d]);
      high[d] = std::max(high[d], cc.cells[c][d]);
    }
  for (int d = 0; d < 3; ++d) low[d] -= reach, size[d] = high[d] + reach + 1 - low[d];
  box.assign(static_cast<std::size_t>(size[0]) * size[1] * size[2], 0);
  for (int c : cells) {
    const Index3& at = cc.cells[c];
    for (int k = at[2] - low[2] - reach; k <= at[2] - low[2] + reach; ++k)
      for (int j = at[1] - low[1] - reach; j <= at[1] - low[1] + reach; ++j) {
        const auto row = box.begin() + (static_cast<std::ptrdiff_t>(k) * size[1] + j) * size[0] + at[0] - low[0];
        std::fill(row - reach, row + reach + 1, char{1});
      }
  }
  cells.clear();
  std::size_t n = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++n) {
        if (!box[n]) continue;
        const int c = cc.find({low[0] + i, low[1] + j, low[2] + k});
        if (c >= 0 && integrals.hold(c)) cells.push_back(c);
      }
}

/// Contact points by pair.
void find_pairs(const PatchContext& context, const ListRange<int>& cells, std::vector<PairState>& states) {
  states.clear();
  context.contact.each(cells, -1, [&](const ContactFacet& facet) {
    auto state = std::lower_bound(states.begin(), states.end(), facet.pair,
                                  [](const PairState& s, int pair) { return s.pair < pair; });
    if (state == states.end() || state->pair != facet.pair)
      state = states.insert(state, PairState{facet.pair, facet.other_body});
    state->area += facet.area;
    state->closed_area += facet.closed_area;
    state->unknown_area += facet.unknown_area;
  });
}

/// Edge (global axes, m) seen from a body; `unit`: m.
ContactEdge seen_from(const RecoveryBody& body, const Vec3& face_point, const Vec3& normal,
                      const ZoneEdgeSegment& segment, double unit) {
  const BodyMesh& mesh = *body.mesh;
  const Grid& grid = mesh.cut_cells->grid;
  ContactEdge edge;
  edge.origin = grid.to_grid(segment.origin);
  edge.closed = grid.rotation.transpose() * segment.closed;
  edge.along = grid.rotation.transpose() * segment.along;
  edge.curvature = segment.curvature * grid.cell_size;
  edge.inverse_width = segment.inverse_width * grid.cell_size;
  const Vec3 x = grid.to_grid(face_point), n = grid.rotation.transpose() * normal;
  const Solid& solid = mesh.cut_cells->solid;
  edge.surface = solid.surfaces()[solid.surface_at(x, n)].near(x);
  edge.orientation = edge.surface.gradient(x).dot(n) < 0 ? -1 : 1;
  edge.scale = grid.cell_size / unit;
  edge.poisson_ratio = mesh.poisson_ratio();
  return edge;
}

/// Returns the mode of a pair in the last patch of the lists; adds the term of the edge of a zone with a known pressure
/// if it is near and the patch has none yet.
ContactMode mode_of_pair(const PatchContext& context, const PairState& state, const ListRange<int>& cells,
                         PatchLists& lists) {
  const std::size_t patch = lists.size() - 1;
  const RecoveryBody& body = context.body;
  const Grid& grid = context.grid;
  if (body.boundary->is_bonded(state.pair)) return ContactMode::closed;
  if (state.closed_area == 0) return ContactMode::open;
  if (state.couples) return state.is_mixed() ? ContactMode::unclear : ContactMode::closed;
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  context.contact.each(cells, state.pair, [&](const ContactFacet& facet) {
    centroid += facet.position / state.area;
    normal += facet.normal;
  });
  ZoneEdgeSegment segment;
  const Vec3 x = grid.to_global(centroid);
  if (!context.options.contact_edge || lists.edge[patch] >= 0 || !context.known->edge_near(state.pair, x, segment)) {
    if (state.is_mixed()) lists.raise(patch, PatchStatus::edge_unclear);
    return ContactMode::closed;
  }
  double least = 1e300;  // cells of the body
  context.contact.each(cells, state.pair, [&](const ContactFacet& facet) {
    for (const PatchContactPoint& point : context.contact.points(facet))
      least = std::min(least, segment.inside(grid.to_global(point.position)) / facet.cell_size);
  });
  if (least > context.options.term_reach) return ContactMode::closed;
  const double h = lists.unit[patch] * grid.cell_size;
  lists.edge[patch] = static_cast<int>(lists.edges.size());
  lists.edges.push_back({seen_from(body, x, grid.rotation * normal.normalized(), segment, h),
                         -segment.factor / context.scales.stress * std::sqrt(h)});
  return state.is_mixed() ? ContactMode::edge : ContactMode::closed;
}

/// Returns the pair with the largest closed area that wants an auxiliary patch; -1: none, as beside a rigid body.
int coupled_pair(const PatchContext& context, const std::vector<PairState>& states) {
  int coupled = -1;
  for (std::size_t s = 0; s < states.size(); ++s) {
    const PairState& state = states[s];
    const bool wants =
        state.couples && (state.mode == ContactMode::closed || state.mode == ContactMode::unclear) &&
        (context.body.boundary->is_bonded(state.pair) || state.is_closed(context.options.closed_fraction));
    if (wants && (coupled < 0 || state.closed_area > states[coupled].closed_area)) coupled = static_cast<int>(s);
  }
  return coupled >= 0 && context.bodies[states[coupled].other_body].mesh->rigid ? -1 : coupled;
}

/// Whole active cells of the other body under the patch's contact points, down to the auxiliary depth (equation 13),
/// and with more than one ring the cells around those; none if they hold too little material.
void find_auxiliary(const PatchContext& context, const PairState& state, PatchPolynomial polynomial,
                    const ListRange<int>& patch, ListSpace& space, PatchLists& lists) {
  const StressIntegrals& integrals = context.integrals[state.other_body];
  const CutCells& cc = *context.bodies[state.other_body].mesh->cut_cells;
  std::vector<int>& cells = space.cells;
  Vec3& centre = lists.auxiliary_centre.back();
  cells.clear();
  context.contact.each(patch, state.pair, [&](const ContactFacet& facet) {
    centre += facet.other_position / state.area;
    const ListRange<int> under = context.contact.under(facet);
    cells.insert(cells.end(), under.begin(), under.end());
  });
  sort_unique(cells);
  if (polynomial.rings > 1) add_rings(integrals, cc, polynomial.rings - 1, space.box, cells);
  double volume = 0, largest = 0;
  for (int c : cells) {
    volume += cc.volume_fraction(c);
    largest = std::max(largest, cc.size(c));
  }
  if (volume < context.options.min_auxiliary_volume) cells.clear();
  lists.auxiliary_unit.back() = largest;
}

}  // namespace

bool PairState::is_closed(double fraction) const {
  return closed_area > 0 && closed_area > fraction * area * (1 - rounding);
}

void PatchLists::append(const PatchLists& other) {
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(node, other.node), add(polynomial, other.polynomial);
  add(centre, other.centre), add(auxiliary_centre, other.auxiliary_centre);
  add(unit, other.unit), add(auxiliary_unit, other.auxiliary_unit);
  cells.append(other.cells), auxiliary_cells.append(other.auxiliary_cells), pairs.append(other.pairs);
  add(coupled, other.coupled);
  for (const int e : other.edge) edge.push_back(e < 0 ? -1 : static_cast<int>(edges.size()) + e);
  add(edges, other.edges);
  add(kind, other.kind), add(status, other.status), add(fitted, other.fitted);
}

void PatchLists::clear() {
  node.clear(), polynomial.clear(), centre.clear(), auxiliary_centre.clear(), unit.clear(), auxiliary_unit.clear();
  cells.clear(), auxiliary_cells.clear(), pairs.clear();
  coupled.clear(), edge.clear(), edges.clear(), kind.clear(), status.clear(), fitted.clear();
}

void fit_cells(const RecoveryBody& body, int n, PatchPolynomial polynomial, std::vector<int>& cells) {
  const PatchSet& patches = *body.patches;
  const auto first = patches.cells.begin() + patches.begin[n], last = patches.cells.begin() + patches.begin[n + 1];
  const int rings = polynomial.rings;
  cells.clear();
  if (rings > 1) {
    const CutCells& cc = *body.mesh->cut_cells;
    if (!cc.level_cells.empty()) {
      const Vec3 centre = body.mesh->node_position(n), width = Vec3::Constant(rings * unit_of(*body.mesh, n));
      each_cell_within(cc, centre - width, centre + width, [&](int cell) { cells.push_back(cell); });
      cells.insert(cells.end(), first, last);
      return sort_unique(cells);
    }
    const Index3& node = body.mesh->nodes[n];
    for (int k = -rings; k < rings; ++k)
      for (int j = -rings; j < rings; ++j)
        for (int i = -rings; i < rings; ++i) {
          const int c = cc.find({node[0] + i, node[1] + j, node[2] + k});
          if (c >= 0) cells.push_back(c);
        }
  }
  if (rings > 1 && !patches.grown[n]) return;  // the patch is inside
  cells.insert(cells.end(), first, last);
  sort_unique(cells);
}

void add_patch(const PatchContext& context, int node, PatchPolynomial polynomial, PatchLists& lists) {
  static thread_local ListSpace space;
  const ListRange<int> patch = context.cells_of(node);
  const BodyMesh& mesh = *context.body.mesh;
  lists.node.push_back(node);
  lists.polynomial.push_back(polynomial);
  lists.centre.push_back(mesh.node_position(node));
  lists.unit.push_back(unit_of(mesh, node));
  lists.auxiliary_centre.push_back(Vec3::Zero());
  lists.auxiliary_unit.push_back(1);
  lists.edge.push_back(-1);
  lists.kind.push_back(PatchKind::interior);
  lists.status.push_back(PatchStatus::exact);
  lists.fitted.push_back(0);
  fit_cells(context.body, node, polynomial, space.cells);
  lists.cells.add(space.cells);
  find_pairs(context, patch, space.states);
  for (PairState& state : space.states) {
    state.couples = context.body.boundary->is_bonded(state.pair) || !context.known || state.unknown_area > 0;
    state.mode = mode_of_pair(context, state, patch, lists);
  }
  lists.coupled.push_back(coupled_pair(context, space.states));
  space.cells.clear();
  if (lists.coupled.back() >= 0)
    find_auxiliary(context, space.states[lists.coupled.back()], polynomial, patch, space, lists);
  lists.auxiliary_cells.add(space.cells);
  lists.pairs.add(space.states);
}

}  // namespace cgcontact
