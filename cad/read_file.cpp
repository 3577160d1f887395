// SPDX-License-Identifier: Apache-2.0
// Files to shapes. STEP and IGES go through the application framework, which knows colours, layers and products; what
// is left to find out is in which unit the file is written, since OpenCASCADE would turn everything into millimetres.
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_ReportEntity.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_ChildIterator.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <UnitsMethods.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "fmt/format.h"
#include "part.hpp"

namespace delfront::cad {
namespace {

/// A unit by the words that files use, as OpenCASCADE numbers it (and IGES does).
struct Unit {
  const char* word;
  const char* name;
  const char* code;
  double metres;
};
constexpr Unit kUnits[] = {{"inch", "in", "INCH", 0.0254},   {"millimetre", "mm", "MM", 1e-3},
                           {"millimeter", "mm", "MM", 1e-3}, {"foot", "ft", "FT", 0.3048},
                           {"feet", "ft", "FT", 0.3048},     {"mile", "mi", "MI", 1609.344},
                           {"kilometre", "km", "KM", 1e3},   {"kilometer", "km", "KM", 1e3},
                           {"centimetre", "cm", "CM", 1e-2}, {"centimeter", "cm", "CM", 1e-2},
                           {"micrometre", "um", "UM", 1e-6}, {"micron", "um", "UM", 1e-6},
                           {"metre", "m", "M", 1},           {"meter", "m", "M", 1}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

std::string suffix_of(const std::string& path) { return lower(std::filesystem::path(path).extension().string()); }

const Unit* find_unit(const std::string& words) {
  const std::string name = lower(words);
  for (const Unit& unit : kUnits)
    if (name.find(unit.word) != std::string::npos) return &unit;
  for (const Unit& unit : kUnits)
    if (name == unit.name) return &unit;
  return nullptr;
}

const Unit* find_code(const std::string& code) {
  for (const Unit& unit : kUnits)
    if (code == unit.code) return &unit;
  return nullptr;
}

/// Coordinates stay in the unit of the file.
void use_unit(const Unit* unit, CadReport& report) {
  const Unit& used = unit ? *unit : *find_code("MM");
  Interface_Static::SetCVal("xstep.cascade.unit", used.code);
  UnitsMethods::SetCasCadeLengthUnit(used.metres * 1000);
  if (!unit) return;
  report.unit = unit->name;
  report.metres_per_unit = unit->metres;
}

/// Names that say nothing.
std::string sensible(std::string name) {
  while (!name.empty() && std::isspace(static_cast<unsigned char>(name.back()))) name.pop_back();
  const auto first = std::find_if(name.begin(), name.end(), [](unsigned char c) { return !std::isspace(c); });
  name.erase(name.begin(), first);
  const std::string low = lower(name);
  // the last ones are OpenCASCADE's own for shapes without a name
  for (const char* word : {"none", "unnamed", "noname", "$", "*", "the product name", "compound", "compsolid", "solid",
                           "shell", "face", "wire", "edge", "vertex", "sheet", "brep", "trimmed_surf", "trsurf"})
    if (low == word) return {};
  if (low.rfind("open cascade", 0) == 0) return {};
  return name;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_AsciiString text(name->Get());  // UTF-8
  return sensible(text.ToCString());
}

std::string hex_of(const Quantity_Color& colour) {
  Standard_Real r = 0, g = 0, b = 0;
  colour.Values(r, g, b, Quantity_TOC_sRGB);
  const auto byte = [](double x) { return int(std::clamp(x, 0.0, 1.0) * 255 + 0.5); };
  return fmt::format("{:02X}{:02X}{:02X}", byte(r), byte(g), byte(b));
}

/// Walks through products and their instances, and notes what is known of each face in its place.
class Document {
 public:
  Document(const Handle(TDocStd_Document) & document, std::function<std::string(const TopoDS_Shape&)> entity_name)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colours_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        layers_(XCAFDoc_DocumentTool::LayerTool(document->Main())),
        entity_name_(std::move(entity_name)) {}

  TopoDS_Shape run(Part& part) {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    BRep_Builder builder;
    TopoDS_Compound all;
    builder.MakeCompound(all);
    for (int i = 1; i <= roots.Length(); ++i) {
      builder.Add(all, shapes_->GetShape(roots.Value(i)));
      walk(roots.Value(i), TopLoc_Location(), {}, part);
    }
    return all;
  }

 private:
  struct Inherited {
    std::string colour, layer, name;
  };

  void walk(const TDF_Label& label, const TopLoc_Location& at, Inherited from, Part& part) {
    TDF_Label product = label;
    TopLoc_Location here = at;
    if (const std::string layer = layer_of(label); !layer.empty()) from.layer = layer;
    if (const std::string colour = colour_of(label); !colour.empty()) from.colour = colour;
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      XCAFDoc_ShapeTool::GetReferredShape(label, product);
      here = at * XCAFDoc_ShapeTool::GetLocation(label);
      return walk(product, here, from, part);
    }
    if (const std::string name = name_of(product); !name.empty()) from.name = name;
    if (XCAFDoc_ShapeTool::IsAssembly(product)) {
      TDF_LabelSequence children;
      XCAFDoc_ShapeTool::GetComponents(product, children);
      for (int i = 1; i <= children.Length(); ++i) walk(children.Value(i), here, from, part);
      return;
    }
    note_faces(product, here, from, part);
  }

  /// Faces of a product; those of solids get the solid's name, where the product has several.
  void note_faces(const TDF_Label& product, const TopLoc_Location& at, const Inherited& from, Part& part) {
    const TopoDS_Shape shape = shapes_->GetShape(product);
    TopTools_IndexedMapOfShape solids, all;
    TopExp::MapShapes(shape, TopAbs_SOLID, solids);
    TopExp::MapShapes(shape, TopAbs_FACE, all);
    for (int s = 1; s <= solids.Extent(); ++s) {
      std::string name = own_name(product, solids(s));
      if (name.empty() || solids.Extent() == 1) name = from.name.empty() ? name : from.name;
      std::string colour = own_colour(product, solids(s));
      if (colour.empty()) colour = from.colour;
      TopTools_IndexedMapOfShape faces;
      TopExp::MapShapes(solids(s), TopAbs_FACE, faces);
      for (int f = 1; f <= faces.Extent(); ++f)
        note_face(product, faces(f), at, {colour, from.layer, name}, true, part);
      FaceFacts facts;
      facts.solids = {name};
      part.solids.set(solids(s).Moved(at), facts);
    }
    for (int f = 1; f <= all.Extent(); ++f)
      if (solids.IsEmpty()) note_face(product, all(f), at, from, false, part);
  }

  void note_face(const TDF_Label& product, const TopoDS_Shape& face, const TopLoc_Location& at, const Inherited& from,
                 bool is_of_solid, Part& part) {
    FaceFacts facts;
    facts.name = own_name(product, face);
    facts.colour = own_colour(product, face);
    if (facts.colour.empty()) facts.colour = from.colour;
    facts.layer = from.layer;
    TDF_Label sub;
    if (shapes_->FindSubShape(product, face, sub))
      if (const std::string layer = layer_of(sub); !layer.empty()) facts.layer = layer;
    if (is_of_solid || !from.name.empty()) facts.solids.push_back(from.name);
    part.faces.set(face.Moved(at), facts);
  }

  std::string own_name(const TDF_Label& product, const TopoDS_Shape& shape) const {
    TDF_Label sub;
    std::string name = entity_name_(shape);
    if (name.empty() && shapes_->FindSubShape(product, shape, sub)) name = name_of(sub);
    return name;
  }

  std::string own_colour(const TDF_Label& product, const TopoDS_Shape& shape) const {
    TDF_Label sub;
    return shapes_->FindSubShape(product, shape, sub) ? colour_of(sub) : std::string();
  }

  std::string colour_of(const TDF_Label& label) const {
    Quantity_Color colour;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
      if (colours_->GetColor(label, type, colour)) return hex_of(colour);
    return {};
  }

  std::string layer_of(const TDF_Label& label) const {
    Handle(TColStd_HSequenceOfExtendedString) names = layers_->GetLayers(label);
    if (names.IsNull() || names->IsEmpty()) return {};
    return sensible(TCollection_AsciiString(names->First()).ToCString());
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  Handle(XCAFDoc_LayerTool) layers_;
  std::function<std::string(const TopoDS_Shape&)> entity_name_;
};

Handle(TDocStd_Document) new_document() {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  return document;
}

void close(const Handle(TDocStd_Document) & document) { XCAFApp_Application::GetApplication()->Close(document); }

void check_transferred(bool is_done, const Part& part, const char* what) {
  const TopoDS_Shape& shape = part.shape;
  if (is_done && !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More()) return;
  TopTools_IndexedMapOfShape edges;
  if (!shape.IsNull()) TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  std::string why = fmt::format("the {} file holds no faces that could be read", what);
  if (edges.Extent() > 0) why += fmt::format(", but {} edges; curves alone bound nothing", edges.Extent());
  if (!part.report.suspicious.empty()) why += "; " + part.report.suspicious[0].message;
  throw Failure(why + "; export surfaces or solids, in another version of the format or another format");
}

constexpr std::size_t kMostNotes = 200;  ///< of what a translator says

bool is_face(const std::string& type) {
  for (const char* name : {"StepShape_AdvancedFace", "StepShape_FaceSurface", "IGESGeom_TrimmedSurface",
                           "IGESGeom_BoundedSurface", "IGESSolid_Face"})
    if (type == name) return true;
  return false;
}

/// StepShape_AdvancedFace as AdvancedFace.
std::string short_type(const Handle(Standard_Transient) & entity) {
  const std::string name = entity->DynamicType()->Name();
  return name.substr(name.find('_') + 1);
}

/// Geometry with a reference that leads nowhere, or to something else, is what OpenCASCADE crashes at: it is refused.
void check_references(const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Interface_ReportEntity) report = model->ReportEntity(i);
    if (report.IsNull()) continue;
    const Handle(Standard_Transient) entity = model->Value(i);
    const std::string type = entity->DynamicType()->Name();
    const bool is_geometry = type.rfind("StepGeom_", 0) == 0 || type.rfind("StepShape_", 0) == 0;
    const Handle(Interface_Check) check = report->Check();
    for (int k = 1; k <= check->NbFails() && is_geometry; ++k) {
      const std::string what = check->CFail(k);
      if (what.find("(name)") != std::string::npos || what.find("String") != std::string::npos) continue;
      const Handle(TCollection_HAsciiString) label = model->StringLabel(entity);
      throw Failure(fmt::format("{} ({}): {}; the file is damaged there: export it again",
                                label.IsNull() ? "?" : label->ToCString(), short_type(entity), what));
    }
  }
}

/// What the translators failed at, and faces of the file that became none.
void note_translation(const Handle(XSControl_WorkSession) & session, Part& part) {
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  const Handle(Interface_InterfaceModel) model = session->Model();
  const auto note = [&](const char* kind, const Handle(Standard_Transient) & entity, const std::string& what,
                        Point at) {
    if (part.report.suspicious.size() >= kMostNotes) return;
    const Handle(TCollection_HAsciiString) label = model->StringLabel(entity);
    part.report.suspicious.push_back(
        {kind, fmt::format("{} ({}): {}", label.IsNull() ? "?" : label->ToCString(), short_type(entity), what), at});
  };
  TopTools_IndexedMapOfShape kept;  // without places, which instances of a product have
  for (TopExp_Explorer face(part.shape, TopAbs_FACE); face.More(); face.Next())
    kept.Add(face.Current().Located(TopLoc_Location()).Oriented(TopAbs_FORWARD));
  const auto is_kept = [&](const TopoDS_Shape& shape) {
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
      if (kept.Contains(face.Current().Located(TopLoc_Location()).Oriented(TopAbs_FORWARD))) return true;
    return false;
  };
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    const Handle(Transfer_Binder) binder = process->Find(entity);
    const TopoDS_Shape shape = binder.IsNull() ? TopoDS_Shape() : TransferBRep::ShapeResult(binder);
    const TopExp_Explorer vertex(shape.IsNull() ? part.shape : shape, TopAbs_VERTEX);
    const bool has_place = !shape.IsNull() && vertex.More();
    const gp_Pnt p = has_place ? BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current())) : gp_Pnt();
    const Point at{p.X(), p.Y(), p.Z()};
    if (!binder.IsNull())
      for (int k = 1; k <= binder->Check()->NbFails(); ++k)
        note("not_translated", entity, binder->Check()->CFail(k), at);
    if (!binder.IsNull())
      for (int k = 1; k <= binder->Check()->NbWarnings(); ++k)
        note("reader_says", entity, binder->Check()->CWarning(k), at);
    if ((shape.IsNull() || !is_kept(shape)) && is_face(entity->DynamicType()->Name()))
      note("lost_face", entity, "this face of the file could not be read and is missing", at);
  }
}

