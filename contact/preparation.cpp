#include "contact/preparation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "contact/checks/condition_checks.hpp"
#include "contact/checks/load_checks.hpp"
#include "contact/checks/memory.hpp"
#include "contact/checks/rigid_supports.hpp"
#include "contact/model/plane_strain.hpp"
#include "contact/motions/free_components.hpp"
#include "contact/motions/free_motion.hpp"
#include "contact/plausibility.hpp"
#include "contact/results/reference/reference.hpp"

namespace cgcontact {
namespace {

/// Fraction of all loads that may act along a surface on which a body slides: a face may end between quadrature points.
constexpr double max_load_along_surface = 1e-3;

/// For each body the least Young's modulus of those that contact pairs join to it, directly or over others, Pa.
std::vector<double> softest_moduli(const Preparation& p) {
  std::vector<double> moduli;
  for (const BodyModel& body : p.bodies) moduli.push_back(body.spec->material.youngs_modulus);
  for (bool changed = true; changed;) {
    changed = false;
    for (const ContactPair& pair : p.pairs) {
      const double least = std::min(moduli[pair.primary], moduli[pair.secondary]);
      changed |= moduli[pair.primary] != least || moduli[pair.secondary] != least;
      moduli[pair.primary] = moduli[pair.secondary] = least;
    }
  }
  return moduli;
}

/// The smallest cell where a body may touch others, m; its own cells' size without contact.
double smallest_contact_cell(const Preparation& p, int body, double otherwise) {
  double smallest = 1e300;
  for (const ContactPair& pair : p.pairs) {
    if (pair.primary != body && pair.secondary != body) continue;
    for (const ContactGroup& group : pair.groups) smallest = std::min(smallest, group.h);
  }
  return smallest < 1e300 ? smallest : otherwise;
}

/// Checks for motions that are free although all contact is closed. Components that nothing holds, flat faces that
/// slide on each other, and whatever the loads drive, are mistakes in the scene. A body that spins in its contact
/// undriven (ball, roller) is held: no force arises. So are motions along one side's surface that the other side's
/// points seem to resist, as in contact of curved surfaces between cells. Friction resists what slides.
void check_free_motions(const Scene& scene, Preparation& p) {
  const auto refuse_driven = [&](const FreeMotions& free, double allowed, const std::string& text) {
    const FreeMotions driven = driven_by_loads(free, p.bodies, allowed);
    if (!driven.empty())
      throw InputError(fmt::format("{}: {}, and the loads drive it{}", scene.file, describe(driven, scene), text));
  };
  const std::string text = find_free_motion(scene, p.bodies, p.supports, p.pairs);
  const FreeMotions free = find_free_motions(p.bodies, p.supports, p.pairs);
  const FreeMotions on_both_sides = free_on_both_sides(free, p.bodies, p.pairs);
  if (!text.empty()) {
    refuse_driven(free, no_load, ": " + text);
    if (free.empty() || on_both_sides.slides()) throw InputError(scene.file + ": " + text);
  }
  std::vector<SupportPoint> held = hold(on_both_sides, p.bodies);
  // The exact pressure does no work on these. A rotation about the axis of another body's surface (a pin in a wider
  // hole) ends where the loads do none.
  const SurfaceMotions surface = find_surface_motions(p.bodies, p.supports, p.pairs);
  refuse_driven(surface.own, max_load_along_surface, "");
  refuse_driven(surface.others.without_rotation(), max_load_along_surface, "");
  FreeMotions along_surfaces = surface.own;
  along_surfaces.add(surface.others);
  along_surfaces.add(free);
  FreeMotions left = along_surfaces;
  left.leave_out(held, p.bodies);
  if (!left.empty() && driven_by_loads(along_surfaces, p.bodies, no_load).empty())
    p.warnings.push_back(
        describe(along_surfaces, scene) +
        ": this motion is unconstrained but unloaded; weak springs stabilise it without changing the result");
  else if (!on_both_sides.empty())
    p.warnings.push_back(
        describe(on_both_sides, scene) +
        ": this motion is unconstrained but unloaded; it is fixed at a few points, which takes no force");
  const std::vector<double> softest = softest_moduli(p);
  for (const FreeMotions& motions : motions_of_floating_bodies(p.bodies, p.supports, p.pairs))
    for (SupportPoint point : hold(motions, p.bodies)) {
      const BodyModel& body = p.bodies[point.body];
      const double h = body.cut_cells.h(point.cell);
      point.weight *= scene.solver.soft_hold * softest[point.body] / support_modulus(scene, *body.spec) *
                      smallest_contact_cell(p, point.body, h) / h;
      point.follows = true;
      held.push_back(point);
    }
  p.supports.insert(p.supports.end(), held.begin(), held.end());
}

/// A rigid body needs no density under gravity if its supports alone hold it: its mass moves nothing then.
void check_masses(const Preparation& p) {
  const std::vector<RigidComponent> components = whole_bodies(p.bodies).list;
  std::vector<int> itself(p.bodies.size());
  std::iota(itself.begin(), itself.end(), 0);
  std::vector<Resistance> held(p.bodies.size(), Resistance::Zero());
  for (const SupportPoint& point : p.supports)
    if (point.support >= 0 && point.spring == 0) add_resistance(point, components, p.bodies, itself, held);
  for (std::size_t b = 0; b < p.bodies.size(); ++b) {
    const BodySpec& body = *p.bodies[b].spec;
    if (body.inertia.unknown && motions_not_resisted(held[b]).cols() > 0)
      throw InputError(body.location, "\"" + body.name + "\"",
                       "it has no density, which gravity and rotation act on, and its supports leave it free to move",
                       "material = {density = 7850} in kg/m^3, or supports that hold the rigid body wholly");
  }
}

/// The recovery takes the body force at nodes, which may lie on a singular plane or outside of the body.
void check_body_forces(const std::vector<BodyModel>& bodies) {
  for (const BodyModel& body : bodies) {
    if (!body.boundary.body_force_at) continue;
    for (int cell = 0; cell < static_cast<int>(body.cut_cells.cells.size()); ++cell)
      body.boundary.body_force_at(body.cut_cells.grid.to_global(body.cut_cells.corner(cell)));
  }
}

/// Checks that its files can be read and its pressure has a value where faces may touch, unless it depends on the
/// contact force.
void check_reference(const Scene& scene, const std::vector<ContactPair>& pairs) {
  const Reference reference(scene, scene.reference);
  if (scene.reference_of_force || !reference.has_pressure()) return;
  for (const ContactPair& pair : pairs)
    for (const ContactPoint& point : pair.points) reference.pressure(point.x);
}

}  // namespace

void check_settings(const Scene& scene) {
  scene.geometry.check();
  scene.contact.check();
  scene.solver.check();
  scene.recovery.check();
  scene.results.check();
  scene.output.check();
  scene.accuracy.check();
}

double count_contact_rows(const Preparation& preparation) {
  double rows = 0;
  for (std::size_t b = 0; b < preparation.bodies.size(); ++b) {
    const BodyModel& body = preparation.bodies[b];
    std::vector<BodyFace> faces;  // of automatic pairs only what is in reach counts
    for (const ContactPair& pair : preparation.pairs)
      if (!pair.spec->automatic && (pair.primary == static_cast<int>(b) || pair.secondary == static_cast<int>(b)))
        faces.emplace_back(pair.face(static_cast<int>(b)), body);
    for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p)
      rows += body.boundary.pair_of_point[p] >= 0 ||
              std::any_of(faces.begin(), faces.end(), [&](const BodyFace& face) { return face.contains(p); });
  }
  return rows;
}

