#include "contact/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/model/memory.hpp"

namespace cgcontact {
namespace {

/// Of a body: without nodes that are constrained.
long long count_unknowns(const BodyModel& body) {
  const long long all = static_cast<long long>(size_of(body.cut_cells).nodes);
  if (body.spec->plane_strain && body.cut_cells.num_levels() == 1) return (dofs_per_node - 1) * all / 2;
  if (body.cut_cells.num_levels() == 1) return dofs_per_node * all;
  return make_body_mesh(body.cut_cells, body.spec->material, Scales{}, 0).num_free_dofs();
}

std::string describe_body(const BodyModel& body) {
  const CutCells& cc = body.cut_cells;
  std::map<std::string, double> area;
  double total_area = 0;
  for (int p = 0; p < static_cast<int>(cc.boundary.size()); ++p) {
    total_area += body.slices * body.area(p);
    for (const std::string& name : body.surface_names(p)) area[name] += body.slices * body.area(p);
  }
  const long long cut = static_cast<long long>(cc.moments.size()), active = static_cast<long long>(cc.cells.size());
  std::string text = fmt::format(
      "body \"{}\": E = {:g} Pa, nu = {:g}, volume {:.10g} m3, surface {:.10g} m2\n"
      "  grid {} x {} x {} cells of {:g} m; {} active, {} of them cut; {} unknowns\n",
      body.spec->name, body.spec->material.youngs_modulus, body.spec->material.poisson_ratio,
      body.slices * volume(cc) * std::pow(cc.grid.cell_size, 3), total_area, cc.grid.num_cells[0], cc.grid.num_cells[1],
      cc.grid.num_cells[2], cc.grid.cell_size, active, cut, count_unknowns(body));
  if (cc.num_levels() > 1) {
    text += "  levels:";
    for (int l = 0; l < cc.num_levels(); ++l)
      text +=
          fmt::format("{} {} cells of {:g} m", l == 0 ? "" : ",", cc.parts[l].cells.size(), cc.grid.cell_size_of(l));
    text += "\n";
  }
  if (body.spec->plane_strain)
    text += fmt::format(
        "  plane strain across {0}: the nodes on both sides share their unknowns, nothing moves along {0}\n",
        name_of(*body.spec->plane_strain));
  for (const std::string& note : body.spec->notes) text += "  " + note + "\n";
  for (const auto& [name, a] : area) text += fmt::format("  face {}: {:.10g} m2\n", name, a);
  for (const FaceSpec& spec : body.spec->faces) {
    const BodyFace face(spec, body);
    double declared = 0;
    for (int p = 0; p < static_cast<int>(cc.boundary.size()); ++p)
      if (face.contains(p)) declared += body.slices * body.area(p);
    text += fmt::format("  face {}: {:.10g} m2 (declared)\n", spec.name, declared);
  }
  return text;
}

/// "load "body.face": (1, 0, -500) N at (0, 0, 0.1) m, moment (0, 0, 0) N m there, 0.01 m2": its resultants about the
/// centroid.
std::string describe_load(const Scene& scene, const std::vector<BodyModel>& bodies, int number) {
  const LoadSpec& load = scene.loads[number];
  const BodyModel& body = bodies[load.face.body];
  const BodyFace face(load.face.face, body);
  const LinearTraction resultant = resultant_of(body, number);
  FaceMoments moments;
  Vec3 force = Vec3::Zero(), about_origin = Vec3::Zero();
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    if (!face.contains(p)) continue;
    const Vec3 x = body.point(p);
    const double area = body.slices * body.area(p);
    const Vec3 f = area * (load.given_traction(x, body.normal(p)) + resultant.at(x));
    moments.add(x, area);
    force += f;
    about_origin += x.cross(f);
  }
  const Vec3 centroid = moments.centroid(), moment = about_origin - centroid.cross(force);
  const auto text = [](const Vec3& v, double scale) {  // what is rounding beside the scale is 0
    const auto rounded = [&](double value) { return std::abs(value) > 1e-9 * scale ? value : 0.0; };
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", rounded(v[0]), rounded(v[1]), rounded(v[2]));
  };
  const double size = std::sqrt(moments.area());
  return fmt::format("load on \"{}.{}\": {} N at ({:.4g}, {:.4g}, {:.4g}) m, moment {} N m there; {:.6g} m2\n",
                     body.spec->name, load.face.face.name, text(force, force.norm()), centroid[0], centroid[1],
                     centroid[2], text(moment, std::max(moment.norm(), force.norm() * size)), moments.area());
}

}  // namespace

CheckFiles draw(const Scene& scene, const Preparation& preparation, const std::string& directory) {
  std::vector<CheckedBody> bodies;
  for (const BodyModel& body : preparation.bodies) {
    CheckedBody checked{&body.cut_cells, body.boundary.pair_of_point};
    for (int& pair : checked.pair_of_point)
      if (pair >= 0) pair = static_cast<int>(preparation.pairs[pair].spec - scene.contacts.data());
    bodies.push_back(std::move(checked));
  }
  return write_check(scene, bodies, directory);
}

std::string describe(const Scene& scene, const Preparation& preparation) {
  std::string text = fmt::format("{}: {}\n", scene.file, scene.title.empty() ? "(no title)" : scene.title);
  long long unknowns = 0;
  std::vector<BodySize> sizes;
  for (const BodyModel& body : preparation.bodies) {
    text += describe_body(body);
    sizes.push_back(size_of(body.cut_cells));
    unknowns += count_unknowns(body);
  }
  const auto supports = std::count_if(scene.supports.begin(), scene.supports.end(),
                                      [](const SupportSpec& support) { return !support.by_plane_strain; });
  text += fmt::format("{} support{}, {} load{}\n", supports, supports == 1 ? "" : "s", scene.loads.size(),
                      scene.loads.size() == 1 ? "" : "s");
  for (int l = 0; l < static_cast<int>(scene.loads.size()); ++l) text += describe_load(scene, preparation.bodies, l);
  for (const ContactPair& pair : preparation.pairs) {
    double area = 0, smallest = 1e300, largest = -1e300;
    for (const ContactPoint& q : pair.points) {
      area += preparation.bodies[pair.primary].slices * q.weight;
      smallest = std::min(smallest, q.distance);
      largest = std::max(largest, q.distance);
    }
    text += fmt::format(
        "contact \"{}\": {} - {}, {} points in {} groups, {:.6g} m2 in reach, distance {:.3g} .. {:.3g} m\n",
        pair.spec->name, scene.bodies[pair.primary].name, scene.bodies[pair.secondary].name, pair.points.size(),
        pair.groups.size(), area, smallest, largest);
  }
  if (!scene.steps.empty()) text += fmt::format("{} step{}\n", scene.steps.size(), scene.steps.size() == 1 ? "" : "s");
  for (const std::string& warning : preparation.warnings) text += fmt::format("warning: {}\n", warning);
  text += fmt::format("contact.csv: {:.0f} rows\n{} unknowns in all, about {:.0f} MB of memory\n",
                      count_contact_rows(preparation), unknowns,
                      expected_memory(sizes, memory_extras(scene, preparation)) / 1e6);
  return text;
}

std::string describe_settings(const Scene& scene) {
  return scene.geometry.print() + scene.contact.print() + scene.solver.print() + scene.recovery.print() +
         scene.results.print() + (scene.accuracy.any() ? scene.accuracy.print() : "");
}

}  // namespace cgcontact
