/// What the user describes: bodies, materials, grids, faces, supports, loads, contact. No grid is made yet.
/// All units are SI (m, N, Pa); all keys are documented in docs/scene.md.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/types.hpp"
#include "core/expressions/expression.hpp"
#include "core/geometry/solid.hpp"
#include "core/scene/face_traction.hpp"
#include "core/scene/scalar_field.hpp"
#include "core/settings/accuracy_options.hpp"
#include "core/settings/contact_options.hpp"
#include "core/settings/geometry_options.hpp"
#include "core/settings/output_options.hpp"
#include "core/settings/recovery_options.hpp"
#include "core/settings/result_options.hpp"
#include "core/settings/solver_options.hpp"

namespace cgcontact {

struct RepairedSurface;
class SizeField;

enum class Coordinate { x, y, z };
const std::vector<std::string>& coordinate_names();
/// Its name in scenes.
const std::string& name_of(Coordinate coordinate);

struct Material {
  double youngs_modulus = 0;  ///< Pa; infinite: that of a rigid body
  double poisson_ratio = 0;
  std::optional<double> density = {};       ///< kg/m^3
  std::optional<double> expansion = {};     ///< 1/K, of lengths
  std::optional<double> yield_stress = {};  ///< Pa
  bool modulus_has_units = false;           ///< the scene gives E with a unit
  bool is_rigid() const { return std::isinf(youngs_modulus); }
};

/// Forces per volume on a body that is accelerated, or turns steadily.
struct Inertia {
  Vec3 weight = Vec3::Zero();                        ///< N/m^3: density times acceleration of gravity
  double spin = 0;                                   ///< N/m^4: density times the square of the angular speed
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();  ///< m, unit: the axis of rotation
  bool unknown = false;  ///< of a rigid body without a density: it acts on the supports that must hold the body
  bool any() const { return !weight.isZero(0) || spin != 0; }
  /// N/m^3
  Vec3 force(const Vec3& x) const {
    const Vec3 r = x - centre;
    return weight + spin * (r - r.dot(axis) * axis);
  }
};

/// A named region of a body's boundary: the points that match every selector given.
struct FaceSpec {
  std::string name;
  std::vector<std::string> surfaces;                   ///< primitive faces, "primitive.face"; empty: any
  std::optional<std::pair<Vec3, Vec3>> box;            ///< points in [min, max], m
  std::optional<std::pair<Vec3, double>> normal_cone;  ///< unit axis, cosine of the half angle
  std::vector<Solid> owners;  ///< shapes of these faces where other shapes have faces on the same surfaces, m
  SourceLocation location;

  /// Does a boundary point lie on the face? `names`: names of the elementary surface; x in m and n in global axes.
  bool contains(const std::vector<std::string>& names, const Vec3& x, const Vec3& n) const {
    return selects(names) && contains(x, n);
  }
  /// Its two tests: the elementary surface; box and normal cone.
  bool selects(const std::vector<std::string>& names) const;
  bool contains(const Vec3& x, const Vec3& n) const;
};

/// Where a body's cells are to be smaller: no larger than `size` up to `distance` from a region, growing by `grading`
/// times the distance from there.
struct RefineSpec {
  enum class Kind { box, sphere, ring, face };
  Kind kind = Kind::sphere;
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< box, m
  Vec3 center = Vec3::Zero();                   ///< sphere, ring, m
  Vec3 axis = Vec3::UnitZ();                    ///< ring, of length 1
  double radius = 0;                            ///< sphere; of the ring's circle about its axis, m
  double tube_radius = 0;                       ///< ring: up to there from the circle, m
  FaceSpec face;                                ///< of the body
  double size = 0;                              ///< m
  double distance = 0;                          ///< m
  double grading = 0.5;
  SourceLocation location;
};

struct BodySpec {
  std::string name;
  Solid solid;  ///< global coordinates, m
  Material material;
  double cell_size = 0;  ///< m; of the largest cells. 0: chosen from the shape, with [accuracy] only
  std::vector<RefineSpec> refine;
  std::vector<std::shared_ptr<const SizeField>> sizes;         ///< as `refine`, from an earlier solution ([accuracy])
  double max_cells = std::numeric_limits<double>::infinity();  ///< a refined grid of surely more is refused at once
  std::optional<Coordinate> plane_strain;                      ///< nothing varies and nothing moves along this axis
  SourceLocation plane_strain_location;
  /// Largest radius in a scene of bodies of revolution (plane_strain is the axis across their half-plane), m; or 0
  double unit_radius = 0;
  bool quadtree = false;  ///< in plane strain with cells of several sizes: one layer of them on every level
  Vec3 grid_offset =
      Vec3::Zero();  ///< fraction of a cell by which the grid starts before the body's bounding box, [0,1)
  Mat3 grid_rotation = Mat3::Identity();
  std::array<Expression, 3> body_force;  ///< N/m^3
  Inertia inertia;                       ///< what acts on its mass
  double temperature = 0;                ///< K, change since it was free of stress
  bool plain_lengths = false;            ///< its shape has numbers without a unit
  std::vector<FaceSpec> faces;           ///< those declared; a primitive's own faces can be used by their names too
  std::vector<std::string> notes;        ///< on what was read from mesh files, one line each
  std::vector<std::string> warnings;     ///< the same for what the user should look at
  std::vector<std::shared_ptr<const RepairedSurface>> repairs;  ///< on request, of its mesh files
  SourceLocation location;

