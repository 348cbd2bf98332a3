#include "contact/results/verdict/contact_zone.hpp"

#include <algorithm>
#include <map>

#include "core/geometry/solid_middle.hpp"

namespace cgcontact {

namespace {

/// Images count that are no farther behind a plane than the widest zones whose width is counted reach, cells.
constexpr double image_reach = 9;

}  // namespace

ContactZone::ContactZone(const std::vector<RecoveryBody>& bodies, std::size_t index) {
  const Grid& grid = bodies[index].mesh->cut_cells->grid;
  middle_ = grid.to_global(middle_of(bodies[index].mesh->cut_cells->solid));
  std::map<int, int> other_of_pair;
  for (const ContactLink& link : bodies[index].boundary->links) {
    if (!link.primary || bodies[index].boundary->is_bonded(link.pair)) continue;
    other_of_pair[link.pair] = link.other_body;
    forces_.push_back({link.pair, link.cell, 0, link.active, grid.to_global(link.position), grid.rotation * link.normal,
                       link.weight, link.weight * link.pressure, link.weight * link.spread_pressure, link.larger_cell});
  }
  if (other_of_pair.empty()) return;
  const std::vector<SymmetryPlane> planes = symmetry_planes(*bodies[index].mesh->cut_cells, *bodies[index].boundary);
  for (const auto& [pair, other] : other_of_pair)
    if (!planes.empty())
      add_images(pair, common_planes(planes, symmetry_planes(*bodies[other].mesh->cut_cells, *bodies[other].boundary),
                                     grid.cell_size));
}

/// Images in every plane, and of images in planes across: four quarters of a quarter.
void ContactZone::add_images(int pair, const std::vector<SymmetryPlane>& planes) {
  const std::size_t first_image = images_.size();
  for (std::size_t p = 0; p < planes.size() && p < 31; ++p) {
    const auto add = [&](TransmittedForce f) {
      if (f.pair != pair || -planes[p].distance(f.position) > image_reach * f.cell_size) return;
      for (std::size_t k = 0; k < p; ++k)
        if ((f.image >> k & 1) && std::abs(planes[k].normal.dot(planes[p].normal)) > 0.5) return;  // parallel planes
      f.position = planes[p].image(f.position);
      f.normal = planes[p].turned(f.normal);
      f.image |= 1 << p;
      images_.push_back(f);
    };
    const std::size_t last_image = images_.size();
    for (const TransmittedForce& f : forces_) add(f);
    for (std::size_t i = first_image; i < last_image; ++i) add(images_[i]);
  }
}

std::vector<TransmittedForce> ContactZone::closed_cells() const {
  std::map<std::array<int, 3>, TransmittedForce> cells;
  const auto add = [&](const TransmittedForce& f) {
    if (!f.closed) return;
    TransmittedForce& whole =
        cells
            .try_emplace({f.image, f.cell, f.pair},
                         TransmittedForce{f.pair, f.cell, f.image, true, Vec3::Zero(), Vec3::Zero(), 0, 0, 0, 0})
            .first->second;
    whole.area += f.area;
    whole.cell_size = std::max(whole.cell_size, f.cell_size);
    whole.position += f.area * f.position;
    whole.normal += f.area * f.normal;
  };
  for (const TransmittedForce& f : forces_) add(f);
  for (const TransmittedForce& f : images_) add(f);
  std::vector<TransmittedForce> closed;
  for (auto& [key, whole] : cells) {
    whole.position /= whole.area;
    whole.normal.normalize();
    closed.push_back(whole);
  }
  // A stable order: the first criteria hold in a mirror image too, whose cells have another order.
  std::stable_sort(closed.begin(), closed.end(), [&](const TransmittedForce& a, const TransmittedForce& b) {
    return std::pair(a.image, (a.position - middle_).norm()) < std::pair(b.image, (b.position - middle_).norm());
  });
  return closed;
}

}  // namespace cgcontact
