// SPDX-License-Identifier: Apache-2.0
// Faces one by one: parameter curves, their deviation from the edges, the order of each loop, and what is missing
// between its sides.
#include "cad/build_cad.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cad/order_loop.hpp"
#include "cad/shapes.hpp"
#include "geometry_text/projection.hpp"

namespace delfront::cad {
namespace {

constexpr int kSamples = 21;        ///< along an edge, where it is compared with its parameter curves
constexpr double kRounding = 1e-9;  ///< of the diagonal: deviations that are none
constexpr double kLoose = 1e-3;     ///< of an edge's length: deviations that a projection may mend
constexpr double kMended = 0.5;     ///< of the deviation: what a projection must come below
constexpr double kNoGap = 1e-7;     ///< of the loop's extent in the parameter plane
constexpr double kDigits = 1e-10;   ///< least size of a shape, of its distance from the origin
constexpr double kBeside = 1e-3;    ///< of the diagonal: an edge that ends that far from its corner has another one
constexpr double kBesideTolerance = 10;  ///< the same, of the corner's tolerance
constexpr double kTinyEdge = 1e-5;       ///< of the diagonal
constexpr double kLooseShare = 1e-4;     ///< of the diagonal: tolerances worth a word

struct Deviation {
  double most = 0;
  Point at;
};

class Builder {
 public:
  Builder(const Result& data, CadReport& report, Context& context) : data_(data), report_(report), context_(context) {}

  Brep run() {
    add_corners_and_edges();
    for (std::size_t f = 0; f < data_.faces.size(); ++f) {
      context_.progress("read", f, data_.faces.size(), "CAD faces");
      add_face(f);
    }
    brep_.regions = data_.regions;
    note_suspicious_edges();
    return std::move(brep_);
  }

 private:
  static std::string edge_name(std::size_t e) { return fmt::format("edge {}", e + 1); }
  std::string face_name(std::size_t f) const {
    const Face& face = data_.faces[f];
    return fmt::format("face {} ({}{}{})", f + 1, face.facts.surface, face.name.empty() ? "" : ", ", face.name);
  }

  void add_corners_and_edges() {
    Box box;
    for (const Vertex& v : data_.vertices) {
      if (!std::isfinite(length(v.at)))
        throw InputError(
            fmt::format("corner {} of the CAD file lies at ({:g}, {:g}, {:g}), which is no place; export it "
                        "again",
                        brep_.corners.size() + 1, v.at.x, v.at.y, v.at.z));
      brep_.corners.push_back({v.at, v.name, v.tolerance});
      box.add(v.at);
    }
    for (std::size_t e = 0; e < data_.edges.size(); ++e) {
      const Edge& given = data_.edges[e];
      BrepEdge edge;
      edge.curve = make_curve(given.curve);
      edge.range = given.range;
      if (!(edge.range[0] < edge.range[1]))
        throw InputError(edge_name(e) + " of the CAD file has no length: its parameter range is empty", place_of(e));
      for (std::size_t k = 0; k < 2; ++k)
        if (given.corners[k] >= 0) edge.corners[k] = CornerId(std::size_t(given.corners[k]));
      if (edge.is_degenerate() && !edge.corners[0].is_valid())
        throw InputError(edge_name(e) + " of the CAD file is a point, but has no corner");
      edge.name = given.name;
      edge.tolerance = given.tolerance;
      for (int i = 0; i <= kSamples && edge.curve; ++i) box.add(edge.curve->at(at_sample(edge.range, i)));
      brep_.edges.push_back(std::move(edge));
    }
    diagonal_ = box.diagonal();
    check_digits(box);
    for (std::size_t e = 0; e < brep_.edges.size(); ++e) raise_to_corners(e);
  }

  /// Far from the origin coordinates have too few digits left for the shape.
  void check_digits(const Box& box) const {
    const double farthest = std::max(length(box.low), length(box.high));
    if (!(diagonal_ > kDigits * farthest))
      throw InputError(
          fmt::format("the geometry is {:.3g} in size, but lies {:.3g} from the origin: its coordinates have "
                      "too few digits; move it to the origin and export it again",
                      diagonal_, farthest),
          {{box.low, {}}});
  }

  std::vector<Place> place_of(std::size_t e) const {
    const int corner = data_.edges[e].corners[0];
    if (corner < 0) return {};
    return {{data_.vertices[std::size_t(corner)].at, {std::uint32_t(e)}}};
  }

  static double at_sample(const std::array<double, 2>& range, int i) {
    return i == kSamples ? range[1] : range[0] + (range[1] - range[0]) * i / kSamples;
  }

