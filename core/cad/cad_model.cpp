#include "core/cad/cad_model.hpp"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_Surface.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/errors.hpp"
#include "core/cad/cad_shape.hpp"

namespace cgcontact {

namespace {

constexpr double angle_between_triangles = 0.35;  // radians, of the mesher: 20 degrees
constexpr double area_tolerance = 1e-4;           // relative: a face that its triangles miss more of is not covered
constexpr int finer_attempts = 4;
constexpr double gap_factor = 1e3;  // a face's corners may be so many tolerances of its edges off its surface

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

class OcctSurface final : public ParametricSurface {
 public:
  explicit OcctSurface(const Handle(Geom_Surface) & surface) : surface_(surface) {
    plane_ = surface->IsKind(STANDARD_TYPE(Geom_Plane));
    surface->Bounds(min_[0], max_[0], min_[1], max_[1]);
    for (int k = 0; k < 2; ++k) {
      const bool periodic = k == 0 ? surface->IsUPeriodic() : surface->IsVPeriodic();
      if (periodic) {
        min_[k] = -std::numeric_limits<double>::infinity();
        max_[k] = -min_[k];
      }
    }
  }
  bool is_plane() const override { return plane_; }
  void first(const Vec2& uv, SurfaceJet& jet) const override {
    gp_Pnt p;
    gp_Vec u, v;
    surface_->D1(uv[0], uv[1], p, u, v);
    jet.x = vec(p.XYZ());
    jet.xu = vec(u.XYZ());
    jet.xv = vec(v.XYZ());
  }
  void second(const Vec2& uv, SurfaceJet& jet) const override {
    gp_Pnt p;
    gp_Vec u, v, uu, vv, both;
    surface_->D2(uv[0], uv[1], p, u, v, uu, vv, both);
    jet.x = vec(p.XYZ());
    jet.xu = vec(u.XYZ());
    jet.xv = vec(v.XYZ());
    jet.xuu = vec(uu.XYZ());
    jet.xvv = vec(vv.XYZ());
    jet.xuv = vec(both.XYZ());
  }
  Vec2 clamped(const Vec2& uv) const override { return uv.cwiseMax(min_).cwiseMin(max_); }

 private:
  Handle(Geom_Surface) surface_;
  bool plane_;
  Vec2 min_, max_;
};

class OcctCurve final : public PlaneCurve {
 public:
  explicit OcctCurve(const Handle(Geom2d_Curve) & curve) : curve_(curve) {}
  Vec2 at(double t) const override {
    const gp_Pnt2d p = curve_->Value(t);
    return {p.X(), p.Y()};
  }

 private:
  Handle(Geom2d_Curve) curve_;
};

/// The surface of a face where the face is, without the trimming that OpenCASCADE puts around some.
Handle(Geom_Surface) surface_of(const TopoDS_Face& face) {
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  while (surface->IsKind(STANDARD_TYPE(Geom_RectangularTrimmedSurface)))
    surface = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface)->BasisSurface();
  return surface;
}

CadFace describe_face(const TopoDS_Face& face) {
  CadFace result;
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties, 1e-6);
  result.area = properties.Mass();
  result.middle = vec(properties.CentreOfMass().XYZ());
  const BRepAdaptor_Surface surface(face);
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  switch (surface.GetType()) {
    case GeomAbs_Plane: {
      result.kind = "plane";
      const gp_Pln plane = surface.Plane();
      result.axis = sign * (plane.Direct() ? 1 : -1) * vec(plane.Axis().Direction().XYZ());
      break;
    }
    case GeomAbs_Cylinder:
      result.kind = "cylinder";
      result.radius = surface.Cylinder().Radius();
      result.axis = vec(surface.Cylinder().Axis().Direction().XYZ());
      break;
    case GeomAbs_Cone:
      result.kind = "cone";
      result.half_angle = std::abs(surface.Cone().SemiAngle());
      result.axis = vec(surface.Cone().Axis().Direction().XYZ());
      break;
    case GeomAbs_Sphere:
      result.kind = "sphere";
      result.radius = surface.Sphere().Radius();
      break;
    case GeomAbs_Torus:
      result.kind = "torus";
      result.radius = surface.Torus().MinorRadius();
      result.major_radius = surface.Torus().MajorRadius();
      result.axis = vec(surface.Torus().Axis().Direction().XYZ());
      break;
    default:
      result.kind = "other";
  }
  return result;
}

/// Puts the triangulations of all faces together: points of an edge that several faces have are one.
class Assembler {
 public:
  Assembler(const CadModel& model, CurvedTriangles& result) : model_(model), result_(result) {
    TopExp::MapShapes(model.shape().solid, TopAbs_EDGE, edges_);
    TopExp::MapShapes(model.shape().solid, TopAbs_VERTEX, vertices_);
    point_of_vertex_.assign(vertices_.Extent() + 1, -1);
    points_of_edge_.resize(edges_.Extent() + 1);
  }