  /// Six unknowns instead of elasticity.
  bool rigid() const { return material.is_rigid(); }
  bool axisymmetric() const { return unit_radius > 0; }
  /// Returns the coordinate along the axis of revolution.
  int axis_of_revolution() const { return (static_cast<int>(*plane_strain) + 1) % 3; }
  /// Returns the axis along which nothing varies, if there is one.
  std::optional<int> axis_across() const {
    return plane_strain ? std::optional(static_cast<int>(*plane_strain)) : std::nullopt;
  }
  /// Returns whether x (m) is inside or on the boundary, within rounding.
  bool holds(const Vec3& x) const;
  /// Returns whether a point (m) of the face lies on shapes other than its owners.
  bool is_beside_owners(const FaceSpec& face, Vec3 x) const;
};

/// "body.face" resolved.
struct FaceRef {
  int body = -1;
  FaceSpec face;
  SourceLocation location;
};

/// Components of a displacement, as supports hold them.
enum class Held { x, y, z, normal, radial, tangential, axial };
constexpr int num_held = 7;
/// As in scenes.
const char* name_of(Held component);

/// Frictionless support: u . direction = value on the face, one entry per constrained direction; or springs along them.
struct SupportSpec {
  FaceRef face;
  bool symmetry = false;  ///< direction is the normal of the face, value 0
  bool implied = false;   ///< by the body: an end in plane strain, or the axis of revolution
  std::array<std::optional<Expression>, 3> displacement;  ///< m, components in global axes
  std::optional<Expression> normal_displacement;          ///< m, along the outward normal
  std::array<std::optional<Expression>, 3> cylindrical;   ///< m, radial, tangential, axial
  std::optional<Axis> axis;                               ///< of these; none: that of the face
  /// Springs to the ground along x, y, z and the normal: Pa/m, or N/m of the whole face (`of_face`); 0: none.
  std::array<double, 4> springs{0, 0, 0, 0};
  bool of_face = false;
  std::vector<double> steps;  ///< factors of what is prescribed, one for each step; empty: 1

  bool holds_normal() const { return symmetry || normal_displacement; }
  bool is_cylindrical() const { return cylindrical[0] || cylindrical[1] || cylindrical[2]; }
  bool is_elastic() const { return springs != std::array<double, 4>{0, 0, 0, 0}; }
  SourceLocation location;
};

struct LoadSpec {
  FaceRef face;
  std::array<Expression, 3> traction;  ///< Pa, global axes
  Expression pressure;                 ///< Pa, acts against the outward normal
  Vec3 force = Vec3::Zero();           ///< N, of the whole face, added to these
  Vec3 moment = Vec3::Zero();          ///< N m
  std::optional<Vec3> at;              ///< m, where the force acts; none: at the centroid of the face
  bool bearing = false;                ///< the force is that of a pressure on the half of a cylinder that faces it
  std::vector<double> steps;           ///< factors of the load, one for each step; empty: 1
  SourceLocation location;

