#include "tests/support/cad_parts.hpp"

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <fstream>
#include <gp_Circ.hxx>

namespace cgcontact::test {

namespace {

const double pi = std::acos(-1.0);

void write_step(const TopoDS_Shape& shape, const std::string& file, const char* unit = "MM") {
  STEPControl_Writer writer;
  Interface_Static::SetCVal("write.step.unit", unit);
  writer.Transfer(shape, STEPControl_AsIs);
  writer.Write(file.c_str());
}

/// Turned about a skew axis and moved, so that nothing is parallel to the axes.
TopoDS_Shape skew(const TopoDS_Shape& shape) {
  gp_Trsf turn, move;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 0.4, -0.7)), 0.7);
  move.SetTranslation(gp_Vec(3, -2, 5));
  return BRepBuilderAPI_Transform(shape, move * turn, true).Shape();
}

TopoDS_Shape rounded(const TopoDS_Shape& shape, double radius) {
  BRepFilletAPI_MakeFillet fillet(shape);
  for (TopExp_Explorer e(shape, TopAbs_EDGE); e.More(); e.Next()) fillet.Add(radius, TopoDS::Edge(e.Current()));
  return fillet.Shape();
}

/// Smooth through three circles of different sizes, the middle one beside the axis: free-form surfaces.
TopoDS_Shape lofted() {
  BRepOffsetAPI_ThruSections loft(true, false);
  const double radius[3] = {5, 3, 4}, shift[3] = {0, 1.5, -1};
  for (int k = 0; k < 3; ++k) {
    const gp_Circ circle(gp_Ax2(gp_Pnt(shift[k], 0, 5 * k), gp_Dir(0.1 * k, 0, 1)), radius[k]);
    loft.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire());
  }
  loft.Build();
  return loft.Shape();
}

TopoDS_Shape cross_drilled() {
  const TopoDS_Shape shaft = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -8), gp_Dir(0, 0, 1)), 5, 16).Shape();
  const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-10, 0, 1), gp_Dir(1, 0, 0.2)), 2, 20).Shape();
  return BRepAlgoAPI_Cut(shaft, hole).Shape();
}

/// A lug: a plate with a rounded end and an eye, on a foot, with a fillet between both.
TopoDS_Shape lug() {
  const TopoDS_Shape foot = BRepPrimAPI_MakeBox(gp_Pnt(-20, -15, 0), gp_Pnt(20, 15, 8)).Shape();
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(gp_Pnt(-12, -5, 0), gp_Pnt(12, 5, 30)).Shape();
  const TopoDS_Shape end = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, -5, 30), gp_Dir(0, 1, 0)), 12, 10).Shape();
  const TopoDS_Shape eye = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, -20, 30), gp_Dir(0, 1, 0)), 6, 40).Shape();
  ShapeUpgrade_UnifySameDomain unify(
      BRepAlgoAPI_Fuse(foot, BRepAlgoAPI_Cut(BRepAlgoAPI_Fuse(plate, end).Shape(), eye).Shape()).Shape());
  unify.Build();
  const TopoDS_Shape solid = unify.Shape();
  BRepFilletAPI_MakeFillet fillet(solid);
  for (TopExp_Explorer e(solid, TopAbs_EDGE); e.More(); e.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(e.Current());
    double t0 = 0, t1 = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, t0, t1);
    if (curve.IsNull()) continue;
    const gp_Pnt a = curve->Value(t0), b = curve->Value(t1);
    const bool on_foot = std::abs(a.Z() - 8) < 1e-6 && std::abs(b.Z() - 8) < 1e-6;
    if (on_foot && std::abs(std::abs(a.Y()) - 5) < 1e-6 && std::abs(std::abs(b.Y()) - 5) < 1e-6 &&
        std::abs(a.Y() - b.Y()) < 1e-6)
      fillet.Add(3, edge);
  }
  fillet.Build();
  return fillet.Shape();
}

TopoDS_Shape quarter(const TopoDS_Shape& shape, double size, double thickness) {
  return BRepAlgoAPI_Common(shape, BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(size, size, thickness)).Shape()).Shape();
}

TopoDS_Shape ring(double inner, double outer, double height) {
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(outer, height).Shape(),
                         BRepPrimAPI_MakeCylinder(inner, height).Shape())
      .Shape();
}

TopoDS_Shape shell(double inner, double outer) {
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(outer).Shape(), BRepPrimAPI_MakeSphere(inner).Shape()).Shape();
}