  void run() {
    for (int f = 1; f <= model_.shape().faces.Extent(); ++f) add_face(f);
  }

 private:
  [[noreturn]] void refuse(int f, const std::string& why) const {
    throw InputError(cad_face_text(model_.faces()[f - 1], f) + ": " + why);
  }

  int point_of_vertex(const TopoDS_Vertex& vertex) {
    int& number = point_of_vertex_[vertices_.FindIndex(vertex)];
    if (number < 0) {
      number = static_cast<int>(result_.points.size());
      result_.points.push_back(vec(BRep_Tool::Pnt(vertex).XYZ()));
    }
    return number;
  }

  /// The edge in the parameter plane of the face: of the two that a seam has, the one on which the triangles end.
  static Handle(Geom2d_Curve)
      curve_of(const TopoDS_Edge& edge, const TopoDS_Face& face, const Handle(Poly_Triangulation) & mesh,
               const Poly_PolygonOnTriangulation& polygon) {
    double begin = 0, end = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, begin, end);
    if (curve.IsNull() || !BRep_Tool::IsClosed(edge, face)) return curve;
    const Handle(Geom2d_Curve) other = BRep_Tool::CurveOnSurface(TopoDS::Edge(edge.Reversed()), face, begin, end);
    const int middle = (polygon.NbNodes() + 1) / 2;
    const gp_Pnt2d node = mesh->UVNode(polygon.Node(middle));
    const double t = polygon.Parameters()->Value(middle);
    return other->Value(t).Distance(node) < curve->Value(t).Distance(node) ? other : curve;
  }

  void add_face(int f) {
    const TopoDS_Face& face = TopoDS::Face(model_.shape().faces(f));
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull() || mesh->NbTriangles() == 0) refuse(f, "OpenCASCADE finds no triangles on it");
    if (!mesh->HasUVNodes()) refuse(f, "its triangles have no parameters");
    const bool reversed = face.Orientation() == TopAbs_REVERSED;
    CurvedFace curved;
    curved.surface = std::make_shared<OcctSurface>(surface_of(face));
    curved.orientation = reversed ? -1 : 1;
    result_.faces.push_back(curved);

    const gp_Trsf& move = place.Transformation();
    std::vector<int> point(mesh->NbNodes() + 1, -1);
    std::vector<char> pole(mesh->NbNodes() + 1, 0);
    int pole_axis = 0;
    /// The side of a triangle from one node to another along an edge.
    struct OnEdge {
      int edge, curve;
      double t0, t1;
    };
    std::map<std::pair<int, int>, OnEdge> on_edge;
    for (TopExp_Explorer explorer(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); explorer.More(); explorer.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(explorer.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, place);
      if (polygon.IsNull()) {
        if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
        refuse(f, "an edge of it has no place among its triangles");
      }
      const int n = polygon->NbNodes();
      TopoDS_Vertex first, last;
      TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), first, last);
      if (first.IsNull() || last.IsNull()) refuse(f, "an edge of it has no ends");
      const int number = edges_.FindIndex(edge);
      if (BRep_Tool::Degenerated(edge)) {
        for (int i = 1; i <= n; ++i) {
          point[polygon->Node(i)] = point_of_vertex(first);
          pole[polygon->Node(i)] = 1;
        }
        const gp_Pnt2d a = mesh->UVNode(polygon->Node(1)), b = mesh->UVNode(polygon->Node(n));
        pole_axis = std::abs(b.X() - a.X()) >= std::abs(b.Y() - a.Y()) ? 0 : 1;
        continue;
      }
      if (polygon->Parameters().IsNull()) refuse(f, "an edge of it has no parameters");
      std::vector<int>& own = points_of_edge_[number];
      if (own.empty()) {
        own.resize(n, -1);
        own.front() = point_of_vertex(first);
        own.back() = point_of_vertex(last);
        for (int i = 1; i + 1 < n; ++i) {
          own[i] = static_cast<int>(result_.points.size());
          result_.points.push_back(vec(mesh->Node(polygon->Node(i + 1)).Transformed(move).XYZ()));
        }
      }
      if (static_cast<int>(own.size()) != n) refuse(f, "an edge of it is divided otherwise than in the next face");
      const Handle(Geom2d_Curve) curve = curve_of(edge, face, mesh, *polygon);
      if (curve.IsNull()) refuse(f, "an edge of it has no curve in its parameter plane");
      const int curve_number = static_cast<int>(result_.curves.size());
      result_.curves.push_back(std::make_shared<OcctCurve>(curve));
      for (int i = 1; i <= n; ++i) {
        point[polygon->Node(i)] = own[i - 1];
        if (i == 1) continue;
        const int a = polygon->Node(i - 1), b = polygon->Node(i);
        const double ta = polygon->Parameters()->Value(i - 1), tb = polygon->Parameters()->Value(i);
        on_edge[{a, b}] = {number, curve_number, ta, tb};
        on_edge[{b, a}] = {number, curve_number, tb, ta};
      }
    }
    for (int i = 1; i <= mesh->NbNodes(); ++i) {
      if (point[i] >= 0) continue;
      point[i] = static_cast<int>(result_.points.size());
      result_.points.push_back(vec(mesh->Node(i).Transformed(move).XYZ()));
    }
    for (int t = 1; t <= mesh->NbTriangles(); ++t) {
      int node[3];
      mesh->Triangle(t).Get(node[0], node[1], node[2]);
      if (reversed) std::swap(node[1], node[2]);
      const Triangle corners{point[node[0]], point[node[1]], point[node[2]]};
      // Between two places of the line that a pole is.
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      CurvedTriangle triangle;
      triangle.face = f - 1;
      for (int k = 0; k < 3; ++k) {
        const gp_Pnt2d uv = mesh->UVNode(node[k]);
        triangle.uv[k] = {uv.X(), uv.Y()};
        if (pole[node[k]]) {
          triangle.pole = k;
          triangle.pole_axis = pole_axis;
        }
        const auto found = on_edge.find({node[k], node[(k + 1) % 3]});
        if (found != on_edge.end())
          triangle.sides[k] = {found->second.edge, found->second.t0, found->second.t1, found->second.curve, -1};
      }
      result_.corners.push_back(corners);
      result_.triangles.push_back(triangle);
    }
  }

  const CadModel& model_;
  CurvedTriangles& result_;
  TopTools_IndexedMapOfShape edges_, vertices_;
  std::vector<int> point_of_vertex_;
  std::vector<std::vector<int>> points_of_edge_;
};

