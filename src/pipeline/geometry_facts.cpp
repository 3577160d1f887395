// SPDX-License-Identifier: Apache-2.0
#include "pipeline/geometry_facts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

namespace delfront {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 40;       ///< entities of a kind on the terminal
constexpr std::size_t kShownOpen = 8;    ///< free edges
constexpr double kOneWay = 0.99619;      ///< cosine of the 5 degrees that `select = { normal = … }` allows
constexpr std::size_t kShownOfKind = 3;  ///< repairs and suspicious things of a kind

double length_of(const BrepEdge& edge) {
  constexpr int kPieces = 200;
  double sum = 0;
  for (int i = 0; i < kPieces && !edge.is_degenerate(); ++i) {
    const double step = (edge.range[1] - edge.range[0]) / kPieces;
    sum += distance(edge.curve->at(edge.range[0] + i * step), edge.curve->at(edge.range[0] + (i + 1) * step));
  }
  return sum;
}

std::string ends_of(const Brep& brep, const BrepEdge& edge) {
  if (!edge.corners[0].is_valid()) return "closed";
  const auto name = [&](CornerId c) {
    return brep.corners[c].name.empty() ? fmt::format("corner {}", c.value + 1) : brep.corners[c].name;
  };
  return fmt::format("{} to {}", name(edge.corners[0]), name(edge.corners[1]));
}

Json notes_json(const std::vector<CadNote>& notes) {
  Json json = Json::array();
  for (const CadNote& note : notes)
    json.push_back({{"kind", note.kind}, {"message", note.message}, {"at", {note.at.x, note.at.y, note.at.z}}});
  return json;
}

Json cad_json(const CadReport& cad) {
  return {{"format", cad.format},
          {"unit", cad.unit},
          {"metres_per_unit", cad.metres_per_unit > 0 ? Json(cad.metres_per_unit) : Json(nullptr)},
          {"solids", cad.solids},
          {"shells", cad.shells},
          {"free_edges", cad.free_edges},
          {"open_at", notes_json(cad.open_at)},
          {"internal_edges", cad.internal_edges},
          {"largest_tolerance", cad.largest_tolerance},
          {"repairs", notes_json(cad.repairs)},
          {"suspicious", notes_json(cad.suspicious)}};
}

std::string notes_text(const char* word, const std::vector<CadNote>& notes) {
  std::string text;
  std::map<std::string, std::size_t> count;
  for (const CadNote& note : notes) {
    const std::size_t k = ++count[note.kind];
    if (k <= kShownOfKind) text += fmt::format("{:<14} {}: {}\n", word, note.kind, note.message);
  }
  for (const auto& [kind, n] : count)
    if (n > kShownOfKind)
      text += fmt::format("{:<14} {}: and {} more (--json lists all)\n", word, kind, n - kShownOfKind);
  return text;
}

std::string cad_text(const CadReport& cad) {
  std::string text = fmt::format("CAD            {}, {} solid{}, {} shell{}{}\n", cad.format, cad.solids,
                                 cad.solids == 1 ? "" : "s", cad.shells, cad.shells == 1 ? "" : "s",
                                 cad.free_edges > 0 ? fmt::format(", open: {} free edges", cad.free_edges) : "");
  for (std::size_t i = 0; i < std::min(kShownOpen, cad.open_at.size()); ++i)
    text += fmt::format("open           {}\n", cad.open_at[i].message);
  if (cad.free_edges > kShownOpen)
    text += fmt::format("               and {} more free edges\n", cad.free_edges - kShownOpen);
  text += fmt::format("unit           {}\n", cad.unit.empty() ? "the file does not say" : cad.unit);
  text += fmt::format("tolerance      up to {:.3g}\n", cad.largest_tolerance);
  if (cad.internal_edges > 0) text += fmt::format("left out       {} edges within faces\n", cad.internal_edges);
  text += notes_text("repaired", cad.repairs);
  text += notes_text("suspicious", cad.suspicious);
  return text;
}

/// What a cylinder and a sphere are known by; the second is 0 for spheres.
struct Round {
  double radius;
  Point axis;
};

std::optional<Round> round_of(const Brep& brep, const BrepFace& face, const std::string& surface) {
  if ((surface != "cylinder" && surface != "sphere") || face.loops.empty() || face.loops[0].empty()) return {};
  const BrepUse& use = face.loops[0][0];
  Point2 uv = use.curve->at(brep.edges[use.edge].range[0]);
  if (surface == "sphere") uv.y = 0;  // away from poles
  const SurfaceDerivatives s = face.surface->derivatives(uv);
  const double bend = largest_curvature(s);
  if (!(bend > 0)) return {};
  return Round{1 / bend, surface == "cylinder" ? s.v / length(s.v) : Point{}};
}

/// A direction as it is read: three digits, no -0.
std::string direction_text(Point n) {
  const auto rounded = [](double x) { return std::round(1000 * x) / 1000 + 0.0; };
  return fmt::format("({:g}, {:g}, {:g})", rounded(n.x), rounded(n.y), rounded(n.z));
}

std::string round_text(const std::optional<Round>& round) {
  if (!round) return {};
  return fmt::format("radius {:.6g}, ", round->radius) +
         (length(round->axis) > 0 ? fmt::format("axis along {}, ", direction_text(round->axis)) : "");
}

std::string place_text(const FacePlace& place) {
  Point at = place.at;
  for (int k = 0; k < 3; ++k)  // what is next to nothing beside the rest
    if (std::abs(at[k]) < 1e-9 * (length(place.at) + place.box.diagonal())) at[k] = 0;
  std::string text = place.area > 0 ? fmt::format("area {:.4g} ", place.area) : "";
  text += fmt::format("at ({:.4g}, {:.4g}, {:.4g}), ", at.x, at.y, at.z);
  return place.normal ? text + fmt::format("looks along {}, ", direction_text(*place.normal)) : text;
}

Json numbers(Point p) { return {p.x, p.y, p.z}; }

}  // namespace

