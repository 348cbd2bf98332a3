#include "contact/model/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "contact/model/around_axis.hpp"
#include "contact/model/plane_strain.hpp"
#include "contact/model/refined_grid.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/cells/cells_around.hpp"
#include "core/scene/face_dividers.hpp"

namespace cgcontact {
namespace {

/// Supports of rigid bodies are that much stiffer: these have no stress to lag, and the error of a prescribed
/// displacement falls by that factor per outer iteration.
constexpr double firm_on_rigid = 1e4;

}  // namespace

void extend_box(const CutCells& cut_cells, int cell, Vec3& low, Vec3& high) {
  for (int k = 0; k < 2; ++k) {
    const Vec3 x = global_position(cut_cells, cell, Vec3::Constant(2 * k - 1));
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
}

FaceTraction resultant_of(const BodyModel& body, int load) {
  const auto found = body.resultants.find(load);
  return found == body.resultants.end() ? FaceTraction() : found->second;
}

std::vector<HeldDirection> held_at(const Scene& scene, const BodyModel& body, int support, const Vec3& x,
                                   const Vec3& n) {
  const auto face = body.supported.find(support);
  return held_at(scene.supports[support], face == body.supported.end() ? SupportedFace() : face->second, x, n);
}

namespace {

bool has_body_force(const BodySpec& body) {
  const auto is_zero = [](const Expression& component) { return component.is_zero(); };
  return body.inertia.any() || !std::all_of(body.body_force.begin(), body.body_force.end(), is_zero);
}

std::string in_quotes(const std::string& name) { return "\"" + name + "\""; }

/// The supports at a point, if one of them is about an axis or by springs.
std::vector<std::pair<const SupportSpec*, SupportedFace>> other_supports_of(const Scene& scene, const BodyModel& body,
                                                                            const PointConditions& key) {
  std::vector<std::pair<const SupportSpec*, SupportedFace>> supports;
  for (const int s : key.supports)
    if (const auto face = body.supported.find(s); face != body.supported.end())
      supports.emplace_back(&scene.supports[s], face->second);
  return supports;
}

/// The loads that hold at a point.
std::vector<std::pair<const LoadSpec*, FaceTraction>> tractions_of(const Scene& scene, const BodyModel& body,
                                                                   const PointConditions& key) {
  std::vector<std::pair<const LoadSpec*, FaceTraction>> tractions;
  for (const int l : key.loads) tractions.emplace_back(&scene.loads[l], resultant_of(body, l));
  return tractions;
}

TractionCondition make_condition(const Scene& scene, const BodyModel& body, const PointConditions& key,
                                 const StepSpec& step) {
  TractionCondition condition;
  for (int s : key.supports) {
    const SupportSpec& support = scene.supports[s];
    condition.normal_held |= support.holds_normal();
    for (int i = 0; i < 3; ++i) condition.component_held[i] |= support.displacement[i].has_value();
  }
  if (auto others = other_supports_of(scene, body, key); !others.empty())
    condition.held = [others = std::move(others)](const Vec3& x, const Vec3& n) {
      std::vector<Vec3> directions;
      for (const auto& [support, face] : others)
        for (const HeldDirection& held : held_at(*support, face, x, n)) directions.push_back(held.direction);
      return directions;
    };
  if (!key.loads.empty())
    condition.traction = [tractions = tractions_of(scene, body, key), step](const Vec3& x, const Vec3& n) {
      Vec3 t = Vec3::Zero();
      for (const auto& [load, resultant] : tractions) t += step.of(*load) * load->traction_at(x, n, resultant);
      return t;
    };
  return condition;
}

/// Ties every boundary point of a body to the supports and loads that hold there.
void assign_conditions(const Scene& scene, int body, BodyModel& model, std::vector<char>& support_used,
                       std::vector<char>& load_used) {
  const std::size_t num_points = model.cut_cells.boundary.size();
  BoundaryData& data = model.boundary;
  std::map<PointConditions, int> index;
  std::vector<std::pair<int, BodyFace>> supports, loads;
  for (int s = 0; s < static_cast<int>(scene.supports.size()); ++s)
    if (scene.supports[s].face.body == body) supports.emplace_back(s, BodyFace(scene.supports[s].face.face, model));
  for (int l = 0; l < static_cast<int>(scene.loads.size()); ++l)
    if (scene.loads[l].face.body == body) loads.emplace_back(l, BodyFace(scene.loads[l].face.face, model));
  data.condition_of_point.resize(num_points);
  data.pair_of_point.assign(num_points, -1);
  PointConditions key;
  for (std::size_t p = 0; p < num_points; ++p) {
    key.supports.clear();
    key.loads.clear();
    for (const auto& [s, face] : supports)
      if (face.contains(static_cast<int>(p))) key.supports.push_back(s), support_used[s] = 1;
    for (const auto& [l, face] : loads)
      if (face.contains(static_cast<int>(p))) key.loads.push_back(l), load_used[l] = 1;
    const auto [entry, is_new] = index.emplace(key, static_cast<int>(model.conditions.size()));
    if (is_new) model.conditions.push_back(key);
    data.condition_of_point[p] = entry->second;
  }
}

/// Returns the moments of a face of the whole thickness.
FaceMoments moments_of(const FaceSpec& face, const BodyModel& model) {
  FaceMoments moments(model.spec->axis_across());
  for (const int p : BodyFace(face, model).points())
    moments.add(model.point(p), model.normal(p), model.slices * model.area(p));
  return moments;
}

/// Finds the tractions that give the loads of a body their forces and moments.
void find_resultants(const Scene& scene, int body, BodyModel& model) {
  for (int l = 0; l < static_cast<int>(scene.loads.size()); ++l) {
    const LoadSpec& load = scene.loads[l];
    if (load.face.body != body || !load.has_resultants()) continue;
    const FaceMoments moments = moments_of(load.face.face, model);
    if (!(moments.area() > 0)) continue;  // reported as a face without points
    try {
      model.resultants[l] = load.resulting_traction(moments, model.spec->axisymmetric());
    } catch (const InputError& error) {
      throw InputError(load.location, in_quotes(model.spec->name + "." + load.face.face.name), error.what(),
                       load.bearing ? "bearing = true for a cylinder, with a force across its axis"
                       : model.spec->plane_strain
                           ? "a force alone, or a moment about " + coordinate_names()[*model.spec->axis_across()]
                           : "a force alone, or a face with some breadth");
    }
  }
}

/// Areas and axes of faces that the supports of a body need.
void measure_supported_faces(const Scene& scene, int body, BodyModel& model) {
  for (int s = 0; s < static_cast<int>(scene.supports.size()); ++s) {
    const SupportSpec& support = scene.supports[s];
    if (support.face.body != body || !(support.is_cylindrical() || support.is_elastic())) continue;
    const FaceMoments moments = moments_of(support.face.face, model);
    if (!(moments.area() > 0)) continue;  // reported as a face without points
    const auto axis = support.axis || !support.is_cylindrical() ? support.axis : moments.axis();
    if (support.is_cylindrical() && !axis)
      throw InputError(support.location, in_quotes(model.spec->name + "." + support.face.face.name),
                       "the face is no cylinder: about which axis are its components?",
                       "cylindrical = {.., point = [x, y, z], axis = [x, y, z]}, or the side of a cylinder");
    model.supported[s] = {moments.area(), axis.value_or(Axis())};
  }
}

using UseForce = std::function<void(int cell, const Vec3& xi, const Vec3& x, const Vec3& force)>;
using ForceAt = std::function<Vec3(const Vec3& x)>;

void each_body_force(const BodyModel& body, const ForceAt& force_at, const UseForce& use) {
  const CutCells& cc = body.cut_cells;
  double weights[125];
  for (std::size_t e = 0; e < cc.cells.size(); ++e) {
    const int cut = cc.cut_of_active[e];
    const double factor =
        std::pow(cc.h(static_cast<int>(e)), 3) * cc.grid.thickness_of_cell(cc.level(static_cast<int>(e))) / 8;
    fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], 5, weights);
    for (int q = 0; q < 125; ++q) {
      const Vec3 xi(Gauss5::point[q / 25], Gauss5::point[q / 5 % 5], Gauss5::point[q % 5]);
      const Vec3 x = global_position(cc, static_cast<int>(e), xi);
      const double ring = cc.grid.ring(grid_position(cc, static_cast<int>(e), xi));
      use(static_cast<int>(e), xi, x, ring * factor * weights[q] * force_at(x));
    }
  }
}

/// In plane strain a body expands across the axis by (1 + nu) times its free strain, and is held back along it.
void set_temperature(double factor, BodyModel& model) {
  const BodySpec& body = *model.spec;
  model.expansion = Mat3::Zero();
  model.held_back = Sym3::Zero();
  if (body.temperature == 0) return;
  const double strain = factor * body.temperature * body.material.expansion.value_or(0);
  model.expansion = strain * Mat3::Identity();
  if (!body.plane_strain || body.axisymmetric()) return;
  const int axis = static_cast<int>(*body.plane_strain);
  model.expansion *= 1 + body.material.poisson_ratio;
  model.expansion(axis, axis) = 0;
  model.held_back[axis] = -body.material.youngs_modulus * strain;
}

void measure_thickness(BodyModel& model) {
  const CutCells& cc = model.cut_cells;
  double area = 0, free_area = 0;
  for (std::size_t p = 0; p < cc.boundary.size(); ++p) {
    area += cc.boundary.weight[p];
    if (!model.boundary.conditions[model.boundary.condition_of_point[p]].is_support())
      free_area += cc.boundary.weight[p];
  }
  const double twice = 2 * volume(cc);
  model.thickness = twice / area;
  model.free_thickness = free_area > 0 ? twice / free_area : 1e9;
}

/// Faces of a body that supports, loads and contacts name.
std::vector<const FaceSpec*> faces_in_use(const Scene& scene, int body) {
  std::vector<const FaceSpec*> faces;
  const auto add = [&](const FaceRef& face) {
    if (face.body == body) faces.push_back(&face.face);
  };
  for (const SupportSpec& support : scene.supports) add(support.face);
  for (const LoadSpec& load : scene.loads) add(load.face);
  for (const ContactSpec& contact : scene.contacts) {
    add(contact.first);
    add(contact.second);
  }
  for (const ProbeSpec& probe : scene.probes)
    if (probe.kind == ProbeSpec::Kind::face) add(probe.face);
  return faces;
}

/// Solid and grid that a body's cells are made from.
struct BodyOnGrid {
  Solid solid;  ///< in the coordinates of the grid
  Grid grid;
  std::vector<Plane> dividers;
  CellTree tree;
};

/// Planes at which loads of a body jump.
void add_jumps_of_loads(const Scene& scene, int body, BodyOnGrid& on_grid) {
  Vec3 min, max;
  scene.bodies[body].solid.bounding_box(min, max);
  for (const LoadSpec& load : scene.loads)
    if (load.face.body == body)
      for (const Expression* field : {&load.pressure, &load.traction[0], &load.traction[1], &load.traction[2]})
        add_jump_dividers(load.face.face, jump_planes(*field, min, max), on_grid.solid, on_grid.grid, on_grid.dividers);
}

/// All but the grid.
void put_on_grid(const Scene& scene, int body, BodyOnGrid& on_grid) {
  const BodySpec& spec = scene.bodies[body];
  const Grid& grid = on_grid.grid;
  on_grid.solid = spec.solid.transformed(
      grid.rotation.transpose(), -(grid.rotation.transpose() * grid.origin) / grid.cell_size, 1.0 / grid.cell_size);
  // Longer on both sides than the one layer of cells: they have no ends.
  if (grid.is_quadtree()) on_grid.solid = stretched_to(spec, on_grid.solid, -1, 2);
  on_grid.dividers = face_dividers(faces_in_use(scene, body), on_grid.solid, grid);
  add_jumps_of_loads(scene, body, on_grid);
  on_grid.tree = refined_tree(spec, on_grid.solid, grid, on_grid.dividers, scene.geometry);
}

/// One slice for all quadtrees, as thick as the smallest of their cells: there cells are cubes.
void set_slices(std::vector<BodyOnGrid>& bodies) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const BodyOnGrid& body : bodies)
    if (body.grid.is_quadtree()) smallest = std::min(smallest, body.grid.cell_size_of(body.tree.num_levels() - 1));
  for (BodyOnGrid& body : bodies)
    if (body.grid.is_quadtree()) body.grid.slice = smallest;
}

