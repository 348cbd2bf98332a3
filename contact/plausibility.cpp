#include "contact/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "contact/checks/condition_checks.hpp"
#include "contact/results/figures/conditions.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/geometry/solid_middle.hpp"

namespace cgcontact {
namespace {

/// Pa: soft gels and foams; diamond has 1.05e12 to 1.2e12.
constexpr double min_modulus = 1e5, max_modulus = 1.25e12;
/// Pa: rubber begins there. Most materials in MPa are a number below it, which is then read as Pa.
constexpr double softest_rubber = 1e6;
/// Moduli in GPa are numbers below it, those in MPa of all but rubber above.
constexpr double max_in_gigapascals = 1e3;
/// Sizes of two bodies in contact differ by less, but where one is in mm and the other in m.
constexpr double max_size_ratio = 100;
/// m: parts are shorter, and most numbers of mm are larger.
constexpr double longest_part = 10;
/// m: a consistent set with mm has its parts longer than that.
constexpr double longer_than_in_metres = 1;
/// Directions that lie in the span of others to within this length are held by them.
constexpr double in_span = 1e-6;

struct Checked {
  const Scene& scene;
  const Preparation& preparation;
  std::set<int> told = {};  ///< bodies whose modulus or size was found strange
  std::vector<std::string> found = {};

