// SPDX-License-Identifier: Apache-2.0
// Mending: first what is not valid as it is, then faces whose edges are free are sewn, with as small a tolerance as
// closes most. Nothing is done to a part that is whole.
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Message_ListIteratorOfListOfMsg.hxx>
#include <Message_Msg.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeExtend_DataMapIteratorOfDataMapOfShapeListOfMsg.hxx>
#include <ShapeExtend_MsgRegistrator.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cctype>
#include <map>

#include "fmt/format.h"
#include "geometry.hpp"
#include "part.hpp"

namespace delfront::cad {
namespace {

constexpr double kSewShares[] = {1e-7, 1e-6, 1e-5, 1e-4};  ///< of the diagonal, one after the other

Point place_of(const TopoDS_Shape& shape) {
  for (TopExp_Explorer v(shape, TopAbs_VERTEX); v.More(); v.Next())
    return point_of(BRep_Tool::Pnt(TopoDS::Vertex(v.Current())));
  return {};
}

/// ShapeFix names what it did by keys as FixWire.FixReorder.MSG0 or FixAdvFace.FixMissingSeam.MSG0.
std::string kind_of(const Message_Msg& message) {
  const TCollection_AsciiString text(Message_Msg(message).Get());
  std::string key = text.ToCString();
  const std::size_t fix = key.rfind(".Fix");
  if (fix == std::string::npos) return "mended";
  key = key.substr(fix + 4);
  key = key.substr(0, key.find('.'));
  std::string kind;
  for (const char c : key) {
    if (std::isupper(static_cast<unsigned char>(c)) && !kind.empty()) kind += '_';
    kind += char(std::tolower(static_cast<unsigned char>(c)));
  }
  return "fixed_" + kind;
}

const char* word_for(const TopoDS_Shape& shape) {
  switch (shape.ShapeType()) {
    case TopAbs_FACE:
      return "a face";
    case TopAbs_WIRE:
      return "a loop of edges";
    case TopAbs_EDGE:
      return "an edge";
    case TopAbs_SHELL:
      return "a shell";
    case TopAbs_SOLID:
      return "a solid";
    default:
      return "a part";
  }
}

void note_messages(const Handle(ShapeExtend_MsgRegistrator) & messages, CadReport& report) {
  for (ShapeExtend_DataMapIteratorOfDataMapOfShapeListOfMsg it(messages->MapShape()); it.More(); it.Next())
    for (Message_ListIteratorOfListOfMsg msg(it.Value()); msg.More(); msg.Next()) {
      const Point at = place_of(it.Key());
      const std::string kind = kind_of(msg.Value());
      std::string words = kind;
      std::replace(words.begin(), words.end(), '_', ' ');
      report.repairs.push_back(
          {kind, fmt::format("{} at ({:g}, {:g}, {:g}): {}", word_for(it.Key()), at.x, at.y, at.z, words), at});
    }
}

bool has_face_without_wires(const TopoDS_Shape& shape) {
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next())
    if (!TopExp_Explorer(f.Current(), TopAbs_WIRE).More()) return true;
  return false;
}

/// Instances of a product are checked once.
bool is_valid(const TopoDS_Shape& shape, const Say& say) {
  TopTools_IndexedMapOfShape pieces;
  for (const auto& [what, avoid] :
       {std::pair{TopAbs_SOLID, TopAbs_SHAPE}, {TopAbs_SHELL, TopAbs_SOLID}, {TopAbs_FACE, TopAbs_SHELL}})
    for (TopExp_Explorer it(shape, what, avoid); it.More(); it.Next())
      pieces.Add(it.Current().Located(TopLoc_Location()));
  for (int i = 1; i <= pieces.Extent(); ++i) {
    if (i % 64 == 1) say("checking", double(i) / pieces.Extent());
    if (!BRepCheck_Analyzer(pieces(i)).IsValid()) return false;
  }
  return true;
}

void fix(Part& part, const Say& say) {
  if (is_valid(part.shape, say) && !has_face_without_wires(part.shape)) return;
  const Handle(ShapeFix_Shape) fixer = new ShapeFix_Shape(part.shape);
  const Handle(ShapeExtend_MsgRegistrator) messages = new ShapeExtend_MsgRegistrator;
  fixer->SetMsgRegistrator(messages);
  fixer->SetPrecision(1e-7 * std::max(part.diagonal, 1e-30));
  fixer->SetMaxTolerance(std::max(1e-4 * part.diagonal, largest_tolerance(part.shape)));
  Watch watch(say, "mending");
  fixer->Perform(watch.range());
  watch.check();
  const Handle(ShapeBuild_ReShape) context = fixer->Context();
  part.become(fixer->Shape(), [&](const TopoDS_Shape& shape) {
    TopTools_ListOfShape images;
    const TopoDS_Shape image = context->Apply(shape);
    if (!image.IsNull()) images.Append(image);
    return images;
  });
  note_messages(messages, part.report);
}

/// Faces with an edge that no other face has.
bool is_loose(const TopoDS_Shape& shape) { return count_free_edges(shape) > 0; }

/// What is whole stays as it is; the rest is taken apart to faces.
void split_loose(const TopoDS_Shape& shape, TopTools_ListOfShape& whole, TopTools_ListOfShape& loose) {
  if (shape.ShapeType() == TopAbs_COMPOUND || shape.ShapeType() == TopAbs_COMPSOLID) {
    for (TopoDS_Iterator it(shape); it.More(); it.Next()) split_loose(it.Value(), whole, loose);
    return;
  }
  if (!TopExp_Explorer(shape, TopAbs_FACE).More()) return;
  (is_loose(shape) ? loose : whole).Append(shape);
}

/// The sides that two faces share after sewing and the largest distance between them.
void note_sewn(const BRepBuilderAPI_Sewing& sewing, double tolerance, std::size_t before, std::size_t after,
               Part& part) {
  double gap = 0;
  Point at;
  for (TopExp_Explorer e(sewing.SewedShape(), TopAbs_EDGE); e.More(); e.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(e.Current());
    if (BRep_Tool::Tolerance(edge) <= gap) continue;
    gap = BRep_Tool::Tolerance(edge);
    at = place_of(edge);
  }
  part.report.repairs.push_back(
      {"sewn",
       fmt::format("loose faces were sewn with a tolerance of {:.3g}: {} free edges before, {} after; the widest gap "
                   "may be {:.3g}, at ({:g}, {:g}, {:g})",
                   tolerance, before, after, gap, at.x, at.y, at.z),
       at});
}

void sew(Part& part, const CadOptions& options, const Say& say) {
  TopTools_ListOfShape whole, loose;
  split_loose(part.shape, whole, loose);
  if (loose.IsEmpty()) return;
  const std::size_t before = count_free_edges(part.shape);
  std::vector<double> tolerances;
  if (options.tolerance > 0)
    tolerances = {options.tolerance};
  else
    for (const double share : kSewShares) tolerances.push_back(share * part.diagonal);
  Handle(BRepBuilderAPI_Sewing) best;
  std::size_t fewest = before;
  double used = 0;
  for (const double tolerance : tolerances) {
    if (fewest == 0) break;
    const Handle(BRepBuilderAPI_Sewing) sewing = new BRepBuilderAPI_Sewing(tolerance);
    for (const TopoDS_Shape& shape : loose) sewing->Add(shape);
    Watch watch(say, "sewing");
    sewing->Perform(watch.range());
    watch.check();
    const std::size_t left = sewing->SewedShape().IsNull() ? before : count_free_edges(sewing->SewedShape());
    if (left >= fewest) continue;
    fewest = left;
    best = sewing;
    used = tolerance;
  }
  if (best.IsNull()) return;
  note_sewn(*best, used, before, fewest, part);
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : whole) builder.Add(all, shape);
  builder.Add(all, best->SewedShape());
  part.become(all, [&](const TopoDS_Shape& shape) {
    TopTools_ListOfShape images;
    if (shape.ShapeType() == TopAbs_FACE && best->IsModifiedSubShape(shape))
      images.Append(best->ModifiedSubShape(shape));
    return images;
  });
}

