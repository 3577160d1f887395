// SPDX-License-Identifier: Apache-2.0
// What the tests write and ask; errors are thrown, as in any test.
#include "occ_files.hpp"

#include <BOPAlgo_Builder.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <Geom_BSplineCurve.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <fstream>
#include <gp_Ax1.hxx>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace delfront::occ {
namespace {

/// What it reports of its work is no part of a test's output.
void be_silent() { Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream)); }

void require(bool is_done, const std::string& path) {
  if (!is_done) throw std::runtime_error("cannot write " + path);
}

}  // namespace

TopoDS_Compound compound_of(const std::vector<TopoDS_Shape>& shapes) {
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : shapes) builder.Add(all, shape);
  return all;
}

void write_step(const TopoDS_Shape& shape, const std::string& path) {
  be_silent();
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  require(writer.Write(path.c_str()) == IFSelect_RetDone, path);
}

void write_iges(const TopoDS_Shape& shape, const std::string& path) {
  be_silent();
  IGESControl_Writer writer("MM", 0);
  writer.AddShape(shape);
  writer.ComputeModel();
  require(writer.Write(path.c_str()), path);
}

void write_brep(const TopoDS_Shape& shape, const std::string& path) {
  require(BRepTools::Write(shape, path.c_str()), path);
}

void write_coloured_box(const std::string& name, const std::vector<Colour>& colours, const std::string& path) {
  be_silent();
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) tool = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TopoDS_Shape made = box(1, 2, 3);
  const TDF_Label label = shapes->AddShape(made, false);
  TDataStd_Name::Set(label, name.c_str());
  std::size_t i = 0;
  for (TopExp_Explorer face(made, TopAbs_FACE); face.More() && i < colours.size(); face.Next(), ++i) {
    const TDF_Label sub = shapes->AddSubShape(label, face.Current());
    tool->SetColor(sub, Quantity_Color(colours[i].r, colours[i].g, colours[i].b, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  }
  STEPCAFControl_Writer writer;
  writer.Transfer(document, STEPControl_AsIs);
  require(writer.Write(path.c_str()) == IFSelect_RetDone, path);
  XCAFApp_Application::GetApplication()->Close(document);
}

void write_assembly(const std::vector<Product>& products, const std::string& path) {
  be_silent();
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label whole = shapes->NewShape();
  TDataStd_Name::Set(whole, "whole");
  for (const Product& product : products) {
    const TDF_Label label = shapes->AddShape(product.solid, false);
    TDataStd_Name::Set(label, TCollection_ExtendedString(product.name.c_str(), true));
    for (const Point& at : product.at) {
      gp_Trsf move;
      move.SetTranslation(gp_Vec(at.x, at.y, at.z));
      shapes->AddComponent(whole, label, TopLoc_Location(move));
    }
  }
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  writer.Transfer(document, STEPControl_AsIs);
  require(writer.Write(path.c_str()) == IFSelect_RetDone, path);
  XCAFApp_Application::GetApplication()->Close(document);
}

TopoDS_Shape box(double x, double y, double z, Point at) {
  return BRepPrimAPI_MakeBox(gp_Pnt(at.x, at.y, at.z), x, y, z).Shape();
}
TopoDS_Shape cylinder(double radius, double height) { return BRepPrimAPI_MakeCylinder(radius, height).Shape(); }
TopoDS_Shape sphere(double radius) { return BRepPrimAPI_MakeSphere(radius).Shape(); }
TopoDS_Shape cone(double low, double high, double height) { return BRepPrimAPI_MakeCone(low, high, height).Shape(); }
TopoDS_Shape torus(double radius, double tube) { return BRepPrimAPI_MakeTorus(radius, tube).Shape(); }

TopoDS_Shape tee() {
  const TopoDS_Shape main = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -3), gp_Dir(0, 0, 1)), 1, 6).Shape();
  const TopoDS_Shape branch = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), 0.6, 3).Shape();
  return BRepAlgoAPI_Fuse(main, branch).Shape();
}

TopoDS_Shape two_boxes(bool is_fused) {
  const TopoDS_Shape a = box(1, 1, 1), b = box(2, 1, 1, {1, 0, 0});
  if (!is_fused) return compound_of({a, b});
  BOPAlgo_Builder builder;
  builder.AddArgument(a);
  builder.AddArgument(b);
  builder.Perform();
  return builder.Shape();
}

TopoDS_Shape lattice(std::size_t a_side, double turn) {
  std::vector<TopoDS_Shape> boxes;
  for (std::size_t i = 0; i < a_side * a_side * a_side; ++i)
    boxes.push_back(box(1, 1, 1, {double(i % a_side), double(i / a_side % a_side), double(i / a_side / a_side)}));
  gp_Trsf place;
  place.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)), turn);
  return compound_of(boxes).Moved(TopLoc_Location(place));
}

TopoDS_Shape pin_in_a_block(double turn) {
  const gp_Ax2 axis(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1));
  const TopoDS_Shape pin = BRepPrimAPI_MakeCylinder(axis, 0.5, 1).Shape();
  const TopoDS_Shape block = BRepAlgoAPI_Cut(box(2, 2, 1, {-1, -1, 0}), pin).Shape();
  gp_Trsf turned;
  turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turn);
  return compound_of({block, BRepBuilderAPI_Transform(pin, turned, true).Shape()});
}

