#include "core/bodies/cad_body.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/bodies/booleans.hpp"
#include "core/bodies/clipped_triangles.hpp"
#include "core/bodies/triangle_body.hpp"
#include "core/bodies/triangle_cells.hpp"
#include "core/cells/cell_tree.hpp"
#include "core/cells/grid.hpp"

namespace cgcontact {

namespace {

/// Fraction of a cell by which triangles may be off the surface.
constexpr double sag_of_cell = 0.01;
/// Boundary of pruned cells goes to leaves up to three cells of the level before away: in cells of the level.
constexpr int pruned_reach = 6;
/// Largest distance, in sags, from a point found on the surface to the point on the triangle that the search began at.
constexpr double near_sags = 4;
/// Nearer to the triangles than this, in sags, the exact surface decides what is inside.
constexpr double exact_within = 2;
constexpr double metres_per_unit = 1e-3;

std::vector<std::string> face_names(const CadModel& model) {
  std::vector<std::string> names;
  for (const CadFace& face : model.faces()) names.push_back(face.names.empty() ? "" : face.names.front());
  return names;
}

std::vector<int> patches(const CurvedTriangles& triangles) {
  std::vector<int> result;
  for (const CurvedTriangle& t : triangles.triangles) result.push_back(t.face);
  return result;
}

/// Weights a, b of corners 1, 2 at a point of a flat triangle.
Vec2 corner_weights(const TriangleSurface& surface, int triangle, const Vec3& x) {
  const Vec3& origin = surface.corner(triangle, 0);
  const Vec3 u = surface.corner(triangle, 1) - origin, v = surface.corner(triangle, 2) - origin, n = u.cross(v),
             y = x - origin;
  const double inverse = 1 / n.squaredNorm();
  return {n.dot(y.cross(v)) * inverse, n.dot(u.cross(y)) * inverse};
}

/// Point on the exact surface, in the coordinates of the body.
struct ExactFoot {
  Vec3 x, normal;
};

/// Returns the point of the exact surface nearest to x, searched from a point on a triangle; nullopt if it is not near
/// there.
std::optional<ExactFoot> exact_foot(const CadSurface& surface, int triangle, const Vec3& foot, const Vec3& x) {
  const CurvedTriangles& curved = surface.curved;
  const Similarity& motion = curved.placement;
  const CurvedFace& face = curved.faces[curved.triangles[triangle].face];
  const Vec2 at = corner_weights(surface.flat, triangle, foot);
  Vec2 uv = curved.parameters(triangle, at[0], at[1]);
  SurfaceJet jet;
  const Vec3 local = motion.rotation.transpose() * (x - motion.translation) / motion.scale;
  if (!project(*face.surface, local, uv, jet)) return std::nullopt;
  const Vec3 found = motion(jet.x);
  const double limit = near_sags * surface.sag + 0.5 * (x - foot).norm();
  if ((found - foot).norm() > limit) return std::nullopt;
  return ExactFoot{found, face.orientation * (motion.rotation * jet.xu.cross(jet.xv)).normalized()};
}

/// One face.
class CadPatch final : public SurfacePatch {
 public:
  CadPatch(std::shared_ptr<const CadSurface> surface, int face) : surface_(std::move(surface)), face_(face) {}

  Surface near(const Vec3& x) const override {
    const ExactFoot at = nearest(x);
    Surface plane;
    plane.point = at.x;
    plane.direction = at.normal;
    return plane;
  }
  Vec3 normal(const Vec3& x) const override { return nearest(x).normal; }

 private:
  /// On the surface of the face beyond its rim, too; at the tip of a cone and the like on the nearest triangle.
  ExactFoot nearest(const Vec3& x) const {
    const TriangleSurface::Foot foot = surface_->flat.nearest(x, face_);
    if (const auto exact = exact_foot(*surface_, foot.triangle, foot.point, x)) return *exact;
    return {foot.point, surface_->flat.normal(foot.triangle)};
  }