/// Areas of the exact images of the triangles, by face.
std::vector<double> face_areas(const CurvedTriangles& triangles) {
  // Degree 5 (Radon 1948).
  const double r = std::sqrt(15.0), a = (6 - r) / 21, b = (6 + r) / 21, wa = (155 - r) / 1200, wb = (155 + r) / 1200;
  const double rule[7][3] = {
      {1.0 / 3, 1.0 / 3, 9.0 / 40}, {a, a, wa},        {a, 1 - 2 * a, wa}, {1 - 2 * a, a, wa}, {b, b, wb},
      {b, 1 - 2 * b, wb},           {1 - 2 * b, b, wb}};
  std::vector<double> areas(triangles.faces.size(), 0);
  for (std::size_t t = 0; t < triangles.triangles.size(); ++t)
    for (const auto& [x, y, w] : rule) {
      const CurvedPlace place = triangles.place(static_cast<int>(t), x, y);
      areas[triangles.triangles[t].face] += w / 2 * place.along_a.cross(place.along_b).norm();
    }
  return areas;
}

}  // namespace

std::string cad_face_text(const CadFace& face, int number) {
  std::string text = fmt::format("face {}", number);
  if (!face.name.empty()) text += fmt::format(" \"{}\"", printable(face.name));
  text += " (" + (face.kind == "other" ? std::string("free-form") : face.kind);
  if (face.radius > 0) text += fmt::format(" of radius {:.6g} mm", face.radius);
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
  return {vec(box.CornerMin().XYZ()), vec(box.CornerMax().XYZ())};
}

double CadModel::distance(int face, const Vec3& x) const {
  BRepExtrema_DistShapeShape search(BRepBuilderAPI_MakeVertex(gp_Pnt(x[0], x[1], x[2])).Vertex(),
                                    shape_->faces(face + 1));
  return search.IsDone() && search.NbSolution() > 0 ? search.Value() : std::numeric_limits<double>::infinity();
}

CurvedTriangles CadModel::triangles(double deflection) const {
  try {
    for (int attempt = 0; attempt < finer_attempts; ++attempt, deflection /= 2) {
      // A finer mesh than an earlier one is made only where that is gone.
      BRepTools::Clean(shape_->solid);
      IMeshTools_Parameters parameters;
      parameters.Deflection = deflection;
      parameters.Angle = angle_between_triangles;
      parameters.AllowQualityDecrease = true;
      BRepMesh_IncrementalMesh(shape_->solid, parameters);
      CurvedTriangles result;
      Assembler(*this, result).run();
      result.refine(deflection);
      const std::vector<double> areas = face_areas(result);
      std::size_t worst = 0;
      const auto miss = [&](std::size_t f) { return std::abs(areas[f] / faces_[f].area - 1); };
      for (std::size_t f = 1; f < faces_.size(); ++f)
        if (miss(f) > miss(worst)) worst = f;
      if (!(miss(worst) > area_tolerance)) return result;
      if (attempt + 1 == finer_attempts)
        throw InputError(fmt::format("{}: its triangles cover {:.6g} mm^2 of its {:.6g} mm^2",
                                     cad_face_text(faces_[worst], static_cast<int>(worst) + 1), areas[worst],
                                     faces_[worst].area));
    }
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("OpenCASCADE cannot divide the solid into triangles: {}", failure.GetMessageString()));
  }
  return {};
}

}  // namespace cgcontact
