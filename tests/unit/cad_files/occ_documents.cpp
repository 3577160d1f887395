// SPDX-License-Identifier: Apache-2.0
#include "occ_documents.hpp"

#include <IGESControl_Controller.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Trsf.hxx>
#include <stdexcept>
#include <vector>

#include "occ_files.hpp"

namespace delfront::occ {
void set_unit(const std::string& unit) {
  IGESControl_Controller::Init();
  STEPControl_Controller::Init();
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  Interface_Static::SetCVal("xstep.cascade.unit", unit.c_str());
  Interface_Static::SetCVal("write.step.unit", unit.c_str());
}

namespace {

/// Of a box: x low, x high, y low, y high, z low, z high.
std::vector<TopoDS_Shape> faces_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) faces.push_back(face.Current());
  return faces;
}

}  // namespace

void write_step_in(const std::string& unit, const TopoDS_Shape& shape, const std::string& path) {
  set_unit(unit);
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  if (writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("cannot write " + path);
}

void write_assembly(const std::string& path) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TopoDS_Shape left = box(1, 1, 1), right = box(2, 1, 1);
  const std::vector<TopoDS_Shape> of_left = faces_of(left), of_right = faces_of(right);
  const TDF_Label one = shapes->AddShape(left, false), other = shapes->AddShape(right, false);
  TDataStd_Name::Set(one, "left part");
  TDataStd_Name::Set(other, "right#2");
  TDataStd_Name::Set(shapes->AddSubShape(one, of_left[0]), "inlet");
  TDataStd_Name::Set(shapes->AddSubShape(other, of_right[1]), "outlet");
  const Quantity_Color orange(1, 128.0 / 255, 0, Quantity_TOC_sRGB);
  for (const std::size_t face : {2, 3})
    colours->SetColor(shapes->AddSubShape(one, of_left[face]), orange, XCAFDoc_ColorSurf);
  const TDF_Label root = shapes->NewShape();
  TDataStd_Name::Set(root, "two parts");
  gp_Trsf beside;
  beside.SetTranslation(gp_Vec(1, 0, 0));
  shapes->AddComponent(root, one, TopLoc_Location());
  shapes->AddComponent(root, other, TopLoc_Location(beside));
  shapes->UpdateAssemblies();
  set_unit("MM");
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  writer.Transfer(document, STEPControl_AsIs);
  if (writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("cannot write " + path);
  XCAFApp_Application::GetApplication()->Close(document);
}

}  // namespace delfront::occ
