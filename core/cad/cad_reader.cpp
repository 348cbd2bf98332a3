#include <fmt/format.h>

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <set>

#include "core/base/errors/errors.hpp"
#include "core/cad/cad_formats.hpp"
#include "core/cad/cad_shape.hpp"

namespace cgcontact {

namespace {

/// Stops OpenCASCADE's messages on the standard output.
void be_quiet() {
  static std::once_flag once;
  std::call_once(once, [] {
    const Message_SequenceOfPrinters printers = Message::DefaultMessenger()->Printers();
    for (Message_SequenceOfPrinters::Iterator i(printers); i.More(); i.Next())
      Message::DefaultMessenger()->RemovePrinter(i.Value());
  });
}

/// Names that can stand in a scene and are all different.
void make_names_unique(const std::string& file, std::vector<Found>& parts) {
  std::map<std::string, int> count;
  for (Found& part : parts) {
    if (is_no_name(part.name)) part.name = std::filesystem::path(file).stem().string();
    ++count[part.name];
  }
  std::map<std::string, int> number;
  std::set<std::string> seen;
  for (Found& part : parts) {
    const std::string name = part.name;
    if (count[name] > 1) part.name += fmt::format("_{}", ++number[name]);
    while (!seen.insert(part.name).second) part.name += "_";
  }
}

double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-6);
  return properties.Mass();
}
double area_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-6);
  return properties.Mass();
}

/// Edges that only one face has, once each, with that face.
std::vector<std::pair<TopoDS_Edge, TopoDS_Face>> open_edges(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  std::vector<std::pair<TopoDS_Edge, TopoDS_Face>> open;
  for (int e = 1; e <= faces_of.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(faces_of.FindKey(e));
    if (BRep_Tool::Degenerated(edge) || faces_of(e).Extent() != 1) continue;
    const TopoDS_Face face = TopoDS::Face(faces_of(e).First());
    if (!BRep_Tool::IsClosed(edge, face)) open.emplace_back(edge, face);
  }
  return open;
}

/// Describes the gap of an open surface: which face, and how far it is to the next open edge.
std::string describe_gap(const TopoDS_Shape& shape) {
  const auto open = open_edges(shape);
  if (open.empty()) return "its shells enclose no volume";
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  const CadModel model = make_cad_model(shape);
  const int number = faces.FindIndex(open.front().second);
  // As wide as it is at the wider end of the edge.
  double gap = std::numeric_limits<double>::infinity();
  TopoDS_Vertex a, b;
  TopExp::Vertices(open.front().first, a, b);
  for (std::size_t k = 1; k < open.size(); ++k) {
    if (open[k].second.IsSame(open.front().second)) continue;
    const BRepExtrema_DistShapeShape at_a(a, open[k].first), at_b(b, open[k].first);
    if (at_a.IsDone() && at_b.IsDone()) gap = std::min(gap, std::max(at_a.Value(), at_b.Value()));
  }
  std::string text = fmt::format("{} of its edges belong to one face only, the first of them to {}", open.size(),
                                 cad_face_text(model.faces()[number - 1], number));
  if (std::isfinite(gap)) text += fmt::format(", {:.3g} mm from the nearest open edge of another face", gap);
  return text;
}

/// Faces that do not know of each other joined where their rims are nearer than the tolerance (mm).
TopoDS_Shape sewn(const TopoDS_Shape& shape, double tolerance) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(shape);
  sewing.Perform();
  return sewing.SewedShape();
}

/// Closed shells as solids; empty if one is open.
std::vector<TopoDS_Solid> solids_of_shells(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Solid> solids;
  for (TopExp_Explorer i(shape, TopAbs_SHELL); i.More(); i.Next()) {
    const TopoDS_Shell shell = TopoDS::Shell(i.Current());
    if (!BRep_Tool::IsClosed(shell) && !open_edges(shell).empty()) return {};
    BRepBuilderAPI_MakeSolid make(shell);
    if (!make.IsDone()) return {};
    TopoDS_Solid solid = make.Solid();
    BRepLib::OrientClosedSolid(solid);
    solids.push_back(solid);
  }
  return solids;
}