std::vector<FacePlace> places_of_faces(const Model& grid, std::size_t num_faces) {
  struct Sums {
    Point vector, moment;                                    // of areas
    double cosine = 1;                                       // of the normal farthest from the mean one
    double least = std::numeric_limits<double>::infinity();  // distance of a triangle from the middle
  };
  std::vector<FacePlace> places(num_faces);
  std::vector<Sums> sums(num_faces);
  const auto for_each = [&](const auto& take) {
    for (std::size_t t = 0; t < grid.triangles.size(); ++t) {
      const auto& v = grid.triangles[TriangleId(t)];
      const Point a = grid.points[v[0]], b = grid.points[v[1]], c = grid.points[v[2]];
      const std::size_t f = grid.input_face[TriangleId(t)];
      take(places[f], sums[f], 0.5 * cross(b - a, c - a), (a + b + c) / 3, std::array{a, b, c});
    }
  };
  for_each([](FacePlace& place, Sums& sum, Point area, Point middle, const std::array<Point, 3>& corners) {
    for (const Point& p : corners) place.box.add(p);
    place.area += length(area);
    sum.vector = sum.vector + area;
    sum.moment = sum.moment + length(area) * middle;
  });
  for_each([](FacePlace& place, Sums& sum, Point area, Point middle, const std::array<Point, 3>&) {
    const double away = distance(middle, sum.moment / place.area);
    if (away < sum.least) {
      sum.least = away;
      place.at = middle;
    }
    const double product = length(area) * length(sum.vector);
    if (product > 0) sum.cosine = std::min(sum.cosine, dot(area, sum.vector) / product);
  });
  for (std::size_t f = 0; f < num_faces; ++f)
    if (length(sums[f].vector) > 0 && sums[f].cosine > kOneWay)
      places[f].normal = sums[f].vector / length(sums[f].vector);
  return places;
}

