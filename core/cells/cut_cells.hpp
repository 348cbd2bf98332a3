/// Which cells a body fills, the moments of the cut ones, and quadrature points on the body's boundary.
/// Everything here is in grid coordinates (cell units, grid axes): h = 1.
#pragma once

#include <memory>
#include <vector>

#include "core/base/types.hpp"
#include "core/cells/grid.hpp"
#include "core/cells/grid_numbers.hpp"
#include "core/geometry/csg.hpp"

namespace cgcontact {

/// Highest degree per variable of the stored moments: 2 p for the stiffness of Q1, 4 for the energy of
/// (conjoint sigma* - sigma_h), which is of degree 2 per variable.
constexpr int moment_degree = 4;
constexpr int num_moments = (moment_degree + 1) * (moment_degree + 1) * (moment_degree + 1);
/// Moments of L_i(x) L_j(y) L_k(z) (Legendre polynomials, cell coordinates in [-1,1]^3, so a full cell has
/// moment[0] = 8) over cell and body; index (i * (moment_degree+1) + j) * (moment_degree+1) + k.
using Moments = std::array<double, num_moments>;

struct Plane {
  Vec3 normal;
  double offset;                                                ///< normal . x = offset
  std::shared_ptr<const std::vector<char>> surfaces = nullptr;  ///< as a divider: cuts the pieces of these only

  bool divides(int surface) const { return !surfaces || (*surfaces)[surface]; }
};

/// Points on the boundary, all vectors of the same length. Positions, normals in grid coordinates, weights in cell
/// units squared (sum of weights = area / h^2).
struct BoundaryPoints {
  std::vector<Vec3> position;
  std::vector<Vec3> normal;  ///< outward unit normal
  std::vector<double> weight;
  std::vector<int> cell;     ///< active cell that the point belongs to (index into CutCells::cells)
  std::vector<int> surface;  ///< index into solid.surfaces()
  /// Means over the point's piece of surface (between dividers), which say on which side of the dividers it lies: a
  /// point of it may be as near to one as rounding. Empty in bodies without face dividers.
  std::vector<Vec3> piece_position, piece_normal;
  std::size_t size() const { return weight.size(); }
  void append(const Vec3& x, const Vec3& n, double w, int owner, int on_surface) {
    position.push_back(x);
    normal.push_back(n);
    weight.push_back(w);
    cell.push_back(owner);
    surface.push_back(on_surface);
  }
  void reserve(std::size_t n) {
    position.reserve(n);
    normal.reserve(n);
    weight.reserve(n);
    cell.reserve(n);
    surface.reserve(n);
    if (!piece_position.empty()) {
      piece_position.reserve(n);
      piece_normal.reserve(n);
    }
  }
  /// Keeps the first n points.
  void truncate(std::size_t n) {
    position.resize(n);
    normal.resize(n);
    weight.resize(n);
    cell.resize(n);
    surface.resize(n);
    if (!piece_position.empty()) {
      piece_position.resize(n);
      piece_normal.resize(n);
    }
  }
  /// Sets the piece of the last point.
  void set_piece(const Vec3& mean_position, const Vec3& mean_normal) {
    piece_position.push_back(mean_position);
    piece_normal.push_back(mean_normal);
  }
  const Vec3& position_of_piece(std::size_t i) const {
    return piece_position.empty() ? position[i] : piece_position[i];
  }
  const Vec3& normal_of_piece(std::size_t i) const { return piece_normal.empty() ? normal[i] : piece_normal[i]; }
  /// Appends point i of another set, owned by `owner`.
  void append(const BoundaryPoints& from, std::size_t i, int owner) {
    append(from.position[i], from.normal[i], from.weight[i], owner, from.surface[i]);
    if (!from.piece_position.empty()) set_piece(from.piece_position[i], from.piece_normal[i]);
  }
};

/// The pieces of a surface in a cell without volume of its own belong to an active neighbour.
struct Adoption {
  int active;    ///< cell that owns the pieces
  Index3 donor;  ///< cell in which they lie (may be outside of the grid by rounding)
  int surface;
};

/// The cells of one body.
struct CutCells {
  Solid solid;  ///< in grid coordinates
  Grid grid;
  std::vector<Index3> cells;         ///< active cells (positive volume), by k, j, i
  GridNumbers numbers;               ///< of the active cells: indices into cells
  std::vector<signed char> levels;   ///< level of each active cell; empty: 0
  std::vector<int> cut_of_active;    ///< index into moments, or -1 for an interior (full) cell
  std::vector<int> active_of_cut;    ///< cut cell -> active cell
  std::vector<Moments> moments;      ///< one per cut cell
  BoundaryPoints boundary;           ///< default rule, all surfaces
  std::vector<Adoption> adoptions;   ///< ascending in active
  std::vector<Plane> face_dividers;  ///< planes at which all boundary pieces are cut (core/cells/face_dividers.hpp)
  long long num_pruned = 0;  ///< cells whose volume was rounding only; their points and moments went to a neighbour

  int level(int active) const { return levels.empty() ? 0 : levels[active]; }
  /// Size of an active cell, m.
  double h(int active) const { return grid.cell_size_of(level(active)); }
  double volume_fraction(int active) const {
    const int cut = cut_of_active[active];
    return cut < 0 ? 1.0 : moments[cut][0] / 8.0;
  }
  /// Active cell at the given cell index triple, or -1.
  int find(const Index3& c) const { return numbers.find(c); }
  /// Active cell that contains the point (grid coordinates), or the nearest active cell within one cell, or -1.
  int locate(const Vec3& x) const;
};

/// Cell coordinates in [-1,1]^3 of a point in grid coordinates (may lie slightly outside for re-homed points).
Vec3 cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& grid_position);

/// Where cell coordinates are: grid coordinates; global axes, m.
Vec3 grid_position(const CutCells& cut_cells, int active_cell, const Vec3& xi);
Vec3 global_position(const CutCells& cut_cells, int active_cell, const Vec3& xi);

/// Classifies all cells of the grid and integrates the cut ones. Throws InputError if the body has no volume or
/// sticks out of its grid. `face_dividers`: where declared faces end, in grid coordinates: their pieces are cut there.
CutCells make_cut_cells(const Solid& solid_in_grid_coordinates, const Grid& grid,
                        const std::vector<Plane>& face_dividers = {});

/// Quadrature points of the pieces of the given surfaces in one active cell, the pieces being split at the
/// borders of declared faces and additionally at the `dividers` (planes in grid coordinates, e.g. the grid planes of
/// another body's grid) so that the points of every part lie on one side of each. On planes the rule of every part
/// integrates polynomials of total degree
/// <= 2 order - 1 exactly, on curved surfaces polynomials in space of total degree <= order + 1 (to about 1e-9);
/// weights are positive. Appends to `points`.
void boundary_points_of_cell(const CutCells& cut_cells, int active_cell, const std::vector<int>& surfaces,
                             const std::vector<Plane>& dividers, int order, BoundaryPoints& points);

/// Weights on the 27 or 125 Gauss points of the cell (n = 3 or 5 per direction, x slowest: q = (a * n + b) * n + c)
/// that integrate all products of polynomials of degree < n per variable exactly; closed form from the moments.
/// The weights of a full cell sum to 8.
void fitted_weights(const Moments& moments, int n, double* weights);

/// Moments of the cell of twice the size from those of its children, re-centred; children[a + 2 b + 4 c] is the child
/// at offset (a, b, c), nullptr if it is empty. A full child is given by full_cell_moments().
Moments coarse_moments(const std::array<const Moments*, 8>& children);
const Moments& full_cell_moments();

}  // namespace cgcontact