constexpr double sewing_share = 1e-4;             // of the diagonal: gaps that a repair closes
constexpr double iges_gap = 1e-3, no_gap = 1e-7;  // mm

double diagonal(const TopoDS_Shape& shape) {
  const auto [low, high] = make_cad_model(shape).box();
  return (high - low).norm();
}

/// Conversion of the file's shapes to solids.
class SolidMaker {
 public:
  SolidMaker(const std::string& file, const Remarks& remarks, bool loose, bool repair)
      : file_(file), remarks_(remarks), loose_(loose), repair_(repair) {}

  void add(const Found& found) {
    if (found.shape.ShapeType() == TopAbs_SOLID) return finish(found, found.shape, "");
    if (!TopExp_Explorer(found.shape, TopAbs_FACE).More()) return;  // curves and points
    if (!add_shells(found, found.shape, "")) loose_faces_.Add(found);
  }

  /// Faces that belong to no solid are looked at where there is no solid.
  std::vector<CadSolid> take() {
    if (solids_.empty() && loose_faces_.any) close_loose_faces();
    if (solids_.empty())
      throw InputError(
          file_ + ": there is no solid in it" +
          (remarks_.other_files.empty() ? " (allowed: a file with at least one solid)" : remarks_.where_else()));
    return std::move(solids_);
  }

 private:
  /// All that is no solid in one shape.
  struct LooseFaces {
    bool any = false;
    TopoDS_Compound shape;
    Found found;
    void Add(const Found& part) {
      BRep_Builder builder;
      if (!any) builder.MakeCompound(shape);
      builder.Add(shape, part.shape);
      any = true;
      found.face_names.insert(found.face_names.end(), part.face_names.begin(), part.face_names.end());
      found.colours.insert(found.colours.end(), part.colours.begin(), part.colours.end());
    }
  };

  /// The closed shells of a shape as solids; false if one of them is open or there is none.
  bool add_shells(const Found& found, const TopoDS_Shape& shape, const std::string& repaired) {
    const std::vector<TopoDS_Solid> closed = solids_of_shells(shape);
    for (std::size_t k = 0; k < closed.size(); ++k) {
      Found one = found;
      if (closed.size() > 1) one.name += fmt::format("_{}", k + 1);
      finish(one, closed[k], repaired);
    }
    return !closed.empty();
  }

  void close_loose_faces() {
    Found& found = loose_faces_.found;
    found.name = std::filesystem::path(file_).stem().string();
    // Faces of IGES files do not know of each other.
    const TopoDS_Shape open = sewn(loose_faces_.shape, loose_ ? iges_gap : no_gap);
    if (add_shells(found, open, "")) return;
    if (!repair_)
      throw InputError(
          fmt::format("{}: there is no solid in it but an open surface: {} (allowed: closed surfaces; "
                      "repair = true closes gaps of up to 1e-4 of the size)",
                      file_, describe_gap(open)));
    const double tolerance = sewing_share * diagonal(open);
    const TopoDS_Shape closed = sewn(open, tolerance);
    const std::string repaired = fmt::format("gaps of up to {:.3g} mm closed: area {:.8g} mm^2 before, {:.8g} after",
                                             tolerance, area_of(open), area_of(closed));
    if (!add_shells(found, closed, repaired))
      throw InputError(
          fmt::format("{}: there is no solid in it but a surface that stays open, also with gaps of up to "
                      "{:.3g} mm closed: {}",
                      file_, tolerance, describe_gap(closed)));
  }

