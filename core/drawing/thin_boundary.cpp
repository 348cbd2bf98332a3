#include "core/drawing/thin_boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace cgcontact {

namespace {

/// Fractions of a zone's width, its second largest extent, within which triangles around it stay: the largest that
/// leaves few enough.
constexpr std::array<double, 3> around_zone{0.5, 0.25, 0.125};
/// Factor by which the lattice grows until there are few enough triangles.
constexpr double growth = 1.4;
/// Largest lattice, of the largest extent of the scene: a coarser one leaves no shape.
constexpr double coarsest = 0.1;

/// The surfaces that meet in a point, at most three: more or three are a corner.
struct Meeting {
  std::array<int, 3> surfaces{-1, -1, -1};
  void add(int surface) {
    for (int& s : surfaces) {
      if (s == surface) return;
      if (s < 0) {
        s = surface;
        return;
      }
    }
  }
  bool is_corner() const { return surfaces[2] >= 0; }
};

struct VertexKey {
  std::array<int, 5> numbers;  ///< lattice cube, surfaces
  bool operator==(const VertexKey& o) const { return numbers == o.numbers; }
};

struct VertexKeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0;
    for (const int n : key.numbers) hash = (hash ^ static_cast<std::uint32_t>(n)) * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

/// Boundary of one body, thinned with different lattices.
class Thinning {
 public:
  explicit Thinning(const DrawnBody& body)
      : body_(body), triangles_(conforming_boundary(body)), meetings_(body.position.size()) {
    for (const BoundaryTriangle& triangle : body.mesh.boundary)
      for (const int p : triangle.points) meetings_[p].add(triangle.surface);
    for (Meeting& meeting : meetings_) std::sort(meeting.surfaces.begin(), meeting.surfaces.end(), std::greater<>());
  }

  /// `lattice`: m; 0: all as it is.
  std::vector<ThinTriangle> run(double lattice, const std::vector<SceneBox>& kept) const {
    const std::vector<int> point = points_of(lattice, kept);
    std::vector<ThinTriangle> thin;
    for (const ThinTriangle& triangle : triangles_) {
      std::array<int, 3> corners = triangle.points;
      for (int& p : corners) p = point[p];
      if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
        thin.push_back({corners, triangle.source});
    }
    return thin;
  }

 private:
  /// Returns for each point the one that stands for it.
  std::vector<int> points_of(double lattice, const std::vector<SceneBox>& kept) const {
    std::unordered_map<VertexKey, int, VertexKeyHash> first;
    std::vector<int> point(body_.position.size());
    for (std::size_t p = 0; p < point.size(); ++p) {
      const Vec3& x = body_.position[p];
      const bool near = std::any_of(kept.begin(), kept.end(), [&](const SceneBox& box) {
        return (x.array() >= box.low.array()).all() && (x.array() <= box.high.array()).all();
      });
      point[p] = static_cast<int>(p);
      if (!(lattice > 0) || near || meetings_[p].is_corner()) continue;
      VertexKey key{};
      for (int k = 0; k < 3; ++k) key.numbers[k] = static_cast<int>(std::floor(x[k] / lattice));
      key.numbers[3] = meetings_[p].surfaces[0];
      key.numbers[4] = meetings_[p].surfaces[1];
      point[p] = first.try_emplace(key, static_cast<int>(p)).first->second;
    }
    return point;
  }

  const DrawnBody& body_;
  const std::vector<ThinTriangle> triangles_;
  std::vector<Meeting> meetings_;
};

std::vector<SceneBox> widened(std::vector<SceneBox> zones, double fraction) {
  for (SceneBox& zone : zones) {
    std::array<double, 3> extents{zone.extent()[0], zone.extent()[1], zone.extent()[2]};
    std::sort(extents.begin(), extents.end());
    const Vec3 margin = Vec3::Constant(fraction * extents[1]);
    zone.low -= margin;
    zone.high += margin;
  }
  return zones;
}

}  // namespace

std::vector<std::vector<ThinTriangle>> thin_boundaries(const std::vector<DrawnBody>& bodies,
                                                       const std::vector<SceneBox>& zones, std::size_t most) {
  std::vector<Thinning> thinnings;
  SceneBox box;
  double area = 0;
  for (const DrawnBody& body : bodies) {
    thinnings.emplace_back(body);
    for (const BoundaryTriangle& t : body.mesh.boundary) {
      const Vec3& a = body.position[t.points[0]];
      area += (body.position[t.points[1]] - a).cross(body.position[t.points[2]] - a).norm() / 2;
      box.add(a);
    }
  }
  std::vector<std::vector<ThinTriangle>> thin(bodies.size());
  const auto run = [&](double lattice, const std::vector<SceneBox>& kept) {
    std::size_t count = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) count += (thin[b] = thinnings[b].run(lattice, kept)).size();
    return count <= most;
  };
  if (run(0, {})) return thin;
  const double finest = std::sqrt(area / static_cast<double>(most));
  std::vector<std::vector<SceneBox>> kept_zones;
  for (const double fraction : around_zone) kept_zones.push_back(widened(zones, fraction));
  kept_zones.emplace_back();
  for (const std::vector<SceneBox>& kept : kept_zones)
    for (double lattice = finest; lattice < coarsest * box.extent().maxCoeff(); lattice *= growth)
      if (run(lattice, kept)) return thin;
  return thin;
}

}  // namespace cgcontact
