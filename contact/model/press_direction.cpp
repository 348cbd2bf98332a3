#include "contact/model/press_direction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <map>

namespace cgcontact {
namespace {

/// Cells between faces that make up an edge, and from an edge to what it changes.
constexpr int at_edge = 1, near_edge = 2;
/// Cosines: faces that see each other at less than that are oblique; neighbours below that make up an edge.
constexpr double oblique_below = 0.866, edge_below = 0.7;
/// Of its area, the sum of the normals of a face with a tip.
constexpr double tip_below = 0.8;
/// Of the mean of n n^T: what is nothing.
constexpr double nothing = 1e-9;

using Place = std::array<int, 3>;

/// By cell: what is seen there, with the surface.
class Places {
 public:
  struct Entry {
    int surface;
    const FacingNormals* normals;
  };
  Places(const std::vector<Index3>& cells, const std::vector<int>& surfaces,
         const std::vector<FacingNormals>& normals) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (normals[i].area > 0) places_[{cells[i][0], cells[i][1], cells[i][2]}].push_back({surfaces[i], &normals[i]});
  }

  template <typename Visit>
  void visit(const Index3& cell, int reach, const Visit& visit) const {
    for (int a = -reach; a <= reach; ++a)
      for (int b = -reach; b <= reach; ++b)
        for (int c = -reach; c <= reach; ++c) {
          const auto place = places_.find({cell[0] + a, cell[1] + b, cell[2] + c});
          if (place == places_.end()) continue;
          for (const Entry& entry : place->second) visit(entry);
        }
  }

 private:
  std::map<Place, std::vector<Entry>> places_;
};

/// Does a convex edge or a tip begin at an oblique face?
bool is_edge(const Places& places, const Index3& cell, int surface, const FacingNormals& normals) {
  if (!(normals.area > 0) || normals.cosine > oblique_below * normals.area) return false;
  bool edge = normals.is_tip();
  places.visit(cell, at_edge, [&](const Places::Entry& other) {
    if (other.surface == surface) return;  // curved
    const Vec3 n = normals.own.normalized(), m = other.normals->own.normalized();
    const Vec3 between = other.normals->place / other.normals->area - normals.place / normals.area;
    edge |= n.dot(m) < edge_below && (m - n).dot(between) > 0;
  });
  return edge;
}

}  // namespace

void FacingNormals::add(double weight, const Vec3& x, const Vec3& normal, const Vec3& opposite_normal) {
  area += weight;
  cosine -= weight * normal.dot(opposite_normal);
  support += weight * x.dot(normal);
  place += weight * x;
  own += weight * normal;
  opposite += weight * opposite_normal;
  own_spread += weight * normal * normal.transpose();
  opposite_spread += weight * opposite_normal * opposite_normal.transpose();
}

void FacingNormals::add(const FacingNormals& other) {
  area += other.area;
  cosine += other.cosine;
  support += other.support;
  place += other.place;
  own += other.own;
  opposite += other.opposite;
  own_spread += other.own_spread;
  opposite_spread += other.opposite_spread;
}

bool FacingNormals::is_tip() const { return own.norm() < tip_below * area && support > place.dot(own) / area; }

Vec3 FacingNormals::direction() const {
  const auto inverse = [&](const Mat3& spread) -> Mat3 {
    return (spread / area + nothing * Mat3::Identity()).inverse();
  };
  return ((inverse(own_spread) + inverse(opposite_spread)).inverse() * (own - opposite)).normalized();
}

std::vector<Vec3> press_directions(const std::vector<Index3>& cells, const std::vector<int>& surfaces,
                                   const std::vector<FacingNormals>& normals) {
  std::vector<Vec3> directions(cells.size(), Vec3::Zero());
  const Places places(cells, surfaces, normals);
  std::vector<Index3> edges;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_edge(places, cells[i], surfaces[i], normals[i])) edges.push_back(cells[i]);
  if (edges.empty()) return directions;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool near = std::any_of(edges.begin(), edges.end(), [&](const Index3& edge) {
      return std::max({std::abs(edge[0] - cells[i][0]), std::abs(edge[1] - cells[i][1]),
                       std::abs(edge[2] - cells[i][2])}) <= near_edge;
    });
    if (!near) continue;
    FacingNormals around;
    places.visit(cells[i], near_edge, [&](const Places::Entry& other) { around.add(*other.normals); });
    if (around.area > 0) directions[i] = around.direction();
  }
  return directions;
}

}  // namespace cgcontact