  bool has_resultants() const { return !force.isZero(0) || !moment.isZero(0); }
  /// What is given per area and what gives the face its force and moment besides (`resulting`), Pa; n: outward normal.
  Vec3 traction_at(const Vec3& x, const Vec3& n, const FaceTraction& resulting) const {
    return Vec3(traction[0](x), traction[1](x), traction[2](x)) - pressure(x) * n + resulting.at(x, n);
  }
  /// axisymmetric: on a body of revolution, where a force along the axis has no moment about any point.
  FaceTraction resulting_traction(const FaceMoments& moments, bool axisymmetric) const {
    if (axisymmetric) return moments.with_resultants(force, Vec3::Zero(), moments.centroid());
    return bearing ? moments.with_bearing(force)
                   : moments.with_resultants(force, moment, at.value_or(moments.centroid()));
  }
};

/// What the moment of a pair's forces is taken about.
struct MomentSpec {
  Vec3 point = Vec3::Zero();  ///< m
  std::optional<Vec3> axis;   ///< of length 1
};

struct ContactSpec {
  std::string name;
  FaceRef first, second;          ///< with automatic pairs: FaceSpec that selects all points
  bool automatic = false;         ///< made by automatic = true: no error if the two bodies are out of reach
  bool bonded = false;            ///< tied in all directions for good, tension and shear too
  double friction = 0;            ///< Coulomb's coefficient; 0: none
  double interference = 0;        ///< m, overlap added to the geometric one (positive presses the bodies together)
  std::optional<double> preload;  ///< N, the normal force that the interference is chosen for
  /// m, points farther apart than this do not belong to the pair; 0: twice the larger cell
  double search_distance = 0;
  std::optional<MomentSpec> moment_about;
  SourceLocation location;
};

/// Where displacement and recovered stress are wanted.
struct ProbeSpec {
  enum class Kind { point, line, circle, face };
  std::string name;
  Kind kind = Kind::point;
  std::vector<Vec3> points;         ///< m; none: those on the boundary of the face
  std::vector<double> way;          ///< of each point: m from the beginning of the line, degrees on the circle
  FaceRef face;                     ///< of a face
  int body = -1;                    ///< index; -1: all bodies that hold a point
  std::vector<ScalarField> fields;  ///< without repetition
  std::vector<int> outside;         ///< points that no body holds
  SourceLocation location;
};

/// A plane along which the bodies are cut for a picture.
struct SectionSpec {
  std::string name;
  Vec3 point = Vec3::Zero();    ///< m
  Vec3 normal = Vec3::UnitX();  ///< of length 1, towards the viewer
  ScalarField field = ScalarField::von_mises;
  SourceLocation location;
};

/// Pressure along a line on a contact face, and what it is compared with.
struct ReferenceSpec {
  /// CSV file (first column: coordinate along the path, m; second: pressure, Pa) or empty
  std::string pressure_file;
  /// Stress on the contact face: CSV with y, then syy, szz, syz of the first and of the second body (plane strain)
  std::string stress_file;
  std::optional<Expression> pressure;     ///< Pa, function of x, y, z
  Coordinate coordinate = Coordinate::y;  ///< what the first column of the file is
  std::optional<double> force;            ///< N, total contact force of the first pair
  /// Exact stress of each body as expressions (xx, yy, zz, xy, yz, zx), for effectivity; empty: unknown
  std::vector<std::array<Expression, 6>> stress_of_body;
  std::vector<std::pair<std::string, Expression>> zones;  ///< name, expression that is non-zero inside the zone
  SourceLocation location;
};

/// What loads the bodies in one step, as fractions of what the scene says.
struct StepSpec {
  std::size_t number = 0;
  double loads = 1;          ///< tractions, pressures, forces, body forces, temperatures
  double displacements = 1;  ///< prescribed at supports
  double interference = 1;   ///< of all contacts; overlap of the geometry is always there
  double fraction = 1;       ///< of the way from the step before, for own factors; its end unless a step is divided

  /// What there is in this step of a load, and of what a support prescribes.
  double of(const LoadSpec& load) const { return loads * own(load.steps); }
  double of(const SupportSpec& support) const { return displacements * own(support.steps); }

 private:
  double own(const std::vector<double>& factors) const {
    if (factors.empty()) return 1;
    const double before = number > 0 ? factors.at(number - 1) : 0;
    return before + fraction * (factors.at(number) - before);
  }
};

struct Scene {
  std::string file, title;
  std::vector<BodySpec> bodies;
  std::vector<SupportSpec> supports;
  std::vector<LoadSpec> loads;
  std::vector<ContactSpec> contacts;
  std::vector<ProbeSpec> probes;
  std::vector<SectionSpec> sections;
  std::vector<StepSpec> steps;  ///< the last one is the scene itself; empty: that alone
  StepSpec last_step() const { return steps.empty() ? StepSpec() : steps.back(); }
  GeometryOptions geometry;
  ContactOptions contact;
  SolverOptions solver;
  RecoveryOptions recovery;
  ResultOptions results;
  AccuracyOptions accuracy;
  std::map<std::string, FaceRef> accuracy_faces;  ///< those that targets of `accuracy` name
  OutputOptions output;
  ReferenceSpec reference;  ///< at a contact force of 1 N, if it depends on that
  /// [reference] at a contact force in N (magnitude, first pair); empty if it does not depend on it
  std::function<ReferenceSpec(double)> reference_of_force;
  Constants parameters;  ///< values of [parameters], after --set

  /// The reference at the computed contact force, N; a force of zero is as good as none.
  ReferenceSpec reference_at(double contact_force) const;
};

}  // namespace cgcontact