namespace {

/// An aerofoil of a kind, closed, square to the x axis, turned about it.
TopoDS_Wire section(double x, double chord, double thickness, double pitch) {
  constexpr int kPoints = 16;
  const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double w = 2 * std::numbers::pi * i / kPoints;
    const double along = 0.5 * chord * std::cos(w), across = 0.5 * thickness * std::sin(w) * (1 + 0.3 * std::cos(w));
    points->SetValue(i + 1, gp_Pnt(x, along * std::cos(pitch) - across * std::sin(pitch),
                                   along * std::sin(pitch) + across * std::cos(pitch)));
  }
  GeomAPI_Interpolate spline(points, true, 1e-9);
  spline.Perform();
  return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(spline.Curve()).Edge()).Wire();
}

}  // namespace

TopoDS_Shape propeller(int blades) {
  BRepOffsetAPI_ThruSections loft(true, false, 1e-6);
  loft.CheckCompatibility(false);  // which would cut closed sections in pieces that wave
  for (int i = 0; i <= 5; ++i) {
    const double s = i / 5.0;
    loft.AddWire(section(0.15 + 0.85 * s, 0.35 * (1 - 0.5 * s * s), 0.06 * (1 - 0.6 * s), 1.1 - 0.8 * s));
  }
  loft.Build();
  std::vector<TopoDS_Shape> parts = {
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -0.5), gp_Dir(0, 0, 1)), 0.3, 1).Shape()};
  for (int k = 0; k < blades; ++k) {
    gp_Trsf turned;
    turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 2 * std::numbers::pi * k / blades);
    parts.push_back(BRepBuilderAPI_Transform(loft.Shape(), turned, true).Shape());
  }
  return compound_of(parts);
}

TopoDS_Shape open_box() {
  const TopoDS_Shape whole = box(1, 1, 1);
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer face(whole, TopAbs_FACE); face.More(); face.Next()) faces.push_back(face.Current());
  faces.pop_back();
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (const TopoDS_Shape& face : faces) builder.Add(shell, face);
  return shell;
}

TopoDS_Shape loose_box() {
  const TopoDS_Shape whole = box(1, 2, 3);
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer face(whole, TopAbs_FACE); face.More(); face.Next())
    faces.push_back(BRepBuilderAPI_Copy(face.Current()).Shape());
  return compound_of(faces);
}

namespace {

Handle(Geom_BSplineCurve) wave() {
  TColgp_Array1OfPnt points(1, 6);
  const double z[] = {0, 0.4, 1.1, 0.7, 0.2, 0.3};
  for (int i = 1; i <= 6; ++i) points(i) = gp_Pnt(1 + z[i - 1], 0, 0.8 * i);
  return GeomAPI_PointsToBSpline(points).Curve();
}

}  // namespace

TopoDS_Shape bent_plate() {
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(wave());
  const TopoDS_Shape sheet = BRepPrimAPI_MakePrism(edge, gp_Vec(0, 2, 0)).Shape();
  return BRepPrimAPI_MakePrism(sheet, gp_Vec(1.5, 0, 0)).Shape();
}

TopoDS_Shape revolved_spline() {
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(wave());
  return BRepPrimAPI_MakeRevol(edge, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape();
}

double area_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-9);
  return properties.Mass();
}

double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-9);
  return properties.Mass();
}

double distance_to(const TopoDS_Shape& shape, Point p) {
  const TopoDS_Shape vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(p.x, p.y, p.z)).Shape();
  BRepExtrema_DistShapeShape search(vertex, shape);
  if (!search.IsDone() || search.NbSolution() == 0) throw std::runtime_error("no projection was found");
  double least = search.Value();  // which misses places within faces at times
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More() && least > 0; face.Next()) {
    GeomAPI_ProjectPointOnSurf on(gp_Pnt(p.x, p.y, p.z), BRep_Tool::Surface(TopoDS::Face(face.Current())));
    if (on.NbPoints() > 0) least = std::min(least, on.LowerDistance());
    ShapeAnalysis_Surface surface(BRep_Tool::Surface(TopoDS::Face(face.Current())));  // so does that, near poles
    const gp_Pnt2d uv = surface.ValueOfUV(gp_Pnt(p.x, p.y, p.z), 1e-12);
    least = std::min(least, surface.Value(uv).Distance(gp_Pnt(p.x, p.y, p.z)));
  }
  return least;
}

TopoDS_Shape read(const std::string& path, const std::string& unit) {
  be_silent();
  const std::string suffix = path.substr(path.rfind('.'));
  TopoDS_Shape shape;
  if (suffix == ".brep" || suffix == ".egads") {
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    std::istringstream rest(text.str().substr(text.str().find("CASCADE Topology")));
    BRep_Builder builder;
    BRepTools::Read(shape, rest, builder);
    return shape;
  }
  if (suffix == ".iges" || suffix == ".igs" || suffix == ".IGS") {
    IGESControl_Reader reader;
    reader.ReadFile(path.c_str());
    Interface_Static::SetCVal("xstep.cascade.unit", unit.c_str());
    reader.TransferRoots();
    return reader.OneShape();
  }
  STEPControl_Reader reader;
  reader.ReadFile(path.c_str());
  Interface_Static::SetCVal("xstep.cascade.unit", unit.c_str());
  reader.TransferRoots();
  return reader.OneShape();
}

}  // namespace delfront::occ
