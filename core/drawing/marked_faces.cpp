#include "core/drawing/marked_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/numbers/rounding.hpp"

namespace cgcontact {

namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Returns the area of a boundary point per weight, m^2.
double area_factor(const Grid& grid) { return grid.slices() * grid.cell_size * grid.cell_size; }

}  // namespace

MarkedFaces::MarkedFaces(const Scene& scene, const std::vector<CheckedBody>& bodies) : scene_(scene), bodies_(bodies) {
  for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b) {
    std::vector<FaceRef>& faces = declared_faces_.emplace_back();
    for (const FaceSpec& face : scene.bodies[b].faces) faces.push_back({b, face, face.location});
  }
  for (const std::vector<FaceRef>& faces : declared_faces_) {
    std::vector<Selected>& selected = declared_.emplace_back();
    for (const FaceRef& face : faces) selected.push_back(select(face));
  }
  for (const SupportSpec& support : scene.supports) supports_.push_back(select(support.face));
  for (const LoadSpec& load : scene.loads) loads_.push_back(select(load.face));
  for (const ContactSpec& contact : scene.contacts) {
    firsts_.push_back(select(contact.first));
    seconds_.push_back(select(contact.second));
  }
  for (std::size_t l = 0; l < loads_.size(); ++l) resultants_.push_back(resultant_of(static_cast<int>(l)));
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) add_body(b);
}

FaceTraction MarkedFaces::resultant_of(int load) const {
  const LoadSpec& spec = scene_.loads[load];
  if (!spec.has_resultants()) return {};
  const int body = spec.face.body;
  const Grid& grid = bodies_[body].cut_cells->grid;
  const BoundaryPoints& points = bodies_[body].cut_cells->boundary;
  FaceMoments moments(scene_.bodies[body].axis_across());
  for (std::size_t p = 0; p < points.size(); ++p)
    if (contains(loads_[load], body, points.surface[p], grid.to_global(points.position_of_facet(p)),
                 grid.rotation * points.normal_of_facet(p)))
      moments.add(grid.to_global(points.position[p]), grid.rotation * points.normal[p],
                  points.weight[p] * area_factor(grid));
  return moments.area() > 0 ? spec.resulting_traction(moments, scene_.bodies[body].axisymmetric()) : FaceTraction();
}

MarkedFaces::Selected MarkedFaces::select(const FaceRef& face) const {
  Selected selected{&face, {}};
  for (const Surface& s : bodies_[face.body].cut_cells->solid.surfaces())
    selected.surfaces.push_back(face.face.selects(s.names));
  return selected;
}

bool MarkedFaces::contains(const Selected& selected, int body, int surface, const Vec3& x, const Vec3& n) const {
  return selected.face->body == body && selected.surfaces[surface] && selected.face->face.contains(x, n);
}

MarkedFaces::Key MarkedFaces::key_at(int body, int cell, int surface, const Vec3& x, const Vec3& n) const {
  Key key;
  key.body = body;
  key.names = bodies_[body].cut_cells->solid.surfaces()[surface].names;
  for (int s = 0; s < static_cast<int>(supports_.size()); ++s)
    if (contains(supports_[s], body, surface, x, n)) key.supports.push_back(s);
  for (int l = 0; l < static_cast<int>(loads_.size()); ++l)
    if (contains(loads_[l], body, surface, x, n)) key.loads.push_back(l);
  for (int c = 0; c < static_cast<int>(firsts_.size()); ++c)
    if (!scene_.contacts[c].automatic &&
        (contains(firsts_[c], body, surface, x, n) || contains(seconds_[c], body, surface, x, n)))
      key.contacts.push_back(c);
  // Automatic pairs may touch anywhere: what counts is that something is opposite.
  const auto automatic = automatic_pair_.find({body, cell, surface});
  if (automatic != automatic_pair_.end()) key.contacts.push_back(automatic->second);
  if (!key.loads.empty()) return key;  // the resultant of a load is not to be divided
  for (int f = 0; f < static_cast<int>(declared_[body].size()); ++f)
    if (contains(declared_[body][f], body, surface, x, n)) key.declared.push_back(f);
  return key;
}