/// Faces of a box but one, or all with one of them moved outwards: an open surface.
void write_broken(const std::string& folder) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(10, 10, 10).Shape();
  BRep_Builder builder;
  TopoDS_Shell open;
  TopoDS_Compound loose;
  builder.MakeShell(open);
  builder.MakeCompound(loose);
  int number = 0;
  for (TopExp_Explorer f(box, TopAbs_FACE); f.More(); f.Next(), ++number) {
    if (number == 5) {
      gp_Trsf up;
      up.SetTranslation(gp_Vec(0, 0, 1e-3));
      builder.Add(loose, BRepBuilderAPI_Transform(f.Current(), up, true).Shape());
      continue;
    }
    builder.Add(open, f.Current());
    builder.Add(loose, f.Current());
  }
  write_step(open, folder + "/open_box.step");
  write_step(loose, folder + "/loose_box.step");
  BRepTools::Write(box, (folder + "/box.brep").c_str());
  IGESControl_Writer iges("MM", 1);
  iges.AddShape(box);
  iges.ComputeModel();
  iges.Write((folder + "/box.igs").c_str());
  std::ofstream(folder + "/text.step") << "solid cube\nfacet normal 0 0 1\n";
  std::ofstream(folder + "/empty.step") << "";
}

/// The lug with names for two of its faces.
void write_lug(const std::string& folder) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TopoDS_Shape part = lug();
  const TDF_Label label = shapes->AddShape(part, false);
  TDataStd_Name::Set(label, "lug");
  for (TopExp_Explorer f(part, TopAbs_FACE); f.More(); f.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(f.Current()));
    if (surface.GetType() == GeomAbs_Cylinder && surface.Cylinder().Radius() == 6)
      TDataStd_Name::Set(shapes->AddSubShape(label, f.Current()), "eye");
    if (surface.GetType() == GeomAbs_Plane && surface.Value(0, 0).Z() == 0 &&
        std::abs(surface.Plane().Axis().Direction().Z()) == 1)
      TDataStd_Name::Set(shapes->AddSubShape(label, f.Current()), "sole");
  }
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  writer.SetNameMode(true);
  writer.Transfer(document);
  writer.Write((folder + "/lug.step").c_str());
  XCAFApp_Application::GetApplication()->Close(document);
}

/// The rings of a ball bearing, width 13, for twelve balls of radius 3.5 on a circle of 21.25; the grooves' radius
/// is 1.25 times the balls', and the inner ring is thick, so that it stays round. Named faces: "bore", "outside",
/// "groove".
void write_bearing(const std::string& folder) {
  const double pitch = 21.25, ball = 3.5, groove = 1.25 * ball, width = 13;
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label assembly = shapes->NewShape();
  TDataStd_Name::Set(assembly, "bearing");
  const auto add = [&](const char* name, double inside, double outside, double torus, const char* named,
                       double radius) {
    const TopoDS_Shape grooved =
        BRepAlgoAPI_Cut(ring(inside, outside, width),
                        BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, width / 2), gp_Dir(0, 0, 1)), torus, groove).Shape())
            .Shape();
    TopExp_Explorer solids(grooved, TopAbs_SOLID);
    const TopoDS_Shape part = solids.Current();
    const TDF_Label label = shapes->AddShape(part, false);
    TDataStd_Name::Set(label, name);
    for (TopExp_Explorer f(part, TopAbs_FACE); f.More(); f.Next()) {
      const BRepAdaptor_Surface surface(TopoDS::Face(f.Current()));
      if (surface.GetType() == GeomAbs_Torus) TDataStd_Name::Set(shapes->AddSubShape(label, f.Current()), "groove");
      if (surface.GetType() == GeomAbs_Cylinder && surface.Cylinder().Radius() == radius)
        TDataStd_Name::Set(shapes->AddSubShape(label, f.Current()), named);
    }
    gp_Trsf to_middle;
    to_middle.SetTranslation(gp_Vec(0, 0, -width / 2));
    shapes->AddComponent(assembly, label, TopLoc_Location(to_middle));
  };
  add("inner", 10, 19.2, pitch - ball + groove, "bore", 10);
  add("outer", 23.3, 27.5, pitch + ball - groove, "outside", 27.5);
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  writer.SetNameMode(true);
  writer.Transfer(document);
  writer.Write((folder + "/bearing.step").c_str());
  XCAFApp_Application::GetApplication()->Close(document);
}

/// Two bolts, one turned and moved, and a plate with named and coloured faces; lengths in inches.
void write_assembly(const std::string& folder) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TopoDS_Shape bolt = BRepPrimAPI_MakeCylinder(2, 20).Shape();
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(gp_Pnt(-15, -15, -5), gp_Pnt(15, 15, 0)).Shape();
  const TDF_Label bolt_label = shapes->AddShape(bolt, false), plate_label = shapes->AddShape(plate, false);
  TDataStd_Name::Set(bolt_label, "bolt");
  TDataStd_Name::Set(plate_label, "base plate");
  int number = 0;
  for (TopExp_Explorer f(plate, TopAbs_FACE); f.More(); f.Next(), ++number) {
    const TDF_Label label = shapes->AddSubShape(plate_label, f.Current());
    if (number == 5) {
      TDataStd_Name::Set(label, "seat");
      colours->SetColor(label, Quantity_Color(1, 0, 0, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
    }
  }
  const TDF_Label assembly = shapes->NewShape();
  TDataStd_Name::Set(assembly, "assembly");
  gp_Trsf turned, moved;
  moved.SetTranslation(gp_Vec(8, 0, 0));
  turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), pi / 6);
  shapes->AddComponent(assembly, bolt_label, TopLoc_Location(moved));
  shapes->AddComponent(assembly, bolt_label, TopLoc_Location(moved * turned));
  shapes->AddComponent(assembly, plate_label, TopLoc_Location());
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.unit", "INCH");
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  writer.Transfer(document);
  writer.Write((folder + "/assembly.step").c_str());
  XCAFApp_Application::GetApplication()->Close(document);
}

