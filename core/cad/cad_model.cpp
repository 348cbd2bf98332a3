#include "core/cad/cad_model.hpp"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <GeomConvert.hxx>
#include <GeomLib_IsPlanarSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Precision.hxx>
#include <ShapeCustom_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors/errors.hpp"
#include "core/cad/cad_shape.hpp"

namespace cgcontact {

namespace {

/// Returns a plane whose axis is the normal of a surface in the middle of its used range; throws where that has none.
Handle(Geom_Surface) plane_along(const gp_Pln& plane, const BRepAdaptor_Surface& surface) {
  gp_Pnt x;
  gp_Vec u, v;
  surface.D1((surface.FirstUParameter() + surface.LastUParameter()) / 2,
             (surface.FirstVParameter() + surface.LastVParameter()) / 2, x, u, v);
  const gp_Dir axis = plane.Axis().Direction(), normal = u.Crossed(v);
  return new Geom_Plane(plane.Location(), axis.Dot(normal) > 0 ? axis : axis.Reversed());
}

/// Returns the simple surface that equals the free-form surface of a face within its tolerance; null if none.
Handle(Geom_Surface) simple_surface(const TopoDS_Face& face, const BRepAdaptor_Surface& surface) {
  const double tolerance = std::max(Precision::Confusion(), BRep_Tool::Tolerance(face));
  try {
    const Handle(Geom_Surface) trimmed = new Geom_RectangularTrimmedSurface(
        BRep_Tool::Surface(face), surface.FirstUParameter(), surface.LastUParameter(), surface.FirstVParameter(),
        surface.LastVParameter());
    const GeomLib_IsPlanarSurface planar(trimmed, tolerance);
    if (planar.IsPlanar()) return plane_along(planar.Plan(), surface);
    ShapeCustom_Surface search(GeomConvert::SurfaceToBSplineSurface(trimmed));
    const Handle(Geom_Surface) found = search.ConvertToAnalytical(tolerance, false);
    const auto plane = Handle(Geom_Plane)::DownCast(found);
    return plane.IsNull() ? found : plane_along(plane->Pln(), surface);
  } catch (const Standard_Failure&) {  // it has no normal or cannot be converted: it is of no simple kind
    return {};
  }
}

CadFace describe_face(const TopoDS_Face& face) {
  CadFace result;
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties, 1e-6);
  result.area = properties.Mass();
  result.middle = vector_of(properties.CentreOfMass().XYZ());
  const BRepAdaptor_Surface surface(face);
  GeomAdaptor_Surface shape(BRep_Tool::Surface(face));
  if (shape.GetType() > GeomAbs_Torus)
    if (const Handle(Geom_Surface) simple = simple_surface(face, surface); !simple.IsNull()) shape.Load(simple);
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  switch (shape.GetType()) {
    case GeomAbs_Plane: {
      result.kind = "plane";
      const gp_Pln plane = shape.Plane();
      result.axis = sign * (plane.Direct() ? 1 : -1) * vector_of(plane.Axis().Direction().XYZ());
      break;
    }
    case GeomAbs_Cylinder:
      result.kind = "cylinder";
      result.radius = shape.Cylinder().Radius();
      result.axis = vector_of(shape.Cylinder().Axis().Direction().XYZ());
      break;
    case GeomAbs_Cone:
      result.kind = "cone";
      result.half_angle = std::abs(shape.Cone().SemiAngle());
      result.axis = vector_of(shape.Cone().Axis().Direction().XYZ());
      break;
    case GeomAbs_Sphere:
      result.kind = "sphere";
      result.radius = shape.Sphere().Radius();
      break;
    case GeomAbs_Torus:
      result.kind = "torus";
      result.radius = shape.Torus().MinorRadius();
      result.ring_radius = shape.Torus().MajorRadius();
      result.axis = vector_of(shape.Torus().Axis().Direction().XYZ());
      break;
    default:
      result.kind = "other";
  }
  return result;
}

}  // namespace

std::string cad_face_text(const CadFace& face, int number) {
  std::string text = fmt::format("face {}", number);
  if (!face.name.empty()) text += fmt::format(" \"{}\"", printable(face.name));
  text += " (" + (face.kind == "other" ? std::string("free-form") : face.kind);
  if (const std::string sizes = cad_size_text(face, 1, "mm"); !sizes.empty()) text += " of " + sizes;
  return text + fmt::format(") at ({:.6g}, {:.6g}, {:.6g}) mm", face.middle[0], face.middle[1], face.middle[2]);
}

CadModel make_cad_model(const TopoDS_Shape& solid) {
  auto shape = std::make_shared<CadModel::Shape>();
  shape->solid = solid;
  TopExp::MapShapes(solid, TopAbs_FACE, shape->faces);
  std::vector<CadFace> faces;
  for (int f = 1; f <= shape->faces.Extent(); ++f) faces.push_back(describe_face(TopoDS::Face(shape->faces(f))));
  return CadModel(shape, faces);
}

double CadModel::volume() const {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape_->solid, properties, 1e-9);
  return properties.Mass();
}

double CadModel::area() const {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape_->solid, properties, 1e-9);
  return properties.Mass();
}

std::pair<Vec3, Vec3> CadModel::box() const {
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape_->solid, box, false, false);
  if (box.IsVoid()) return {Vec3::Zero(), Vec3::Zero()};
  return {vector_of(box.CornerMin().XYZ()), vector_of(box.CornerMax().XYZ())};
}

std::vector<double> CadModel::distances(const std::vector<int>& faces, const Vec3& x) const {
  const TopoDS_Vertex point = BRepBuilderAPI_MakeVertex(gp_Pnt(x[0], x[1], x[2])).Vertex();
  std::vector<double> result;
  for (const int face : faces) {
    const BRepExtrema_DistShapeShape search(point, shape_->faces(face + 1));
    result.push_back(search.IsDone() && search.NbSolution() > 0 ? search.Value()
                                                                : std::numeric_limits<double>::infinity());
  }
  return result;
}

}  // namespace cgcontact