  std::shared_ptr<const CadSurface> surface_;
  int face_;
};

}  // namespace

CadSurface::CadSurface(CurvedTriangles triangles, const std::vector<std::string>& names,
                       const CurvedTriangles::Wanted& wanted)
    : curved(std::move(triangles)),
      flat(curved.points, curved.corners, patches(curved), names),
      sag(curved.largest_sag(wanted)) {}

CadBody::CadBody(const CadModel& model, double scale, double cell_size) : model_(model) {
  Similarity to_metres;
  to_metres.scale = scale;
  const CurvedTriangles triangles = model.triangles(sag_of_cell * cell_size / scale);
  surface_ = std::make_shared<const CadSurface>(triangles.moved(to_metres), face_names(model));
  set_surfaces();
}

CadBody::CadBody(const CadModel& model, std::shared_ptr<const CadSurface> surface)
    : model_(model), surface_(std::move(surface)) {
  set_surfaces();
}

void CadBody::set_surfaces() {
  surfaces_.resize(model_.faces().size());
  for (std::size_t f = 0; f < surfaces_.size(); ++f) {
    const CadFace& face = model_.faces()[f];
    Surface& surface = surfaces_[f];
    surface.names = face.names;
    if (face.kind == "plane") {
      surface.point = placement()(face.middle);
      surface.direction = placement().rotation * face.axis;
    } else {
      surface.kind = Surface::Kind::patch;
      surface.patch = std::make_shared<CadPatch>(surface_, static_cast<int>(f));
    }
  }
}

/// Another scale: cells of another size, to which the triangles are to be fine enough.
std::shared_ptr<const BodyGeometry> CadBody::transformed(const Mat3& rotation, const Vec3& translation,
                                                         double scale) const {
  CurvedTriangles moved = surface_->curved.moved({rotation, translation, scale});
  if (scale != 1) moved.refine(sag_of_cell);
  return std::shared_ptr<const BodyGeometry>(
      new CadBody(model_, std::make_shared<const CadSurface>(std::move(moved), face_names(model_))));
}

/// Elsewhere the triangles stay as large as the coarsest cells allow, or a ball on a plate would have as many as if all
/// of its cells were those of the contact zone.
std::shared_ptr<const BodyGeometry> CadBody::on_level(int level, const CellTree& tree) const {
  const double scale = std::ldexp(1.0, level);
  const Vec3 margin = Vec3::Constant(pruned_reach / scale + 4 * sag_of_cell);  // images bulge out of the boxes
  const auto wanted = [&](const Vec3& low, const Vec3& high) {
    return tree.is_refined_in(level - 1, low / scale - margin, high / scale + margin);
  };
  CurvedTriangles moved = surface_->curved.moved({Mat3::Identity(), Vec3::Zero(), scale});
  moved.refine(sag_of_cell, wanted);
  auto body = std::shared_ptr<CadBody>(
      new CadBody(model_, std::make_shared<const CadSurface>(std::move(moved), face_names(model_), wanted)));
  body->first_cell_ = Index3{max_index, max_index, max_index};
  body->last_cell_ = Index3{-max_index, -max_index, -max_index};
  tree.refined(level - 1).each([&](const Index3& divided) {
    for (int k = 0; k < 3; ++k) {
      body->first_cell_[k] = std::min(body->first_cell_[k], 2 * divided[k] - pruned_reach);
      body->last_cell_[k] = std::max(body->last_cell_[k], 2 * divided[k] + 1 + pruned_reach);
    }
  });
  return body;
}

std::shared_ptr<const BodyGeometry> CadBody::stretched(int, double, double) const {
  throw InputError("a CAD solid on refined grids in plane strain is not possible");
}

bool CadBody::bounding_box(Vec3& min, Vec3& max) const {
  min = surface_->flat.tree().min();
  max = surface_->flat.tree().max();
  return true;
}

/// From where the line meets the triangles; where it meets a triangle but not the surface near it (it grazes it), at
/// the triangle.
void CadBody::crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const {
  const CurvedTriangles& curved = surface_->curved;
  const Similarity& motion = curved.placement;
  const double slack = near_sags * surface_->sag / d.norm();
  surface_->flat.each_hit(x, d, reach + slack, [&](double t, int triangle) {
    const int f = curved.triangles[triangle].face;
    const CurvedFace& face = curved.faces[f];
    Crossing crossing{t, f, surface_->flat.normal(triangle)};
    if (!face.surface->is_plane()) {
      const Vec2 at = corner_weights(surface_->flat, triangle, x + t * d);
      Vec2 uv = curved.parameters(triangle, at[0], at[1]);
      SurfaceJet jet;
      double exact = t;
      const Vec3 local = motion.rotation.transpose() * (x - motion.translation) / motion.scale;
      if (meet(*face.surface, local, motion.rotation.transpose() * d / motion.scale, uv, exact, jet)) {
        const Vec3 normal = face.orientation * (motion.rotation * jet.xu.cross(jet.xv)).normalized();
        const double slope = std::max(std::abs(normal.dot(d)) / d.norm(), 0.1);
        if (std::abs(exact - t) * slope <= slack) crossing = {exact, f, normal};
      }
    }
    if (std::abs(crossing.t) <= reach) found.push_back(crossing);
  });
}

std::unique_ptr<CellSweep> CadBody::sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                                const LeafLevel& leaves) const {
  return std::make_unique<TriangleCells>(surface_->flat, &surface_->curved, grid.num_cells, dividers, order, leaves);
}

void CadBody::boundary_points(const Index3& cell, const std::vector<char>& selected, const std::vector<Plane>& dividers,
                              int order, int owner, BoundaryPoints& points) const {
  triangle_boundary_points(surface_->flat, &surface_->curved, triangles_near_cell(surface_->flat, cell), cell, selected,
                           dividers, order, owner, points);
}

