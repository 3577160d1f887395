// SPDX-License-Identifier: Apache-2.0
#include "bad_shapes.hpp"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <gp_Circ.hxx>
#include <gp_Trsf.hxx>
#include <stdexcept>
#include <vector>

#include "occ_files.hpp"
#include "shells.hpp"

namespace delfront::occ {
namespace {

std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
    faces.push_back(TopoDS::Face(face.Current()));
  return faces;
}

TopoDS_Shape unit_box() { return BRepPrimAPI_MakeBox(1, 1, 1).Shape(); }

TopoDS_Solid solid_of(const std::vector<TopoDS_Face>& faces) {
  BRep_Builder builder;
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, cad::shell_of(faces));
  return solid;
}

TopoDS_Vertex vertex_at(const gp_Pnt& p) {
  TopoDS_Vertex v;
  BRep_Builder().MakeVertex(v, p, 1e-7);
  return v;
}

TopoDS_Edge line_between(const TopoDS_Vertex& a, const TopoDS_Vertex& b, const gp_Dir& way) {
  BRep_Builder builder;
  TopoDS_Edge edge;
  const gp_Pnt from = BRep_Tool::Pnt(a);
  builder.MakeEdge(edge, new Geom_Line(from, way), 1e-7);
  builder.Add(edge, a.Oriented(TopAbs_FORWARD));
  builder.Add(edge, b.Oriented(TopAbs_REVERSED));
  builder.Range(edge, 0, from.Distance(BRep_Tool::Pnt(b)));
  return edge;
}

/// An edge of the box's top and what it becomes.
TopoDS_Shape replaced(const TopoDS_Shape& shape, const TopoDS_Shape& from, const TopoDS_Shape& to) {
  const Handle(BRepTools_ReShape) context = new BRepTools_ReShape;
  context->Replace(from, to);
  return context->Apply(shape);
}

}  // namespace

TopoDS_Shape box_with_a_face_missing() {
  std::vector<TopoDS_Face> faces = faces_of(unit_box());
  faces.pop_back();
  return solid_of(faces);
}

TopoDS_Shape crossing_wire() {
  const gp_Pnt at[] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  TopoDS_Vertex vertex[4];
  for (int i = 0; i < 4; ++i) vertex[i] = vertex_at(at[i]);
  BRep_Builder builder;
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (int i = 0; i < 4; ++i)
    builder.Add(wire, line_between(vertex[i], vertex[(i + 1) % 4], gp_Dir(gp_Vec(at[i], at[(i + 1) % 4]))));
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 1e-7);
  builder.Add(face, wire);
  return face;
}

TopoDS_Shape box_with_a_tiny_edge(double length) {
  const TopoDS_Shape box = unit_box();
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(box, TopAbs_EDGE, edges);
  const TopoDS_Edge edge = TopoDS::Edge(edges(1).Oriented(TopAbs_FORWARD));
  TopoDS_Vertex first, last;
  TopExp::Vertices(edge, first, last);
  const gp_Vec way(BRep_Tool::Pnt(first), BRep_Tool::Pnt(last));
  const TopoDS_Vertex a = vertex_at(BRep_Tool::Pnt(first).Translated(0.5 * way));
  const TopoDS_Vertex b = vertex_at(BRep_Tool::Pnt(first).Translated((0.5 + length) * way));
  BRep_Builder builder;
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  builder.Add(wire, line_between(first, a, gp_Dir(way)));
  builder.Add(wire, line_between(a, b, gp_Dir(way)));
  builder.Add(wire, line_between(b, last, gp_Dir(way)));
  return replaced(box, edge, wire);
}

TopoDS_Shape cylinder_with_a_moved_parameter_curve(double by) {
  const TopoDS_Shape whole = BRepPrimAPI_MakeCylinder(1, 2).Shape();
  const TopoDS_Face side = faces_of(whole).front();
  for (TopExp_Explorer e(side, TopAbs_EDGE); e.More(); e.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(e.Current());
    if (BRep_Tool::IsClosed(edge, side)) continue;
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, side, first, last);
    const Handle(Geom2d_Curve) moved = Handle(Geom2d_Curve)::DownCast(curve->Translated(gp_Vec2d(0, by)));
    BRep_Builder().UpdateEdge(edge, moved, side, 1e-7);
    break;
  }
  return whole;
}

