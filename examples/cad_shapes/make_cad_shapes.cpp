// SPDX-License-Identifier: Apache-2.0
// Makes a CAD file with OpenCASCADE: make_cad_shapes FOLDER
//   ahmed.step  the air round the Ahmed body (25-degree slant) in a wind tunnel, millimetres, faces with names
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Tool.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <cstdio>
#include <functional>
#include <gp_Pln.hxx>
#include <numbers>
#include <stdexcept>
#include <string>

namespace {

constexpr double kPi = std::numbers::pi;

/// @param name_of  a name for a face, by what it lies on
void write_step(const TopoDS_Shape& shape, const std::string& name,
                const std::function<std::string(const TopoDS_Face&)>& name_of, const std::string& path) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  const TDF_Label product = shapes->AddShape(shape, false);
  TDataStd_Name::Set(product, name.c_str());
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
    TDataStd_Name::Set(shapes->AddSubShape(product, face.Current()), name_of(TopoDS::Face(face.Current())).c_str());
  if (!writer.Transfer(document, STEPControl_AsIs) || writer.Write(path.c_str()) != IFSelect_RetDone)
    throw std::runtime_error("cannot write " + path);
  XCAFApp_Application::GetApplication()->Close(document);
}

// The Ahmed body. S. R. Ahmed, G. Ramm, G. Faltin, Some salient features of the time-averaged ground vehicle wake, SAE
// 840300, 1984. x runs downstream from the nose, y to the left, z up from the tunnel's floor.
constexpr double kLength = 1044, kWidth = 389, kHeight = 288, kClearance = 50, kRadius = 100;
constexpr double kSlantLength = 222, kSlantAngle = 25 * kPi / 180;
constexpr double kStiltRadius = 15, kStiltX[] = {202, 672}, kStiltY = 327.0 / 2;
constexpr double kTunnelLow[] = {-2100, -935, 0}, kTunnelHigh[] = {7900, 935, 1400};

TopoDS_Edge arc(const gp_Pnt& a, const gp_Pnt& middle, const gp_Pnt& b) {
  return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(a, middle, b).Value());
}
TopoDS_Edge line(const gp_Pnt& a, const gp_Pnt& b) { return BRepBuilderAPI_MakeEdge(a, b); }

/// From the side: a rectangle with two round corners in front and the slant behind; pushed through the width.
TopoDS_Shape side_view() {
  const double low = kClearance, high = kClearance + kHeight, half = kWidth / 2, r = kRadius,
               d = r * (1 - std::sqrt(0.5));
  const double slant_x = kLength - kSlantLength * std::cos(kSlantAngle);
  const double slant_z = high - kSlantLength * std::sin(kSlantAngle);
  const auto at = [&](double x, double z) { return gp_Pnt(x, -half, z); };
  BRepBuilderAPI_MakeWire wire;
  wire.Add(arc(at(0, low + r), at(d, low + d), at(r, low)));
  wire.Add(line(at(r, low), at(kLength, low)));
  wire.Add(line(at(kLength, low), at(kLength, slant_z)));
  wire.Add(line(at(kLength, slant_z), at(slant_x, high)));
  wire.Add(line(at(slant_x, high), at(r, high)));
  wire.Add(arc(at(r, high), at(d, high - d), at(0, high - r)));
  wire.Add(line(at(0, high - r), at(0, low + r)));
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire.Wire()).Face(), gp_Vec(0, kWidth, 0)).Shape();
}

/// From above: round corners in front; pushed up.
TopoDS_Shape plan_view() {
  const double half = kWidth / 2, r = kRadius, d = r * (1 - std::sqrt(0.5));
  const auto at = [&](double x, double y) { return gp_Pnt(x, y, kClearance); };
  BRepBuilderAPI_MakeWire wire;
  wire.Add(arc(at(0, -half + r), at(d, -half + d), at(r, -half)));
  wire.Add(line(at(r, -half), at(kLength, -half)));
  wire.Add(line(at(kLength, -half), at(kLength, half)));
  wire.Add(line(at(kLength, half), at(r, half)));
  wire.Add(arc(at(r, half), at(d, half - d), at(0, half - r)));
  wire.Add(line(at(0, half - r), at(0, -half + r)));
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire.Wire()).Face(), gp_Vec(0, 0, kHeight)).Shape();
}

/// Both views have the body as what they share: roundings meet in a mitre.
TopoDS_Shape ahmed_air() {
  const TopoDS_Shape body = BRepAlgoAPI_Common(side_view(), plan_view()).Shape();
  TopoDS_Shape air = BRepPrimAPI_MakeBox(gp_Pnt(kTunnelLow[0], kTunnelLow[1], kTunnelLow[2]),
                                         gp_Pnt(kTunnelHigh[0], kTunnelHigh[1], kTunnelHigh[2]));
  air = BRepAlgoAPI_Cut(air, body).Shape();
  for (const double x : kStiltX)
    for (const double y : {-kStiltY, kStiltY})
      air =
          BRepAlgoAPI_Cut(
              air, BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, 0), gp_Dir(0, 0, 1)), kStiltRadius, kClearance).Shape())
              .Shape();
  return air;
}

std::string ahmed_name(const TopoDS_Face& face) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  if (const auto round = Handle(Geom_CylindricalSurface)::DownCast(surface); !round.IsNull())
    return round->Radius() < 2 * kStiltRadius ? "stilts" : "body";
  const gp_Pln plane = Handle(Geom_Plane)::DownCast(surface)->Pln();
  const gp_Pnt walls[] = {{kTunnelLow[0], 0, 1},  {kTunnelHigh[0], 0, 1}, {5, 0, kTunnelLow[2]},
                          {5, 0, kTunnelHigh[2]}, {5, kTunnelHigh[1], 1}, {5, kTunnelLow[1], 1}};
  const char* const names[] = {"inlet", "outlet", "floor", "top", "side_left", "side_right"};
  const gp_Dir ways[] = {{1, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
  for (int i = 0; i < 6; ++i)
    if (plane.Axis().Direction().IsParallel(ways[i], 1e-6) && plane.Distance(walls[i]) < 1e-6) return names[i];
  if (plane.Distance(gp_Pnt(kLength, 0, 0)) < 1e-6 && plane.Axis().Direction().IsParallel(gp_Dir(1, 0, 0), 1e-6))
    return "base";
  const double x = std::abs(plane.Axis().Direction().X());
  return x > 0.01 && x < 0.99 ? "slant" : "body";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_cad_shapes FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  try {
    write_step(ahmed_air(), "air", ahmed_name, folder + "/ahmed.step");
  } catch (const Standard_Failure& e) {
    std::fprintf(stderr, "OpenCASCADE: %s\n", e.GetMessageString());
    return 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
