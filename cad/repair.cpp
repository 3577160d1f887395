// SPDX-License-Identifier: Apache-2.0
// What ShapeFix leaves, or makes worse: edges without length, parameter curves that are another edge's, faces that are
// there twice, solids turned inside out. Each is looked for by its measure, and said.
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepTools.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "fmt/format.h"
#include "geometry.hpp"
#include "shells.hpp"
#include "translation.hpp"

namespace delfront::cad {
namespace {

constexpr double kTinyEdge = 1e-7;   ///< of the diagonal: edges that may be within their corners' tolerance
constexpr double kRounding = 1e-12;  ///< of the diagonal
constexpr double kBeside =
    10;  ///< of a corner's tolerance: an edge that ends farther off has another corner, unless it is
constexpr double kBesideShare = 1e-3;  ///< within this of the diagonal
constexpr double kMostBeside = 0.05;   ///< of the diagonal, whatever the tolerance
constexpr double kInfiniteParameter = 1e100;
constexpr double kOffEdge = 1e-3;    ///< of an edge's length: parameter curves that are wrong rather than loose
constexpr double kSamePlace = 1e-7;  ///< of the diagonal: places of faces that are there twice
constexpr int kSamples = 16;         ///< along an edge
constexpr int kNet = 5;              ///< places along each parameter of a face, to find one within it
constexpr int kMostRounds = 4;       ///< of removing edges: chains of them go one by one

/// Instances of a product are looked at once: what is wrong with one is wrong with all.
class Seen {
 public:
  bool is_new(const TopoDS_Shape& shape) { return seen_.insert(shape.TShape().get()).second; }

