#include "core/part_outline.hpp"

#include <algorithm>
#include <cmath>

#include "core/scene_mesh.hpp"
#include "core/triangle_faces.hpp"
#include "core/triangle_reader.hpp"

namespace cgcontact {

namespace {

const double least_flat_cosine = std::cos(3.14159265358979323846 / 180);  // a degree
const double least_outward_cosine = std::cos(3.14159265358979323846 / 6);
constexpr double plane_slack = 1e-6;  // of the height: single precision in the file
constexpr double end_share = 0.02, face_share = 0.1;

/// The part of a triangle with sign * z >= level.
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

struct Region {
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
  Region cap, plane;
  double outward = 0;
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const double cosine = sign * surface.normal(t)[2];
    const auto upper = clip(surface, t, sign, extreme - end_share * height);
    if (!upper.empty() && cosine > 0) cap.add(upper);
    const auto touching = clip(surface, t, sign, extreme - plane_slack * height);
    if (!touching.empty() && cosine > least_flat_cosine) plane.add(touching);
    if (cosine > least_outward_cosine) outward += area(clip(surface, t, sign, extreme - face_share * height));
  }
  PartEnd end;
  end.flat = plane.area > cap.area / 2;
  const Region& region = end.flat ? plane : cap;
  end.min = region.min;
  end.max = region.max;
  end.faces_outwards = outward > 0;
  return end;
}

std::vector<SmoothPart> find_parts(const TriangleSurface& surface) {
  std::vector<SmoothPart> parts(surface.face_names().size());
  std::vector<double> largest(parts.size(), -1);
  const auto area_vector = [&](int t) {
    const Vec3& a = surface.corner(t, 0);
    return Vec3((surface.corner(t, 1) - a).cross(surface.corner(t, 2) - a) / 2);
  };
  const int count = static_cast<int>(surface.triangles().size());
  for (int t = 0; t < count; ++t) {
    const int p = surface.patch(t);
    const Vec3 a = area_vector(t);
    parts[p].area += a.norm();
    parts[p].normal += a;
    if (a.norm() <= largest[p]) continue;
    largest[p] = a.norm();
    parts[p].seed = (surface.corner(t, 0) + surface.corner(t, 1) + surface.corner(t, 2)) / 3;
  }
  for (SmoothPart& part : parts) {
    part.flat = part.normal.norm() > 1e-6 * part.area;
    if (part.flat)
      part.normal.normalize();
    else
      part.normal.setZero();
  }
  for (int t = 0; t < count; ++t) {
    SmoothPart& part = parts[surface.patch(t)];
    part.flat = part.flat && surface.normal(t).dot(part.normal) >= least_flat_cosine;
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const SmoothPart& a, const SmoothPart& b) { return a.area > b.area; });
  return parts;
}

double enclosed_volume(const TriangleSurface& surface) {
  double volume = 0;
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t)
    volume += surface.corner(t, 0).dot(surface.corner(t, 1).cross(surface.corner(t, 2))) / 6;
  return volume;
}

}  // namespace

PartOutline outline_part(const std::string& file, double scale) {
  TriangleSoup soup = read_triangles(file);
  for (Vec3& x : soup.points) x *= scale;
  const SurfaceRepairs repairs = repair_and_check(soup, file);
  const TriangleSurface surface = make_surface(soup, name_faces(soup, "part", {}), default_crease_angle);
  PartOutline outline;
  outline.min = surface.tree().min();
  outline.max = surface.tree().max();
  const Vec3 extent = outline.max - outline.min;
  outline.volume = enclosed_volume(surface);
  outline.note = describe_surface(file, repairs, extent);
  outline.doubt = doubtful_unit(extent);
  outline.top = find_end(surface, 1, outline.max[2], extent[2]);
  outline.bottom = find_end(surface, -1, -outline.min[2], extent[2]);
  outline.parts = find_parts(surface);
  return outline;
}

}  // namespace cgcontact
