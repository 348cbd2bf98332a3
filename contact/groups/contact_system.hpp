/// Linear system of a scene: all bodies' stiffness, their supports and the rows of their contact groups.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Makes the scales: lengths by the largest cells, stresses by the largest Young's modulus.
Scales make_scales(const Scene& scene);

/// Makes the system; the contact groups are open at first. The bodies must outlive it. exec: what makes the rows of the
/// groups.
ElasticSystem make_contact_system(const Scene& scene, const std::vector<BodyModel>& bodies,
                                  const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs,
                                  const Scales& scales, const ExecSpace& exec);

/// Puts the terms of the supports into a system that has none.
void add_supports(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                  const Scales& scales, ElasticSystem& system);

}  // namespace cgcontact
