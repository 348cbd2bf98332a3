#include "core/scene_file/templates/part_outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"
#include "core/scene_file/sections/scene_mesh.hpp"
#include "core/triangles/triangle_faces.hpp"

namespace cgcontact {

namespace {

const double min_flat_cosine = std::cos(radians_per_degree);  // a degree
const double min_outward_cosine = std::cos(pi / 6);
constexpr double plane_slack = 1e-6;  // of the height: single precision in the file
constexpr double end_share = 0.02, face_share = 0.1;

/// Clips a triangle to sign * z >= level.
std::vector<Vec3> clip(const TriangleSurface& surface, int t, double sign, double level) {
  std::vector<Vec3> polygon;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = surface.corner(t, k), &b = surface.corner(t, (k + 1) % 3);
    const double da = sign * a[2] - level, db = sign * b[2] - level;
    if (da >= 0) polygon.push_back(a);
    if ((da >= 0) != (db >= 0)) polygon.push_back(a + da / (da - db) * (b - a));
  }
  return polygon;
}

double area(const std::vector<Vec3>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < polygon.size(); ++k)
    sum += (polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]) / 2;
  return sum.norm();
}

struct EndRegion {
  double area = 0;
  Vec3 min = Vec3::Constant(1e300), max = Vec3::Constant(-1e300);
  void add(const std::vector<Vec3>& polygon) {
    area += cgcontact::area(polygon);
    for (const Vec3& x : polygon) {
      min = min.cwiseMin(x);
      max = max.cwiseMax(x);
    }
  }
};

/// sign: 1 for the top, -1 for the bottom.
PartEnd find_end(const TriangleSurface& surface, double sign, double extreme, double height) {
  EndRegion cap, plane;
  double outward = 0;
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const double cosine = sign * surface.normal(t)[2];
    const auto upper = clip(surface, t, sign, extreme - end_share * height);
    if (!upper.empty() && cosine > 0) cap.add(upper);
    const auto touching = clip(surface, t, sign, extreme - plane_slack * height);
    if (!touching.empty() && cosine > min_flat_cosine) plane.add(touching);
    if (cosine > min_outward_cosine) outward += area(clip(surface, t, sign, extreme - face_share * height));
  }
  PartEnd end;
  end.flat = plane.area > cap.area / 2;
  const EndRegion& region = end.flat ? plane : cap;
  end.min = region.min;
  end.max = region.max;
  end.faces_outwards = outward > 0;
  return end;
}

std::vector<SmoothRegion> find_regions(const TriangleSurface& surface) {
  std::vector<SmoothRegion> regions(surface.face_names().size());
  std::vector<double> largest(regions.size(), -1);
  const auto area_vector = [&](int t) {
    const Vec3& a = surface.corner(t, 0);
    return Vec3((surface.corner(t, 1) - a).cross(surface.corner(t, 2) - a) / 2);
  };
  const int count = static_cast<int>(surface.triangles().size());
  for (int t = 0; t < count; ++t) {
    const int p = surface.patch(t);
    const Vec3 a = area_vector(t);
    regions[p].area += a.norm();
    regions[p].normal += a;
    if (a.norm() <= largest[p]) continue;
    largest[p] = a.norm();
    regions[p].seed = (surface.corner(t, 0) + surface.corner(t, 1) + surface.corner(t, 2)) / 3;
  }
  for (SmoothRegion& region : regions) {
    region.flat = region.normal.norm() > 1e-6 * region.area;
    if (region.flat)
      region.normal.normalize();
    else
      region.normal.setZero();
  }
  for (int t = 0; t < count; ++t) {
    SmoothRegion& region = regions[surface.patch(t)];
    region.flat = region.flat && surface.normal(t).dot(region.normal) >= min_flat_cosine;
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const SmoothRegion& a, const SmoothRegion& b) { return a.area > b.area; });
  return regions;
}

double enclosed_volume(const TriangleSurface& surface) {
  double volume = 0;
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t)
    volume += surface.corner(t, 0).dot(surface.corner(t, 1).cross(surface.corner(t, 2))) / 6;
  return volume;
}

/// Finds everything that depends on how the part is turned.
void find_ends(const TriangleSurface& surface, PartOutline& outline) {
  outline.min = surface.tree().min();
  outline.max = surface.tree().max();
  const double height = outline.max[2] - outline.min[2];
  outline.top = find_end(surface, 1, outline.max[2], height);
  outline.bottom = find_end(surface, -1, -outline.min[2], height);
  outline.below_top.clear();
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const std::array<Vec3, 3> corners{surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2)};
    const bool near = std::any_of(corners.begin(), corners.end(),
                                  [&](const Vec3& x) { return x[2] >= outline.max[2] - face_share * height; });
    if (near) outline.below_top.push_back(corners);
  }
}

}  // namespace

PartCut PartOutline::cut_at(double push) const {
  const double level = max[2] - push;
  PartCut cut;  // by the divergence theorem, what lies above it projects on it
  for (const auto& corners : below_top) {
    std::vector<Vec3> above, ends;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = corners[k], &b = corners[(k + 1) % 3];
      const double da = a[2] - level, db = b[2] - level;
      if (da >= 0) above.push_back(a);
      if ((da >= 0) != (db >= 0)) ends.push_back(a + da / (da - db) * (b - a)), above.push_back(ends.back());
    }
    for (std::size_t k = 2; k < above.size(); ++k)
      cut.area += (above[k - 1] - above[0]).cross(above[k] - above[0])[2] / 2;
    if (ends.size() == 2) cut.rim += (ends[1] - ends[0]).norm();
  }
  return cut;
}

double PartOutline::push_until(const std::function<bool(double, const PartCut&)>& is_enough, double most) const {
  double near = 0, far = most;
  if (!is_enough(most, cut_at(most))) return most;
  for (int pass = 0; pass < 30; ++pass) {
    const double middle = (near + far) / 2;
    (is_enough(middle, cut_at(middle)) ? far : near) = middle;
  }
  return far;
}

PartOutline outline_part(const std::string& file, double scale, bool repair) {
  const BodySurface read = read_body_surface(file, scale, repair);
  const TriangleSoup& soup = read.soup;
  const TriangleSurface surface = make_surface(soup, name_faces(soup, "part", {}), default_crease_angle);
  return outline_surface(surface, describe_surface(file, read, surface.tree().max() - surface.tree().min()));
}

PartOutline outline_surface(const TriangleSurface& surface, const std::string& note) {
  PartOutline outline;
  outline.volume = enclosed_volume(surface);
  outline.note = note;
  outline.doubt = doubtful_unit(surface.tree().max() - surface.tree().min());
  outline.regions = find_regions(surface);
  for (const SmoothRegion& region : outline.regions) outline.area += region.area;
  find_ends(surface, outline);
  const auto flat = std::find_if(outline.regions.begin(), outline.regions.end(), [&](const SmoothRegion& region) {
    return region.flat && region.area > 0.05 * outline.area;
  });
  if (outline.top.faces_outwards || flat == outline.regions.end()) return outline;
  PartOutline turned = outline;
  turned.turn = rotation_between(flat->normal, Vec3::UnitZ());
  find_ends(surface.transformed(turned.turn, Vec3::Zero(), 1), turned);
  return turned.top.faces_outwards ? turned : outline;
}

}  // namespace cgcontact
