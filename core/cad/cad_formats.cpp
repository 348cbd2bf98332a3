#include "core/cad/cad_formats.hpp"

#include <fmt/format.h>

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <StepBasic_DocumentFile.hxx>
#include <StepRepr_HArray1OfRepresentationItem.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_SolidModel.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>

#include "core/base/errors/errors.hpp"
#include "core/cad/step_references.hpp"

namespace cgcontact {

namespace {

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return "";
  const TCollection_ExtendedString& text = name->Get();
  std::string result(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter bytes = result.data();
  result.resize(static_cast<std::size_t>(text.ToUTF8CString(bytes)));
  while (!result.empty() && result.back() == '\0') result.pop_back();
  return printable(result);
}

class Document {
 public:
  Document() {
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document_);
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    colours_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
  }
  ~Document() { XCAFApp_Application::GetApplication()->Close(document_); }
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  Handle(TDocStd_Document) & document() { return document_; }

  std::vector<Found> parts() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (int i = 1; i <= roots.Length(); ++i) walk(roots.Value(i), TopLoc_Location(), "");
    return std::move(parts_);
  }

 private:
  void walk(const TDF_Label& label, const TopLoc_Location& location, const std::string& instance) {
    TDF_Label referred;
    if (XCAFDoc_ShapeTool::GetReferredShape(label, referred)) {
      walk(referred, location * XCAFDoc_ShapeTool::GetLocation(label), name_of(label));
      return;
    }
    if (XCAFDoc_ShapeTool::IsAssembly(label)) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(label, components);
      for (int i = 1; i <= components.Length(); ++i) walk(components.Value(i), location, "");
      return;
    }
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    std::string product = name_of(label);
    if (is_no_name(product)) product = instance;
    std::vector<TopoDS_Shape> bodies;
    for (TopExp_Explorer i(shape, TopAbs_SOLID); i.More(); i.Next()) bodies.push_back(i.Current());
    if (bodies.empty()) bodies.push_back(shape);
    for (const TopoDS_Shape& body : bodies) {
      Found found;
      found.name = product;
      found.shape = body.Moved(location);
      TDF_Label own;
      std::optional<std::array<int, 3>> colour_of_solid = colour(label);
      if (bodies.size() > 1 && shapes_->FindSubShape(label, body, own)) {
        const std::string name = name_of(own);
        if (!is_no_name(name)) found.name = name;
        if (const auto given = colour(own)) colour_of_solid = given;
      }
      for (TopExp_Explorer i(body, TopAbs_FACE); i.More(); i.Next()) {
        const TopoDS_Face face = TopoDS::Face(i.Current());
        TDF_Label of_face;
        std::optional<std::array<int, 3>> given;
        if (shapes_->FindSubShape(label, face, of_face)) {
          const std::string name = name_of(of_face);
          if (!is_no_name(name)) found.face_names.emplace_back(TopoDS::Face(face.Moved(location)), name);
          given = colour(of_face);
        }
        if (!given) given = colour_of_solid;
        if (given) found.colours.emplace_back(TopoDS::Face(face.Moved(location)), *given);
      }
      parts_.push_back(std::move(found));
    }
  }

  std::optional<std::array<int, 3>> colour(const TDF_Label& label) const {
    Quantity_Color value;
    if (!colours_->GetColor(label, XCAFDoc_ColorSurf, value) && !colours_->GetColor(label, XCAFDoc_ColorGen, value))
      return std::nullopt;
    double red = 0, green = 0, blue = 0;
    value.Values(red, green, blue, Quantity_TOC_sRGB);
    const auto byte = [](double x) { return static_cast<int>(std::lround(255 * x)); };
    return std::array<int, 3>{byte(red), byte(green), byte(blue)};
  }

  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  std::vector<Found> parts_;
};

/// Items of a kind that OpenCASCADE does not know are null, which it does not expect; leaves them out and counts them.
int remove_unknown_items(const Interface_InterfaceModel& model) {
  int removed = 0;
  for (int e = 1; e <= model.NbEntities(); ++e) {
    const auto representation = Handle(StepRepr_Representation)::DownCast(model.Value(e));
    if (representation.IsNull() || representation->Items().IsNull()) continue;
    const StepRepr_HArray1OfRepresentationItem& items = *representation->Items();
    std::vector<Handle(StepRepr_RepresentationItem)> known;
    for (int k = items.Lower(); k <= items.Upper(); ++k)
      if (!items.Value(k).IsNull()) known.push_back(items.Value(k));
    const int count = static_cast<int>(known.size());
    if (count == items.Length()) continue;
    removed += items.Length() - count;
    Handle(StepRepr_HArray1OfRepresentationItem) left;  // null: none
    if (count > 0) left = new StepRepr_HArray1OfRepresentationItem(1, count);
    for (int k = 0; k < count; ++k) left->SetValue(k + 1, known[k]);
    representation->SetItems(left);
  }
  return removed;
}

