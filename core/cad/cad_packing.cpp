/// Solids as bytes: the shapes in OpenCASCADE's binary format, all in one, so that those that share faces still do.
#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <TopExp.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <sstream>

#include "core/cad/cad_shape.hpp"

namespace cgcontact {

namespace {

void put_text(const std::string& text, Packing& packing) { packing.put(std::vector<char>(text.begin(), text.end())); }

std::string take_text(Unpacking& unpacking) {
  std::vector<char> text;
  unpacking.take(text);
  return {text.begin(), text.end()};
}

void put_face(const CadFace& face, Packing& packing) {
  put_text(face.name, packing);
  packing.put(face.colour.has_value());
  packing.put(face.colour.value_or(std::array<int, 3>{}));
  put_text(face.kind, packing);
  for (const double figure : {face.area, face.radius, face.ring_radius, face.half_angle}) packing.put(figure);
  packing.put(face.middle);
  packing.put(face.axis);
  packing.put(face.names.size());
  for (const std::string& name : face.names) put_text(name, packing);
}

CadFace take_face(Unpacking& unpacking) {
  CadFace face;
  face.name = take_text(unpacking);
  bool coloured = false;
  std::array<int, 3> colour{};
  unpacking.take(coloured);
  unpacking.take(colour);
  if (coloured) face.colour = colour;
  face.kind = take_text(unpacking);
  for (double* const figure : {&face.area, &face.radius, &face.ring_radius, &face.half_angle}) unpacking.take(*figure);
  unpacking.take(face.middle);
  unpacking.take(face.axis);
  std::size_t count = 0;
  unpacking.take(count);
  for (std::size_t k = 0; k < count; ++k) face.names.push_back(take_text(unpacking));
  return face;
}

}  // namespace

void pack_solids(const std::vector<CadSolid>& solids, Packing& packing) {
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const CadSolid& solid : solids) builder.Add(all, solid.model.shape().solid);
  std::ostringstream shapes;
  BinTools::Write(all, shapes, false, false, BinTools_FormatVersion_CURRENT);
  put_text(shapes.str(), packing);
  for (const CadSolid& solid : solids) {
    for (const std::string* const text : {&solid.name, &solid.repair, &solid.left_out}) put_text(*text, packing);
    packing.put(solid.model.faces().size());
    for (const CadFace& face : solid.model.faces()) put_face(face, packing);
  }
}

std::vector<CadSolid> unpack_solids(const std::vector<char>& bytes) {
  Unpacking unpacking(bytes);
  std::istringstream shapes(take_text(unpacking));
  TopoDS_Shape all;
  BinTools::Read(all, shapes);
  std::vector<CadSolid> solids;
  for (TopoDS_Iterator i(all); i.More(); i.Next()) {
    const std::string name = take_text(unpacking), repair = take_text(unpacking), left_out = take_text(unpacking);
    auto shape = std::make_shared<CadModel::Shape>();
    shape->solid = i.Value();
    TopExp::MapShapes(shape->solid, TopAbs_FACE, shape->faces);
    std::size_t count = 0;
    unpacking.take(count);
    std::vector<CadFace> faces;
    for (std::size_t f = 0; f < count; ++f) faces.push_back(take_face(unpacking));
    solids.push_back({name, CadModel(shape, faces), repair, left_out});
  }
  return solids;
}

}  // namespace cgcontact
