#include "contact/condition_checks.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cgcontact {
namespace {

/// Directions with a larger cosine are one.
constexpr double parallel = 1 - 1e-9;
/// Relative difference of displacements that is rounding.
constexpr double equal = 1e-9;
/// Part of a contact face on which a support may lie by the rim of a declared face.
constexpr double rim = 0.01;

struct Held {
  Vec3 direction;
  double value;
};

std::vector<Held> held_at(const SupportSpec& support, const Vec3& x, const Vec3& n) {
  std::vector<Held> held;
  if (support.holds_normal())
    held.push_back({n, support.normal_displacement ? (*support.normal_displacement)(x) : 0.0});
  for (int k = 0; k < 3; ++k)
    if (support.displacement[k]) held.push_back({Vec3::Unit(k), (*support.displacement[k])(x)});
  return held;
}

std::string face_name(const Scene& scene, const FaceRef& face) {
  return '"' + scene.bodies[face.body].name + "." + face.face.name + '"';
}

void check_point(const Scene& scene, const SupportSpec& one, const SupportSpec& other, const Vec3& x, const Vec3& n) {
  for (const Held& a : held_at(one, x, n))
    for (const Held& b : held_at(other, x, n)) {
      const double cosine = a.direction.dot(b.direction), value = cosine < 0 ? -b.value : b.value;
      if (std::abs(cosine) < parallel || std::abs(a.value - value) <= equal * (std::abs(a.value) + std::abs(value)))
        continue;
      throw InputError(
          other.place, "",
          fmt::format("prescribes {:g} m where the support of {} prescribes {:g} m in the same direction, at "
                      "({:.4g}, {:.4g}, {:.4g}) m",
                      b.value, face_name(scene, one.face), cosine < 0 ? -a.value : a.value, x[0], x[1], x[2]),
          "one displacement for every point and direction");
    }
}

/// Supports of one body whose faces share points.
void check_supports(const Scene& scene, int b, const BodyModel& body) {
  const int points = static_cast<int>(body.cut_cells.boundary.size());
  for (std::size_t i = 0; i < scene.supports.size(); ++i)
    for (std::size_t j = i + 1; j < scene.supports.size(); ++j) {
      const SupportSpec &one = scene.supports[i], &other = scene.supports[j];
      if (one.face.body != b || other.face.body != b) continue;
      const BodyFace first(one.face.face, body), second(other.face.face, body);
      for (int p = 0; p < points; ++p)
        if (first.contains(p) && second.contains(p)) check_point(scene, one, other, body.point(p), body.normal(p));
    }
}

void check_support_on_contact(const Scene& scene, const SupportSpec& support, const BodyModel& body,
                              const std::vector<ContactPair>& pairs) {
  const BodyFace face(support.face.face, body);
  std::vector<double> held(pairs.size(), 0.0), all(pairs.size(), 0.0);
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    const int pair = body.boundary.pair_of_point[p];
    if (pair < 0 || pairs[pair].spec->automatic) continue;
    all[pair] += body.area(p);
    if (!face.contains(p)) continue;
    for (const Held& h : held_at(support, body.point(p), body.normal(p)))
      if (std::abs(h.direction.dot(body.normal(p))) > parallel) held[pair] += body.area(p);
  }
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (held[k] > rim * all[k])
      throw InputError(
          support.place, face_name(scene, support.face),
          fmt::format("holds {:.3g} m2 of a face of contact \"{}\" along its normal: contact cannot act there", held[k],
                      pairs[k].spec->name),
          "a support or a contact on every face");
}

}  // namespace

void check_conditions(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs) {
  for (std::size_t b = 0; b < bodies.size(); ++b) check_supports(scene, static_cast<int>(b), bodies[b]);
  for (const SupportSpec& support : scene.supports)
    check_support_on_contact(scene, support, bodies[support.face.body], pairs);
}

}  // namespace cgcontact
