/// Profiles of lines and arcs turned about an axis, by OpenCASCADE: those that are tori; and back, the sections of
/// solids of revolution.
#include <fmt/format.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Section.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRep_Tool.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Circ.hxx>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Lin.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>
#include <numeric>

#include "core/base/errors/errors.hpp"
#include "core/cad/cad_shape.hpp"
#include "core/geometry/profile.hpp"

namespace cgcontact {

namespace {

TopoDS_Edge edge_of(const ProfileEdge& edge, const ProfileFrame& frame) {
  const auto at = [&](const Vec2& x) { return point_of(frame.origin + x[0] * frame.first + x[1] * frame.second); };
  if (!edge.is_arc) return BRepBuilderAPI_MakeEdge(at(edge.from), at(edge.to));
  if (edge.from != edge.to)
    return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(edge.from), at(edge.through), at(edge.to)).Value());
  const gp_Ax2 axes(at((edge.from + edge.through) / 2), direction_of(frame.first.cross(frame.second)),
                    direction_of(frame.first));
  return BRepBuilderAPI_MakeEdge(gp_Circ(axes, (edge.through - edge.from).norm() / 2));
}

}  // namespace

CadModel CadModel::revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame) {
  try {
    BRepBuilderAPI_MakeWire wire;
    std::vector<TopoDS_Edge> edges;
    for (const ProfileEdge& edge : profile) {
      wire.Add(edge_of(edge, frame));
      if (!wire.IsDone())
        throw InputError(fmt::format("OpenCASCADE cannot join edge {} to those before it", edges.size() + 1));
      edges.push_back(wire.Edge());
    }
    const BRepBuilderAPI_MakeFace face(wire.Wire(), true);
    if (!face.IsDone()) throw InputError(std::string("OpenCASCADE finds no area in the profile"));
    BRepPrimAPI_MakeRevol turn(face.Face(), gp_Ax1(point_of(frame.origin), direction_of(frame.second)), true);
    TopExp_Explorer solids(turn.Shape(), TopAbs_SOLID);
    if (!solids.More()) throw InputError(std::string("OpenCASCADE makes no body of the profile"));
    TopoDS_Solid solid = TopoDS::Solid(solids.Current());
    BRepLib::OrientClosedSolid(solid);
    CadModel model = make_cad_model(solid);
    for (std::size_t k = 0; k < edges.size(); ++k)
      for (const TopoDS_Shape& made : turn.Generated(edges[k]))
        if (const int number = model.shape_->faces.FindIndex(made); number > 0)
          model.faces_[number - 1].names = {profile[k].face};
    return model;
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("OpenCASCADE cannot turn the profile: {}", failure.GetMessageString()));
  }
}

namespace {

/// Tells whether a surface is one around an axis; mm, radians.
bool is_around(const BRepAdaptor_Surface& surface, const gp_Ax1& axis) {
  constexpr double same_line = 1e-4, same_direction = 1e-6;
  const gp_Lin line(axis);
  const auto is_on = [&](const gp_Ax1& own) {
    return line.Distance(own.Location()) < same_line && own.Direction().IsParallel(axis.Direction(), same_direction);
  };
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      return surface.Plane().Axis().Direction().IsParallel(axis.Direction(), same_direction);
    case GeomAbs_Cylinder:
      return is_on(surface.Cylinder().Axis());
    case GeomAbs_Cone:
      return is_on(surface.Cone().Axis());
    case GeomAbs_Sphere:
      return line.Distance(surface.Sphere().Location()) < same_line;
    case GeomAbs_Torus:
      return is_on(surface.Torus().Axis());
    case GeomAbs_SurfaceOfRevolution:
      return is_on(surface.AxeOfRevolution());
    default:
      return false;
  }
}

/// OpenCASCADE's sections of surfaces that are none of its simple ones are splines, a fraction of their length away
/// from what they stand for.
constexpr double same_curve = 1e-6;
constexpr int samples_along = 8;

/// Tells whether a curve is a line. point_at: by the fraction of its parameter, 0 to 1.
template <class PointAt>
bool is_straight(const PointAt& point_at) {
  const Vec2 from = point_at(0), along = Vec2(point_at(1)) - from;
  const double length = along.norm();
  for (int k = 1; k < samples_along; ++k) {
    const Vec2 x = Vec2(point_at(double(k) / samples_along)) - from;
    if (!(std::abs(cross(along, x)) <= same_curve * length * length)) return false;
  }
  return length > 0;
}