CellEstimate CadBody::estimate_cells(const Grid& grid, double max_cells) const {
  return estimate_triangle_cells(surface_->flat, grid, max_cells);
}

std::vector<int> CadBody::surfaces_near(const Vec3& centre, double half_size, double slack,
                                        const std::vector<int>&) const {
  return patches_near(surface_->flat, centre, half_size, slack + surface_->sag);
}

double CadBody::signed_distance(const Vec3& x) const {
  const TriangleSurface::Foot foot = surface_->flat.nearest(x);
  const double side = (x - foot.point).dot(foot.normal) < 0 ? -1 : 1;
  const double distance = side * foot.distance;
  if (foot.distance > exact_within * surface_->sag || surface_->curved.is_plane(foot.triangle)) return distance;
  const auto exact = exact_foot(*surface_, foot.triangle, foot.point, x);
  return exact ? (x - exact->x).dot(exact->normal) : distance;
}

void CadBody::each_facet_in_cell(const UseFacet& use) const {
  for (int t = 0; t < static_cast<int>(num_facets()); ++t)
    each_cell_of_triangle(
        surface_->flat, t,
        [&](int axis, const Index3& cell) {
          const int at = std::max(cell[axis], first_cell_[axis]);
          return at <= last_cell_[axis] ? at : max_index;
        },
        [&](const Index3& cell, const SurfacePolygon& polygon) {
          use(cell, surface_->flat.patch(t), polygon.x.data(), polygon.n);
        });
}

const CadBody* as_cad(const Solid& solid) { return dynamic_cast<const CadBody*>(&solid.geometry()); }

namespace {

/// Expression of surfaces as a CAD model, as far as a ball (m) reaches. Its lengths are metres too.
CadModel model_of(const CsgBody& body, const Vec3& centre, double radius) {
  std::vector<CadModel> stack;
  const CadModel everything = CadModel::inner_side(
      [&] {
        Surface ball;
        ball.kind = Surface::Kind::sphere;
        ball.point = centre;
        ball.radius = 2 * radius;
        return ball;
      }(),
      centre, radius);
  const auto combine = [&](CadModel::Operation operation) {
    const CadModel b = stack.back();
    stack.pop_back();
    stack.back() = CadModel::combine(operation, stack.back(), {}, b, {});
  };
  for (const BooleanOp& step : body.expression()) {
    switch (step.kind) {
      case BooleanOp::Kind::surface:
        stack.push_back(CadModel::inner_side(body.surfaces()[step.surface], centre, radius));
        break;
      case BooleanOp::Kind::complement_surface:
        stack.push_back(everything);
        stack.push_back(CadModel::inner_side(body.surfaces()[step.surface], centre, radius));
        combine(CadModel::Operation::subtract);
        break;
      case BooleanOp::Kind::unite:
        combine(CadModel::Operation::unite);
        break;
      case BooleanOp::Kind::intersect:
        combine(CadModel::Operation::intersect);
        break;
      case BooleanOp::Kind::subtract:
        combine(CadModel::Operation::subtract);
        break;
      case BooleanOp::Kind::empty:
        throw InputError(std::string("one of the shapes is empty"));
    }
  }
  return stack.back();
}

}  // namespace

std::optional<Solid> combine_cad(BooleanOp::Kind op, const Solid& a, const Solid& b, double cell_size) {
  const CadBody *cad_a = as_cad(a), *cad_b = as_cad(b);
  if (!cad_a && !cad_b) return std::nullopt;
  if ((!cad_a && !as_csg(a)) || (!cad_b && !as_csg(b))) return std::nullopt;
  const auto [low, high] = box_around(a, b);
  // In mm: OpenCASCADE's tolerances are lengths.
  const Mat3 same = Mat3::Identity();
  const Vec3 none = Vec3::Zero();
  const double to_mm = 1 / metres_per_unit, radius = 2 * to_mm * (high - low).norm();
  const Vec3 centre = to_mm * (low + high) / 2;
  const auto operand = [&](const Solid& solid, const CadBody* cad, Similarity& placement) {
    placement = {};
    if (!cad) {
      const Solid large = solid.transformed(same, none, to_mm);
      return model_of(*as_csg(large), centre, radius);
    }
    Similarity enlarge;
    enlarge.scale = to_mm;
    placement = enlarge.after(cad->placement());
    return cad->model();
  };
  Similarity placement_a, placement_b;
  const CadModel first = operand(a, cad_a, placement_a), second = operand(b, cad_b, placement_b);
  const CadModel::Operation operation = op == BooleanOp::Kind::unite       ? CadModel::Operation::unite
                                        : op == BooleanOp::Kind::intersect ? CadModel::Operation::intersect
                                                                           : CadModel::Operation::subtract;
  return Solid(std::make_shared<CadBody>(CadModel::combine(operation, first, placement_a, second, placement_b),
                                         metres_per_unit, cell_size));
}

}  // namespace cgcontact