  const BodySpec& body(int b) const { return scene.bodies[b]; }
  void tell(const std::string& sentence) { found.push_back(sentence); }
};

/// Geometric mean of the sides of its bounding box: foils and long bars have a small one. In plane strain the sides in
/// the plane, m.
double mean_side(const BodySpec& body) {
  Vec3 sides = extent_of(body.solid);
  if (!body.plane_strain) return std::cbrt(sides[0]) * std::cbrt(sides[1]) * std::cbrt(sides[2]);
  sides[static_cast<int>(*body.plane_strain)] = 1;
  return std::sqrt(sides[0]) * std::sqrt(sides[1]) * std::sqrt(sides[2]);
}

std::string sides_text(const BodySpec& body) {
  const Vec3 sides = extent_of(body.solid);
  return fmt::format("{:.3g} x {:.3g} x {:.3g} m", sides[0], sides[1], sides[2]);
}

/// "body "a"", "bodies "a", "b"".
std::string bodies_text(const Checked& c, const std::vector<int>& bodies) {
  std::vector<std::string> names;
  for (const int b : bodies) names.push_back('"' + c.body(b).name + '"');
  return (names.size() == 1 ? "body " : "bodies ") + join(names);
}

/// Says what is wrong with a modulus, Pa; "" if nothing is.
std::string fault_of_modulus(const BodySpec& body) {
  const double modulus = body.material.youngs_modulus;
  const std::string given = fmt::format("E = {:.6g} Pa", modulus);
  if (modulus > max_modulus)
    return given +
           " is more than diamond has (1.2e12 Pa): is its unit right? A body that is to be much stiffer than the "
           "others has rigid = true";
  if (body.material.modulus_has_units || modulus >= softest_rubber)
    return modulus < min_modulus ? given + " is less than soft gels have (1e5 Pa): is its unit right?" : "";
  const bool in_millimetres = body.plain_lengths && longest_side(body.solid) > longer_than_in_metres;
  return given +
         fmt::format(
             " is less than rubber has (1e6 Pa): a number without a unit is in Pa; write \"{0:.6g} {1}\", or "
             "\"{0:.6g} Pa\" if that is meant",
             modulus, modulus < max_in_gigapascals ? "GPa" : "MPa") +
         (in_millimetres ? " (in mm, N and MPa throughout the result is right, but m and Pa stand beside it)" : "");
}

void find_moduli(Checked& c) {
  std::map<std::string, std::vector<int>> bodies_of;
  std::vector<std::string> order;
  for (int b = 0; b < static_cast<int>(c.scene.bodies.size()); ++b) {
    if (c.body(b).rigid()) continue;
    const std::string fault = fault_of_modulus(c.body(b));
    if (fault.empty()) continue;
    if (bodies_of[fault].empty()) order.push_back(fault);
    bodies_of[fault].push_back(b);
    c.told.insert(b);
  }
  for (const std::string& fault : order) c.tell(bodies_text(c, bodies_of[fault]) + ": " + fault);
}

void find_sizes_of_pairs(Checked& c) {
  std::set<std::pair<int, int>> seen;
  for (const ContactPair& pair : c.preparation.pairs) {
    int large = pair.primary, small = pair.secondary;
    if (!seen.insert(std::minmax(large, small)).second) continue;
    if (mean_side(c.body(large)) < mean_side(c.body(small))) std::swap(large, small);
    const double ratio = mean_side(c.body(large)) / mean_side(c.body(small));
    if (ratio < max_size_ratio) continue;
    const bool both_told = c.told.count(large) + c.told.count(small) == 2;
    c.told.insert({large, small});
    if (both_told) continue;
    c.tell(
        fmt::format("contact \"{}\": body \"{}\" ({}) is {:.0f} times as large as body \"{}\" ({}): is one of them "
                    "in mm? A number without a unit is in m; write \"40 mm\"",
                    pair.spec->name, c.body(large).name, sides_text(c.body(large)), ratio, c.body(small).name,
                    sides_text(c.body(small))));
  }
}

void find_long_bodies(Checked& c) {
  for (int b = 0; b < static_cast<int>(c.scene.bodies.size()); ++b) {
    const double longest = longest_side(c.body(b).solid);
    if (!c.body(b).plain_lengths || longest <= longest_part || c.told.count(b) > 0) continue;
    c.told.insert(b);
    c.tell(
        fmt::format("body \"{0}\" is {1:.4g} m long: a number without a unit is in m; write \"{1:.4g} mm\" if mm "
                    "are meant, \"{1:.4g} m\" if not",
                    c.body(b).name, longest));
  }
}

/// The largest magnitude of factor_of(step) of any step.
template <class FactorOf>
double largest_factor(const Scene& scene, const FactorOf& factor_of) {
  double largest = std::abs(factor_of(scene.last_step()));
  for (const StepSpec& step : scene.steps) largest = std::max(largest, std::abs(factor_of(step)));
  return largest;
}

void find_long_ways(Checked& c) {
  std::vector<double> way(c.scene.supports.size(), 0.0);
  for (const SupportPoint& point : c.preparation.supports)
    if (point.support >= 0 && point.spring == 0)
      way[point.support] = std::max(way[point.support], std::abs(point.prescribed));
  for (std::size_t s = 0; s < way.size(); ++s) {
    const double factor = largest_factor(c.scene, [&](const StepSpec& step) { return step.of(c.scene.supports[s]); });
    const FaceRef& face = c.scene.supports[s].face;
    const double longest = longest_side(c.body(face.body).solid);
    if (factor * way[s] <= c.scene.results.largest_displacement * longest) continue;
    c.tell(
        fmt::format("support of \"{0}.{1}\": it moves the face by {2:.4g} m, the body is {3:.3g} m long: too much "
                    "for small displacements; a number without a unit is in m, write \"{2:.4g} mm\" if mm are meant",
                    c.body(face.body).name, face.face.name, factor * way[s], longest));
  }
}

void find_large_interferences(Checked& c) {
  const double factor = largest_factor(c.scene, [](const StepSpec& step) { return step.interference; });
  std::set<const ContactSpec*> seen;
  for (const ContactPair& pair : c.preparation.pairs) {
    const double depth = factor * std::abs(pair.spec->interference);
    const double longest =
        std::min(longest_side(c.body(pair.primary).solid), longest_side(c.body(pair.secondary).solid));
    if (depth <= c.scene.results.largest_displacement * longest || !seen.insert(pair.spec).second) continue;
    c.tell(
        fmt::format("contact \"{0}\": an interference of {1:.4g} m, the smaller body is {2:.3g} m long: too much "
                    "for small displacements; a number without a unit is in m, write \"{1:.4g} mm\" if mm are meant",
                    pair.spec->name, depth, longest));
  }
}

void find_large_loads(Checked& c) {
  const std::vector<LoadFigures> loads = load_figures(c.scene, c.preparation.bodies);
  for (std::size_t l = 0; l < c.scene.loads.size(); ++l) {
    const auto factor_of = [&](const StepSpec& step) { return step.of(c.scene.loads[l]); };
    const double factor = largest_factor(c.scene, factor_of), last = factor_of(c.scene.last_step());
    if (last == 0) continue;  // the figures are those of the last step
    const int b = c.scene.loads[l].face.body;
    const double mean = factor / std::abs(last) * loads[l].force.norm() / loads[l].area;
    const double modulus = c.body(b).material.youngs_modulus;
    if (!(mean > c.scene.results.largest_pressure * modulus) || c.told.count(b) > 0) continue;
    c.tell(
        fmt::format("load on \"{}\": {} over {:.3g} m2 are {:.3g} Pa, {} % of the E of its body: too much for small "
                    "strain; is a unit wrong, of the load, of E or of the lengths?",
                    loads[l].face, scaled(factor / std::abs(last) * loads[l].force.norm(), "N"), loads[l].area, mean,
                    percent_number(mean / modulus)));
  }
}

/// Finds what of a traction is left beside the directions that supports hold.
Vec3 left_beside(const std::vector<Vec3>& held, const Vec3& traction) {
  std::vector<Vec3> basis;
  Vec3 left = traction;
  for (Vec3 direction : held) {
    for (const Vec3& e : basis) direction -= e.dot(direction) * e;
    if (direction.norm() < in_span) continue;
    basis.push_back(direction.normalized());
    left -= basis.back().dot(left) * basis.back();
  }
  return left;
}

/// Names of the supports that take a load where it acts; empty if they leave more than a rim of it.
std::vector<std::string> holders_of_load(const Checked& c, int number) {
  const LoadSpec& load = c.scene.loads[number];
  const BodyModel& body = c.preparation.bodies[load.face.body];
  const FaceTraction resultant = resultant_of(body, number);
  std::vector<std::pair<int, BodyFace>> supports;
  for (int s = 0; s < static_cast<int>(c.scene.supports.size()); ++s)
    if (c.scene.supports[s].face.body == load.face.body && !c.scene.supports[s].is_elastic() &&
        !c.scene.supports[s].implied)
      supports.emplace_back(s, BodyFace(c.scene.supports[s].face.face, body));
  double all = 0, left = 0;
  std::set<std::string> names;
  for (const int p : BodyFace(load.face.face, body).points()) {
    const Vec3 x = body.point(p), n = body.normal(p), traction = load.traction_at(x, n, resultant);
    std::vector<Vec3> held;
    for (const auto& [support, face] : supports) {
      if (!face.contains(p)) continue;
      for (const HeldDirection& direction : held_at(c.scene, body, support, x, n))
        if (direction.stiffness == 0) held.push_back(direction.direction);
      names.insert('"' + body.spec->name + "." + c.scene.supports[support].face.face.name + '"');
    }
    all += body.area(p) * traction.norm();
    left += body.area(p) * left_beside(held, traction).norm();
  }
  if (!(all > 0) || left > rim * all) return {};
  return {names.begin(), names.end()};
}

void find_held_loads(Checked& c) {
  for (int l = 0; l < static_cast<int>(c.scene.loads.size()); ++l) {
    const std::vector<std::string> holders = holders_of_load(c, l);
    if (holders.empty()) continue;
    const FaceRef& face = c.scene.loads[l].face;
    c.tell(
        fmt::format("load on \"{}.{}\": the support of {} holds the face in the direction of the load, which "
                    "goes into the support and does nothing else: load a face, or a part of it, that is free to move",
                    c.body(face.body).name, face.face.name, join(holders)));
  }
}

/// Tells of a named face that takes the faces of other shapes, because they lie on the same surface.
void find_shared_face(Checked& c, const char* of, const FaceRef& ref) {
  const FaceSpec& face = ref.face;
  if (face.owners.empty()) return;
  const BodyModel& model = c.preparation.bodies[ref.body];
  const Grid& grid = model.cut_cells.grid;
  double area = 0, beside = 0;
  std::set<std::string> others;
  for (const int p : BodyFace(face, model).points()) {
    area += model.area(p);
    if (!model.spec->is_beside_owners(face, grid.to_global(model.cut_cells.boundary.position_of_facet(p)))) continue;
    beside += model.area(p);
    for (const std::string& name : model.surface_names(p))
      if (!face.selects({name})) others.insert('"' + name + '"');
  }
  if (beside <= rounding * area) return;
  c.tell(
      fmt::format("{} \"{}.{}\": the face lies on one surface with {}, of which it takes {:.3g} of its {:.3g} m2 too: "
                  "name all that are meant in one face ([[body]] faces = [{{name = .., surfaces = [..]}}]), or give "
                  "it a box around the part that is meant",
                  of, c.body(ref.body).name, face.name, join({others.begin(), others.end()}), model.slices * beside,
                  model.slices * area));
}

/// Loads and supports; a plane of symmetry is meant as a whole.
void find_shared_faces(Checked& c) {
  for (const LoadSpec& load : c.scene.loads) find_shared_face(c, "load on", load.face);
  for (const SupportSpec& support : c.scene.supports)
    if (!support.symmetry && !support.implied) find_shared_face(c, "support of", support.face);
}

struct Rule {
  const char* finds;
  void (*apply)(Checked&);
};

/// Those first whose findings explain others.
const Rule rules[] = {
    {"a modulus that no material has", find_moduli},
    {"bodies in contact of very different size", find_sizes_of_pairs},
    {"a part of tens of metres", find_long_bodies},
    {"a prescribed displacement above a tenth of the body", find_long_ways},
    {"an interference above a tenth of the body", find_large_interferences},
    {"a load above a tenth of the modulus", find_large_loads},
    {"a load where a support takes it", find_held_loads},
    {"a face that is more than the shape of its name has", find_shared_faces},
};

}  // namespace

std::vector<std::string> implausible_values(const Scene& scene, const Preparation& preparation) {
  Checked checked{scene, preparation};
  for (const Rule& rule : rules) rule.apply(checked);
  return checked.found;
}

}  // namespace cgcontact