/// Returns what make() gives; its InputErrors name the body.
template <class Make>
auto naming_body(const BodySpec& body, const Make& make) {
  try {
    return make();
  } catch (const TooManyCells& error) {
    throw TooManyCells(body.location, in_quotes(body.name), error.what());
  } catch (const InputError& error) {
    throw InputError(body.location, in_quotes(body.name), error.what());
  }
}

[[noreturn]] void refuse_empty_face(const Scene& scene, const FaceRef& face) {
  throw InputError(face.location, in_quotes(scene.bodies[face.body].name + "." + face.face.name),
                   "the face selects no point of the body's boundary");
}

}  // namespace

/// Cells; far above the rounding of a body's position, 1e-16 of its distance from the origin.
constexpr double grid_margin = 1e-6;

Grid make_grid(const BodySpec& body) {
  Grid grid;
  grid.cell_size = body.cell_size;
  grid.rotation = body.grid_rotation;
  Vec3 min, max;
  const Solid rotated = body.solid.transformed(body.grid_rotation.transpose(), Vec3::Zero());
  if (!rotated.bounding_box(min, max))
    throw InputError(body.location, in_quotes(body.name), "the body is not bounded",
                     "intersect half-spaces with a box");
  if (body.plane_strain) {
    grid.plane_strain = static_cast<int>(*body.plane_strain);
    if (!body.quadtree) check_thickness(body, (max - min)[grid.plane_strain]);
  }
  Vec3 start = min - body.cell_size * body.grid_offset;
  for (int d = 0; d < 3; ++d) {
    if (body.quadtree && d == grid.plane_strain) continue;
    // A face that lies on a grid plane up to rounding may stick out of its cell: a layer of (mostly empty) cells more.
    if (body.grid_offset[d] < grid_margin) start[d] -= body.cell_size;
    if (body.axisymmetric() && d == grid.radial_axis()) start[d] = 0;
    const double cells = (max[d] - start[d]) / body.cell_size + grid_margin;
    if (!(cells < 20000))
      throw InputError(body.location, std::to_string(body.cell_size), "more than 20000 cells along one axis",
                       "a larger cell_size");
    grid.num_cells[d] = static_cast<int>(std::ceil(cells));
  }
  if (body.quadtree) {
    const int axis = grid.plane_strain;
    start[axis] = min[axis];
    grid.num_cells[axis] = 1;
    grid.slice = grid.cell_size;
    grid.middle = 0.5 * (min[axis] + max[axis]);
    grid.thickness = body.axisymmetric() ? 2 * pi * body.unit_radius : max[axis] - min[axis];
    grid.unit_radius = body.unit_radius;
  }
  grid.origin = body.grid_rotation * start;
  return grid;
}