/// Solids that the reader has met and made nothing of.
int count_lost_solids(const XSControl_WorkSession& session) {
  const Handle(Transfer_TransientProcess) process = session.TransferReader()->TransientProcess();
  int lost = 0;
  for (int e = 1; e <= session.Model()->NbEntities(); ++e) {
    const Handle(Standard_Transient) entity = session.Model()->Value(e);
    if (entity->IsKind(STANDARD_TYPE(StepShape_SolidModel)) && process->IsBound(entity) &&
        TransferBRep::ShapeResult(process, entity).IsNull())
      ++lost;
  }
  return lost;
}

/// Names of other files that the file refers to.
std::string names_of_other_files(const Interface_InterfaceModel& model) {
  std::set<std::string> names;
  for (int e = 1; e <= model.NbEntities(); ++e) {
    const auto document = Handle(StepBasic_DocumentFile)::DownCast(model.Value(e));
    if (document.IsNull()) continue;
    for (const Handle(TCollection_HAsciiString) & text : {document->Id(), document->Name()})
      if (!text.IsNull() && text->Length() > 0) {
        names.insert(fmt::format("\"{}\"", printable(text->ToCString(), 80)));
        break;
      }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Checks that all files of an assembly's components are there.
void check_other_files(const std::string& file, const STEPCAFControl_Reader& reader) {
  for (NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator i(
           reader.ExternFiles());
       i.More(); i.Next())
    if (i.Value()->GetLoadStatus() != IFSelect_RetDone || !i.Value()->GetTransferStatus())
      throw InputError(
          fmt::format("{}: it is an assembly whose parts lie in other files, and \"{}\" cannot be read (allowed: all "
                      "of its files in one folder, or an export as one file)",
                      file, printable(i.Key().ToCString(), 200)));
}

std::string counted(int count, const char* one, const char* several) {
  return count == 1 ? std::string(one) : fmt::format("{} {}", count, several);
}

}  // namespace

bool is_no_name(const std::string& name) {
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  return upper.empty() || upper.rfind("OPEN CASCADE STEP TRANSLATOR", 0) == 0 || upper == "NONE" ||
         upper == "ADVANCED_FACE" || upper == "FACE" || upper == "SOLID";
}

std::vector<Found> read_step(const std::string& file, Remarks& remarks) {
  check_step_references(file);
  Document document;
  STEPCAFControl_Reader reader;
  // After the reader is made: its constructor sets all of these to what they are by default.
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  reader.SetNameMode(true);
  reader.SetColorMode(true);
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone)
    throw InputError(file + ": is not a STEP file that can be read (allowed: ISO 10303-21 text, AP203, AP214, AP242)");
  const Handle(XSControl_WorkSession) session = reader.Reader().WS();
  const int unknown = remove_unknown_items(*session->Model());
  remarks.other_files = names_of_other_files(*session->Model());
  const bool transferred = reader.Transfer(document.document());
  check_other_files(file, reader);
  if (!transferred) throw InputError(file + ": no shape of it can be read" + remarks.where_else());
  const int lost = count_lost_solids(*session);
  if (lost > 0) remarks.left_out = counted(lost, "a solid", "solids") + " of it cannot be read and is left out";
  if (unknown > 0)
    remarks.left_out += (lost > 0 ? "; " : "") + counted(unknown, "an item", "items") +
                        " of a kind that OpenCASCADE does not know (annotations, for the most part) left out";
  return document.parts();
}

std::vector<Found> read_iges(const std::string& file) {
  Document document;
  IGESCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(true);
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone)
    throw InputError(file + ": is not an IGES file that can be read");
  if (!reader.Transfer(document.document())) throw InputError(file + ": no shape of it can be read");
  return document.parts();
}

std::vector<Found> read_brep(const std::string& file) {
  TopoDS_Shape shape;
  BRep_Builder builder;
  if (!BRepTools::Read(shape, file.c_str(), builder) || shape.IsNull())
    throw InputError(file + ": is not a BREP file that can be read");
  std::vector<Found> parts;
  const auto add = [&](const TopoDS_Shape& part) {
    Found found;
    found.shape = part;
    parts.push_back(found);
  };
  for (TopExp_Explorer i(shape, TopAbs_SOLID); i.More(); i.Next()) add(i.Current());
  if (parts.empty()) add(shape);
  return parts;
}

}  // namespace cgcontact