/// What a file that is no STEP file at all begins with is told from one that is damaged.
std::string first_bytes(const std::string& path, std::size_t count) {
  std::ifstream in(path, std::ios::binary);
  std::string text(count, '\0');
  in.read(text.data(), std::streamsize(count));
  text.resize(std::size_t(in.gcount()));
  return text;
}

bool ends_whole(const std::string& path, const std::string& mark) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const auto size = std::streamoff(in.tellg());
  const auto tail = std::min<std::streamoff>(size, 4096);
  in.seekg(size - tail);
  std::string text(std::size_t(tail), '\0');
  in.read(text.data(), tail);
  return text.find(mark) != std::string::npos;
}

constexpr double kMostNumber = 1e101;  ///< OpenCASCADE's own infinity is 2e100

/// Words that stand where numbers do, and numbers that no length can be: OpenCASCADE would go on for ever with some.
/// @param has_strings  what stands between apostrophes says nothing
void check_numbers(const std::string& path, bool has_strings) {
  std::ifstream in(path, std::ios::binary);
  std::string line, word;
  bool is_string = false;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const auto check = [&] {
      const std::string low = lower(word);
      const std::size_t sign = !low.empty() && (low[0] == '-' || low[0] == '+') ? 1 : 0;
      const bool is_none = low.compare(sign, std::string::npos, "nan") == 0 || low.compare(sign, 3, "inf") == 0;
      const bool is_number = low.size() > sign && std::isdigit(static_cast<unsigned char>(low[sign]));
      const bool is_huge =
          is_number && low.find('e') != std::string::npos && std::abs(std::strtod(low.c_str(), nullptr)) > kMostNumber;
      word.clear();
      if ((is_none && (low.size() == sign + 3 || low.compare(sign, std::string::npos, "infinity") == 0)) || is_huge)
        throw Failure(fmt::format("line {}: {} is no number that a length can be; export it again", number, low));
    };
    for (const char c : line) {
      if (has_strings && c == '\'') is_string = !is_string;
      const bool is_end = std::strchr(" \t\r(),;='", c) != nullptr;
      if (is_end && !word.empty()) check();
      if (!is_end && !is_string) word += c;
    }
    if (!word.empty()) check();
  }
}

