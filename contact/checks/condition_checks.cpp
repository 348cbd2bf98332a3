#include "contact/checks/condition_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Directions with a larger cosine are one.
constexpr double parallel = 1 - rounding;

struct HeldBy {
  int support;
  HeldDirection held;
};

std::string face_name(const Scene& scene, const FaceRef& face) {
  return '"' + scene.bodies[face.body].name + "." + face.face.name + '"';
}

/// Returns whether the direction of `b` is held already, by the same value. Throws if it is held by another one.
bool is_held(const Scene& scene, const std::vector<HeldBy>& held, const HeldBy& by, const Vec3& x) {
  const HeldDirection& b = by.held;
  for (const auto& [support, a] : held) {
    const double cosine = a.direction.dot(b.direction), value = cosine < 0 ? -b.value : b.value;
    if (std::abs(cosine) < parallel) continue;
    if (std::abs(a.value - value) <= rounding * (std::abs(a.value) + std::abs(value))) return true;
    throw InputError(
        scene.supports[by.support].location, "",
        fmt::format("prescribes {:g} m where the support of {} prescribes {:g} m in the same direction, {}", b.value,
                    face_name(scene, scene.supports[support].face),
                    (cosine < 0 ? -a.value : a.value) + 0.0,  // no "-0"
                    at_position(x)),
        "one displacement for every point and direction");
  }
  return false;
}

/// Supports of one body whose faces share points, and a component and the normal of one support.
void check_supports(const Scene& scene, int b, const BodyModel& body) {
  std::vector<std::pair<int, BodyFace>> supports;
  for (int s = 0; s < static_cast<int>(scene.supports.size()); ++s)
    if (scene.supports[s].face.body == b) supports.emplace_back(s, BodyFace(scene.supports[s].face.face, body));
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    std::vector<HeldBy> held;  // different directions; springs agree with everything
    for (const auto& [support, face] : supports) {
      if (!face.contains(p)) continue;
      for (const HeldDirection& h : held_at(scene, body, support, body.point(p), body.normal(p)))
        if (h.stiffness == 0 && !is_held(scene, held, {support, h}, body.point(p))) held.push_back({support, h});
    }
  }
}

void check_support_on_contact(const Scene& scene, int s, const BodyModel& body, const std::vector<ContactPair>& pairs) {
  const SupportSpec& support = scene.supports[s];
  const BodyFace face(support.face.face, body);
  std::vector<double> held(pairs.size(), 0.0), all(pairs.size(), 0.0);
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    const int pair = body.boundary.pair_of_point[p];
    if (pair < 0 || pairs[pair].spec->automatic) continue;
    all[pair] += body.area(p);
    if (!face.contains(p)) continue;
    for (const HeldDirection& h : held_at(scene, body, s, body.point(p), body.normal(p)))
      if (pairs[pair].bonded() || std::abs(h.direction.dot(body.normal(p))) > holds_normal) {
        held[pair] += body.area(p);
        break;
      }
  }
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (held[k] > rim * all[k])
      throw InputError(
          support.location, face_name(scene, support.face),
          fmt::format("holds {:.3g} m2 of a face of {} \"{}\"{}: contact cannot act there", held[k],
                      pairs[k].bonded() ? "the bonded contact" : "contact", pairs[k].spec->name,
                      pairs[k].bonded() ? "" : " along its normal"),
          "a support or a contact on every part of a face: faces = [{name = \"low\", surfaces = [..], box = {..}}] "
          "of the body declares a part away from the contact, which can be held");
}

/// Rejects a load on tied faces: a jump of the traction, which no body could be given.
void check_load_on_bond(const Scene& scene, const LoadSpec& load, const BodyModel& body,
                        const std::vector<ContactPair>& pairs) {
  const BodyFace face(load.face.face, body);
  std::vector<double> loaded(pairs.size(), 0.0), all(pairs.size(), 0.0);
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    const int pair = body.boundary.pair_of_point[p];
    if (pair < 0 || !pairs[pair].bonded()) continue;
    all[pair] += body.area(p);
    if (face.contains(p)) loaded[pair] += body.area(p);
  }
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (loaded[k] > rim * all[k])
      throw InputError(
          load.location, face_name(scene, load.face),
          fmt::format("loads {:.3g} m2 of a face of the bonded contact \"{}\"", loaded[k], pairs[k].spec->name),
          "loads on faces that are not bonded (declared faces divide a face)");
}

/// Checks that no two pairs of the same bodies share a region of both faces, which would carry the pressure twice.
void check_shared_faces(const std::vector<BodyModel>& bodies, const ContactSpec& one, const ContactSpec& other) {
  const auto shared = [&](const FaceRef& a, const FaceRef& b) {
    const BodyModel& body = bodies[a.body];
    const BodyFace first(a.face, body), second(b.face, body);
    double area = 0, smaller[2] = {0, 0};
    for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
      const bool in_first = first.contains(p), in_second = second.contains(p);
      if (in_first) smaller[0] += body.area(p);
      if (in_second) smaller[1] += body.area(p);
      if (in_first && in_second) area += body.area(p);
    }
    return area > rim * std::min(smaller[0], smaller[1]) ? area : 0.0;
  };
  const bool same_order = one.first.body == other.first.body;
  const FaceRef &first = same_order ? other.first : other.second, &second = same_order ? other.second : other.first;
  if (first.body != one.first.body || second.body != one.second.body) return;
  const double area = std::min(shared(one.first, first), shared(one.second, second));
  if (area > 0)
    throw InputError(
        other.location, '"' + other.name + '"',
        fmt::format("shares {:.3g} m2 of its faces with contact \"{}\": the pressure would act twice there", area,
                    one.name),
        "every part of two faces in one pair");
}

}  // namespace

void check_conditions(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs) {
  for (std::size_t b = 0; b < bodies.size(); ++b) check_supports(scene, static_cast<int>(b), bodies[b]);
  for (int s = 0; s < static_cast<int>(scene.supports.size()); ++s)  // contact on ends: check_plane_strain
    if (!scene.supports[s].implied) check_support_on_contact(scene, s, bodies[scene.supports[s].face.body], pairs);
  for (const LoadSpec& load : scene.loads) check_load_on_bond(scene, load, bodies[load.face.body], pairs);
  std::vector<const ContactSpec*> named;  // automatic ones are one for every two bodies
  for (const ContactSpec& contact : scene.contacts)
    if (!contact.automatic) named.push_back(&contact);
  for (std::size_t l = 0; l < named.size(); ++l)
    for (std::size_t k = 0; k < l; ++k) check_shared_faces(bodies, *named[k], *named[l]);
}

}  // namespace cgcontact