/// Shapes whose faces are all B-splines, as some exporters write them: a plate on a block, skew, and a pin that fills a
/// bore.
void write_splines(const std::string& folder) {
  const auto both = [](const TopoDS_Shape& a, const TopoDS_Shape& b) {
    TopoDS_Compound compound;
    BRep_Builder builder;
    builder.MakeCompound(compound);
    for (const TopoDS_Shape& shape : {a, b}) builder.Add(compound, BRepBuilderAPI_NurbsConvert(shape, true).Shape());
    return compound;
  };
  const TopoDS_Shape pin = BRepPrimAPI_MakeCylinder(5, 8).Shape();
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(gp_Pnt(-10, -12, 0), gp_Pnt(10, 12, 8)).Shape();
  write_step(both(BRepAlgoAPI_Cut(block, pin).Shape(), pin), folder + "/spline_pin.step");
  write_step(both(skew(BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(20, 20, 10)).Shape()),
                  skew(BRepPrimAPI_MakeBox(gp_Pnt(-5, -5, 10), gp_Pnt(25, 25, 13)).Shape())),
             folder + "/spline_boxes.step");
  write_step(both(skew(BRepPrimAPI_MakeCone(4, 2, 6).Shape()), BRepPrimAPI_MakeSphere(gp_Pnt(40, 0, 0), 3).Shape()),
             folder + "/spline_cone_and_ball.step");
}

}  // namespace

std::vector<CadPart> write_cad_parts(const std::string& folder) {
  const Message_SequenceOfPrinters printers = Message::DefaultMessenger()->Printers();
  for (Message_SequenceOfPrinters::Iterator i(printers); i.More(); i.Next())
    Message::DefaultMessenger()->RemovePrinter(i.Value());
  std::vector<CadPart> parts;
  const auto add = [&](const std::string& name, const TopoDS_Shape& shape, double volume, double area) {
    write_step(shape, folder + "/" + name + ".step");
    parts.push_back({name, volume, area});
  };
  add("box", BRepPrimAPI_MakeBox(10, 7, 5).Shape(), 350, 310);
  add("cylinder", BRepPrimAPI_MakeCylinder(5, 8).Shape(), 200 * pi, 130 * pi);
  add("sphere", BRepPrimAPI_MakeSphere(5).Shape(), 500 * pi / 3, 100 * pi);
  add("torus", BRepPrimAPI_MakeTorus(5, 2).Shape(), 40 * pi * pi, 40 * pi * pi);
  add("cone", BRepPrimAPI_MakeCone(4, 2, 6).Shape(), 56 * pi, (20 + 6 * std::sqrt(40.0)) * pi);
  add("tip", BRepPrimAPI_MakeCone(4, 0, 6).Shape(), 32 * pi, (16 + 4 * std::sqrt(52.0)) * pi);
  add("skew_cylinder", skew(BRepPrimAPI_MakeCylinder(5, 8).Shape()), 200 * pi, 130 * pi);
  add("skew_sphere", skew(BRepPrimAPI_MakeSphere(5).Shape()), 500 * pi / 3, 100 * pi);
  add("shell", shell(3, 5), 4 * pi / 3 * 98, 4 * pi * 34);
  add("filleted", rounded(BRepPrimAPI_MakeBox(10, 8, 6).Shape(), 1.5), 0, 0);
  add("skew_filleted", skew(rounded(BRepPrimAPI_MakeBox(10, 8, 6).Shape(), 1.5)), 0, 0);
  add("lofted", lofted(), 0, 0);
  add("cross_drilled", cross_drilled(), 0, 0);
  write_lug(folder);
  parts.push_back({"lug", 0, 0});
  add("inner_ring", quarter(ring(400, 700, 1000), 1000, 100), 0, 0);
  add("outer_ring", quarter(ring(700, 1000, 1000), 1100, 100), 0, 0);
  add("ball_octant", quarter(BRepPrimAPI_MakeSphere(700).Shape(), 1000, 1000), 0, 0);
  add("shell_octant", quarter(shell(700, 1000), 1100, 1100), 0, 0);
  write_bearing(folder);
  write_broken(folder);
  write_splines(folder);
  write_assembly(folder);  // last: it leaves the unit of its file to those after it
  return parts;
}

}  // namespace cgcontact::test
