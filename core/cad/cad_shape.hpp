/// Implementation of CadModel; for the files that use OpenCASCADE only.
#pragma once

#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Dir.hxx>
#include <gp_Pnt.hxx>
#include <gp_XYZ.hxx>

#include "core/base/process/packing.hpp"
#include "core/cad/cad_model.hpp"

namespace cgcontact {

inline gp_Pnt point_of(const Vec3& x) { return {x[0], x[1], x[2]}; }
inline gp_Dir direction_of(const Vec3& x) { return {x[0], x[1], x[2]}; }
inline Vec3 vector_of(const gp_XYZ& x) { return {x.X(), x.Y(), x.Z()}; }

struct CadModel::Shape {
  TopoDS_Shape solid;                ///< a solid or a compound of solids
  TopTools_IndexedMapOfShape faces;  ///< in the order of CadModel::faces
};

/// Makes the model of a shape from its geometry; names and colours are empty.
CadModel make_cad_model(const TopoDS_Shape& solid);

/// Solids as bytes, and back: the same shapes, faces in the same order.
void pack_solids(const std::vector<CadSolid>& solids, Packing& packing);
std::vector<CadSolid> unpack_solids(const std::vector<char>& bytes);

/// CadModel::triangles as bytes, and back; surfaces and curves are those of the model.
void pack_triangles(const CadModel& model, double deflection, Packing& packing);
CurvedTriangles unpack_triangles(const CadModel& model, const std::vector<char>& bytes);

/// Sorts the edges for CadModel::section.
std::vector<CadModel::SectionEdge> section_edges(const CadModel& model, const ProfileFrame& frame);

/// "face 7 (cylinder of radius 5 mm) at (x, y, z) mm".
std::string cad_face_text(const CadFace& face, int number);

}  // namespace cgcontact