bool has_end_of_iges(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line, last;
  while (std::getline(in, line))
    if (line.find_first_not_of(" \r\n\x1a") != std::string::npos) last = line;
  return last.size() > 72 && last[72] == 'T';
}

void read_step(const std::string& path, Part& part, const Say& say) {
  part.report.format = "STEP";
  if (first_bytes(path, 4096).find("ISO-10303-21") == std::string::npos)
    throw Failure("this is no STEP file: it does not begin with ISO-10303-21");
  if (!ends_whole(path, "END-ISO-10303-21"))
    throw Failure("the STEP file is not whole: END-ISO-10303-21 is missing at its end; copy it again");
  check_numbers(path, true);
  STEPCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(true);
  reader.SetLayerMode(true);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw Failure("the STEP file cannot be parsed");
  check_references(reader.Reader().WS());
  say("units", -1);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  use_unit(lengths.IsEmpty() ? nullptr : find_unit(lengths.First().ToCString()), part.report);
  Handle(TDocStd_Document) document = new_document();
  Watch watch(say, "translating");
  const bool is_done = reader.Transfer(document, watch.range());
  watch.check();
  const Handle(XSControl_TransferReader) transfer = reader.Reader().WS()->TransferReader();
  const auto name_of_entity = [&](const TopoDS_Shape& shape) -> std::string {
    for (const TopoDS_Shape& s : {shape, shape.Located(TopLoc_Location())}) {
      const Handle(StepRepr_RepresentationItem) item =
          Handle(StepRepr_RepresentationItem)::DownCast(transfer->EntityFromShapeResult(s, 1));
      if (!item.IsNull() && !item->Name().IsNull()) return sensible(item->Name()->ToCString());
    }
    return {};
  };
  part.shape = Document(document, name_of_entity).run(part);
  close(document);
  note_translation(reader.Reader().WS(), part);
  check_transferred(is_done, part, "STEP");
}

