/// What CadModel stands for; for the files that use OpenCASCADE only.
#pragma once

#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Shape.hxx>

#include "core/cad/cad_model.hpp"

namespace cgcontact {

struct CadModel::Shape {
  TopoDS_Shape solid;                ///< a solid or a compound of solids
  TopTools_IndexedMapOfShape faces;  ///< in the order of CadModel::faces
};

/// The faces of a shape with what can be told from their geometry; names and colours are empty.
CadModel make_cad_model(const TopoDS_Shape& solid);

/// "face 7 (cylinder of radius 5 mm) at (x, y, z) mm".
std::string cad_face_text(const CadFace& face, int number);

}  // namespace cgcontact
