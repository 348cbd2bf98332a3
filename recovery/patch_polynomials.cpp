/// Degree of the polynomial of every node, and how many rings of cells it is fitted to (docs/recovery.md, "Degree").
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "recovery/patch_assembly.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t grain = 64;

/// Cells across a body from which on patches with contact are of degree 2.
constexpr int thick = 4;
/// In a zone without edges patches of degree 2 extend over half of the thickness: the scatter of sigma_h in cut cells
/// averages out over as large a patch as a polynomial follows.
constexpr int most_rings = 4;
int rings_of_thickness(int cells) { return (cells + 2) / 4; }
/// Within so many cells of an edge of the contact zone, two rings; farther inside one is enough, and so it must be
/// where the edge has a radius of less than so many cells.
constexpr double edge_width = 3, wide_radius = 14;

/// Cells across the body in that direction of its grid that has the fewest, seen from the fullest cell beside the given
/// one; at most what most_rings need.
int cells_across(const CutCells& cc, int cell) {
  constexpr int most = 4 * most_rings;
  int fullest = cell;
  const auto at = [&](const Index3& c, int i, int j, int k) { return cc.find({c[0] + i, c[1] + j, c[2] + k}); };
  for (int n = 0; n < 27; ++n) {
    const int near = at(cc.cells[cell], n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (near >= 0 && cc.volume_fraction(near) > cc.volume_fraction(fullest)) fullest = near;
  }
  const Index3& c = cc.cells[fullest];
  int least = most;
  for (int d = 0; d < 3; ++d) {
    int count = 1;
    for (const int side : {-1, 1})
      for (int s = side; count < least && at(c, d == 0 ? s : 0, d == 1 ? s : 0, d == 2 ? s : 0) >= 0; s += side)
        ++count;
    least = std::min(least, count);
  }
  return least;
}

/// Cells across the thinner one of the bodies at the closed contact points of a cell; 0: there are none.
int cells_across_contact(const std::vector<RecoveryBody>& bodies, const RecoveryBody& body, int cell) {
  int seen = -1, least = 0;  // cell of the other body
  for (int l : body.boundary->links_of_cell[cell]) {
    const ContactLink& link = body.boundary->links[l];
    if (!link.active || link.other_cell == seen) continue;
    if (seen < 0) least = cells_across(*body.mesh->cut_cells, cell);
    least = std::min(least, cells_across(*bodies[link.other_body].mesh->cut_cells, link.other_cell));
    seen = link.other_cell;
  }
  return least;
}

/// In a zone with edges their distance counts, in one without the thickness of the bodies.
int rings_at_contact(const RecoveryBody& body, int node, const EdgeMap& edges, int across) {
  const Grid& grid = body.mesh->cut_cells->grid;
  const Index3& at = body.mesh->nodes[node];
  const Vec3 x = grid.to_global(Vec3(at[0], at[1], at[2]));
  const PatchSet& patches = *body.patches;
  int pair = -1;
  bool has_edges = false;
  for (int p = patches.begin[node]; p < patches.begin[node + 1]; ++p)
    for (int l : body.boundary->links_of_cell[patches.cells[p]]) {
      if (body.boundary->links[l].pair == pair) continue;
      pair = body.boundary->links[l].pair;
      if (!edges.has(pair)) continue;
      EdgePiece piece;
      const bool wide = edges.near(pair, x, piece) && piece.inside(x) <= edge_width * grid.cell_size &&
                        std::abs(piece.curvature) * wide_radius * grid.cell_size < 1;
      if (!wide) return 1;
      has_edges = true;
    }
  return has_edges ? 2 : rings_of_thickness(across);
}

}  // namespace

bool touches_contact(const RecoveryBody& body, int n) {
  const PatchSet& patches = *body.patches;
  for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p)
    if (!body.boundary->links_of_cell[patches.cells[p]].empty()) return true;
  return false;
}

std::vector<PatchPolynomial> patch_polynomials(const std::vector<RecoveryBody>& bodies, std::size_t index,
                                               const EdgeMap* edges, const RecoveryOptions& options) {
  const RecoveryBody& body = bodies[index];
  const PatchSet& patches = *body.patches;
  std::vector<char> across(body.mesh->cell_nodes.size());
  parallel_for(across.size(), grain, [&](std::size_t cell) {
    across[cell] = static_cast<char>(cells_across_contact(bodies, body, static_cast<int>(cell)));
  });
  std::vector<PatchPolynomial> polynomials(body.mesh->num_nodes);
  parallel_for(polynomials.size(), grain, [&](std::size_t n) {
    const int node = static_cast<int>(n);
    int least = 0;  // cells across at the closed points of the patch
    for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p) {
      const int cells = across[patches.cells[p]];
      if (cells > 0) least = least > 0 ? std::min(least, cells) : cells;
    }
    const bool contact = least > 0 || touches_contact(body, node);
    int degree = options.degree.interior, rings = 1;
    if (contact)
      degree = options.degree.contact > 0 ? options.degree.contact : least >= thick ? 2 : 1;
    else if (!patches.full[n])
      degree = options.degree.boundary;
    if (degree == 2 && options.quadratic_rings > 0) {
      rings = options.quadratic_rings;
    } else if (degree == 2 && least >= thick) {
      rings = edges ? rings_at_contact(body, node, *edges, least) : rings_of_thickness(least);
    }
    polynomials[n] = {static_cast<char>(degree), static_cast<char>(rings)};
  });
  return polynomials;
}

}  // namespace cgcontact
