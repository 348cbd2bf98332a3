#include "contact/results/figures/zone_figures.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "contact/groups/indentation.hpp"
#include "contact/model/around_axis.hpp"
#include "contact/results/figures/hertz.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "recovery/face/symmetry_planes.hpp"

namespace cgcontact {
namespace {

/// Least length of the mean unit normal of a zone that is laid out on a plane (that of a spherical cap of 52 degrees).
constexpr double nearly_flat = 0.9;
/// Area over the root of both second moments (per area) of an ellipse and of a rectangle, and how near one has to be.
constexpr double of_ellipse = 4 * pi, of_rectangle = 12, near_shape = 0.25;
/// Cosine between planes of symmetry that are across each other; of curvatures, the larger one: no curvature.
constexpr double across = 1e-6, no_curvature = 1e-6;
/// Fraction of a body's size that is rounding; cells by which a face may miss its mirror image.
constexpr double same_position = 1e-6, mirror_tolerance = 0.01;
/// Half the width of the zone over the smallest radius of curvature up to which Hertz's half-spaces stand for bodies.
constexpr double max_width = 0.5;

/// Turns a direction to z.
Mat3 rotation_to(const Vec3& direction) { return rotation_between(direction, Vec3::UnitZ()); }

/// The zone of one pair, and how it goes on behind planes of symmetry.
class Zone {
 public:
  Zone(const SolvedState& state, const std::vector<ContactRow>& rows, const std::vector<PairFigures>& pairs, int pair)
      : state_(state), pair_(state.pairs[pair]), figures_(pairs[pair]) {
    for (const ContactRow& row : rows)
      if (row.pair == pair && row.touching && is_pressed(row, figures_.max_pressure)) rows_.push_back(&row);
    find_planes();
    lay_out();
  }

  /// Counts the equal sectors of the whole zone, those behind planes of symmetry included.
  int num_sectors() const { return askew_ ? 1 : 1 << planes_.size(); }

  const std::vector<SymmetryPlane>& reached_planes() const { return reached_; }

  ZoneFrame frame() const {
    ZoneFrame found;
    if (!askew_) found.planes = planes_;
    if (normal_.norm() > 0) found.normal = normal_;
    return found;
  }

  std::optional<ZoneExtent> extent() const {
    if (!flat_) return std::nullopt;
    ZoneExtent extent;
    const double shape = num_sectors() * figures_.area / std::sqrt(moment_[0] * moment_[1]);
    if (std::abs(shape - of_ellipse) < near_shape) extent.shape = ZoneExtent::Shape::round;
    if (std::abs(shape - of_rectangle) < near_shape) extent.shape = ZoneExtent::Shape::rectangular;
    const double factor = extent.shape == ZoneExtent::Shape::rectangular ? 3 : 4;
    for (int k = 0; k < 2; ++k) extent.half_axes[k] = std::sqrt(factor * moment_[k]);
    extent.directions = direction_;
    return extent;
  }

  std::optional<HertzFigures> hertz(double force) const {
    if (!flat_) return std::nullopt;
    if (body_of_revolution() && extent()->shape != ZoneExtent::Shape::round) return std::nullopt;  // a ring
    Mat3 curvature = Mat3::Zero();
    double min_radius = std::numeric_limits<double>::infinity();
    for (const int body : {pair_.primary, pair_.secondary}) {
      const auto surface = surface_of(body);
      if (!surface) return std::nullopt;
      curvature += curvature_of(*surface, body);
      if (surface->radius > 0)
        min_radius = std::min(min_radius, surface->radius * state_.bodies[body].cut_cells.grid.cell_size);
    }
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << direction_[0], direction_[1];
    const SymmetricEigen<2> solver(tangents.transpose() * curvature * tangents);
    const double least = solver.eigenvalues()[0], most = solver.eigenvalues()[1];
    if (!(most * min_radius > no_curvature) || least < -no_curvature * most) return std::nullopt;
    const double modulus =
        effective_modulus(state_.scene.bodies[pair_.primary].material, state_.scene.bodies[pair_.secondary].material);
    HertzFigures hertz;
    const double whole = num_sectors() * force;
    if (least > no_curvature * most) {
      hertz = hertz_point(whole, least, most, modulus);
    } else {
      const Vec3 along = tangents * solver.eigenvectors().col(0);
      const double length = std::sqrt(12 * along.dot(moments_ * along));  // of a rectangle
      hertz = hertz_line(whole / length, most, modulus);
    }
    if (std::max(hertz.b, hertz.a.value_or(0)) > max_width * min_radius) return std::nullopt;
    return hertz;
  }

