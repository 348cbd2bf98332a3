#include "recovery/constrained/patch_polynomials.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/process/parallel.hpp"
#include "core/cells/cells_around.hpp"
#include "core/geometry/solid_middle.hpp"
#include "recovery/constrained/patch_lists.hpp"

namespace cgcontact {
namespace {

/// In a zone whose pressure nothing knows patches of degree 2 extend over half of the thickness: the scatter of sigma_h
/// in cut cells averages out over as large a patch as a polynomial follows.
constexpr int max_rings = 4;
int rings_of_thickness(int cells) { return (cells + 2) / 4; }
/// Returns whether there are active cells at the position of a cell, whatever their size.
bool is_occupied(const CutCells& cc, const CellIndex& index) {
  bool found = false;
  each_cell_at(cc, index, [&](int) { found = true; });
  return found;
}

/// Cells of a body from the given one on along an axis of its grid, without that one; at most `limit`.
int cells_beyond(const CutCells& cc, CellIndex c, int axis, int side, int limit) {
  int count = 0;
  while (count < limit) {
    c.cell[axis] += side;
    if (!is_occupied(cc, c)) break;
    ++count;
  }
  return count;
}

/// In that direction of the grid that has the fewest; at most what max_rings need.
int min_cells(const CutCells& cc, const CellIndex& c) {
  int least = 4 * max_rings;
  for (int axis = 0; axis < 3; ++axis) {
    const int before = cells_beyond(cc, c, axis, -1, least);
    least = std::min(least, before + 1 + cells_beyond(cc, c, axis, 1, least));
  }
  return least;
}

/// Cells across a body at its contact face, and at half of the depth below it, max_rings cells at most: curved bodies
/// are thin along their face at tangent grid planes, not below. 0: no closed contact.
struct CellsAcross {
  char at_face = 0, below = 0;

  void take_thinner(const CellsAcross& other) {
    if (other.at_face == 0) return;
    at_face = at_face > 0 ? std::min(at_face, other.at_face) : other.at_face;
    below = below > 0 ? std::min(below, other.below) : other.below;
  }
};

/// Returns the fullest of the cells of its size beside the given one; of equals the nearest one, of those the one
/// towards the middle of the body, in its mirror image as well.
int fullest_beside(const CutCells& cc, int cell, const Vec3& middle) {
  const Index3& c = cc.cells[cell];
  int fullest = cell;
  double best = -1;
  for (int n = 0; n < 27; ++n) {
    const Index3 to = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    const Vec3 step(to[0], to[1], to[2]);
    const int near = cc.find(cc.level(cell), {c[0] + to[0], c[1] + to[1], c[2] + to[2]});
    if (near < 0) continue;
    const double away = (Vec3(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5) + step - middle / cc.size(cell)).norm();
    const double score = cc.volume_fraction(near) - 1e-3 * step.norm() - 1e-6 * away;
    if (score > best + 1e-12) best = score, fullest = near;
  }
  return fullest;
}

/// Seen from the fullest cell beside the given one; outward: the normal, in grid axes.
CellsAcross cells_across(const CutCells& cc, int cell, const Vec3& outward, const Vec3& middle) {
  CellIndex c{cc.level(cell), cc.cells[fullest_beside(cc, cell, middle)]};
  CellsAcross across;
  across.at_face = static_cast<char>(min_cells(cc, c));
  int axis = 0;
  outward.cwiseAbs().maxCoeff(&axis);
  const int inward = outward[axis] > 0 ? -1 : 1;
  c.cell[axis] += inward * (cells_beyond(cc, c, axis, inward, 2 * max_rings) / 2);
  across.below = static_cast<char>(min_cells(cc, c));
  return across;
}

/// Returns the cells across the thinner one of the bodies at the closed contact points of a cell.
CellsAcross cells_across_contact(const std::vector<RecoveryBody>& bodies, const RecoveryBody& body, int cell,
                                 const Vec3& middle, const std::vector<Vec3>& middles) {
  int seen = -1;  // cell of the other body
  CellsAcross least;
  for (int l : body.boundary->links_of_cell[cell]) {
    const ContactLink& link = body.boundary->links[l];
    if (!link.active || link.other_cell == seen) continue;
    const CutCells& own = *body.mesh->cut_cells;
    const CutCells& other = *bodies[link.other_body].mesh->cut_cells;
    const Vec3 outward = -(other.grid.rotation.transpose() * (own.grid.rotation * link.normal));
    if (seen < 0) least = cells_across(own, cell, link.normal, middle);
    if (!bodies[link.other_body].mesh->rigid)
      least.take_thinner(cells_across(other, link.other_cell, outward, middles[link.other_body]));
    seen = link.other_cell;
  }
  return least;
}

/// Returns whether a problem on the face knows the pressure of a pair at the patch of a node.
bool is_known(const RecoveryBody& body, int node, const KnownPressures& known) {
  const PatchSet& patches = *body.patches;
  for (int p = patches.begin[node]; p < patches.begin[node + 1]; ++p)
    for (const int l : body.boundary->links_of_cell[patches.cells[p]])
      if (known.has_zone(body.boundary->links[l].pair)) return true;
  return false;
}

/// Returns whether a patch holds points of a contact face, closed or open.
bool touches_contact(const RecoveryBody& body, int n) {
  const PatchSet& patches = *body.patches;
  for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p)
    if (!body.boundary->links_of_cell[patches.cells[p]].empty()) return true;
  return false;
}

/// Returns pairs that slip somewhere, by number: between regions that stick, slip and are open the shear has corners
/// that no quadratic follows (docs/recovery.md).
std::vector<char> slipping_pairs(const BoundaryData& boundary) {
  std::vector<char> slips(boundary.friction.size(), 0);
  for (const ContactLink& link : boundary.links)
    if (link.slips) slips[link.pair] = 1;
  return slips;
}

bool touches_any(const RecoveryBody& body, int n, const std::vector<char>& pairs) {
  const PatchSet& patches = *body.patches;
  for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p)
    for (const int l : body.boundary->links_of_cell[patches.cells[p]])
      if (pairs[body.boundary->links[l].pair]) return true;
  return false;
}

}  // namespace

