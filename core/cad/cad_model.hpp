/// Solids of CAD files (STEP, IGES, BREP) by OpenCASCADE, of which no header appears here. Lengths of the model in mm,
/// as OpenCASCADE has them, unless in the coordinates of a Similarity.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/cad/curved_triangles.hpp"
#include "core/geometry/surface.hpp"

namespace cgcontact {

struct ProfileEdge;
struct ProfileFrame;

struct CadFace {
  std::string name;                          ///< in the file, "" if it has none
  std::optional<std::array<int, 3>> colour;  ///< red, green, blue, 0 to 255
  std::string kind;                          ///< plane, cylinder, cone, sphere, torus, other
  double area = 0;                           ///< mm^2
  double radius = 0;                         ///< mm: cylinder, sphere, tube of a torus
  double ring_radius = 0;                    ///< mm: torus
  double half_angle = 0;                     ///< radians: cone
  Vec3 middle = Vec3::Zero();                ///< mm, centroid of the face
  Vec3 axis = Vec3::Zero();                  ///< unit: outward normal of a plane, axis of the others
  std::vector<std::string> names;            ///< "part.face": its name in the scene
};

/// Returns the kinds that a face may have.
const std::vector<std::string>& cad_kinds();
/// Formats "radius 5 mm", "ring radius 30 mm, tube radius 10 mm", "half-angle 20 degrees"; empty: of a face of another
/// kind. `mm`: a millimetre in `unit`.
std::string cad_size_text(const CadFace& face, double mm, const std::string& unit);

/// One solid. Read-only, copies share it.
class CadModel {
 public:
  struct Shape;  ///< OpenCASCADE's
  CadModel(std::shared_ptr<const Shape> shape, std::vector<CadFace> faces);

  const Shape& shape() const { return *shape_; }
  const std::vector<CadFace>& faces() const { return faces_; }
  double volume() const;  ///< mm^3
  double area() const;    ///< mm^2
  /// Returns corners of a box around it, mm.
  std::pair<Vec3, Vec3> box() const;
  /// Returns the model of the faces with these names, in their order.
  CadModel named(const std::vector<std::vector<std::string>>& names) const;
  /// Distances of a point from faces, mm.
  std::vector<double> distances(const std::vector<int>& faces, const Vec3& x) const;

  /// Returns triangles no farther than about `deflection` (mm) from the surface, closed. Throws InputError that names
  /// the face that could not be divided into triangles.
  CurvedTriangles triangles(double deflection) const;

  /// Boolean operations on two models, each moved to the same space first; the faces keep their names. Throws
  /// InputError if the result is no single body of one or more solids.
  enum class Operation { unite, intersect, subtract };
  static CadModel combine(Operation operation, const CadModel& a, const Similarity& placement_a, const CadModel& b,
                          const Similarity& placement_b);
  /// Makes the inner side of a plane, sphere or cylinder, of a cone the half that is in use, within a ball (mm).
  static CadModel inner_side(const Surface& surface, const Vec3& centre, double radius);
  /// Turns a profile (mm) about the second axis of its frame (mm), arcs anywhere; an arc that ends where it begins is a
  /// circle, `through` lies opposite. Faces have the names of their edges. Throws InputError.
  static CadModel revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame);
  /// Cuts a solid of revolution by the half-plane from the second axis of a frame (mm) to the side of the first: closed
  /// lines of lines and arcs (mm, in the frame), each with the number of its face or -1 on the axis. Throws InputError
  /// that names the face that is not of revolution, or whose section is another curve.
  struct SectionEdge {
    Vec2 from, to, through;
    int is_arc, face;
  };
  std::vector<std::vector<SectionEdge>> section(const ProfileFrame& frame) const;

 private:
  std::shared_ptr<const Shape> shape_;
  std::vector<CadFace> faces_;
};

/// Solid of a file.
struct CadSolid {
  std::string name;  ///< unique in the file
  CadModel model;
  std::string repair;    ///< "" or what was repaired on request
  std::string left_out;  ///< "" or what of the file is in no solid of it although it should be known of
};

struct CadReading {
  bool repair = false;
};

/// Reads all solids of a .step, .stp, .iges, .igs or .brep file where the assembly places them, in mm (.brep: in its
/// own units). Throws InputError: not to be read, none, open shells, invalid ones. OpenCASCADE may crash on a damaged
/// file, or never end: here and in CadModel it works in child processes with limits of time and memory; an InputError
/// says how one ended.
std::vector<CadSolid> read_cad(const std::string& file, const CadReading& reading);

/// Returns whether OpenCASCADE is in memory: it is loaded when it is first needed.
bool cad_is_loaded();

/// By the ending of its name: .step, .stp; .iges, .igs; .brep, .brp (which says nothing of units).
enum class CadFormat { step, iges, brep, unknown };
CadFormat cad_format(const std::string& file);

}  // namespace cgcontact
