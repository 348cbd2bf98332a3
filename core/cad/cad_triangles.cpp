/// Triangles of a solid by OpenCASCADE's mesher, with the surfaces and curves that they stand for.
#include <fmt/format.h>

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
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
#include <TopoDS_Vertex.hxx>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/errors/errors.hpp"
#include "core/cad/cad_shape.hpp"

namespace cgcontact {

namespace {

constexpr double angle_between_triangles = 0.35;  // radians, of the mesher: 20 degrees
constexpr double area_tolerance = 1e-4;           // relative: a face that its triangles miss more of is not covered
constexpr int finer_attempts = 4;

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
    jet.x = vector_of(p.XYZ());
    jet.xu = vector_of(u.XYZ());
    jet.xv = vector_of(v.XYZ());
  }
  void second(const Vec2& uv, SurfaceJet& jet) const override {
    gp_Pnt p;
    gp_Vec u, v, uu, vv, both;
    surface_->D2(uv[0], uv[1], p, u, v, uu, vv, both);
    jet.x = vector_of(p.XYZ());
    jet.xu = vector_of(u.XYZ());
    jet.xv = vector_of(v.XYZ());
    jet.xuu = vector_of(uu.XYZ());
    jet.xvv = vector_of(vv.XYZ());
    jet.xuv = vector_of(both.XYZ());
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

CurvedFace curved_face(const TopoDS_Face& face) {
  CurvedFace curved;
  curved.surface = std::make_shared<OcctSurface>(surface_of(face));
  curved.orientation = face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  return curved;
}

/// In the order in which the explorer finds them, a seam twice.
std::vector<TopoDS_Edge> edges_of(const TopoDS_Face& face) {
  std::vector<TopoDS_Edge> edges;
  for (TopExp_Explorer i(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); i.More(); i.Next())
    edges.push_back(TopoDS::Edge(i.Current()));
  return edges;
}

/// Edge in the parameter plane of the face; a seam has two such curves.
Handle(Geom2d_Curve) curve_of(const TopoDS_Edge& edge, const TopoDS_Face& face, bool other) {
  double begin = 0, end = 0;
  return BRep_Tool::CurveOnSurface(other ? TopoDS::Edge(edge.Reversed()) : edge, face, begin, end);
}

/// Curve of an edge of a face.
struct FaceEdge {
  int face = 0;  ///< from 1
  int edge = 0;  ///< among edges_of(face)
  bool other = false;
};

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
  const std::vector<FaceEdge>& edges_of_curves() const { return edges_of_curves_; }

 private:
  [[noreturn]] void refuse(int f, const std::string& why) const {
    throw InputError(cad_face_text(model_.faces()[f - 1], f) + ": " + why);
  }

  int point_of_vertex(const TopoDS_Vertex& vertex) {
    int& number = point_of_vertex_[vertices_.FindIndex(vertex)];
    if (number < 0) {
      number = static_cast<int>(result_.points.size());
      result_.points.push_back(vector_of(BRep_Tool::Pnt(vertex).XYZ()));
    }
    return number;
  }

  /// Returns whether the triangles end on the second of the two curves that a seam has in its face's parameter plane.
  static bool is_other(const TopoDS_Edge& edge, const TopoDS_Face& face, const Handle(Poly_Triangulation) & mesh,
                       const Poly_PolygonOnTriangulation& polygon) {
    if (!BRep_Tool::IsClosed(edge, face)) return false;
    const Handle(Geom2d_Curve) curve = curve_of(edge, face, false), other = curve_of(edge, face, true);
    if (curve.IsNull() || other.IsNull()) return false;
    const int middle = (polygon.NbNodes() + 1) / 2;
    const gp_Pnt2d node = mesh->UVNode(polygon.Node(middle));
    const double t = polygon.Parameters()->Value(middle);
    return other->Value(t).Distance(node) < curve->Value(t).Distance(node);
  }

  void add_face(int f) {
    const TopoDS_Face& face = TopoDS::Face(model_.shape().faces(f));
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull() || mesh->NbTriangles() == 0) refuse(f, "OpenCASCADE finds no triangles on it");
    if (!mesh->HasUVNodes()) refuse(f, "its triangles have no parameters");
    const bool reversed = face.Orientation() == TopAbs_REVERSED;
    result_.faces.push_back(curved_face(face));

    const gp_Trsf& move = location.Transformation();
    std::vector<int> point(mesh->NbNodes() + 1, -1);
    std::vector<char> pole(mesh->NbNodes() + 1, 0);
    int pole_axis = 0;
    /// Side of a triangle from one node to another along an edge.
    struct OnEdge {
      int edge, curve;
      double t0, t1;
    };
    std::map<std::pair<int, int>, OnEdge> on_edge;
    const std::vector<TopoDS_Edge> edges = edges_of(face);
    for (int index_in_face = 0; index_in_face < static_cast<int>(edges.size()); ++index_in_face) {
      const TopoDS_Edge& edge = edges[index_in_face];
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
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
          result_.points.push_back(vector_of(mesh->Node(polygon->Node(i + 1)).Transformed(move).XYZ()));
        }
      }
      if (static_cast<int>(own.size()) != n) refuse(f, "an edge of it is divided otherwise than in the next face");
      const FaceEdge of_curve{f, index_in_face, is_other(edge, face, mesh, *polygon)};
      const Handle(Geom2d_Curve) curve = curve_of(edge, face, of_curve.other);
      if (curve.IsNull()) refuse(f, "an edge of it has no curve in its parameter plane");
      edges_of_curves_.push_back(of_curve);
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
      result_.points.push_back(vector_of(mesh->Node(i).Transformed(move).XYZ()));
    }
    for (int t = 1; t <= mesh->NbTriangles(); ++t) {
      int node[3];
      mesh->Triangle(t).Get(node[0], node[1], node[2]);
      if (reversed) std::swap(node[1], node[2]);
      const Triangle corners{point[node[0]], point[node[1]], point[node[2]]};
      // Triangles that lie on the line of a pole are dropped.
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
  std::vector<FaceEdge> edges_of_curves_;
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
      const CurvedPoint image = triangles.point_at(static_cast<int>(t), x, y);
      areas[triangles.triangles[t].face] += w / 2 * image.along_a.cross(image.along_b).norm();
    }
  return areas;
}

