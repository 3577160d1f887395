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
#include "translation.hpp"

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
  explicit Translator(const Part& part) : part_(part) { TopExp::MapShapes(part.shape, TopAbs_FACE, faces_); }

  Translation run(const Say& say) {
    for (int f = 1; f <= faces_.Extent(); ++f) {
      if (f % 64 == 1) say("translating faces", double(f) / faces_.Extent());
      add_face(TopoDS::Face(faces_(f)));
    }
    note_owners();
    return std::move(result_);
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
    std::array<Point, kEdgeSamples> samples{};
    for (int i = 0; i < kEdgeSamples && !curve.IsNull(); ++i)
      samples[std::size_t(i)] =
          point_of(curve->Value(made.range[0] + (made.range[1] - made.range[0]) * (i + 1) / (kEdgeSamples + 1)));
    result_.samples.push_back(samples);
    if (curve.IsNull() && !BRep_Tool::Degenerated(edge))
      result_.suspicious.push_back(
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
    result_.shapes.push_back(given);
    result_.faces.push_back(std::move(made));
  }

  void add_wire(const TopoDS_Wire& wire, const TopoDS_Face& face, Face& made) {
    std::vector<Use> loop;
    for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Value());
      if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) {
        ++result_.internal_edges;
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

  /// Of a face that a solid has on both sides, it is on both.
  void note_owners() {
    result_.owners.resize(result_.faces.size());
    const TopTools_IndexedMapOfShape pieces = pieces_of(part_.shape);
    for (int p = 1; p <= pieces.Extent(); ++p) {
      const bool is_solid = pieces(p).ShapeType() == TopAbs_SOLID;
      result_.is_closed.push_back(is_solid || count_free_edges(pieces(p)) == 0);
      for (TopExp_Explorer it(pieces(p), TopAbs_FACE); it.More(); it.Next()) {
        const int f = faces_.FindIndex(it.Current());
        if (f < 1) continue;
        Translation::Owners& owners = result_.owners[std::size_t(f - 1)];
        if (owners.pieces.empty() || owners.pieces.back() != p - 1) owners.pieces.push_back(p - 1);
        const bool is_behind = it.Current().Orientation() == faces_(f).Orientation();
        if (is_solid && owners.solids[is_behind ? 0 : 1] < 0) owners.solids[is_behind ? 0 : 1] = p - 1;
      }
    }
  }

  const Part& part_;
  Translation result_;
  TopTools_IndexedMapOfShape vertices_, edges_, faces_;
};

/// Names of faces: their own, that of their colour where a part has several, or that of their part.
class Namer {
 public:
  explicit Namer(const std::vector<Face>& faces) {
    for (const Face& face : faces)
      for (const std::string& solid : face.facts.solids) colours_[solid].insert(face.facts.colour);
  }

  std::string name_of(const CadFace& facts) const {
    if (!facts.name.empty()) return facts.name;
    const auto has_several = [&](const std::string& solid) { return colours_.at(solid).size() > 1; };
    const bool is_coloured = std::any_of(facts.solids.begin(), facts.solids.end(), has_several);
    if (is_coloured && !facts.colour.empty()) return "colour_" + facts.colour;
    return together(facts.solids);
  }

  static std::string together(const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names)
      if (!name.empty()) all += (all.empty() ? "" : "-") + name;
    return all;
  }

 private:
  std::map<std::string, std::set<std::string>> colours_;  ///< of each part
};

/// Solids in the order of the file, and which of them each face bounds.
void add_regions(const Part& part, const Translation& data, Result& result) {
  const TopTools_IndexedMapOfShape pieces = pieces_of(part.shape);
  std::vector<std::pair<int, int>> order;  // rank, piece
  for (int p = 1; p <= pieces.Extent(); ++p)
    if (pieces(p).ShapeType() == TopAbs_SOLID) order.emplace_back(part.solids.rank(pieces(p)), p - 1);
  std::stable_sort(order.begin(), order.end());
  std::vector<int> region(std::size_t(pieces.Extent()), -1);
  for (const auto& [rank, piece] : order) {
    region[std::size_t(piece)] = int(result.regions.size());
    const FaceFacts* facts = part.solids.find(pieces(piece + 1));
    result.regions.push_back(facts ? Namer::together(facts->solids) : std::string());
  }
  for (std::size_t f = 0; f < data.owners.size(); ++f)
    for (std::size_t k = 0; k < 2; ++k)
      if (const int solid = data.owners[f].solids[k]; solid >= 0)
        result.faces[f].regions[k] = region[std::size_t(solid)];
}

/// Edges that one face has, and only once: the surface is open there.
void note_free_edges(const Translation& data, CadReport& report) {
  constexpr std::size_t kMost = 1000;
  std::vector<int> uses(data.edges.size());
  std::vector<std::size_t> face_of(data.edges.size());
  for (std::size_t f = 0; f < data.faces.size(); ++f)
    for (const auto& loop : data.faces[f].loops)
      for (const Use& use : loop) {
        ++uses[std::size_t(use.edge)];
        face_of[std::size_t(use.edge)] = f;
      }
  for (std::size_t e = 0; e < data.edges.size(); ++e) {
    if (uses[e] != 1 || data.edges[e].curve.kind == CurveData::Kind::none) continue;
    if (++report.free_edges > kMost) continue;
    const auto& places = data.samples[e];
    double length = 0;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) length += distance(places[i], places[i + 1]);
    length *= double(kEdgeSamples + 1) / (kEdgeSamples - 1);  // the ends are no samples
    const Point at = places[kEdgeSamples / 2];
    report.open_at.push_back({"free_edge",
                              fmt::format("edge {}, about {:.3g} long, bounds face {} only; its middle is at ({:g}, "
                                          "{:g}, {:g})",
                                          e + 1, length, face_of[e] + 1, at.x, at.y, at.z),
                              at});
  }
}

}  // namespace

TopTools_IndexedMapOfShape pieces_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape pieces;
  TopExp::MapShapes(shape, TopAbs_SOLID, pieces);
  for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next()) pieces.Add(it.Current());
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) pieces.Add(it.Current());
  return pieces;
}

Translation translate(const Part& part, const Say& say) { return Translator(part).run(say); }

void finish(Part& part, Translation data, Result& result) {
  const Namer namer(data.faces);
  for (Face& face : data.faces) face.name = namer.name_of(face.facts);
  CadReport& report = part.report;
  for (TopExp_Explorer s(part.shape, TopAbs_SOLID); s.More(); s.Next()) ++report.solids;
  for (TopExp_Explorer s(part.shape, TopAbs_SHELL); s.More(); s.Next()) ++report.shells;
  report.internal_edges += data.internal_edges;
  report.largest_tolerance = largest_tolerance(part.shape);
  report.suspicious.insert(report.suspicious.end(), data.suspicious.begin(), data.suspicious.end());
  note_free_edges(data, report);
  result.vertices = std::move(data.vertices);
  result.edges = std::move(data.edges);
  result.faces = std::move(data.faces);
  add_regions(part, data, result);
  result.report = std::move(report);
}

}  // namespace delfront::cad