void read_iges(const std::string& path, Part& part, const Say& say) {
  part.report.format = "IGES";
  const std::string first = first_bytes(path, 80);
  if (first.size() < 80 || (first[72] != 'S' && first[72] != 'C' && first[72] != 'B'))
    throw Failure("this is no IGES file: column 73 of its first line is not S");
  if (!has_end_of_iges(path))
    throw Failure("the IGES file is not whole: it does not end with a line that has T in column 73; copy it again");
  IGESCAFControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw Failure("the IGES file cannot be parsed");
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  constexpr const char* kCodes[] = {"", "INCH", "MM", "", "FT", "MI", "M", "KM", "MIL", "UM", "CM", "UIN"};
  const int flag = model->GlobalSection().UnitFlag();
  const Handle(TCollection_HAsciiString) name = model->GlobalSection().UnitName();
  const Unit* unit = flag > 0 && flag < 12 ? find_code(kCodes[flag]) : nullptr;
  if (!unit && !name.IsNull()) unit = find_unit(name->ToCString());
  use_unit(unit, part.report);
  Handle(TDocStd_Document) document = new_document();
  Watch watch(say, "translating");
  const bool is_done = reader.Transfer(document, watch.range());
  watch.check();
  part.shape = Document(document, [](const TopoDS_Shape&) { return std::string(); }).run(part);
  close(document);
  note_translation(reader.WS(), part);
  check_transferred(is_done, part, "IGES");
}