std::vector<PatchPolynomial> patch_polynomials(const std::vector<RecoveryBody>& bodies, std::size_t index,
                                               const KnownPressures* known, const RecoveryOptions& options) {
  const RecoveryBody& body = bodies[index];
  const PatchSet& patches = *body.patches;
  std::vector<Vec3> middles;  // grid coordinates
  for (const RecoveryBody& each : bodies) middles.push_back(middle_of(each.mesh->cut_cells->solid));
  std::vector<CellsAcross> across(body.mesh->cell_nodes.size());
  if (options.degree.contact != 1)  // else nobody asks
    parallel_for("cgcontact::patch_polynomials::cells_across", across.size(), grain_of_heavy, [&](std::size_t cell) {
      across[cell] = cells_across_contact(bodies, body, static_cast<int>(cell), middles[index], middles);
    });
  const std::vector<char> slips = slipping_pairs(*body.boundary);
  const bool any_slips = std::find(slips.begin(), slips.end(), 1) != slips.end();
  std::vector<PatchPolynomial> polynomials(body.mesh->num_nodes);
  parallel_for("cgcontact::patch_polynomials::polynomials", polynomials.size(), grain_of_heavy, [&](std::size_t n) {
    const int node = static_cast<int>(n);
    CellsAcross least;  // at the closed points of the patch
    for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p) least.take_thinner(across[patches.cells[p]]);
    const bool contact = touches_contact(body, node);
    int degree = options.degree.interior, rings = 1;
    if (contact && options.degree.contact == 0 && any_slips && touches_any(body, node, slips))
      degree = 1;
    else if (contact)
      degree = options.degree.contact > 0 ? options.degree.contact : least.at_face >= options.thick ? 2 : 1;
    else if (!patches.full[n])
      degree = options.degree.boundary;
    if (degree == 2 && options.quadratic_rings > 0) {
      rings = options.quadratic_rings;
    } else if (degree == 2 && least.at_face >= options.thick && !(known && is_known(body, node, *known))) {
      rings = rings_of_thickness(least.below);
    }
    polynomials[n] = {static_cast<char>(degree), static_cast<char>(rings)};
  });
  return polynomials;
}

StressIntegrals integrate_stress(const RecoveryBody& body, const std::vector<PatchPolynomial>& polynomials,
                                 const CellStress& stress, const RecoveryOptions& options) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<int> closed;
  for (const ContactLink& link : body.boundary->links)
    if (link.active && (closed.empty() || closed.back() != link.cell)) closed.push_back(link.cell);
  std::vector<char> marked(cc.cells.size(), 0);
  std::vector<int> cells;
  int rings = 2;
  for (int n = 0; n < body.mesh->num_nodes; ++n) {
    if (polynomials[n].degree == 1) continue;
    rings = std::max<int>(rings, polynomials[n].rings);
    fit_cells(body, n, polynomials[n], cells);
    for (int c : cells) marked[c] = 1;
  }
  mark_cells_around(cc, closed, static_cast<int>(std::ceil(options.auxiliary_depth)) + rings, marked);
  return integrate_stress(*body.mesh, stress, Subset(marked));
}

}  // namespace cgcontact
