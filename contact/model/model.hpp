/// Scene on its grids: one BodyModel per body with cut cells, faces resolved to boundary points, supports and loads.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "contact/model/held_directions.hpp"
#include "core/scene/scene.hpp"
#include "kernels/operator/system.hpp"
#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/patches.hpp"

namespace cgcontact {

/// Supports and loads whose faces contain a boundary point.
struct PointConditions {
  std::vector<int> supports, loads;  ///< indices into the scene's
  bool operator<(const PointConditions& o) const { return std::tie(supports, loads) < std::tie(o.supports, o.loads); }
};

/// Returns the volume of a body, unit of the grid coordinates.
double volume(const CutCells& cut_cells);

/// One body on its grid.
struct BodyModel {
  const BodySpec* spec = nullptr;
  CutCells cut_cells;
  BoundaryData boundary;
  std::vector<PointConditions> conditions;  ///< what boundary.conditions are made of
  std::map<int, FaceTraction> resultants;   ///< of the scene's loads that are given as force and moment
  std::map<int, SupportedFace> supported;   ///< of the scene's supports about axes and by springs
  Mat3 expansion = Mat3::Zero();  ///< strain of the body by itself in the present step, as far as it is free to: global
  Sym3 held_back = Sym3::Zero();  ///< Pa, stress by the rest of that strain (plane strain holds it back), global axes
  double thickness = 0;           ///< twice the volume over the area, unit of the grid coordinates
  double free_thickness = 0;      ///< the same over the area that no support holds
  double slices = 1;              ///< Grid::slices
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);  ///< box around the cells, m
  /// Returns whether the body is less than two cells thick, of that cell's size.
  bool is_thin(int cell) const { return thickness < 2 * std::ldexp(1.0, -cut_cells.level(cell)); }
  Vec3 point(int boundary_point) const { return cut_cells.grid.to_global(cut_cells.boundary.position[boundary_point]); }
  Vec3 normal(int boundary_point) const { return cut_cells.grid.rotation * cut_cells.boundary.normal[boundary_point]; }
  /// Returns m^2; on a quadtree of the slice.
  double area(int boundary_point) const {
    return cut_cells.boundary.weight[boundary_point] * cut_cells.grid.cell_size * cut_cells.grid.cell_size;
  }
  const std::vector<std::string>& surface_names(int boundary_point) const {
    return cut_cells.solid.surfaces()[cut_cells.boundary.surface[boundary_point]].names;
  }
};

/// Takes two opposite corners of a cell into a box, m.
void extend_box(const CutCells& cut_cells, int cell, Vec3& low, Vec3& high);

/// Returns the traction that gives a load of the scene its force and moment; zero for loads without.
FaceTraction resultant_of(const BodyModel& body, int load);

/// Returns the held directions of a support at x (m) with the outward normal n, global axes.
std::vector<HeldDirection> held_at(const Scene& scene, const BodyModel& body, int support, const Vec3& x,
                                   const Vec3& n);

/// A named face on one body's boundary points; the names are compared once.
class BodyFace {
 public:
  BodyFace(const FaceSpec& face, const BodyModel& body) : face_(face), body_(body) {
    for (const Surface& s : body.cut_cells.solid.surfaces()) selected_.push_back(face.selects(s.names));
  }
  /// Returns all points.
  std::vector<int> points() const {
    std::vector<int> all;
    for (int p = 0; p < static_cast<int>(body_.cut_cells.boundary.size()); ++p)
      if (contains(p)) all.push_back(p);
    return all;
  }
  bool contains(int boundary_point) const {
    if (!selected_[body_.cut_cells.boundary.surface[boundary_point]]) return false;
    if (!face_.box && !face_.normal_cone) return true;
    const BoundaryPoints& points = body_.cut_cells.boundary;
    const Grid& grid = body_.cut_cells.grid;
    return face_.contains(grid.to_global(points.position_of_facet(boundary_point)),
                          grid.rotation * points.normal_of_facet(boundary_point));
  }

 private:
  const FaceSpec& face_;
  const BodyModel& body_;
  std::vector<char> selected_;
};

/// Modulus of the stabilisation of supports and contact, Pa: E up to nu = 0.3, beyond that in proportion to the P-wave
/// modulus lambda + 2 mu, which scales the normal traction that the outer iteration lags (docs/decisions.md).
double stabilising_modulus(const Material& material);
/// Returns the same for supports: of a rigid body that of the stiffest elastic one.
double support_modulus(const Scene& scene, const BodySpec& body);

/// One constrained direction at one boundary point of a support.
struct SupportPoint {
  int support = -1;  ///< index into Scene::supports; -1: holds a motion that no load drives (free_motion.hpp)
  int body = 0, cell = 0;
  Vec3 xi;                ///< cell coordinates
  Vec3 direction;         ///< unit, global axes
  Vec3 normal;            ///< outward, global axes
  double weight = 0;      ///< m^2
  double prescribed = 0;  ///< displacement along the direction, m
  double value = 0;       ///< the same in the present step, m
  bool implied = false;   ///< as its support is: for the search for free motions, no term of the linear system
  bool follows = false;   ///< value becomes the displacement in every outer iteration: no force in the end
  bool holds_along_surface = false;  ///< holds a body along surfaces (contact/solve/floating/tangential_drift.hpp)
  Held component = Held::normal;
  double spring = 0;  ///< Pa/m; 0: held
};

/// Returns Pa/m: that of the point's spring, or kappa E/h with the stabilising modulus. The scene's kappa is the
/// contact's. On a body about one cell thick that is held on both sides the outer iteration contracts like 2.7 / kappa:
/// three times stiffer there (docs/decisions.md). Rigid bodies: firm_on_rigid.
double support_stiffness(const Scene& scene, const BodyModel& body, const SupportPoint& point);

/// Makes the grid of a body as its specification asks: offset, rotation, as many cells as the solid's bounding box
/// needs.
Grid make_grid(const BodySpec& body);

/// Sets tractions, body forces and temperature of the scene, all times a factor, as boundary data of a body.
void set_loads(const Scene& scene, const StepSpec& step, BodyModel& model);

/// Makes cut cells and faces of all bodies. Throws InputError (empty body, a face that selects nothing, ...).
std::vector<BodyModel> make_body_models(const Scene& scene);

/// Returns the constrained directions of all supports at their points. What is held there already is left
/// out: the stress would act on it twice; a warning tells where.
std::vector<SupportPoint> make_support_points(const Scene& scene, const std::vector<BodyModel>& bodies,
                                              std::vector<std::string>* warnings = nullptr);

/// Calls use(cell, xi, x, force) for the points of all tractions and body forces of
/// the present step; x in m, force in N, global axes.
void each_force(const BodyModel& body,
                const std::function<void(int cell, const Vec3& xi, const Vec3& x, const Vec3& force)>& use);

/// Returns force (N) and moment (N m) about a point (m) of a force per volume (N/m^3), integrated as those of
/// each_force.
std::pair<Vec3, Vec3> resultants_of_volume(const BodyModel& body, const std::function<Vec3(const Vec3& x)>& force,
                                           const Vec3& about);

/// Returns consistent nodal forces of tractions, pressures and body forces, units Scales::stress * Scales::length^2.
std::vector<double> make_load_vector(const std::vector<BodyModel>& bodies, const ElasticSystem& system,
                                     const Scales& scales);

/// Returns the resultant of nodal forces (units of make_load_vector) on each body, N, global axes.
std::vector<Vec3> force_of_body(const std::vector<BodyModel>& bodies, const ElasticSystem& system, const Scales& scales,
                                const std::vector<double>& nodal_forces);

}  // namespace cgcontact