std::vector<BodyModel> make_body_models(const Scene& scene) {
  check_slices(scene);
  std::vector<BodyModel> bodies(scene.bodies.size());
  std::vector<BodyOnGrid> on_grid(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    on_grid[b].grid = make_grid(scene.bodies[b]);
    naming_body(scene.bodies[b], [&] { put_on_grid(scene, static_cast<int>(b), on_grid[b]); });
  }
  set_slices(on_grid);
  std::vector<char> support_used(scene.supports.size()), load_used(scene.loads.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    BodyModel& model = bodies[b];
    model.spec = &scene.bodies[b];
    const auto& [solid, grid, dividers, tree] = on_grid[b];
    model.cut_cells = naming_body(*model.spec, [&, &s = solid, &g = grid, &d = dividers, &t = tree] {
      return make_cut_cells(s, g, d, scene.geometry, t);
    });
    model.slices = grid.slices();
    if (model.spec->plane_strain && !model.spec->quadtree) check_extruded(*model.spec, model.cut_cells);
    assign_conditions(scene, static_cast<int>(b), model, support_used, load_used);
    find_resultants(scene, static_cast<int>(b), model);
    measure_supported_faces(scene, static_cast<int>(b), model);
    set_loads(scene, scene.last_step(), model);
    measure_thickness(model);
    for (int e = 0; e < static_cast<int>(model.cut_cells.cells.size()); ++e)
      extend_box(model.cut_cells, e, model.low, model.high);
  }
  for (std::size_t s = 0; s < support_used.size(); ++s)
    if (!support_used[s] && !(scene.supports[s].implied && bodies[scene.supports[s].face.body].spec->quadtree))
      refuse_empty_face(scene, scene.supports[s].face);
  for (std::size_t l = 0; l < load_used.size(); ++l)
    if (!load_used[l]) refuse_empty_face(scene, scene.loads[l].face);
  for (const ProbeSpec& probe : scene.probes)
    if (probe.kind == ProbeSpec::Kind::face && BodyFace(probe.face.face, bodies[probe.body]).points().empty())
      refuse_empty_face(scene, probe.face);
  return bodies;
}

