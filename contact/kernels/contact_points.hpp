/// Quadrature points of contact pairs, one array per quantity: kernels run over the points of all pairs, and each pair
/// has its slice.
#pragma once

#include <iterator>
#include <vector>

#include "core/base/numbers/types.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// Quadrature point from or for the arrays: on the surface of the primary body, split at both grids.
struct ContactPoint {
  int group = 0;  ///< of the pair
  int primary_cell = 0, secondary_cell = 0;
  Vec3 primary_xi, secondary_xi;              ///< cell coordinates
  Vec3 primary_position, secondary_position;  ///< grid coordinates
  Vec3 normal;                                ///< outward of the primary body, or press_direction.hpp; global axes
  Vec3 direction;                             ///< along which the gap counts: the normal; bonded: an axis; global axes
  Vec3 x;                                     ///< m
  double weight = 0;                          ///< m^2
  double distance = 0;                        ///< m, before deformation, along the normal
  bool active = true;
};

/// Members of ContactPoint as views of (points) and (points, 3).
template <class Memory>
struct ContactPointArrays {
  using Numbers = Kokkos::View<int*, Memory>;
  using Values = Kokkos::View<double*, Memory>;
  using Vectors = Kokkos::View<double* [3], Kokkos::LayoutRight, Memory>;
  using Flags = Kokkos::View<char*, Memory>;

  Numbers group, primary_cell, secondary_cell;
  Vectors primary_xi, secondary_xi, primary_position, secondary_position, normal, direction, x;
  Values weight, distance;
  Flags active;

  ContactPointArrays() = default;
  explicit ContactPointArrays(std::size_t size);
  std::size_t size() const { return weight.extent(0); }
};

using HostContactPoints = ContactPointArrays<Kokkos::HostSpace>;

/// Copies the arrays to another memory; where that is the host's, the same arrays.
template <class Memory>
ContactPointArrays<Memory> copy_points(const HostContactPoints& host) {
  const auto copy = [](auto& to, const auto& from) { to = Kokkos::create_mirror_view_and_copy(Memory(), from); };
  ContactPointArrays<Memory> points;
  copy(points.group, host.group);
  copy(points.primary_cell, host.primary_cell);
  copy(points.secondary_cell, host.secondary_cell);
  copy(points.primary_xi, host.primary_xi);
  copy(points.secondary_xi, host.secondary_xi);
  copy(points.primary_position, host.primary_position);
  copy(points.secondary_position, host.secondary_position);
  copy(points.normal, host.normal);
  copy(points.direction, host.direction);
  copy(points.x, host.x);
  copy(points.weight, host.weight);
  copy(points.distance, host.distance);
  copy(points.active, host.active);
  return points;
}

/// Points of one pair on the host. A copy has arrays of its own: what is closed in one is not closed in the other.
class ContactPoints {
 public:
  ContactPoints() = default;
  explicit ContactPoints(const std::vector<ContactPoint>& points);
  ContactPoints(const ContactPoints& other);
  ContactPoints(ContactPoints&&) = default;
  ContactPoints& operator=(ContactPoints other) noexcept;

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  ContactPoint operator[](std::size_t q) const;
  double weight(std::size_t q) const { return arrays_.weight(first_ + q); }
  double distance(std::size_t q) const { return arrays_.distance(first_ + q); }
  Vec3 x(std::size_t q) const { return vector(arrays_.x, q); }
  Vec3 normal(std::size_t q) const { return vector(arrays_.normal, q); }
  Vec3 direction(std::size_t q) const { return vector(arrays_.direction, q); }
  int group(std::size_t q) const { return arrays_.group(first_ + q); }
  int primary_cell(std::size_t q) const { return arrays_.primary_cell(first_ + q); }
  bool active(std::size_t q) const { return arrays_.active(first_ + q) != 0; }
  void set_active(std::size_t q, bool active) { arrays_.active(first_ + q) = active ? 1 : 0; }

  /// Return the arrays, and the index of the first point in them.
  const HostContactPoints& arrays() const { return arrays_; }
  std::size_t first_index() const { return first_; }

  /// Goes over the points, gathered.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = ContactPoint;
    using difference_type = std::ptrdiff_t;
    using pointer = const ContactPoint*;
    using reference = ContactPoint;
    Iterator(const ContactPoints& points, std::size_t q) : points_(&points), q_(q) {}
    ContactPoint operator*() const { return (*points_)[q_]; }
    Iterator& operator++() { return ++q_, *this; }
    bool operator==(const Iterator& o) const { return q_ == o.q_; }
    bool operator!=(const Iterator& o) const { return q_ != o.q_; }

   private:
    const ContactPoints* points_;
    std::size_t q_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size_}; }

  /// Puts the points of several pairs into the same arrays, in turn, unless they lie so already; returns these.
  static HostContactPoints join(const std::vector<ContactPoints*>& pairs);

 private:
  Vec3 vector(const HostContactPoints::Vectors& v, std::size_t q) const {
    return {v(first_ + q, 0), v(first_ + q, 1), v(first_ + q, 2)};
  }
  void put(std::size_t q, const ContactPoint& point);

  HostContactPoints arrays_;
  std::size_t first_ = 0, size_ = 0;
};

}  // namespace cgcontact