/// OpenCASCADE's own text; EGADS puts a line before it and its attributes after it.
void read_brep_text(const std::string& path, Part& part, const char* format) {
  part.report.format = format;
  check_numbers(path, false);
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  std::string all = text.str();
  const std::size_t start = all.find("CASCADE Topology V");
  if (start == std::string::npos || start > 4096)
    throw Failure(fmt::format("this is no {} file: CASCADE Topology is not at its beginning", format));
  const std::size_t attributes = all.find("##EGADS HEADER");
  if (attributes != std::string::npos) all.resize(attributes);
  // the shape itself is said last, after all that it is made of
  if (all.find("\nTShapes ", start) == std::string::npos)
    throw Failure(fmt::format("the {} file is not whole: it has no list of shapes (TShapes)", format));
  std::istringstream stream(all.substr(start));
  stream.exceptions(std::ios::failbit | std::ios::badbit);  // at its end the reader would go on for ever
  BRep_Builder builder;
  try {
    BRepTools::Read(part.shape, stream, builder);
  } catch (const std::ios::failure&) {
    throw Failure(fmt::format("the {} file is not whole, or damaged", format));
  }
  check_transferred(true, part, format);
}

}  // namespace

Part read_file(const std::string& path, const Say& say) {
  Part part;
  const std::string suffix = suffix_of(path);
  if (std::filesystem::file_size(path) == 0) throw Failure("the file is empty");
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  if (suffix == ".step" || suffix == ".stp")
    read_step(path, part, say);
  else if (suffix == ".iges" || suffix == ".igs")
    read_iges(path, part, say);
  else
    read_brep_text(path, part, suffix == ".egads" ? "EGADS" : "BREP");
  for (TopExp_Explorer solid(part.shape, TopAbs_SOLID); solid.More(); solid.Next())
    if (!part.solids.find(solid.Current())) part.solids.set(solid.Current(), {});
  part.diagonal = diagonal_of(part.shape);
  return part;
}

}  // namespace delfront::cad