void set_loads(const Scene& scene, const StepSpec& step, BodyModel& model) {
  const double factor = step.loads;
  set_temperature(factor, model);
  model.boundary.conditions.clear();
  for (const PointConditions& key : model.conditions)
    model.boundary.conditions.push_back(make_condition(scene, model, key, step));
  if (has_body_force(*model.spec))
    model.boundary.body_force_at = [spec = model.spec, factor](const Vec3& x) {
      const Vec3 given(spec->body_force[0](x), spec->body_force[1](x), spec->body_force[2](x));
      return Vec3(factor * (given + spec->inertia.force(x)));
    };
}

double volume(const CutCells& cc) {
  double sum = 0;
  for (int e = 0; e < static_cast<int>(cc.cells.size()); ++e) sum += cc.volume(e);
  return sum;
}

double stabilising_modulus(const Material& material) {
  const auto p_wave = [](double nu) { return (1 - nu) / ((1 + nu) * (1 - 2 * nu)); };
  return material.youngs_modulus * std::max(1.0, p_wave(material.poisson_ratio) / p_wave(0.3));
}

double support_modulus(const Scene& scene, const BodySpec& body) {
  if (!body.rigid()) return stabilising_modulus(body.material);
  double stiffest = 0;
  for (const BodySpec& other : scene.bodies)
    if (!other.rigid()) stiffest = std::max(stiffest, stabilising_modulus(other.material));
  return stiffest;
}