Json geometry_json(const Brep& brep, const std::vector<FacePlace>& places, const BrepGridReport& grid,
                   const CadReport& cad) {
  Json corners = Json::array(), edges = Json::array(), faces = Json::array();
  for (const BrepCorner& c : brep.corners)
    corners.push_back({{"name", c.name}, {"at", {c.at.x, c.at.y, c.at.z}}, {"tolerance", c.tolerance}});
  for (const BrepEdge& e : brep.edges)
    if (!e.is_degenerate())
      edges.push_back(
          {{"name", e.name}, {"length", length_of(e)}, {"ends", ends_of(brep, e)}, {"tolerance", e.tolerance}});
  for (std::size_t f = 0; f < brep.faces.size(); ++f) {
    const BrepFace& face = brep.faces[FaceId(f)];
    Json json = {{"name", face.name},
                 {"kind", face.kind},
                 {"loops", face.loops.size()},
                 {"tolerance", face.tolerance},
                 {"area", places[f].area},
                 {"at", numbers(places[f].at)},
                 {"normal", places[f].normal ? numbers(*places[f].normal) : Json(nullptr)},
                 {"box", {numbers(places[f].box.low), numbers(places[f].box.high)}},
                 {"triangles", grid.faces[f].triangles},
                 {"mapped", grid.faces[f].is_mapped},
                 {"min_angle_deg", grid.faces[f].min_angle_deg}};
    if (f < cad.faces.size()) {
      const CadFace& facts = cad.faces[f];
      json["surface"] = facts.surface;
      const std::optional<Round> round = round_of(brep, face, facts.surface);
      json["radius"] = round ? Json(round->radius) : Json(nullptr);
      json["axis"] = round && length(round->axis) > 0 ? numbers(round->axis) : Json(nullptr);
      json["colour"] = facts.colour;
      json["layer"] = facts.layer;
      json["solids"] = facts.solids;
    }
    faces.push_back(std::move(json));
  }
  Json json = {{"corners", corners},
               {"edges", edges},
               {"faces", faces},
               {"grid",
                {{"triangles", grid.triangles},
                 {"min_angle", grid.min_angle_deg},
                 {"mean_min_angle", grid.mean_min_angle_deg},
                 {"below_25", grid.below_25_deg},
                 {"largest_distance", grid.largest_distance},
                 {"largest_normal_angle", grid.largest_normal_angle_deg}}}};
  if (!brep.regions.empty()) json["regions"] = brep.regions;
  if (!cad.format.empty()) json["cad"] = cad_json(cad);
  return json;
}

std::string geometry_text(const Brep& brep, const std::vector<FacePlace>& places, const BrepGridReport& grid,
                          const CadReport& cad, bool is_quick) {
  std::string text;
  std::size_t shown = 0, edges = 0;
  for (const BrepEdge& e : brep.edges) edges += !e.is_degenerate();
  if (!cad.format.empty()) text += cad_text(cad);
  text += fmt::format("geometry       {} corners, {} edges, {} faces\n", brep.corners.size(), edges, brep.faces.size());
  for (const BrepCorner& c : brep.corners)
    if (!c.name.empty() && shown++ < kShown)
      text += fmt::format("corner         {:<20} {:g} {:g} {:g}\n", c.name, c.at.x, c.at.y, c.at.z);
  shown = 0;
  for (const BrepEdge& e : brep.edges)
    if (!e.name.empty() && shown++ < kShown)
      text += fmt::format("edge           {:<20} length {:.6g}, {}\n", e.name, length_of(e), ends_of(brep, e));
  for (std::size_t f = 0; f < std::min(kShown, brep.faces.size()); ++f) {
    const BrepFace& face = brep.faces[FaceId(f)];
    const BrepFaceReport& made = grid.faces[f];
    std::string what = face.kind.empty() ? "" : face.kind + ", ";
    if (f < cad.faces.size())
      what += cad.faces[f].surface + ", " + round_text(round_of(brep, face, cad.faces[f].surface));
    what += place_text(places[f]);
    if (f < cad.faces.size() && !cad.faces[f].colour.empty()) what += "colour " + cad.faces[f].colour + ", ";
    const std::string gridded = made.triangles == 0
                                    ? "no grid"
                                    : fmt::format("{} triangles {}, angles from {:.1f} deg", made.triangles,
                                                  is_quick ? "at a first look" : "of usual size", made.min_angle_deg);
    text += fmt::format("face {:<9} {:<20} {}{} loop{}, {}\n", f + 1, face.name, what, face.loops.size(),
                        face.loops.size() == 1 ? "" : "s", gridded);
  }
  if (brep.faces.size() > kShown)
    text += fmt::format("               and {} more faces (--json lists all)\n", brep.faces.size() - kShown);
  for (std::size_t r = 0; r < std::min(kShown, brep.regions.size()); ++r)
    text += fmt::format("solid {:<8} {}\n", r + 1, brep.regions[r].empty() ? "has no name" : brep.regions[r]);
  if (brep.regions.size() > kShown)
    text += fmt::format("               and {} more solids\n", brep.regions.size() - kShown);
  return text;
}

}  // namespace delfront