  /// Ends of edges may be farther from their corner than the file says.
  void raise_to_corners(std::size_t e) {
    BrepEdge& edge = brep_.edges[EdgeId(e)];
    if (edge.is_degenerate()) return;
    for (std::size_t k = 0; k < 2; ++k) {
      if (!edge.corners[k].is_valid()) continue;
      BrepCorner& corner = brep_.corners[edge.corners[k]];
      const double away = distance(edge.curve->at(edge.range[k]), corner.at);
      if (away <= std::max(corner.tolerance, kRounding * diagonal_)) continue;
      if (!(away <= std::max(kBesideTolerance * corner.tolerance, kBeside * diagonal_)))
        throw InputError(
            fmt::format("{} of the CAD file ends {:.3g} from its corner {}, at ({:g}, {:g}, {:g}): the file "
                        "contradicts itself; export it again, or mend the part there",
                        edge_name(e), away, edge.corners[k].value + 1, corner.at.x, corner.at.y, corner.at.z),
            {{corner.at, {std::uint32_t(e)}}});
      if (away > 2 * std::max(corner.tolerance, 1e-7 * diagonal_))
        note("edge_off_its_corner",
             fmt::format("{} ends {:.3g} from corner {}, whose tolerance is {:.3g}", edge_name(e), away,
                         edge.corners[k].value + 1, corner.tolerance),
             corner.at);
      corner.tolerance = away;
    }
  }

  void note(const char* kind, const std::string& message, Point at) {
    report_.suspicious.push_back({kind, message, at});
  }
  void repaired(const char* kind, const std::string& message, Point at) {
    report_.repairs.push_back({kind, message, at});
  }

  void add_face(std::size_t f) {
    const Face& given = data_.faces[f];
    const ParameterBox used = box_of(given);
    BrepFace face;
    face.surface = make_surface(given.surface, used);
    face.is_reversed = given.is_reversed;
    face.name = given.name;
    face.tolerance = given.tolerance;
    for (std::size_t k = 0; k < 2; ++k)
      if (given.regions[k] >= 0) face.regions[k] = RegionId(std::size_t(given.regions[k]));
    if (given.loops.empty())
      throw InputError(face_name(f) + " has no edges, and its surface no natural end: it cannot be gridded");
    for (const auto& loop : given.loops) add_loop(f, loop, face);
    orient_loops(f, face);
    brep_.faces.push_back(std::move(face));
    report_.faces.push_back(given.facts);
  }

  /// Of the parameter curves that there are; empty where there are none.
  ParameterBox box_of(const Face& face) const {
    Box box;
    for (const auto& loop : face.loops)
      for (const Use& use : loop) {
        if (!use.has_curve) continue;
        const ParameterCurvePointer curve = make_parameter_curve(use.curve);
        for (int i = 0; i <= kSamples; ++i) {
          const Point2 p = curve->at(at_sample(data_.edges[std::size_t(use.edge)].range, i));
          box.add(Point{p.x, p.y, 0});
        }
      }
    return box.is_empty() ? ParameterBox{} : ParameterBox{{box.low.x, box.low.y}, {box.high.x, box.high.y}};
  }

  Deviation deviation(const BrepFace& face, const BrepUse& use) const {
    const BrepEdge& edge = brep_.edges[use.edge];
    Deviation result;
    for (int i = 0; i <= kSamples; ++i) {
      const double t = at_sample(edge.range, i);
      const Point at = edge.is_degenerate() ? brep_.corners[edge.corners[0]].at : edge.curve->at(t);
      const double away = distance(at, face.surface->at(use.curve->at(t)));
      if (away <= result.most) continue;
      result = {away, at};
    }
    return result;
  }

  double length_of(const BrepEdge& edge) const {
    double sum = 0;
    for (int i = 0; i < kSamples && edge.curve; ++i)
      sum += distance(edge.curve->at(at_sample(edge.range, i)), edge.curve->at(at_sample(edge.range, i + 1)));
    return sum;
  }