FaceRegion MarkedFaces::new_region(const Key& key) const {
  FaceRegion region;
  region.body = key.body;
  region.supports = key.supports;
  region.loads = key.loads;
  region.contacts = key.contacts;
  region.low_displacement.fill(std::numeric_limits<double>::max());
  region.high_displacement.fill(std::numeric_limits<double>::lowest());
  std::string face = joined(key.names);
  if (!key.declared.empty()) {
    std::vector<std::string> declared;
    for (const int f : key.declared) declared.push_back(scene_.bodies[key.body].faces[f].name);
    face = joined(declared);
  }
  if (!key.contacts.empty() && !scene_.contacts[key.contacts.front()].automatic) {
    const ContactSpec& contact = scene_.contacts[key.contacts.front()];
    face = (contact.first.body == key.body ? contact.first : contact.second).face.name;
  } else if (!key.loads.empty()) {
    face = scene_.loads[key.loads.front()].face.face.name;
  } else if (!key.supports.empty()) {
    face = scene_.supports[key.supports.front()].face.face.name;
  }
  region.name = scene_.bodies[key.body].name + "." + face;
  for (int s : key.supports) {
    region.symmetry |= scene_.supports[s].symmetry;
    region.elastic |= scene_.supports[s].is_elastic();
  }
  return region;
}

void MarkedFaces::add_point(const Key& key, const Vec3& x, const Vec3& n, double area) {
  const auto [entry, is_new] = index_.emplace(key, static_cast<int>(regions_.size()));
  if (is_new) {
    regions_.push_back(new_region(key));
    acting_.push_back(0);
  }
  FaceRegion& region = regions_[entry->second];
  region.area += area;
  region.centroid += area * x;
  for (int l : key.loads) {
    const Vec3 force = area * scene_.loads[l].traction_at(x, n, resultants_[l]);
    region.force += force;
    region.moment += x.cross(force);
    acting_[entry->second] += force.norm();
  }
  const auto add = [&](Held component, const std::optional<Expression>& prescribed) {
    if (!prescribed) return;
    const auto k = static_cast<std::size_t>(component);
    const double value = (*prescribed)(x);
    region.low_displacement[k] = std::min(region.low_displacement[k], value);
    region.high_displacement[k] = std::max(region.high_displacement[k], value);
  };
  for (int s : key.supports) {
    const SupportSpec& support = scene_.supports[s];
    for (int k = 0; k < 3; ++k) {
      add(static_cast<Held>(k), support.displacement[k]);
      add(static_cast<Held>(static_cast<int>(Held::radial) + k), support.cylindrical[k]);
    }
    add(Held::normal, support.normal_displacement);
  }
}

void MarkedFaces::add_body(int b) {
  const CheckedBody& body = bodies_[b];
  const Grid& grid = body.cut_cells->grid;
  const BoundaryPoints& points = body.cut_cells->boundary;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (const int pair = body.pair_of_point[p]; pair >= 0 && scene_.contacts[pair].automatic)
      automatic_pair_.emplace(std::array<int, 3>{b, points.cell[p], points.surface[p]}, pair);
  const std::size_t first = regions_.size();
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec3 x = grid.to_global(points.position[p]), n = grid.rotation * points.normal[p];
    const Vec3 facet_position = grid.to_global(points.position_of_facet(p)),
               facet_normal = grid.rotation * points.normal_of_facet(p);
    add_point(key_at(b, points.cell[p], points.surface[p], facet_position, facet_normal), x, n,
              points.weight[p] * area_factor(grid));
  }
  for (std::size_t r = first; r < regions_.size(); ++r) finish(regions_[r], acting_[r]);
}

/// Means instead of sums; what is rounding beside all that acts on the region (N) is zero.
void MarkedFaces::finish(FaceRegion& region, double acting) const {
  region.centroid /= region.area;
  region.moment -= region.centroid.cross(region.force);
  region.force = without_rounding(region.force, acting);
  region.moment = without_rounding(region.moment, acting * (std::sqrt(region.area) + region.centroid.norm()));
}

int MarkedFaces::region_at(int body, int cell, int surface, const Vec3& x, const Vec3& n) const {
  const Key key = key_at(body, cell, surface, x, n);
  const auto found = index_.find(key);
  if (found != index_.end()) return found->second;
  for (const auto& [other, region] : index_)  // a sliver whose points went to a neighbour
    if (other.body == body && other.names == key.names) return region;
  return -1;
}

}  // namespace cgcontact