TopoDS_Shape box_with_a_double_face(bool is_copied) {
  std::vector<TopoDS_Face> faces = faces_of(unit_box());
  const TopoDS_Face twice = faces[2];
  faces.push_back(is_copied ? TopoDS::Face(BRepBuilderAPI_Copy(twice).Shape()) : twice);
  return solid_of(faces);
}

TopoDS_Shape inside_out_box() {
  std::vector<TopoDS_Face> faces = faces_of(unit_box());
  for (TopoDS_Face& face : faces) face.Reverse();
  return solid_of(faces);
}

TopoDS_Shape box_with_a_turned_face() {
  std::vector<TopoDS_Face> faces = faces_of(unit_box());
  faces[3].Reverse();
  return solid_of(faces);
}

TopoDS_Shape overlapping_boxes(double layer) {
  return compound_of({unit_box(), BRepPrimAPI_MakeBox(gp_Pnt(1 - layer, 0.2, 0.2), 1, 1, 1).Shape()});
}

TopoDS_Shape sheet_through_a_box() {
  const gp_Pln plane(gp_Pnt(0.5, 0.5, 0.5), gp_Dir(0, 0, 1));
  return compound_of({unit_box(), BRepBuilderAPI_MakeFace(plane, -1, 1, -1, 1).Shape()});
}

TopoDS_Shape box_and_an_edge() {
  return compound_of({unit_box(), BRepBuilderAPI_MakeEdge(gp_Pnt(2, 0, 0), gp_Pnt(3, 1, 0)).Shape()});
}

TopoDS_Shape empty_compound() { return compound_of({}); }

TopoDS_Shape curves_only() {
  return compound_of({BRepBuilderAPI_MakeEdge(gp_Pnt(2, 0, 0), gp_Pnt(3, 1, 0)).Shape(),
                      BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(), 1)).Shape()});
}

TopoDS_Shape box_with_a_corner_at(double x) {
  const TopoDS_Shape box = unit_box();
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(box, TopAbs_VERTEX, vertices);
  BRep_Builder().UpdateVertex(TopoDS::Vertex(vertices(1)), gp_Pnt(x, 0, 0), 1e-7);
  return box;
}

TopoDS_Shape box_at(double x) { return BRepPrimAPI_MakeBox(gp_Pnt(x, 0, 0), 1, 1, 1).Shape(); }

TopoDS_Shape box_with_an_inner_edge() {
  const TopoDS_Shape box = unit_box();
  for (const TopoDS_Face& face : faces_of(box)) {
    const gp_Pln plane = Handle(Geom_Plane)::DownCast(BRep_Tool::Surface(face))->Pln();
    if (std::abs(plane.Axis().Direction().Z()) < 0.5 || plane.Location().Z() < 0.5) continue;
    const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(gp_Pnt(0.3, 0.3, 1), gp_Pnt(0.7, 0.6, 1));
    BRep_Builder builder;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    builder.Add(wire, edge.Oriented(TopAbs_INTERNAL));
    TopoDS_Face made = TopoDS::Face(face.EmptyCopied());
    for (TopoDS_Iterator it(face); it.More(); it.Next()) builder.Add(made, it.Value());
    builder.Add(made, wire.Oriented(TopAbs_INTERNAL));
    return replaced(box, face, made);
  }
  throw std::runtime_error("the box has no top");
}

void write_boxes(std::size_t n, double gap, const std::string& path) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label brick = shapes->AddShape(unit_box(), false), wall = shapes->NewShape();
  TDataStd_Name::Set(brick, "brick");
  TDataStd_Name::Set(wall, "wall");
  const auto side = std::size_t(std::ceil(std::cbrt(double(n))));
  for (std::size_t i = 0; i < n; ++i) {
    gp_Trsf move;
    move.SetTranslation((1 + gap) * gp_Vec(double(i % side), double(i / side % side), double(i / side / side)));
    shapes->AddComponent(wall, brick, TopLoc_Location(move));
  }
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  writer.Transfer(document, STEPControl_AsIs);
  if (writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("cannot write " + path);
  XCAFApp_Application::GetApplication()->Close(document);
}

}  // namespace delfront::occ