 private:
  /// Those of the elastic body, if the other one is rigid and mirrored by them; else those that both bodies have.
  std::vector<SymmetryPlane> planes_of_pair() const {
    const BodyModel &a = state_.bodies[pair_.primary], &b = state_.bodies[pair_.secondary];
    std::vector<SymmetryPlane> of_a = symmetry_planes(a.cut_cells, a.boundary),
                               of_b = symmetry_planes(b.cut_cells, b.boundary);
    if (a.spec->rigid() == b.spec->rigid()) return common_planes(of_a, of_b, a.cut_cells.grid.cell_size);
    const BodyModel& rigid = a.spec->rigid() ? a : b;
    std::vector<SymmetryPlane> planes = a.spec->rigid() ? std::move(of_b) : std::move(of_a);
    planes.erase(std::remove_if(planes.begin(), planes.end(),
                                [&](const SymmetryPlane& plane) { return !mirrors(plane, rigid); }),
                 planes.end());
    return planes;
  }

  /// Returns whether a plane of symmetry of the elastic body completes the rigid one too, which needs no support: it
  /// ends at the plane, or goes on as the zone's mirror image.
  bool mirrors(const SymmetryPlane& plane, const BodyModel& rigid) const {
    const double size = longest_extent(rigid);
    Vec3 low, high;
    rigid.spec->solid.transformed(rotation_to(plane.normal), Vec3::Zero()).bounding_box(low, high);
    if (high[2] - plane.normal.dot(plane.point) <= same_position * size) return true;
    return std::all_of(rows_.begin(), rows_.end(), [&](const ContactRow* row) {
      if (&state_.bodies[row->body] != &rigid) return true;
      const Vec3 x = plane.image(row->x), aside = mirror_tolerance * row->larger_cell * plane.turned(row->normal);
      return rigid.spec->holds(x - aside) && !rigid.spec->holds(x + aside);
    });
  }

  /// Finds those that the zone reaches; of them those across each other divide it. The two sides of a slice do not, nor
  /// does anything that is turned about an axis.
  void find_planes() {
    for (const SymmetryPlane& plane : planes_of_pair())
      if (std::any_of(rows_.begin(), rows_.end(),
                      [&](const ContactRow* row) { return std::abs(plane.distance(row->x)) < row->larger_cell; }))
        reached_.push_back(plane);
    if (body_of_revolution()) return;
    for (const SymmetryPlane& plane : reached_) {
      int parallel = 0;
      for (const SymmetryPlane& other : reached_) {
        const double cosine = std::abs(plane.normal.dot(other.normal));
        parallel += cosine > 1 - across;
        askew_ |= cosine > across && cosine <= 1 - across;
      }
      if (parallel == 1) planes_.push_back(plane);
    }
  }

  /// Computes mean normal, centre and second moments per area, images included, which cancel what is not symmetric.
  void lay_out() {
    double area = 0;
    Vec3 normal = Vec3::Zero();
    for (const ContactRow* row : rows_) {
      area += row->weight;
      normal += (row->body == pair_.primary ? 1 : -1) * row->weight * row->normal;
      centre_ += row->weight * row->x;
    }
    if (!(area > 0) || askew_) return;
    normal /= area;
    centre_ /= area;
    if (const BodySpec* body = body_of_revolution()) {
      sum_around_axis(*body, normal);
      sum_around_axis(*body, centre_);
    }
    for (const SymmetryPlane& plane : planes_) {
      normal -= plane.normal.dot(normal) * plane.normal;
      centre_ -= plane.distance(centre_) * plane.normal;
    }
    if (normal.norm() < nearly_flat) return;
    normal_ = normal.normalized();
    for (const ContactRow* row : rows_)
      moments_ += row->weight / area * (row->x - centre_) * (row->x - centre_).transpose();
    for (const SymmetryPlane& plane : planes_) {
      const Mat3 mirror = Mat3::Identity() - 2 * plane.normal * plane.normal.transpose();
      moments_ = (moments_ + mirror * moments_ * mirror).eval() / 2;
    }
    if (const BodySpec* body = body_of_revolution()) {  // as much along all directions across the axis
      const Vec3 e = Vec3::Unit(body->axis_of_revolution());
      const double along = e.dot(moments_ * e), other = (moments_.trace() - along) / 2;
      moments_ = other * Mat3::Identity() + (along - other) * e * e.transpose();
    } else if (const Grid& grid = state_.bodies[pair_.primary].cut_cells.grid; grid.is_quadtree()) {
      const Vec3 e = Vec3::Unit(grid.plane_strain);  // its rows lie in the plane in the middle
      moments_ += grid.thickness * grid.thickness / 12 * e * e.transpose();
    }
    const Vec3 first = normal_.unitOrthogonal();
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << first, normal_.cross(first);
    const SymmetricEigen<2> solver(tangents.transpose() * moments_ * tangents);
    for (int k = 0; k < 2; ++k) {
      moment_[k] = solver.eigenvalues()[1 - k];
      direction_[k] = tangents * solver.eigenvectors().col(1 - k);
      int largest = 0;
      direction_[k].cwiseAbs().maxCoeff(&largest);
      if (direction_[k][largest] < 0) direction_[k] = -direction_[k];
    }
    flat_ = moment_[1] > 0;
  }

