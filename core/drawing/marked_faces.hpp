/// Regions of the bodies' boundary: same elementary surface, supports, loads and contact; without loads also by
/// declared faces.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/cells/cut_cells.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Body on its grid, as the check finds it.
struct CheckedBody {
  const CutCells* cut_cells = nullptr;
  /// Contact pair (index into Scene::contacts) of each boundary point that has something opposite, else -1.
  std::vector<int> pair_of_point;
};

/// One region. Supports, loads and contacts are indices into the scene.
struct FaceRegion {
  int body = 0;
  std::string name;  ///< "body.face", as the scene calls it where a condition names it, or declares it
  std::vector<int> supports, loads, contacts;
  double area = 0;                                                   ///< m^2
  Vec3 centroid = Vec3::Zero(), force = Vec3::Zero();                ///< m; N, resultant of the loads
  Vec3 moment = Vec3::Zero();                                        ///< N m, of the same about the centroid
  std::array<double, num_held> low_displacement, high_displacement;  ///< m, prescribed; low > high: free
  bool symmetry = false, elastic = false;                            ///< a plane of symmetry; held by springs
};

class MarkedFaces {
 public:
  MarkedFaces(const Scene& scene, const std::vector<CheckedBody>& bodies);

  const std::vector<FaceRegion>& regions() const { return regions_; }
  /// Returns the region of a boundary point (index), at x with the outward normal n (global); -1 if no region is like
  /// that.
  int region_at(int body, int cell, int surface, const Vec3& x, const Vec3& n) const;

 private:
  struct Key {
    int body = 0;
    std::vector<std::string> names;  ///< of the elementary surface
    std::vector<int> supports, loads, contacts;
    std::vector<int> declared;  ///< faces of the body; without loads
    bool operator<(const Key& o) const {
      return std::tie(body, names, supports, loads, contacts, declared) <
             std::tie(o.body, o.names, o.supports, o.loads, o.contacts, o.declared);
    }
  };
  /// Face of the scene with the surfaces of its body that it selects.
  struct Selected {
    const FaceRef* face;
    std::vector<char> surfaces;
  };

  void add_body(int body);
  Selected select(const FaceRef& face) const;
  FaceTraction resultant_of(int load) const;
  bool contains(const Selected& selected, int body, int surface, const Vec3& x, const Vec3& n) const;
  Key key_at(int body, int cell, int surface, const Vec3& x, const Vec3& n) const;
  FaceRegion new_region(const Key& key) const;
  void add_point(const Key& key, const Vec3& x, const Vec3& n, double area);
  void finish(FaceRegion& region, double acting) const;

  const Scene& scene_;
  const std::vector<CheckedBody>& bodies_;
  std::vector<std::vector<FaceRef>> declared_faces_;  // of each body
  std::vector<std::vector<Selected>> declared_;
  std::vector<Selected> supports_, loads_, firsts_, seconds_;
  std::vector<FaceTraction> resultants_;              // of the loads
  std::map<std::array<int, 3>, int> automatic_pair_;  ///< of body, cell, surface
  std::map<Key, int> index_;
  std::vector<FaceRegion> regions_;
  std::vector<double> acting_;  ///< N, integral of the size of the loads in each of them
};

}  // namespace cgcontact