/// Tells whether it is an arc of the circle through three of its points. precision: mm, of the section's own points.
template <class PointAt>
bool is_round(const PointAt& point_at, double precision) {
  const Vec2 from = point_at(0), through = point_at(0.25), to = point_at(0.625);
  const auto arc = arc_through(from, through, to);
  if (!arc) return false;
  const double tolerance = same_curve * std::max((through - from).norm(), (to - from).norm()) + precision;
  for (int k = 0; k <= samples_along; ++k)
    if (const Vec2 x = point_at(double(k) / samples_along);
        !(std::abs((x - arc->circle.centre).norm() - arc->circle.radius) <= tolerance))
      return false;
  return true;
}

}  // namespace

std::vector<CadModel::SectionEdge> section_edges(const CadModel& model, const ProfileFrame& frame) {
  try {
    const gp_Ax1 axis(point_of(frame.origin), direction_of(frame.second));
    const TopTools_IndexedMapOfShape& faces = model.shape().faces;
    double reach = 0;  // a half-plane is a face that is large enough
    for (const Vec3& corner : {model.box().first, model.box().second})
      reach = std::max(reach, 2 * ((corner - frame.origin).norm() + 1));
    for (int f = 1; f <= faces.Extent(); ++f)
      if (!is_around(BRepAdaptor_Surface(TopoDS::Face(faces(f))), axis))
        throw InputError(cad_face_text(model.faces()[f - 1], f) + " is not of revolution about the axis");
    const gp_Ax3 axes(point_of(frame.origin), direction_of(frame.first.cross(frame.second)), direction_of(frame.first));
    const TopoDS_Face half = BRepBuilderAPI_MakeFace(gp_Pln(axes), 0, reach, -reach, reach);
    BRepAlgoAPI_Section section(model.shape().solid, half, false);
    section.ComputePCurveOn1(false);
    section.Build();
    if (!section.IsDone()) throw InputError(std::string("OpenCASCADE cannot cut the solid"));
    std::vector<CadModel::SectionEdge> edges;
    const auto at = [&](const gp_Pnt& x) {
      const Vec3 d = Vec3(x.X(), x.Y(), x.Z()) - frame.origin;
      return Vec2(std::max(d.dot(frame.first), 0.0), d.dot(frame.second));
    };
    for (TopExp_Explorer i(section.Shape(), TopAbs_EDGE); i.More(); i.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(i.Current());
      const BRepAdaptor_Curve curve(edge);
      TopoDS_Shape face;
      int number = section.HasAncestorFaceOn1(edge, face) ? faces.FindIndex(face) : 0;
      const double first = curve.FirstParameter(), last = curve.LastParameter();
      const auto point_at = [&](double fraction) { return at(curve.Value(first + fraction * (last - first))); };
      const bool is_line = curve.GetType() == GeomAbs_Line || is_straight(point_at);
      const bool is_arc =
          !is_line && (curve.GetType() == GeomAbs_Circle || is_round(point_at, BRep_Tool::Tolerance(edge)));
      if (!is_line && !is_arc)
        throw InputError(fmt::format("{} has a section that is neither a line nor an arc",
                                     number > 0 ? cad_face_text(model.faces()[number - 1], number) : "a face"));
      if (number == 0) {  // where the seam of a face lies in the half-plane
        const gp_Pnt x = curve.Value(0.5 * (first + last));
        std::vector<int> all(faces.Extent());
        std::iota(all.begin(), all.end(), 0);
        const std::vector<double> distances = model.distances(all, Vec3(x.X(), x.Y(), x.Z()));
        number = 1 + static_cast<int>(std::min_element(distances.begin(), distances.end()) - distances.begin());
      }
      const int num_edges = is_arc ? 2 : 1;  // a circle has two halves
      for (int k = 0; k < num_edges; ++k)
        edges.push_back({point_at(double(k) / num_edges), point_at((k + 1.0) / num_edges),
                         point_at((k + 0.5) / num_edges), is_arc, number - 1});
    }
    return edges;
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("OpenCASCADE cannot cut the solid: {}", failure.GetMessageString()));
  }
}

}  // namespace cgcontact