  /// The quadric on which all of the zone lies on that body (grid coordinates), or none.
  std::optional<Surface> surface_of(int body) const {
    const CutCells& cells = state_.bodies[body].cut_cells;
    std::set<int> found;
    for (const ContactRow* row : rows_)
      if (row->body == body)
        found.insert(cells.solid.surface_at(cells.grid.to_grid(row->x), cells.grid.rotation.transpose() * row->normal));
    if (found.size() != 1 || *found.begin() < 0) return std::nullopt;
    const Surface& surface = cells.solid.surfaces()[*found.begin()];
    using Kind = Surface::Kind;
    if (surface.kind != Kind::plane && surface.kind != Kind::sphere && surface.kind != Kind::cylinder)
      return std::nullopt;
    return surface;
  }

  /// 1/m, convex positive; on the tangent plane.
  Mat3 curvature_of(const Surface& surface, int body) const {
    if (surface.kind == Surface::Kind::plane) return Mat3::Zero();
    const Grid& grid = state_.bodies[body].cut_cells.grid;
    const Vec3 outward = (body == pair_.primary ? 1 : -1) * normal_;
    const Vec3 gradient = grid.rotation * surface.gradient(grid.to_grid(centre_));
    Mat3 bent = Mat3::Identity() - normal_ * normal_.transpose();
    if (surface.kind == Surface::Kind::cylinder && !body_of_revolution()) {  // the section of a ball
      const Vec3 axis = grid.rotation * surface.direction;
      bent -= axis * axis.transpose();
    }
    return (gradient.dot(outward) > 0 ? 1 : -1) / (surface.radius * grid.cell_size) * bent;
  }

  /// nullptr: it is none.
  const BodySpec* body_of_revolution() const {
    const BodySpec& body = *state_.bodies[pair_.primary].spec;
    return body.axisymmetric() ? &body : nullptr;
  }

  const SolvedState& state_;
  const ContactPair& pair_;
  const PairFigures& figures_;
  std::vector<const ContactRow*> rows_;
  std::vector<SymmetryPlane> reached_, planes_;  // by the zone; those that divide it
  bool askew_ = false;  ///< planes that are neither parallel nor across: their images are not counted
  bool flat_ = false;
  Vec3 centre_ = Vec3::Zero();
  Vec3 normal_ = Vec3::Zero();  ///< outward of the primary body
  Mat3 moments_ = Mat3::Zero();
  double moment_[2] = {0, 0};  ///< m^2, descending
  std::array<Vec3, 2> direction_{Vec3::Zero(), Vec3::Zero()};
};

MomentAbout moment_about(const MomentSpec& spec, const PairFigures& pair) {
  MomentAbout moment;
  moment.point = spec.point;
  moment.axis = spec.axis;
  moment.on_first = pair.moment_on_first - spec.point.cross(pair.force_on_first);
  moment.on_second = pair.moment_on_second - spec.point.cross(pair.force_on_second);
  if (spec.axis) {
    moment.about_axis_first = spec.axis->dot(moment.on_first);
    moment.about_axis_second = spec.axis->dot(moment.on_second);
  }
  return moment;
}

Vec3 mean_normal(const ContactPair& pair, std::size_t number) {
  const ContactGroup& group = pair.groups[number];
  Vec3 normal = Vec3::Zero();
  for (int q = group.first_point; q < group.last_point; ++q)
    normal += pair.points.weight(q) / group.area * pair.points.normal(q);
  return normal;
}

}  // namespace

ZoneFrame frame_of_zone(const SolvedState& state, const std::vector<ContactRow>& rows,
                        const std::vector<PairFigures>& pairs, int pair) {
  return Zone(state, rows, pairs, pair).frame();
}

void set_zone_figures(const SolvedState& state, const std::vector<ContactRow>& rows, std::vector<PairFigures>& pairs) {
  const double unit = state.scales.stress * state.scales.length * state.scales.length;
  std::size_t group = 0;
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const ContactPair& pair = state.pairs[k];
    PairFigures& figures = pairs[k];
    const std::size_t first = group;
    group += pair.groups.size();
    if (pair.spec->moment_about) figures.zone.moment = moment_about(*pair.spec->moment_about, figures);
    if (!(figures.area > 0)) continue;
    if (pair.bonded()) {
      double force = 0;
      for (std::size_t g = 0; g < pair.num_surface_groups(); ++g)
        force += force_of_surface_group(pair, &state.outer.group_force[first], g).dot(mean_normal(pair, g));
      figures.zone.normal_force = force * state.bodies[pair.primary].slices * unit;
    }
    figures.zone.mean_pressure = figures.zone.normal_force / figures.area;
    if (pair.bonded()) continue;
    const Zone zone(state, rows, pairs, static_cast<int>(k));
    figures.zone.sectors = zone.num_sectors();
    figures.zone.planes = zone.reached_planes();
    figures.zone.extent = zone.extent();
    figures.zone.hertz = zone.hertz(figures.zone.normal_force);
  }
}

}  // namespace cgcontact