double support_stiffness(const Scene& scene, const BodyModel& body, const SupportPoint& point) {
  if (point.implied) return 0;  // no term of the linear system
  if (point.spring > 0) return point.spring;
  const double kappa = (body.is_thin(point.cell) ? scene.solver.thin_kappa_factor : 1) * scene.solver.kappa;
  const double firm = body.spec->rigid() && !point.follows ? firm_on_rigid : 1;
  return firm * kappa * support_modulus(scene, *body.spec) / body.cut_cells.h(point.cell);
}

namespace {

/// Adds three points for each connected component of the body, with the area of its end, its centre and its second
/// moments: they hold its rigid motion as plane strain does. They need not lie in it. One end will do. Bodies of
/// revolution are held away from their axis as well.
void hold_one_layer(int support, int b, const BodyModel& body, const BodyFace& face,
                    std::vector<SupportPoint>& points) {
  const CutCells& cells = body.cut_cells;
  const int axis = cells.grid.plane_strain;
  const Vec3 direction = Vec3::Unit(axis), up = Vec3::Unit((axis + 1) % 3), across = Vec3::Unit((axis + 2) % 3);
  std::vector<double> area(cells.cells.size(), 0.0);
  if (body.spec->quadtree)  // it has no ends
    for (int cell = 0; cell < static_cast<int>(area.size()); ++cell)
      area[cell] = cells.volume_fraction(cell) * std::pow(cells.h(cell), 2);
  for (const int p : face.points())
    if (!body.spec->quadtree) area[cells.boundary.cell[p]] += body.area(p);
  int count = 0;
  const std::vector<int> component_of_cell = find_connected_components(cells, count);
  struct Component {
    int cell = -1;
    double area = 0;
    Vec3 first = Vec3::Zero();  ///< moments about the corner of the body, m^3 and m^4
    Mat3 second = Mat3::Zero();
  };
  std::vector<Component> components(count);
  for (int cell = 0; cell < static_cast<int>(area.size()); ++cell) {
    Component& component = components[component_of_cell[cell]];
    component.cell = cell;
    const Vec3 x = global_position(cells, cell, Vec3::Zero()) - body.low;
    const double h = cells.h(cell);
    component.area += area[cell];
    component.first += area[cell] * x;
    component.second += area[cell] * (x * x.transpose() + h * h / 12 * Mat3::Identity());
  }
  for (const Component& component : components) {
    if (component.area == 0) continue;  // a sliver without a point on the end: nothing holds it
    const Vec3 centre = component.first / component.area;
    const Mat3 spread = component.second / component.area - centre * centre.transpose();
    // Half axes r of the plane spread = r r^T: Cholesky's factor of its two rows and columns.
    const double a = std::sqrt(up.dot(spread * up)), c = up.dot(spread * across) / a;
    const Vec3 r = a * up + c * across, s = std::sqrt(across.dot(spread * across) - c * c) * across;
    for (const auto& [x, y] :
         {std::pair(2.0, 0.0), std::pair(-1.0, std::sqrt(3.0)), std::pair(-1.0, -std::sqrt(3.0))}) {
      const Vec3 position =
          body.low + centre + std::sqrt(0.5) * (x * r + y * s);  // of mean zero and unit second moments
      SupportPoint point{support,           b,
                         component.cell,    cell_coordinates(cells, component.cell, cells.grid.to_grid(position)),
                         direction,         direction,
                         component.area / 3};
      point.implied = true;
      points.push_back(point);
      if (!body.spec->axisymmetric()) continue;
      point.direction = point.normal = Vec3::Unit(cells.grid.radial_axis());
      points.push_back(point);
    }
  }
}

/// Sine of the angle from which on directions differ (of parallel ones the cosine is 1 but for rounding).
const double independent = std::sqrt(2 * rounding);

/// Directions that are held at one point.
class HeldSpan {
 public:
  /// Adds a direction; returns false where those before hold it.
  bool add(const Vec3& direction) {
    Vec3 rest = direction;
    for (int k = 0; k < size_; ++k) rest -= rest.dot(basis_[k]) * basis_[k];
    if (rest.norm() < independent) return false;
    basis_[size_++] = rest.normalized();
    return true;
  }

