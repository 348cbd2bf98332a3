/// Profiles of lines and arcs turned about an axis, by OpenCASCADE: those that are tori.
#include <fmt/format.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <gp_Circ.hxx>

#include "core/base/errors.hpp"
#include "core/cad/cad_shape.hpp"
#include "core/geometry/profile.hpp"

namespace cgcontact {

namespace {

gp_Pnt point(const Vec3& x) { return {x[0], x[1], x[2]}; }
gp_Dir direction(const Vec3& x) { return {x[0], x[1], x[2]}; }

TopoDS_Edge edge_of(const ProfileEdge& edge, const ProfileFrame& frame) {
  const auto at = [&](const Vec2& x) { return point(frame.origin + x[0] * frame.first + x[1] * frame.second); };
  if (!edge.is_arc) return BRepBuilderAPI_MakeEdge(at(edge.from), at(edge.to));
  if (edge.from != edge.to)
    return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(at(edge.from), at(edge.through), at(edge.to)).Value());
  const gp_Ax2 axes(at((edge.from + edge.through) / 2), direction(frame.first.cross(frame.second)),
                    direction(frame.first));
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
    BRepPrimAPI_MakeRevol turn(face.Face(), gp_Ax1(point(frame.origin), direction(frame.second)), true);
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

}  // namespace cgcontact