  /// The curve of the file, or one found by projection where that is missing or far off.
  BrepUse make_use(std::size_t f, const Use& given, const BrepFace& face) {
    BrepUse use;
    use.edge = EdgeId(std::size_t(given.edge));
    use.is_reversed = given.is_reversed;
    BrepEdge& edge = brep_.edges[use.edge];
    Deviation off;
    if (given.has_curve) {
      use.curve = make_parameter_curve(given.curve);
      off = deviation(face, use);
    }
    const double allowed = std::max({edge.tolerance, face.tolerance, kRounding * diagonal_});
    const bool is_off = given.has_curve && !(off.most <= std::max(2 * allowed, kLoose * length_of(edge)));
    if ((!given.has_curve || is_off) && !edge.is_degenerate()) {
      const Projection found = project_edge(face.surface, edge.curve, edge.range, diagonal_);
      if (!given.has_curve || found.farthest < kMended * off.most) {
        repaired(given.has_curve ? "replaced_parameter_curve" : "added_parameter_curve",
                 fmt::format("{}: the parameter curve of {} {}; found by projection, {:.3g} off", face_name(f),
                             edge_name(use.edge.index()),
                             given.has_curve ? fmt::format("was {:.3g} off", off.most) : "was missing", found.farthest),
                 found.farthest_at);
        use.curve = given.has_curve ? nearest_period(found.curve, use, face) : found.curve;
        off = {found.farthest, found.farthest_at};
      }
    }
    if (!use.curve)
      throw InputError(
          fmt::format("{} has no parameter curve for its degenerate {}", face_name(f), edge_name(use.edge.index())),
          place_of(use.edge.index()));
    raise_tolerance(f, use, off, allowed);
    return use;
  }

  void raise_tolerance(std::size_t f, const BrepUse& use, const Deviation& off, double allowed) {
    if (!(off.most > allowed)) return;
    BrepEdge& edge = brep_.edges[use.edge];
    if (off.most > 2 * std::max(allowed, 1e-7 * diagonal_))
      note("parameter_curve_off",
           fmt::format("{}: {} lies {:.3g} off the surface, its tolerance is {:.3g}", face_name(f),
                       edge_name(use.edge.index()), off.most, allowed),
           off.at);
    if (edge.is_degenerate())
      brep_.corners[edge.corners[0]].tolerance = std::max(brep_.corners[edge.corners[0]].tolerance, off.most);
    else
      edge.tolerance = off.most;
  }

  /// A projection may lie some periods away from where the file has the edge.
  ParameterCurvePointer nearest_period(const ParameterCurvePointer& found, const BrepUse& use,
                                       const BrepFace& face) const {
    const auto& range = brep_.edges[use.edge].range;
    const double middle = 0.5 * (range[0] + range[1]);
    return move_parameter_curve(found, periods_between(face, found->at(middle), use.curve->at(middle)));
  }

  static Point2 periods_between(const BrepFace& face, Point2 from, Point2 to) {
    const std::array<double, 2> period = face.surface->period();
    Point2 by;
    if (period[0] > 0) by.x = period[0] * std::round((to.x - from.x) / period[0]);
    if (period[1] > 0) by.y = period[1] * std::round((to.y - from.y) / period[1]);
    return by;
  }

  LoopSide side_of(const BrepUse& use) const {
    const BrepEdge& edge = brep_.edges[use.edge];
    const std::size_t first = use.is_reversed ? 1 : 0;
    return {use.curve->at(edge.range[first]),
            use.curve->at(edge.range[1 - first]),
            {edge.corners[first], edge.corners[1 - first]}};
  }

  Point2 extent_of(const std::vector<BrepUse>& uses) const {
    Box box;
    for (const BrepUse& use : uses)
      for (int i = 0; i <= kSamples; ++i) {
        const Point2 p = use.curve->at(at_sample(brep_.edges[use.edge].range, i));
        box.add(Point{p.x, p.y, 0});
      }
    const Point size = box.high - box.low;
    return {size.x, size.y};
  }

  void add_loop(std::size_t f, const std::vector<Use>& given, BrepFace& face) {
    std::vector<BrepUse> uses;
    for (const Use& use : given) uses.push_back(make_use(f, use, face));
    const Point2 extent = extent_of(uses);
    std::vector<LoopSide> sides;
    for (const BrepUse& use : uses) sides.push_back(side_of(use));
    for (const std::vector<std::size_t>& order : order_loop(sides, extent)) {
      std::vector<BrepUse> loop;
      for (const std::size_t i : order) loop.push_back(uses[i]);
      unwrap(given, order, face, loop);
      close_jumps(f, extent, face, loop);
      face.loops.push_back(std::move(loop));
    }
  }

  /// Sides found by projection go on where the one before ended, as many periods away as it takes.
  void unwrap(const std::vector<Use>& given, const std::vector<std::size_t>& order, const BrepFace& face,
              std::vector<BrepUse>& loop) const {
    for (std::size_t i = 1; i < loop.size(); ++i) {
      if (given[order[i]].has_curve) continue;
      const Point2 by = periods_between(face, side_of(loop[i]).begin, side_of(loop[i - 1]).end);
      loop[i].curve = move_parameter_curve(loop[i].curve, by);
    }
  }