 private:
  std::array<Vec3, 3> basis_;
  int size_ = 0;
};

/// Supports of one body that come before another one.
class EarlierSupports {
 public:
  EarlierSupports(const Scene& scene, const BodyModel& body, int support) : scene_(scene), body_(body) {
    for (int s = 0; s < support; ++s)
      if (const SupportSpec& spec = scene.supports[s];
          spec.face.body == scene.supports[support].face.body && !spec.implied)
        faces_.emplace_back(s, BodyFace(spec.face.face, body));
  }
  /// Returns what they hold at a boundary point, x (m) with the outward normal n; springs hold nothing.
  HeldSpan held_at_point(int p, const Vec3& x, const Vec3& n) const {
    HeldSpan span;
    for (const auto& [s, face] : faces_) {
      if (!face.contains(p)) continue;
      for (const HeldDirection& held : held_at(scene_, body_, s, x, n))
        if (held.stiffness == 0) span.add(held.direction);
    }
    return span;
  }

 private:
  const Scene& scene_;
  const BodyModel& body_;
  std::vector<std::pair<int, BodyFace>> faces_;
};

}  // namespace

std::vector<SupportPoint> make_support_points(const Scene& scene, const std::vector<BodyModel>& bodies,
                                              std::vector<std::string>* warnings) {
  std::vector<SupportPoint> points;
  for (int s = 0; s < static_cast<int>(scene.supports.size()); ++s) {
    const SupportSpec& support = scene.supports[s];
    const int b = support.face.body;
    const BodyModel& body = bodies[b];
    const BoundaryPoints& boundary = body.cut_cells.boundary;
    const BodyFace face(support.face.face, body);
    if (support.implied) {
      if (!support.face.face.normal_cone || (*support.face.face.normal_cone).first.sum() > 0)
        hold_one_layer(s, b, body, face, points);
      continue;
    }
    points.reserve(points.size() + face.points().size());
    const EarlierSupports earlier(scene, body, s);
    int repeated = 0;
    for (const int p : face.points()) {
      const Vec3 x = body.point(p), n = body.normal(p);
      SupportPoint point{
          s, b, boundary.cell[p], cell_coordinates(body.cut_cells, boundary.cell[p], boundary.position[p]),
          n, n, body.area(p)};
      HeldSpan span = earlier.held_at_point(p, x, n);
      for (const HeldDirection& held : held_at(scene, body, s, x, n)) {
        if (held.stiffness == 0 && !span.add(held.direction)) {
          ++repeated;  // twice the stress would act on it
          continue;
        }
        point.component = held.component;
        point.direction = held.direction;
        point.prescribed = point.value = held.value;
        point.spring = held.stiffness;
        points.push_back(point);
      }
    }
    if (repeated > 0 && warnings)
      warnings->push_back(
          fmt::format("the support of \"{}.{}\" repeats directions that are held already at {} of its points: the "
                      "reaction there is "
                      "told with those that came first",
                      body.spec->name, support.face.face.name, repeated));
  }
  points.shrink_to_fit();
  return points;
}