 private:
  std::set<const void*> seen_;
};

std::string place(Point p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

/// The shape after what is recorded, and what is known of its faces.
void apply(const Handle(BRepTools_ReShape) & context, Part& part) {
  part.become(context->Apply(part.shape), [&](const TopoDS_Shape& shape) {
    TopTools_ListOfShape images;
    const TopoDS_Shape image = context->Apply(shape);
    if (!image.IsNull()) images.Append(image);
    return images;
  });
}

double length_of(const Handle(Geom_Curve) & curve, double first, double last) {
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double a = first + (last - first) * i / kSamples, b = first + (last - first) * (i + 1) / kSamples;
    sum += curve->Value(a).Distance(curve->Value(b));
  }
  return sum;
}

struct TinyEdge {
  TopoDS_Vertex keeps, goes;
  double length = 0;
};

/// Whether an edge is no longer than the tolerance that its ends have anyway.
bool is_tiny(const TopoDS_Edge& edge, double diagonal, TinyEdge& tiny) {
  if (BRep_Tool::Degenerated(edge)) return false;
  TopExp::Vertices(edge, tiny.keeps, tiny.goes);
  if (tiny.keeps.IsNull() || tiny.goes.IsNull()) return false;
  const double apart = BRep_Tool::Pnt(tiny.keeps).Distance(BRep_Tool::Pnt(tiny.goes));
  const double reach = std::max(BRep_Tool::Tolerance(tiny.keeps), BRep_Tool::Tolerance(tiny.goes));
  const double most = std::min(kTinyEdge * diagonal, std::max(reach, kRounding * diagonal));
  if (apart > most) return false;
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  if (curve.IsNull()) return false;
  tiny.length = last > first ? length_of(curve, first, last) : 0;
  return tiny.length <= most;
}

bool is_all_there_is(const TopTools_ListOfShape& wires) {
  return std::any_of(wires.begin(), wires.end(), [](const TopoDS_Shape& wire) { return wire.NbChildren() < 3; });
}

/// @return how many
int remove_round(Part& part) {
  TopTools_IndexedDataMapOfShapeListOfShape wires;
  TopExp::MapShapesAndAncestors(part.shape, TopAbs_EDGE, TopAbs_WIRE, wires);
  const Handle(BRepTools_ReShape) context = new BRepTools_ReShape;
  int count = 0;
  TopTools_MapOfShape touched;
  for (int i = 1; i <= wires.Extent(); ++i) {
    const TopoDS_Edge edge = TopoDS::Edge(wires.FindKey(i).Oriented(TopAbs_FORWARD));
    TinyEdge tiny;
    if (!is_tiny(edge, part.diagonal, tiny) || is_all_there_is(wires(i))) continue;
    if (touched.Contains(tiny.keeps) || touched.Contains(tiny.goes)) continue;
    touched.Add(tiny.keeps);
    touched.Add(tiny.goes);
    if (!tiny.keeps.IsSame(tiny.goes)) {
      const double apart = BRep_Tool::Pnt(tiny.keeps).Distance(BRep_Tool::Pnt(tiny.goes));
      const double tolerance = std::max(BRep_Tool::Tolerance(tiny.keeps), BRep_Tool::Tolerance(tiny.goes) + apart);
      BRep_Builder().UpdateVertex(tiny.keeps, tolerance);
      context->Replace(tiny.goes.Oriented(TopAbs_FORWARD), tiny.keeps.Oriented(TopAbs_FORWARD));
    }
    context->Remove(edge);
    const Point at = point_of(BRep_Tool::Pnt(tiny.keeps));
    part.report.repairs.push_back(
        {"removed_edge",
         fmt::format("an edge of length {:.3g} at {} was taken out: its ends are one corner", tiny.length, place(at)),
         at});
    ++count;
  }
  if (count > 0) apply(context, part);
  return count;
}

/// The largest distance between an edge and its curve in the parameters of a face; 0 where it has none.
double parameter_curve_off(const TopoDS_Edge& edge, const TopoDS_Face& face, double& length, Point& at) {
  double first = 0, last = 0, first_2d = 0, last_2d = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  const Handle(Geom2d_Curve) on_face = BRep_Tool::CurveOnSurface(edge, face, first_2d, last_2d);
  if (curve.IsNull() || on_face.IsNull() || !(last > first)) return 0;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  length = length_of(curve, first, last);
  double most = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const gp_Pnt there = curve->Value(first + (last - first) * i / kSamples);
    const gp_Pnt2d uv = on_face->Value(first_2d + (last_2d - first_2d) * i / kSamples);
    const double away = there.Distance(surface->Value(uv.X(), uv.Y()));
    if (away <= most) continue;
    most = away;
    at = point_of(there);
  }
  return most;
}

/// A place within a face, on it.
bool place_within(const TopoDS_Face& face, gp_Pnt& at) {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  for (int i = 1; i <= kNet; ++i)
    for (int j = 1; j <= kNet; ++j) {
      const gp_Pnt2d uv(u0 + (u1 - u0) * i / (kNet + 1), v0 + (v1 - v0) * j / (kNet + 1));
      if (BRepClass_FaceClassifier(face, uv, 1e-9).State() != TopAbs_IN) continue;
      at = BRep_Tool::Surface(face)->Value(uv.X(), uv.Y());
      return true;
    }
  return false;
}

bool lies_on(const gp_Pnt& at, const TopoDS_Face& face, double tolerance) {
  const GeomAPI_ProjectPointOnSurf on(at, BRep_Tool::Surface(face));
  if (on.NbPoints() == 0 || on.LowerDistance() > tolerance) return false;
  double u = 0, v = 0;
  on.LowerDistanceParameters(u, v);
  const TopAbs_State state = BRepClass_FaceClassifier(face, gp_Pnt2d(u, v), 1e-9).State();
  return state == TopAbs_IN || state == TopAbs_ON;
}

/// A face by the middles of its edges.
struct Outline {
  TopoDS_Face face;
  std::vector<gp_Pnt> middles;
  double key = 0;  ///< nearly the same for the same face
};

Outline outline_of(const TopoDS_Face& face) {
  Outline result{face, {}, 0};
  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
    double first = 0, last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(TopoDS::Edge(e.Current()), first, last);
    if (curve.IsNull()) continue;
    result.middles.push_back(curve->Value(0.5 * (first + last)));
    const gp_Pnt& p = result.middles.back();
    result.key += p.X() + 0.7 * p.Y() + 0.3 * p.Z();
  }
  return result;
}

bool is_same_face(const Outline& a, const Outline& b, double tolerance) {
  if (a.middles.size() != b.middles.size() || a.middles.empty()) return false;
  for (const gp_Pnt& p : a.middles)
    if (std::none_of(b.middles.begin(), b.middles.end(), [&](const gp_Pnt& q) { return p.Distance(q) <= tolerance; }))
      return false;
  return is_same_surface(a.face, b.face, tolerance);
}

void note_double(const TopoDS_Face& face, Part& part) {
  const Outline outline = outline_of(face);
  const Point at = outline.middles.empty() ? Point{} : point_of(outline.middles[0]);
  part.report.repairs.push_back(
      {"dropped_double_face",
       fmt::format("a face with {} edges, one of them at {}, is there twice: one was taken out", outline.middles.size(),
                   place(at)),
       at});
}

