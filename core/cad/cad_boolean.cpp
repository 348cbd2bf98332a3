#include <fmt/format.h>

#include <BRepAlgoAPI_BooleanOperation.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Ax2.hxx>

#include "core/base/errors/errors.hpp"
#include "core/cad/cad_shape.hpp"

namespace cgcontact {

namespace {

/// The model moved, and where each of its faces went.
struct Moved {
  TopoDS_Shape solid;
  std::vector<TopoDS_Shape> faces;
};

Moved moved(const CadModel& model, const Similarity& placement) {
  gp_Trsf motion;
  const Mat3 m = placement.scale * placement.rotation;
  motion.SetValues(m(0, 0), m(0, 1), m(0, 2), placement.translation[0], m(1, 0), m(1, 1), m(1, 2),
                   placement.translation[1], m(2, 0), m(2, 1), m(2, 2), placement.translation[2]);
  BRepBuilderAPI_Transform transform(model.shape().solid, motion, true);
  Moved result{transform.Shape(), {}};
  for (int f = 1; f <= model.shape().faces.Extent(); ++f)
    result.faces.push_back(transform.ModifiedShape(model.shape().faces(f)));
  return result;
}

}  // namespace

CadModel CadModel::combine(Operation operation, const CadModel& a, const Similarity& placement_a, const CadModel& b,
                           const Similarity& placement_b) {
  try {
    const Moved first = moved(a, placement_a), second = moved(b, placement_b);
    TopTools_ListOfShape arguments, tools;
    arguments.Append(first.solid);
    tools.Append(second.solid);
    BRepAlgoAPI_Fuse fuse;
    BRepAlgoAPI_Common common;
    BRepAlgoAPI_Cut cut;
    BRepAlgoAPI_BooleanOperation& work =
        operation == Operation::unite       ? static_cast<BRepAlgoAPI_BooleanOperation&>(fuse)
        : operation == Operation::intersect ? static_cast<BRepAlgoAPI_BooleanOperation&>(common)
                                            : static_cast<BRepAlgoAPI_BooleanOperation&>(cut);
    work.SetArguments(arguments);
    work.SetTools(tools);
    work.SetNonDestructive(true);
    work.Build();
    if (!work.IsDone() || work.HasErrors()) throw InputError(std::string("OpenCASCADE cannot combine the solids"));
    TopoDS_Compound result;
    BRep_Builder builder;
    builder.MakeCompound(result);
    int count = 0;
    for (TopExp_Explorer i(work.Shape(), TopAbs_SOLID); i.More(); i.Next(), ++count) builder.Add(result, i.Current());
    if (count == 0)
      throw InputError(std::string("the result is empty: the shapes do not overlap, or one holds the other"));
    CadModel combined = make_cad_model(result);
    const auto take_names = [&](const CadModel& from, const Moved& at) {
      for (std::size_t f = 0; f < from.faces_.size(); ++f) {
        const TopTools_ListOfShape& modified = work.Modified(at.faces[f]);
        const auto name = [&](const TopoDS_Shape& face) {
          const int number = combined.shape_->faces.FindIndex(face);
          if (number == 0) return;
          CadFace& to = combined.faces_[number - 1];
          if (to.name.empty()) to.name = from.faces_[f].name;
          if (!to.colour) to.colour = from.faces_[f].colour;
          to.names.insert(to.names.end(), from.faces_[f].names.begin(), from.faces_[f].names.end());
        };
        if (modified.IsEmpty()) {
          if (!work.IsDeleted(at.faces[f])) name(at.faces[f]);
        } else {
          for (const TopoDS_Shape& changed : modified) name(changed);
        }
      }
    };
    take_names(a, first);
    take_names(b, second);
    return combined;
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("OpenCASCADE cannot combine the solids: {}", failure.GetMessageString()));
  }
}

CadModel CadModel::inner_side(const Surface& surface, const Vec3& centre, double radius) {
  TopoDS_Shape solid;
  if (surface.kind == Surface::Kind::sphere) {
    solid = BRepPrimAPI_MakeSphere(point_of(surface.point), surface.radius).Shape();
  } else if (surface.kind == Surface::Kind::cylinder) {
    const Vec3 base = surface.point + ((centre - surface.point).dot(surface.direction) - radius) * surface.direction;
    solid =
        BRepPrimAPI_MakeCylinder(gp_Ax2(point_of(base), direction_of(surface.direction)), surface.radius, 2 * radius)
            .Shape();
  } else if (surface.kind == Surface::Kind::cone) {
    const double length = std::max(radius, (centre - surface.point).dot(surface.direction) + radius);
    solid = BRepPrimAPI_MakeCone(gp_Ax2(point_of(surface.point), direction_of(surface.direction)), 0,
                                 length * surface.sine / surface.cosine, length)
                .Shape();
  } else {
    const Vec3 x = surface.direction.unitOrthogonal(), y = surface.direction.cross(x);
    const Vec3 middle = centre - (centre - surface.point).dot(surface.direction) * surface.direction;
    const double depth = radius + (middle - centre).norm();
    const Vec3 corner = middle - radius * (x + y) - depth * surface.direction;
    solid = BRepPrimAPI_MakeBox(gp_Ax2(point_of(corner), direction_of(surface.direction), direction_of(x)), 2 * radius,
                                2 * radius, depth)
                .Shape();
  }
  CadModel model = make_cad_model(solid);
  for (CadFace& face : model.faces_) {
    const bool flat = face.kind == "plane";
    const bool own = surface.kind == Surface::Kind::plane ? flat && face.axis.dot(surface.direction) > 0.9 : !flat;
    if (own) face.names = surface.names;
  }
  return model;
}

}  // namespace cgcontact
