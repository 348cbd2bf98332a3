#include "contact/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/output_check.hpp"

namespace cgcontact {
namespace {

/// Active nodes of a body.
long long count_nodes(const CutCells& cc) {
  const Index3& n = cc.grid.num_cells;
  std::vector<bool> seen(static_cast<std::size_t>(n[0] + 1) * (n[1] + 1) * (n[2] + 1));
  for (const Index3& c : cc.cells)
    for (int a = 0; a < 8; ++a) seen[cc.grid.node_index({c[0] + (a & 1), c[1] + (a >> 1 & 1), c[2] + (a >> 2)})] = true;
  return std::count(seen.begin(), seen.end(), true);
}

double volume(const CutCells& cc) {
  double sum = 0;
  for (std::size_t e = 0; e < cc.cells.size(); ++e) sum += cc.volume_fraction(static_cast<int>(e));
  return sum * std::pow(cc.grid.cell_size, 3);
}

std::string describe_body(const BodyModel& body) {
  const CutCells& cc = body.cut_cells;
  std::map<std::string, double> area;
  double total_area = 0;
  for (int p = 0; p < static_cast<int>(cc.boundary.size()); ++p) {
    total_area += body.area(p);
    for (const std::string& name : body.surface_names(p)) area[name] += body.area(p);
  }
  const long long cut = static_cast<long long>(cc.moments.size()), active = static_cast<long long>(cc.cells.size());
  std::string text = fmt::format(
      "body \"{}\": E = {:g} Pa, nu = {:g}, volume {:.10g} m3, surface {:.10g} m2\n"
      "  grid {} x {} x {} cells of {:g} m; {} active, {} of them cut; {} unknowns\n",
      body.spec->name, body.spec->material.youngs_modulus, body.spec->material.poisson_ratio, volume(cc), total_area,
      cc.grid.num_cells[0], cc.grid.num_cells[1], cc.grid.num_cells[2], cc.grid.cell_size, active, cut,
      3 * count_nodes(cc));
  for (const std::string& note : body.spec->notes) text += "  " + note + "\n";
  for (const auto& [name, a] : area) text += fmt::format("  face {}: {:.10g} m2\n", name, a);
  return text;
}

}  // namespace

/// Fitted to 17 runs of the scenes of this repository on two threads, 2,000 to 50 million unknowns, plane and solid,
/// with pictures: between 0.77 (plane) and 1.2 times the memory that they took. What grows like the surface weighs
/// most.
long long expected_memory(const Preparation& preparation) {
  double bytes = 85e6;
  for (const BodyModel& body : preparation.bodies)
    bytes += 3 * 170.0 * static_cast<double>(count_nodes(body.cut_cells)) +
             13e3 * static_cast<double>(body.cut_cells.moments.size());
  return static_cast<long long>(bytes);
}

std::vector<std::string> draw(const Scene& scene, const Preparation& preparation, const std::string& directory) {
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
  for (const BodyModel& body : preparation.bodies) {
    text += describe_body(body);
    unknowns += 3 * count_nodes(body.cut_cells);
  }
  text += fmt::format("{} support{}, {} load{}\n", scene.supports.size(), scene.supports.size() == 1 ? "" : "s",
                      scene.loads.size(), scene.loads.size() == 1 ? "" : "s");
  for (const ContactPair& pair : preparation.pairs) {
    double area = 0, smallest = 1e300, largest = -1e300;
    for (const ContactPoint& q : pair.points) {
      area += q.weight;
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
  text += fmt::format("{} unknowns in all, about {:.0f} MB of memory\n", unknowns,
                      static_cast<double>(expected_memory(preparation)) / 1e6);
  return text;
}

}  // namespace cgcontact