void each_force(const BodyModel& body, const UseForce& use) {
  const BoundaryPoints& boundary = body.cut_cells.boundary;
  for (int p = 0; p < static_cast<int>(boundary.size()); ++p) {
    const TractionCondition& condition = body.boundary.conditions[body.boundary.condition_of_point[p]];
    if (!condition.traction) continue;
    const Vec3 x = body.point(p);
    use(boundary.cell[p], cell_coordinates(body.cut_cells, boundary.cell[p], boundary.position[p]), x,
        body.area(p) * condition.traction(x, body.normal(p)));
  }
  if (body.boundary.body_force_at) each_body_force(body, body.boundary.body_force_at, use);
}

std::pair<Vec3, Vec3> resultants_of_volume(const BodyModel& body, const ForceAt& force, const Vec3& about) {
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  each_body_force(body, force, [&](int, const Vec3&, const Vec3& x, const Vec3& f) {
    sum += f;
    moment += (x - about).cross(f);
  });
  sum_around_axis(*body.spec, sum, &moment);
  return {body.slices * sum, body.slices * moment};
}

std::vector<double> make_load_vector(const std::vector<BodyModel>& bodies, const ElasticSystem& system,
                                     const Scales& scales) {
  std::vector<double> f(system.num_dofs(), 0.0);
  const double unit = scales.stress * scales.length * scales.length;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    each_force(bodies[b], [&](int cell, const Vec3& xi, const Vec3&, const Vec3& force) {
      const Vec3 local = bodies[b].cut_cells.grid.rotation.transpose() * force / unit;
      displacement_row(system.meshes[b].cell_nodes[cell], xi, local, [&](int dof, double share) { f[dof] += share; });
    });
  return f;
}

std::vector<Vec3> force_of_body(const std::vector<BodyModel>& bodies, const ElasticSystem& system, const Scales& scales,
                                const std::vector<double>& nodal_forces) {
  std::vector<Vec3> forces;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    Vec3 sum = Vec3::Zero();
    for (int n = mesh.first_node; n < mesh.first_node + mesh.num_nodes; ++n)
      sum += Eigen::Map<const Vec3>(&nodal_forces[dof_offset(n)]);
    forces.push_back(scales.stress * scales.length * scales.length * (bodies[b].cut_cells.grid.rotation * sum));
  }
  return forces;
}

}  // namespace cgcontact