/// Divides triangles until they cover the faces; the curves of their sides.
CurvedTriangles make_triangles(const CadModel& model, double deflection, std::vector<FaceEdge>& edges_of_curves) {
  const TopoDS_Shape& solid = model.shape().solid;
  try {
    for (int attempt = 0; attempt < finer_attempts; ++attempt, deflection /= 2) {
      // A finer mesh than an earlier one is made only where that is gone.
      BRepTools::Clean(solid);
      IMeshTools_Parameters parameters;
      parameters.Deflection = deflection;
      parameters.Angle = angle_between_triangles;
      parameters.AllowQualityDecrease = true;
      BRepMesh_IncrementalMesh(solid, parameters);
      CurvedTriangles result;
      Assembler assembler(model, result);
      assembler.run();
      edges_of_curves = assembler.edges_of_curves();
      result.refine(deflection);
      const std::vector<double> areas = face_areas(result);
      std::size_t worst = 0;
      const auto miss = [&](std::size_t f) { return std::abs(areas[f] / model.faces()[f].area - 1); };
      for (std::size_t f = 1; f < areas.size(); ++f)
        if (miss(f) > miss(worst)) worst = f;
      if (!(miss(worst) > area_tolerance)) return result;
      if (attempt + 1 == finer_attempts)
        throw InputError(fmt::format("{}: its triangles cover {:.6g} mm^2 of its {:.6g} mm^2",
                                     cad_face_text(model.faces()[worst], static_cast<int>(worst) + 1), areas[worst],
                                     model.faces()[worst].area));
    }
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("OpenCASCADE cannot divide the solid into triangles: {}", failure.GetMessageString()));
  }
  return {};
}

}  // namespace

void pack_triangles(const CadModel& model, double deflection, Packing& packing) {
  std::vector<FaceEdge> edges_of_curves;
  const CurvedTriangles triangles = make_triangles(model, deflection, edges_of_curves);
  packing.put(triangles.points);
  packing.put(triangles.corners);
  packing.put(triangles.triangles.size());
  for (const CurvedTriangle& t : triangles.triangles) {
    packing.put(t.face);
    packing.put(t.pole);
    packing.put(t.pole_axis);
    packing.put(t.sides);
    for (const Vec2& uv : t.uv) packing.put(uv);
  }
  packing.put(triangles.bends.size());
  for (const CurvedTriangles::Bend& bend : triangles.bends)
    for (const Vec2& term : bend) packing.put(term);
  packing.put(edges_of_curves);
}

CurvedTriangles unpack_triangles(const CadModel& model, const std::vector<char>& bytes) {
  CurvedTriangles result;
  Unpacking unpacking(bytes);
  std::size_t count = 0;
  unpacking.take(result.points);
  unpacking.take(result.corners);
  unpacking.take(count);
  result.triangles.resize(count);
  for (CurvedTriangle& t : result.triangles) {
    unpacking.take(t.face);
    unpacking.take(t.pole);
    unpacking.take(t.pole_axis);
    unpacking.take(t.sides);
    for (Vec2& uv : t.uv) unpacking.take(uv);
  }
  unpacking.take(count);
  result.bends.resize(count);
  for (CurvedTriangles::Bend& bend : result.bends)
    for (Vec2& term : bend) unpacking.take(term);
  std::vector<FaceEdge> edges_of_curves;
  unpacking.take(edges_of_curves);
  const auto face_of = [&](int f) { return TopoDS::Face(model.shape().faces(f)); };
  for (int f = 1; f <= model.shape().faces.Extent(); ++f) result.faces.push_back(curved_face(face_of(f)));
  std::vector<TopoDS_Edge> edges;
  int face = 0;
  for (const FaceEdge& of_curve : edges_of_curves) {
    if (of_curve.face != face) edges = edges_of(face_of(face = of_curve.face));
    result.curves.push_back(
        std::make_shared<OcctCurve>(curve_of(edges[of_curve.edge], face_of(of_curve.face), of_curve.other)));
  }
  return result;
}

}  // namespace cgcontact
