#include "contact/model/press_direction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <set>

namespace cgcontact {
namespace {

/// Cells between faces that make up an edge, and from an edge to what it changes.
constexpr int at_edge = 1, near_edge = 2;
/// Cosines: faces that see each other at less than that are oblique; neighbours below that make up an edge.
constexpr double oblique_below = 0.866, edge_below = 0.7;
/// Sum of the normals over the area of a face, below which the face has a tip.
constexpr double tip_below = 0.8;
/// Zero, relative to the mean of n n^T.
constexpr double nothing = 1e-9;

/// By cell: what is seen there, with the surface.
class NormalsByCell {
 public:
  struct Entry {
    int surface;
    const FacingNormals* normals;
  };
  NormalsByCell(int num_levels, const std::vector<CellIndex>& cells, const std::vector<int>& surfaces,
                const std::vector<FacingNormals>& normals)
      : num_levels_(num_levels) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (normals[i].area > 0) entries_[cells[i]].push_back({surfaces[i], &normals[i]});
  }

  int num_levels() const { return num_levels_; }

  /// Each cell once, whatever its size.
  template <typename Visit>
  void visit(const CellIndex& cell, int reach, const Visit& visit) const {
    std::set<CellIndex> seen;
    each_cell_index_around(num_levels_, cell, reach, [&](const CellIndex& at) {
      const auto found = entries_.find(at);
      if (found == entries_.end()) return;
      if (at.level < cell.level && !seen.insert(at).second) return;
      for (const Entry& entry : found->second) visit(entry);
    });
  }

 private:
  int num_levels_;
  std::map<CellIndex, std::vector<Entry>> entries_;
};

/// Returns whether a convex edge or a tip begins at an oblique face.
bool is_edge(const NormalsByCell& by_cell, const CellIndex& cell, int surface, const FacingNormals& normals) {
  if (!(normals.area > 0) || normals.cosine > oblique_below * normals.area) return false;
  bool edge = normals.is_tip();
  by_cell.visit(cell, at_edge, [&](const NormalsByCell::Entry& other) {
    if (other.surface == surface) return;  // curved
    const Vec3 n = normals.own.normalized(), m = other.normals->own.normalized();
    const Vec3 between = other.normals->position / other.normals->area - normals.position / normals.area;
    edge |= n.dot(m) < edge_below && (m - n).dot(between) > 0;
  });
  return edge;
}

}  // namespace

void FacingNormals::add(double weight, const Vec3& x, const Vec3& normal, const Vec3& opposite_normal) {
  area += weight;
  cosine -= weight * normal.dot(opposite_normal);
  support += weight * x.dot(normal);
  position += weight * x;
  own += weight * normal;
  opposite += weight * opposite_normal;
  own_spread += weight * normal * normal.transpose();
  opposite_spread += weight * opposite_normal * opposite_normal.transpose();
}

void FacingNormals::add(const FacingNormals& other) {
  area += other.area;
  cosine += other.cosine;
  support += other.support;
  position += other.position;
  own += other.own;
  opposite += other.opposite;
  own_spread += other.own_spread;
  opposite_spread += other.opposite_spread;
}

bool FacingNormals::is_tip() const { return own.norm() < tip_below * area && support > position.dot(own) / area; }

Vec3 FacingNormals::direction() const {
  const auto inverse = [&](const Mat3& spread) -> Mat3 {
    return (spread / area + nothing * Mat3::Identity()).inverse();
  };
  return ((inverse(own_spread) + inverse(opposite_spread)).inverse() * (own - opposite)).normalized();
}

std::vector<Vec3> press_directions(int num_levels, const std::vector<CellIndex>& cells,
                                   const std::vector<int>& surfaces, const std::vector<FacingNormals>& normals) {
  std::vector<Vec3> directions(cells.size(), Vec3::Zero());
  const NormalsByCell by_cell(num_levels, cells, surfaces, normals);
  std::set<CellIndex> edges;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_edge(by_cell, cells[i], surfaces[i], normals[i])) edges.insert(cells[i]);
  if (edges.empty()) return directions;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    bool near = false;
    each_cell_index_around(num_levels, cells[i], near_edge,
                           [&](const CellIndex& at) { near = near || edges.count(at) > 0; });
    if (!near) continue;
    FacingNormals around;
    by_cell.visit(cells[i], near_edge, [&](const NormalsByCell::Entry& other) { around.add(*other.normals); });
    if (around.area > 0) directions[i] = around.direction();
  }
  return directions;
}

}  // namespace cgcontact