/// Of one shell.
void drop_doubles_of(const std::vector<TopoDS_Face>& faces, const Handle(BRepTools_ReShape) & context, Part& part) {
  const double tolerance = kSamePlace * part.diagonal;
  std::vector<Outline> outlines;
  for (const TopoDS_Face& face : faces) outlines.push_back(outline_of(face));
  std::stable_sort(outlines.begin(), outlines.end(), [](const Outline& a, const Outline& b) { return a.key < b.key; });
  std::vector<bool> is_gone(outlines.size(), false);
  for (std::size_t i = 0; i < outlines.size(); ++i)
    for (std::size_t j = i + 1; j < outlines.size() && !is_gone[i]; ++j) {
      if (outlines[j].key - outlines[i].key > 3 * tolerance * double(outlines[i].middles.size() + 1)) break;
      if (is_gone[j] || !is_same_face(outlines[i], outlines[j], tolerance)) continue;
      is_gone[j] = true;
      context->Remove(outlines[j].face);
      note_double(outlines[j].face, part);
    }
}

std::vector<TopoDS_Face> distinct_faces(TopExp_Explorer explorer, Part& part, bool& has_same) {
  std::vector<TopoDS_Face> faces;
  TopTools_MapOfShape known;
  for (; explorer.More(); explorer.Next()) {
    const TopoDS_Face face = TopoDS::Face(explorer.Current());
    if (known.Add(face)) {
      faces.push_back(face);
    } else {
      has_same = true;
      note_double(face, part);
    }
  }
  return faces;
}

bool is_inside_out(const TopoDS_Shape& solid, double diagonal) {
  if (count_free_edges(solid) > 0) return false;
  BRepClass3d_SolidClassifier where(solid);
  where.PerformInfinitePoint(1e-7 * diagonal);
  return where.State() == TopAbs_IN;
}

}  // namespace

bool is_same_surface(const TopoDS_Face& a, const TopoDS_Face& b, double tolerance) {
  gp_Pnt within;
  return place_within(a, within) && lies_on(within, b, tolerance);
}

bool looks_the_same_way(const TopoDS_Face& a, const TopoDS_Face& b) {
  gp_Pnt at;
  if (!place_within(a, at)) return false;
  const auto normal = [&](const TopoDS_Face& face) {
    const GeomAPI_ProjectPointOnSurf on(at, BRep_Tool::Surface(face));
    double u = 0, v = 0;
    if (on.NbPoints() > 0) on.LowerDistanceParameters(u, v);
    gp_Pnt p;
    gp_Vec du, dv;
    BRep_Tool::Surface(face)->D1(u, v, p, du, dv);
    return face.Orientation() == TopAbs_REVERSED ? dv.Crossed(du) : du.Crossed(dv);
  };
  return normal(a).Dot(normal(b)) > 0;
}

void check_corners(const Part& part) {
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(part.shape, TopAbs_EDGE, edges);
  Seen seen;
  for (int i = 1; i <= edges.Extent(); ++i) {
    if (!seen.is_new(edges(i))) continue;
    const TopoDS_Edge edge = TopoDS::Edge(edges(i).Oriented(TopAbs_FORWARD));
    double range[2] = {0, 0};
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, range[0], range[1]);
    if (curve.IsNull() || !(range[1] > range[0])) continue;
    const TopoDS_Vertex ends[2] = {TopExp::FirstVertex(edge), TopExp::LastVertex(edge)};
    for (int k = 0; k < 2; ++k) {
      if (ends[k].IsNull() || std::abs(range[k]) >= kInfiniteParameter) continue;
      const gp_Pnt corner = BRep_Tool::Pnt(ends[k]);
      const double away = curve->Value(range[k]).Distance(corner);
      const double allowed = std::max(kBeside * BRep_Tool::Tolerance(ends[k]), kBesideShare * part.diagonal);
      if (away <= std::min(allowed, kMostBeside * part.diagonal)) continue;
      throw Failure(
          fmt::format("edge {} ends {:.3g} from its corner at {}: the file contradicts itself; export it again, "
                      "or mend the part there",
                      i, away, place(point_of(corner))));
    }
  }
}

