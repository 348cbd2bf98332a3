#include "contact/kernels/contact_points.hpp"

#include <utility>

namespace cgcontact {

template <class Memory>
ContactPointArrays<Memory>::ContactPointArrays(std::size_t size)
    : group("cgcontact::contact_points::group", size),
      primary_cell("cgcontact::contact_points::primary_cell", size),
      secondary_cell("cgcontact::contact_points::secondary_cell", size),
      primary_xi("cgcontact::contact_points::primary_xi", size),
      secondary_xi("cgcontact::contact_points::secondary_xi", size),
      primary_position("cgcontact::contact_points::primary_position", size),
      secondary_position("cgcontact::contact_points::secondary_position", size),
      normal("cgcontact::contact_points::normal", size),
      direction("cgcontact::contact_points::direction", size),
      x("cgcontact::contact_points::x", size),
      weight("cgcontact::contact_points::weight", size),
      distance("cgcontact::contact_points::distance", size),
      active("cgcontact::contact_points::active", size) {}

template struct ContactPointArrays<Kokkos::HostSpace>;

ContactPoints::ContactPoints(const std::vector<ContactPoint>& points) : arrays_(points.size()), size_(points.size()) {
  for (std::size_t q = 0; q < size_; ++q) put(q, points[q]);
}

ContactPoints::ContactPoints(const ContactPoints& other) : arrays_(other.size_), size_(other.size_) {
  for (std::size_t q = 0; q < size_; ++q) put(q, other[q]);
}

ContactPoints& ContactPoints::operator=(ContactPoints other) noexcept {
  arrays_ = std::move(other.arrays_);
  first_ = other.first_;
  size_ = other.size_;
  return *this;
}

void ContactPoints::put(std::size_t q, const ContactPoint& point) {
  const std::size_t i = first_ + q;
  const auto set = [&](const HostContactPoints::Vectors& to, const Vec3& from) {
    for (int d = 0; d < 3; ++d) to(i, d) = from[d];
  };
  arrays_.group(i) = point.group;
  arrays_.primary_cell(i) = point.primary_cell;
  arrays_.secondary_cell(i) = point.secondary_cell;
  set(arrays_.primary_xi, point.primary_xi);
  set(arrays_.secondary_xi, point.secondary_xi);
  set(arrays_.primary_position, point.primary_position);
  set(arrays_.secondary_position, point.secondary_position);
  set(arrays_.normal, point.normal);
  set(arrays_.direction, point.direction);
  set(arrays_.x, point.x);
  arrays_.weight(i) = point.weight;
  arrays_.distance(i) = point.distance;
  arrays_.active(i) = point.active ? 1 : 0;
}

ContactPoint ContactPoints::operator[](std::size_t q) const {
  ContactPoint point;
  point.group = group(q);
  point.primary_cell = primary_cell(q);
  point.secondary_cell = arrays_.secondary_cell(first_ + q);
  point.primary_xi = vector(arrays_.primary_xi, q);
  point.secondary_xi = vector(arrays_.secondary_xi, q);
  point.primary_position = vector(arrays_.primary_position, q);
  point.secondary_position = vector(arrays_.secondary_position, q);
  point.normal = normal(q);
  point.direction = direction(q);
  point.x = x(q);
  point.weight = weight(q);
  point.distance = distance(q);
  point.active = active(q);
  return point;
}

HostContactPoints ContactPoints::join(const std::vector<ContactPoints*>& pairs) {
  std::size_t size = 0;
  bool joined = true;
  for (const ContactPoints* points : pairs) {
    joined &= points->first_ == size && points->arrays_.weight.data() == pairs.front()->arrays_.weight.data();
    size += points->size_;
  }
  if (joined && (pairs.empty() || pairs.front()->arrays_.size() == size))
    return pairs.empty() ? HostContactPoints(0) : pairs.front()->arrays_;
  const HostContactPoints arrays(size);
  std::size_t first = 0;
  for (ContactPoints* points : pairs) {
    ContactPoints slice;
    slice.arrays_ = arrays;
    slice.first_ = first;
    slice.size_ = points->size_;
    for (std::size_t q = 0; q < slice.size_; ++q) slice.put(q, (*points)[q]);
    first += slice.size_;
    *points = std::move(slice);
  }
  return arrays;
}

}  // namespace cgcontact
