#include "contact/groups/contact_system.hpp"

#include <algorithm>

#include "contact/groups/group_rows.hpp"

namespace cgcontact {
namespace {

void add_contact(const ExecSpace& exec, const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs,
                 const Scales& scales, ElasticSystem& system) {
  std::vector<GroupRow> rows = make_group_rows(exec, pairs, bodies, system);
  const std::size_t first_tangent = rows.size();
  for (GroupRow& row : make_tangent_rows(exec, pairs, bodies, system)) rows.push_back(std::move(row));
  const bool rubs = rows.size() > first_tangent;
  set_group_rows(system, std::move(rows));
  if (rubs) {
    match_tangent_rows(pairs, first_tangent, system.group_rows);
    compress_group_rows(system);
  }
  const auto closed_stiffness = [&](const ContactPair& pair, const ContactGroup& g) {
    return pair.stiffness(g) * g.area / (scales.stress * scales.length);
  };
  for (const ContactPair& pair : pairs)
    for (const ContactGroup& g : pair.groups) system.full_group_stiffness.push_back(closed_stiffness(pair, g));
  for (const ContactPair& pair : pairs)
    for (const ContactGroup& g : pair.groups)
      system.full_group_stiffness.insert(system.full_group_stiffness.end(), pair.num_tangents,
                                         closed_stiffness(pair, g));
}

}  // namespace

Scales make_scales(const Scene& scene) {
  Scales scales{0, 0};
  for (const BodySpec& body : scene.bodies) {
    scales.length = std::max(scales.length, body.cell_size);
    if (!body.rigid()) scales.stress = std::max(scales.stress, body.material.youngs_modulus);
  }
  return scales;
}

void add_supports(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                  const Scales& scales, ElasticSystem& system) {
  std::vector<std::vector<SupportTerm>> terms(scene.bodies.size());
  std::vector<std::size_t> count(terms.size(), 0);
  for (const SupportPoint& p : supports) count[p.body] += !p.implied;
  for (std::size_t b = 0; b < terms.size(); ++b) terms[b].reserve(count[b]);
  for (const SupportPoint& p : supports) {
    if (p.implied) continue;
    const Mat3& R = system.meshes[p.body].cut_cells->grid.rotation;
    const double stiffness = support_stiffness(scene, bodies[p.body], p) * p.weight / (scales.stress * scales.length);
    terms[p.body].push_back(
        {p.cell, p.xi, R.transpose() * p.direction, stiffness, bodies[p.body].is_thin(p.cell), p.follows});
  }
  for (std::size_t b = 0; b < terms.size(); ++b) add_support_terms(system, static_cast<int>(b), terms[b]);
}

ElasticSystem make_contact_system(const Scene& scene, const std::vector<BodyModel>& bodies,
                                  const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs,
                                  const Scales& scales, const ExecSpace& exec) {
  std::vector<const CutCells*> cut_cells;
  std::vector<Material> materials;
  for (const BodyModel& body : bodies) {
    cut_cells.push_back(&body.cut_cells);
    materials.push_back(body.spec->material);
  }
  ElasticSystem system = make_elastic_system(cut_cells, materials, scales, scene.solver.ghost_penalty);
  add_supports(scene, bodies, supports, scales, system);
  add_contact(exec, bodies, pairs, scales, system);
  return system;
}

}  // namespace cgcontact
