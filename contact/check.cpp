#include "contact/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/checks/memory.hpp"
#include "contact/results/figures/conditions.hpp"

namespace cgcontact {
namespace {

/// Counts the unknowns of a body, without nodes that are constrained.
long long count_unknowns(const BodyModel& body) {
  const long long all = static_cast<long long>(size_of(body.cut_cells).nodes);
  if (body.spec->rigid()) return body.spec->plane_strain ? 3 : 6;
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
  const long long cut = static_cast<long long>(cc.active_of_cut.size()),
                  active = static_cast<long long>(cc.cells.size());
  std::string text = fmt::format(
      "body \"{}\": {}, volume {:.10g} m3, surface {:.10g} m2\n"
      "  grid {} x {} x {} cells of {:g} m; {} active, {} of them cut; {} unknowns\n",
      body.spec->name,
      body.spec->rigid() ? "rigid"
                         : fmt::format("E = {:g} Pa, nu = {:g}", body.spec->material.youngs_modulus,
                                       body.spec->material.poisson_ratio),
      body.slices * volume(cc) * std::pow(cc.grid.cell_size, 3), total_area, cc.grid.num_cells[0], cc.grid.num_cells[1],
      cc.grid.num_cells[2], cc.grid.cell_size, active, cut, count_unknowns(body));
  if (cc.num_levels() > 1) {
    text += "  levels:";
    for (int l = 0; l < cc.num_levels(); ++l)
      text += fmt::format("{} {} cells of {:g} m", l == 0 ? "" : ",", cc.level_cells[l].cells.size(),
                          cc.grid.cell_size_of(l));
    text += "\n";
  }
  if (body.spec->axisymmetric())
    text += fmt::format("  of revolution about {}: cells are rings, forces and areas those of the whole body\n",
                        coordinate_names()[body.spec->axis_of_revolution()]);
  else if (body.spec->plane_strain)
    text += fmt::format(
        "  plane strain across {0}: the nodes on both sides share their unknowns, nothing moves along {0}\n",
        name_of(*body.spec->plane_strain));
  for (const std::string& note : body.spec->notes) text += "  " + note + "\n";
  if (body.spec->axisymmetric()) area.erase("axis.plane");
  for (const auto& [name, a] : area) text += fmt::format("  face {}: {:.10g} m2\n", name, a);
  for (const FaceSpec& spec : body.spec->faces) {
    double declared = 0;
    for (const int p : BodyFace(spec, body).points()) declared += body.slices * body.area(p);
    text += fmt::format("  face {}: {:.10g} m2 (declared)\n", spec.name, declared);
  }
  return text;
}

std::string components(const Vec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v[0], v[1], v[2]); }

std::string describe_load(const LoadFigures& load) {
  const std::string what =
      fmt::format("{} \"{}\": {}", load.of_body ? "on body" : "load on", load.face, load.condition);
  if (load.of_body && load.force.isZero(0) && load.moment.isZero(0)) return what + "\n";
  return fmt::format("{}; {:.6g} {}; resultant {} N, moment {} N m about {} m\n", what, load.area,
                     load.of_body ? "m3" : "m2", components(load.force), components(load.moment),
                     components(load.about));
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
                                      [](const SupportSpec& support) { return !support.implied; });
  text += fmt::format("{} support{}, {} load{}\n", supports, supports == 1 ? "" : "s", scene.loads.size(),
                      scene.loads.size() == 1 ? "" : "s");
  for (const LoadFigures& load : load_figures(scene, preparation.bodies)) text += describe_load(load);
  for (const ContactPair& pair : preparation.pairs) {
    double area = 0, smallest = 1e300, largest = -1e300;
    for (std::size_t index = 0; index < pair.num_surface_points(); ++index) {
      const ContactPoint q = pair.points[index];
      area += preparation.bodies[pair.primary].slices * q.weight;
      smallest = std::min(smallest, q.distance);
      largest = std::max(largest, q.distance);
    }
    text +=
        fmt::format("{}contact \"{}\": {} - {}, {} points in {} groups, {:.6g} m2 {}, distance {:.3g} .. {:.3g} m\n",
                    pair.bonded() ? "bonded " : "", pair.spec->name, scene.bodies[pair.primary].name,
                    scene.bodies[pair.secondary].name, pair.num_surface_points(), pair.num_surface_groups(), area,
                    pair.bonded() ? "tied" : "in reach", smallest, largest);
  }
  if (!scene.steps.empty()) text += fmt::format("{} step{}\n", scene.steps.size(), scene.steps.size() == 1 ? "" : "s");
  for (const std::string& warning : preparation.warnings) text += fmt::format("warning: {}\n", warning);
  text += fmt::format("contact.csv: {:.0f} rows; supports: {} points\n{} unknowns in all, about {:.0f} MB of memory\n",
                      count_contact_rows(preparation), preparation.supports.size(), unknowns,
                      expected_memory(sizes, memory_extras(scene, preparation)) / 1e6);
  return text;
}

std::string describe_settings(const Scene& scene) {
  return scene.geometry.print() + scene.contact.print() + scene.solver.print() + scene.recovery.print() +
         scene.results.print() + scene.accuracy.print() + scene.output.print();
}

}  // namespace cgcontact