  /// Where a loop jumps in the plane but not in space, along a side of the surface that is a point, a degenerate edge
  /// is missing.
  void close_jumps(std::size_t f, Point2 extent, const BrepFace& face, std::vector<BrepUse>& loop) {
    std::vector<BrepUse> whole;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      whole.push_back(loop[i]);
      const LoopSide here = side_of(loop[i]), next = side_of(loop[(i + 1) % loop.size()]);
      const double jump_x = std::abs(next.begin.x - here.end.x), jump_y = std::abs(next.begin.y - here.end.y);
      if (jump_x <= 1e-3 * extent.x && jump_y <= 1e-3 * extent.y) continue;
      if (jump_x <= kNoGap * extent.x && jump_y <= kNoGap * extent.y) continue;
      if (!here.corners[1].is_valid() || here.corners[1] != next.corners[0]) continue;
      if (!is_point_between(face, here.end, next.begin, brep_.corners[here.corners[1]])) continue;
      BrepEdge edge;
      edge.corners = {here.corners[1], here.corners[1]};
      whole.push_back({brep_.edges.next_id(), make_parameter_line(here.end, next.begin), false});
      brep_.edges.push_back(std::move(edge));
      const Point at = brep_.corners[here.corners[1]].at;
      repaired("added_degenerate_edge",
               fmt::format("{}: a side that is one point in space was missing at corner {}", face_name(f),
                           here.corners[1].value + 1),
               at);
    }
    loop = std::move(whole);
  }

  bool is_point_between(const BrepFace& face, Point2 a, Point2 b, const BrepCorner& corner) const {
    for (int i = 0; i <= 8; ++i) {
      const Point at = face.surface->at({a.x + (b.x - a.x) * i / 8, a.y + (b.y - a.y) * i / 8});
      if (!(distance(at, corner.at) <= 2 * std::max(corner.tolerance, 1e-7 * diagonal_))) return false;
    }
    return true;
  }

  double area_of(const std::vector<BrepUse>& loop) const {
    double twice = 0;
    Point2 last, first;
    bool is_first = true;
    for (const BrepUse& use : loop)
      for (int i = 0; i <= kSamples; ++i) {
        const Point2 p = use.curve->at(at_sample(brep_.edges[use.edge].range, use.is_reversed ? kSamples - i : i));
        if (is_first) first = p, is_first = false;
        twice += (last.x - first.x) * (p.y - first.y) - (p.x - first.x) * (last.y - first.y);
        last = p;
      }
    return 0.5 * twice;
  }

  /// The face is to the left of its loops: the largest runs anticlockwise, the others clockwise.
  void orient_loops(std::size_t f, BrepFace& face) {
    std::vector<double> area;
    for (const auto& loop : face.loops) area.push_back(area_of(loop));
    std::size_t outer = 0;
    for (std::size_t i = 1; i < area.size(); ++i)
      if (std::abs(area[i]) > std::abs(area[outer])) outer = i;
    for (std::size_t i = 0; i < area.size(); ++i) {
      if (area[i] == 0 || (area[i] > 0) == (i == outer)) continue;
      std::reverse(face.loops[i].begin(), face.loops[i].end());
      for (BrepUse& use : face.loops[i]) use.is_reversed = !use.is_reversed;
      repaired("turned_loop", fmt::format("{}: loop {} ran the wrong way round", face_name(f), i + 1),
               face.surface->at(side_of(face.loops[i][0]).begin));
    }
  }

  void note_suspicious_edges() {
    for (std::size_t e = 0; e < data_.edges.size(); ++e) {
      const BrepEdge& edge = brep_.edges[EdgeId(e)];
      if (edge.is_degenerate()) continue;
      const double size = length_of(edge);
      const Point at = edge.curve->at(edge.range[0]);
      if (size < kTinyEdge * diagonal_)
        note("tiny_edge",
             fmt::format("{} is {:.3g} long, {:.2g} of the diagonal", edge_name(e), size, size / diagonal_), at);
      if (edge.tolerance > kLooseShare * diagonal_ || edge.tolerance > 0.5 * size)
        note("loose_tolerance",
             fmt::format("{}, {:.3g} long, lies within {:.3g} of its faces only", edge_name(e), size, edge.tolerance),
             at);
    }
    for (std::size_t c = 0; c < brep_.corners.size(); ++c) {
      const BrepCorner& corner = brep_.corners[CornerId(c)];
      if (corner.tolerance > kLooseShare * diagonal_)
        note("loose_tolerance", fmt::format("corner {} has a tolerance of {:.3g}", c + 1, corner.tolerance), corner.at);
    }
  }

  const Result& data_;
  CadReport& report_;
  Context& context_;
  Brep brep_;
  double diagonal_ = 0;
};

}  // namespace

Brep build_cad(const Result& data, CadReport& report, Context& context) { return Builder(data, report, context).run(); }

}  // namespace delfront::cad