  void finish(const Found& found, TopoDS_Shape solid, std::string repaired) {
    const std::string& name = found.name;
    if (!BRepCheck_Analyzer(solid).IsValid()) {
      if (!repair_)
        throw InputError(
            fmt::format("{}: the solid \"{}\" is not valid: {} (allowed: a sound solid; repair = true lets "
                        "OpenCASCADE heal it)",
                        file_, name, first_fault(solid)));
      solid = healed(solid, name, repaired);
    }
    if (const auto open = open_edges(solid); !open.empty())
      throw InputError(fmt::format("{}: the solid \"{}\" is open: {}", file_, name, describe_gap(solid)));
    TopoDS_Solid turned;
    if (volume_of(solid) < 0) {
      turned = TopoDS::Solid(solid);
      BRepLib::OrientClosedSolid(turned);
      solid = turned;
      repaired += std::string(repaired.empty() ? "" : ", ") + "turned outwards";
    }
    CadModel model = make_cad_model(solid);
    std::vector<CadFace> faces = model.faces();
    const auto number = [&](const TopoDS_Face& face) { return model.shape().faces.FindIndex(face); };
    for (const auto& [face, text] : found.face_names)
      if (const int f = number(face); f > 0) faces[f - 1].name = text;
    for (const auto& [face, colour] : found.colours)
      if (const int f = number(face); f > 0) faces[f - 1].colour = colour;
    auto shape = std::make_shared<CadModel::Shape>(model.shape());
    solids_.push_back({name, CadModel(shape, faces), repaired, remarks_.left_out});
  }

  /// The first face that BRepCheck finds fault with.
  static std::string first_fault(const TopoDS_Shape& solid) {
    const BRepCheck_Analyzer check(solid);
    const CadModel model = make_cad_model(solid);
    for (int f = 1; f <= model.shape().faces.Extent(); ++f)
      if (!check.IsValid(model.shape().faces(f)))
        return fmt::format("{} is not (largest gap that it admits {:.3g} mm)", cad_face_text(model.faces()[f - 1], f),
                           BRep_Tool::MaxTolerance(model.shape().faces(f), TopAbs_EDGE));
    return "its faces do not bound a volume";
  }

  TopoDS_Shape healed(const TopoDS_Shape& solid, const std::string& name, std::string& repaired) const {
    const double volume = volume_of(solid), area = area_of(solid);
    TopoDS_Shape result;
    try {
      ShapeFix_Shape fix(solid);
      fix.SetPrecision(1e-7 * diagonal(solid));
      fix.SetMaxTolerance(sewing_share * diagonal(solid));
      fix.Perform();
      result = fix.Shape();
    } catch (const Standard_Failure& failure) {
      throw InputError(
          fmt::format("{}: the solid \"{}\" cannot be healed: {}", file_, name, failure.GetMessageString()));
    }
    if (result.IsNull() || !BRepCheck_Analyzer(result).IsValid())
      throw InputError(fmt::format("{}: the solid \"{}\" cannot be healed: {}", file_, name,
                                   result.IsNull() ? std::string("nothing is left") : first_fault(result)));
    repaired += fmt::format("{}healed: volume {:.8g} mm^3 before, {:.8g} after, area {:.8g} mm^2 before, {:.8g} after",
                            repaired.empty() ? "" : ", ", volume, volume_of(result), area, area_of(result));
    return result;
  }

  std::string file_;
  Remarks remarks_;
  bool loose_, repair_;
  LooseFaces loose_faces_;
  std::vector<CadSolid> solids_;
};

}  // namespace

std::vector<CadSolid> read_cad(const std::string& file, const CadReading& reading) {
  be_quiet();
  const CadFormat format = cad_format(file);
  Remarks remarks;
  try {
    std::vector<Found> parts = format == CadFormat::step   ? read_step(file, remarks)
                               : format == CadFormat::iges ? read_iges(file)
                                                           : read_brep(file);
    make_names_unique(file, parts);
    SolidMaker maker(file, remarks, format == CadFormat::iges, reading.repair);
    for (const Found& part : parts) maker.add(part);
    return maker.take();
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("{}: OpenCASCADE cannot read it: {}", file, failure.GetMessageString()));
  }
}

}  // namespace cgcontact