MemoryExtras memory_extras(const Scene& scene, const Preparation& preparation) {
  MemoryExtras extras = memory_extras(scene);
  PointNumbers points;
  for (const ContactPair& pair : preparation.pairs) points.contact += static_cast<double>(pair.points.size());
  points.support = static_cast<double>(preparation.supports.size());
  points.rows = count_contact_rows(preparation);
  extras.points = points;
  return extras;
}

double check_memory(const Scene& scene, const Preparation& preparation) {
  std::vector<BodySize> sizes;
  for (const BodyModel& body : preparation.bodies) sizes.push_back(size_of(body.cut_cells));
  return check_memory(scene, sizes, memory_extras(scene, preparation));
}

Preparation discretise(const Scene& scene, bool refuse_near_limit) {
  check_settings(scene);
  check_memory_early(scene, refuse_near_limit);
  Preparation p;
  p.bodies = make_body_models(scene);
  p.supports = make_support_points(scene, p.bodies, &p.warnings);
  p.pairs = make_contact_pairs(scene, p.bodies);
  return p;
}

void validate(const Scene& scene, Preparation& preparation) {
  check_conditions(scene, preparation.bodies, preparation.pairs);
  check_supports_of_rigid_bodies(scene, preparation.bodies, preparation.supports);
  check_plane_strain(scene, preparation.bodies, preparation.supports, preparation.pairs);
  for (std::string& warning : bonded_gap_warnings(scene, preparation.pairs))
    preparation.warnings.push_back(std::move(warning));
  for (std::string& warning : load_resolution_warnings(scene, preparation.bodies))
    preparation.warnings.push_back(std::move(warning));
  check_masses(preparation);
  check_free_motions(scene, preparation);
  check_body_forces(preparation.bodies);
  check_reference(scene, preparation.pairs);
  for (std::string& warning : implausible_values(scene, preparation))
    preparation.warnings.push_back(std::move(warning));
}

Preparation prepare(const Scene& scene, bool refuse_near_limit) {
  Preparation preparation = discretise(scene, refuse_near_limit);
  validate(scene, preparation);
  return preparation;
}

}  // namespace cgcontact
