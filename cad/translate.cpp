// SPDX-License-Identifier: Apache-2.0
// Topology: what is one vertex, edge or face in the shape is one here. Wires are handed over edge by edge as they are;
// their order in the parameter plane is found by the reader of the data.
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <map>
#include <set>

#include "fmt/format.h"
#include "geometry.hpp"
#include "part.hpp"

namespace delfront::cad {
namespace {

constexpr double kSameRange = 1e-9;  ///< of an edge's range, between it and that of its parameter curve

const char* name_of(SurfaceData::Kind kind) {
  switch (kind) {
    case SurfaceData::Kind::plane:
      return "plane";
    case SurfaceData::Kind::cylinder:
      return "cylinder";
    case SurfaceData::Kind::cone:
      return "cone";
    case SurfaceData::Kind::sphere:
      return "sphere";
    case SurfaceData::Kind::torus:
      return "torus";
    case SurfaceData::Kind::nurbs:
      return "nurbs";
    case SurfaceData::Kind::extrusion:
      return "extrusion";
    case SurfaceData::Kind::revolution:
      return "revolution";
    case SurfaceData::Kind::other:
      break;
  }
  return "other";
}

class Translator {
 public:
  Translator(Part& part, Result& result) : part_(part), result_(result) {
    TopExp::MapShapes(part.shape, TopAbs_FACE, faces_);
    for (int f = 1; f <= faces_.Extent(); ++f)
      if (const FaceFacts* facts = part.faces.find(faces_(f)))
        for (const std::string& solid : facts->solids) colours_[solid].insert(facts->colour);
  }

  void run(const Say& say) {
    for (int f = 1; f <= faces_.Extent(); ++f) {
      if (f % 64 == 1) say("translating faces", double(f) / faces_.Extent());
      add_face(TopoDS::Face(faces_(f)));
    }
    for (TopExp_Explorer s(part_.shape, TopAbs_SOLID); s.More(); s.Next()) ++part_.report.solids;
    for (TopExp_Explorer s(part_.shape, TopAbs_SHELL); s.More(); s.Next()) ++part_.report.shells;
    part_.report.free_edges = count_free_edges(part_.shape);
    part_.report.largest_tolerance = largest_tolerance(part_.shape);
    result_.report = std::move(part_.report);
  }

 private:
  int vertex_of(const TopoDS_Vertex& vertex) {
    if (vertex.IsNull()) return -1;
    const int known = vertices_.FindIndex(vertex);
    if (known > 0) return known - 1;
    result_.vertices.push_back({point_of(BRep_Tool::Pnt(vertex)), BRep_Tool::Tolerance(vertex), {}});
    return vertices_.Add(vertex) - 1;
  }

  int edge_of(const TopoDS_Edge& given, const TopoDS_Face& face) {
    const int known = edges_.FindIndex(given);
    if (known > 0) return known - 1;
    const TopoDS_Edge edge = TopoDS::Edge(given.Oriented(TopAbs_FORWARD));
    Edge made;
    made.tolerance = BRep_Tool::Tolerance(edge);
    TopoDS_Vertex first, last;
    TopExp::Vertices(edge, first, last);
    made.corners = {vertex_of(first), vertex_of(last)};
    Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, made.range[0], made.range[1]);
    if (BRep_Tool::Degenerated(edge)) curve.Nullify();
    if (curve.IsNull())
      BRep_Tool::Range(edge, face, made.range[0], made.range[1]);
    else
      made.curve = curve_data(curve, made.range);
    if (curve.IsNull() && !BRep_Tool::Degenerated(edge))
      part_.report.suspicious.push_back(
          {"edge_without_curve",
           fmt::format("an edge between corners {} and {} has no curve in space", made.corners[0] + 1,
                       made.corners[1] + 1),
           made.corners[0] >= 0 ? result_.vertices[std::size_t(made.corners[0])].at : Point{}});
    result_.edges.push_back(std::move(made));
    return edges_.Add(given) - 1;
  }

  void add_face(const TopoDS_Face& given) {
    const TopoDS_Face face = TopoDS::Face(given.Oriented(TopAbs_FORWARD));
    Face made;
    made.is_reversed = given.Orientation() == TopAbs_REVERSED;
    made.tolerance = BRep_Tool::Tolerance(face);
    ParameterBox box;
    BRepTools::UVBounds(face, box.low.x, box.high.x, box.low.y, box.high.y);
    made.surface = surface_data(BRep_Tool::Surface(face), box);
    for (TopoDS_Iterator wire(face); wire.More(); wire.Next())
      if (wire.Value().ShapeType() == TopAbs_WIRE) add_wire(TopoDS::Wire(wire.Value()), face, made);
    made.facts.surface = name_of(made.surface.kind);
    made.facts.tolerance = made.tolerance;
    if (const FaceFacts* facts = part_.faces.find(given)) {
      made.facts.name = facts->name;
      made.facts.colour = facts->colour;
      made.facts.layer = facts->layer;
      made.facts.solids = facts->solids;
    }
    made.name = grid_name(made.facts);
    result_.faces.push_back(std::move(made));
  }

  std::string grid_name(const CadFace& facts) const {
    if (!facts.name.empty()) return facts.name;
    const auto has_several = [&](const std::string& solid) { return colours_.at(solid).size() > 1; };
    const bool is_coloured = std::any_of(facts.solids.begin(), facts.solids.end(), has_several);
    if (is_coloured && !facts.colour.empty()) return "colour_" + facts.colour;
    std::string name;
    for (const std::string& solid : facts.solids)
      if (!solid.empty()) name += (name.empty() ? "" : "-") + solid;
    return name;
  }

  void add_wire(const TopoDS_Wire& wire, const TopoDS_Face& face, Face& made) {
    std::vector<Use> loop;
    for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Value());
      if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) {
        ++part_.report.internal_edges;
        continue;
      }
      Use use;
      use.edge = edge_of(edge, face);
      use.is_reversed = edge.Orientation() == TopAbs_REVERSED;
      double first = 0, last = 0;
      const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
      const std::array<double, 2>& range = result_.edges[std::size_t(use.edge)].range;
      const double slack = kSameRange * (range[1] - range[0]);
      use.has_curve = !curve.IsNull() && std::abs(first - range[0]) <= slack && std::abs(last - range[1]) <= slack;
      if (use.has_curve) use.curve = parameter_curve_data(curve, range);
      loop.push_back(std::move(use));
    }
    if (!loop.empty()) made.loops.push_back(std::move(loop));
  }

  Part& part_;
  Result& result_;
  TopTools_IndexedMapOfShape vertices_, edges_, faces_;
  std::map<std::string, std::set<std::string>> colours_;  ///< of each part
};

}  // namespace

void translate(Part& part, Result& result, const Say& say) { Translator(part, result).run(say); }

}  // namespace delfront::cad