/// What OpenCASCADE gives up at stays as it was, and that is said; the next step may do without.
void attempt(Part& part, const char* what, const std::function<void()>& work) {
  try {
    work();
  } catch (const Standard_Failure& e) {
    part.report.suspicious.push_back(
        {"not_mended",
         fmt::format("mending {} failed in OpenCASCADE ({} {})", what, e.DynamicType()->Name(), e.GetMessageString()),
         {}});
  }
}

}  // namespace

namespace {

/// By which power of ten a part is mended larger: OpenCASCADE works to 1e-7, whatever it is asked for.
double working_scale(double diagonal) {
  constexpr double kSmall = 0.01, kUsual = 1;
  double scale = 1;
  if (diagonal > 0 && diagonal < kSmall)
    while (scale * diagonal < kUsual) scale *= 10;
  return scale;
}

/// Notes from the given ones on say lengths of the part as it is mended.
void unscale_notes(std::vector<CadNote>& notes, std::size_t first, double scale) {
  for (std::size_t i = first; i < notes.size(); ++i) {
    notes[i].at = notes[i].at / scale;
    notes[i].message += fmt::format(" (mended {0:g} times as large: its lengths and places are times {0:g})", scale);
  }
}

void mend(Part& part, const CadOptions& options, const Say& say) {
  if (options.heals) {
    attempt(part, "tiny edges", [&] { remove_tiny_edges(part); });
    attempt(part, "parameter curves", [&] { drop_wrong_parameter_curves(part); });
    attempt(part, "what is not valid", [&] { fix(part, say); });
  }
  if (options.heals) attempt(part, "double faces", [&] { drop_double_faces(part); });
  if (options.sews) attempt(part, "free edges", [&] { sew(part, options, say); });
  if (options.heals) attempt(part, "solids inside out", [&] { turn_inverted_solids(part); });
  attempt(part, "parameters along edges",
          [&] { BRepLib::SameParameter(part.shape, 1e-7 * std::max(part.diagonal, 1e-30)); });
}

}  // namespace

void heal(Part& part, const CadOptions& options, const Say& say) {
  check_corners(part);
  note_loose_edges(part);
  attempt(part, "curves in space", [&] { BRepLib::BuildCurves3d(part.shape); });
  const double scale = working_scale(part.diagonal);
  if (scale == 1) return mend(part, options, say);
  const std::size_t repairs = part.report.repairs.size(), suspicious = part.report.suspicious.size();
  CadOptions scaled = options;
  scaled.tolerance *= scale;
  part.scale(scale);
  mend(part, scaled, say);
  part.scale(1 / scale);
  unscale_notes(part.report.repairs, repairs, scale);
  unscale_notes(part.report.suspicious, suspicious, scale);
}

}  // namespace delfront::cad