void note_loose_edges(Part& part) {
  TopTools_IndexedMapOfShape loose;
  for (TopExp_Explorer e(part.shape, TopAbs_EDGE, TopAbs_FACE); e.More(); e.Next()) loose.Add(e.Current());
  if (loose.IsEmpty()) return;
  const TopoDS_Vertex vertex = TopExp::FirstVertex(TopoDS::Edge(loose(1)));
  const Point at = vertex.IsNull() ? Point{} : point_of(BRep_Tool::Pnt(vertex));
  part.report.suspicious.push_back(
      {"loose_edges",
       fmt::format("edges that belong to no face are left out: {}, one of them at {}", loose.Extent(), place(at)), at});
}

void remove_tiny_edges(Part& part) {
  for (int round = 0; round < kMostRounds; ++round)
    if (remove_round(part) == 0) return;
}

void drop_wrong_parameter_curves(Part& part) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(part.shape, TopAbs_FACE, faces);
  Seen seen;
  for (int f = 1; f <= faces.Extent(); ++f) {
    if (!seen.is_new(faces(f))) continue;
    const TopoDS_Face face = TopoDS::Face(faces(f));
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(e.Current());
      if (BRep_Tool::Degenerated(edge) || BRep_Tool::IsClosed(edge, face)) continue;
      double length = 0;
      Point at;
      const double off = parameter_curve_off(edge, face, length, at);
      const double tolerance = std::max(BRep_Tool::Tolerance(edge), BRep_Tool::Tolerance(face));
      if (!(off > std::max(2 * tolerance, kOffEdge * length))) continue;
      BRep_Builder().UpdateEdge(edge, Handle(Geom2d_Curve)(), face, BRep_Tool::Tolerance(edge));
      part.report.repairs.push_back(
          {"dropped_parameter_curve",
           fmt::format("face {}: the parameter curve of an edge was {:.3g} off at {}; it is found again by projection",
                       f, off, place(at)),
           at});
    }
  }
}

void drop_double_faces(Part& part) {
  const Handle(BRepTools_ReShape) context = new BRepTools_ReShape;
  TopTools_IndexedMapOfShape shells;
  TopExp::MapShapes(part.shape, TopAbs_SHELL, shells);
  const std::size_t before = part.report.repairs.size();
  std::map<const void*, bool> is_whole;  // of shells looked at
  for (int s = 1; s <= shells.Extent(); ++s) {
    const void* const shell = shells(s).TShape().get();
    if (const auto known = is_whole.find(shell); known != is_whole.end() && known->second) continue;
    const std::size_t known_before = part.report.repairs.size();
    bool has_same = false;
    const std::vector<TopoDS_Face> faces = distinct_faces(TopExp_Explorer(shells(s), TopAbs_FACE), part, has_same);
    if (has_same) context->Replace(shells(s), shell_of(faces));
    drop_doubles_of(faces, context, part);
    is_whole[shell] = part.report.repairs.size() == known_before;
  }
  bool ignored = false;
  drop_doubles_of(distinct_faces(TopExp_Explorer(part.shape, TopAbs_FACE, TopAbs_SHELL), part, ignored), context, part);
  if (part.report.repairs.size() > before) apply(context, part);
}

void turn_inverted_solids(Part& part) {
  const Handle(BRepTools_ReShape) context = new BRepTools_ReShape;
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(part.shape, TopAbs_SOLID, solids);
  bool is_turned = false;
  std::map<std::pair<const void*, int>, bool> is_inverted;
  for (int s = 1; s <= solids.Extent(); ++s) {
    const auto [known, is_new] =
        is_inverted.try_emplace({solids(s).TShape().get(), int(solids(s).Orientation())}, false);
    if (is_new) known->second = is_inside_out(solids(s), part.diagonal);
    if (!known->second) continue;
    TopoDS_Solid turned;
    BRep_Builder().MakeSolid(turned);
    for (TopoDS_Iterator it(solids(s)); it.More(); it.Next()) BRep_Builder().Add(turned, it.Value().Reversed());
    context->Replace(solids(s), turned);
    is_turned = true;
    const TopExp_Explorer vertex(solids(s), TopAbs_VERTEX);
    const Point at = point_of(BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current())));
    part.report.repairs.push_back(
        {"turned_solid",
         fmt::format("solid {}, with a corner at {}, was inside out: its faces were turned", s, place(at)), at});
  }
  if (is_turned) apply(context, part);
}

}  // namespace delfront::cad
