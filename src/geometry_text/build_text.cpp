// SPDX-License-Identifier: Apache-2.0
// Text to Brep: surfaces, corners, edges, faces, shapes, each with its name; every error says file and line.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/nearest_name.hpp"
#include "delfront/errors.hpp"
#include "geometry_text/build_edge.hpp"
#include "geometry_text/place_loop.hpp"
#include "geometry_text/projection.hpp"
#include "geometry_text/shapes.hpp"

namespace delfront {
namespace {

constexpr double kShare = 1e-9;  ///< of the diagonal: the tolerance where none is given
constexpr int kSamples = 16;

class TextBuilder {
 public:
  TextBuilder(const GeometryText& text, std::string file) : text_(text), file_(std::move(file)) {}

  Brep run() {
    for (const TextSurface& surface : text_.surfaces)
      at_line(surface.line, "surface", surface.name, [&] {
        surfaces_.emplace_back(build_surface(surface));
        add_name(surface_names_, surface.name);
      });
    for (const TextCorner& corner : text_.corners)
      at_line(corner.line, "corner", corner.name, [&] {
        brep_.corners.push_back({corner.at, corner.name});
        add_name(corner_names_, corner.name);
      });
    for (const TextEdge& edge : text_.edges) at_line(edge.line, "edge", edge.name, [&] { make_curve(edge); });
    find_tolerance();
    for (std::size_t e = 0; e < curves_.size(); ++e)
      at_line(text_.edges[e].line, "edge", text_.edges[e].name, [&] { make_edge(e); });
    for (const TextFace& face : text_.faces) at_line(face.line, "face", face.name, [&] { make_face(face); });
    for (const TextShape& shape : text_.shapes)
      at_line(shape.line, "shape", shape.name, [&] { append_brep(brep_, build_shape(shape)); });
    if (brep_.faces.empty())
      throw InputError(file_ + " has no faces: add a [[face]], or a [[shape]] such as type = \"sphere\", radius = 1");
    brep_.tolerance = text_.tolerance;
    at_line({}, "the geometry", "", [&] {
      check_lengths();
      check_brep(brep_);
    });
    return std::move(brep_);
  }

 private:
  using Names = std::map<std::string, std::size_t>;

  template <class Make>
  void at_line(TextLine line, const char* what, const std::string& name, const Make& make) const {
    try {
      make();
    } catch (const InputError& e) {
      const std::string where = line.number > 0 ? fmt::format("{}:{}", file_, line.number) : file_;
      throw InputError(fmt::format("{}: {}{}: {}", where, what, name.empty() ? "" : " '" + name + "'", e.what()),
                       e.places);
    }
  }

  static void add_name(Names& names, const std::string& name) {
    if (name.empty()) throw InputError("the name is empty");
    if (name[0] == '-') throw InputError("names do not begin with a minus: that turns edges round");
    if (!names.try_emplace(name, names.size()).second) throw InputError("the name is there already; names are unique");
  }
  static std::size_t find_name(const Names& names, const std::string& name, const char* what) {
    const auto found = names.find(name);
    if (found != names.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [other, index] : names) known.push_back(other);
    const std::string near = nearest_name(name, known);
    throw InputError(fmt::format("there is no {} '{}'{}", what, name, near.empty() ? "" : "; did you mean " + near));
  }
  SurfacePointer find_surface(const std::string& name) const {
    return surfaces_[find_name(surface_names_, name, "surface")];
  }

  void make_curve(const TextEdge& edge) {
    add_name(edge_names_, edge.name);
    if (edge.from.empty() != edge.to.empty()) throw InputError("from and to come together: one of them is missing");
    Ends ends;
    const Point *from = nullptr, *to = nullptr;
    if (!edge.from.empty()) {
      ends = {CornerId(find_name(corner_names_, edge.from, "corner")),
              CornerId(find_name(corner_names_, edge.to, "corner"))};
      from = &brep_.corners[ends[0]].at;
      to = &brep_.corners[ends[1]].at;
    }
    curves_.push_back(build_curve(edge, from, to, [this](const std::string& name) { return find_surface(name); }));
    ends_.push_back(ends);
  }

  void find_tolerance() {
    Box box;
    for (const BrepCorner& corner : brep_.corners) box.add(corner.at);
    for (const BuiltCurve& curve : curves_)
      for (int i = 0; i <= kSamples; ++i)
        box.add(curve.curve->at(curve.range[0] + (curve.range[1] - curve.range[0]) * i / kSamples));
    reach_ = box.is_empty() ? 1 : box.diagonal() + length(box.centre());
    tolerance_ = std::max(text_.tolerance, kShare * box.diagonal());
  }

  /// Sides of whole surfaces that are nearly a point are as bad as edges that are.
  void check_lengths() const {
    Box all;
    for (const BrepEdge& edge : brep_.edges)
      for (int i = 0; i <= kSamples && !edge.is_degenerate(); ++i) all.add(place_on(edge, i));
    for (std::size_t e = 0; e < brep_.edges.size(); ++e) {
      const BrepEdge& edge = brep_.edges[EdgeId(e)];
      if (edge.is_degenerate()) continue;
      Box own;
      for (int i = 0; i <= kSamples; ++i) own.add(place_on(edge, i));
      if (own.diagonal() > std::max(text_.tolerance, kShare * all.diagonal())) continue;
      throw InputError(
          fmt::format("edge {}{} at ({:g}, {:g}, {:g}) has no length; leave it out, or make a pole of it: "
                      "control points that are exactly the same",
                      e + 1, edge.name.empty() ? "" : " ('" + edge.name + "')", own.low.x, own.low.y, own.low.z),
          {{own.low, {std::uint32_t(e)}}});
    }
  }
  static Point place_on(const BrepEdge& edge, int i) {
    return edge.curve->at(edge.range[0] + (edge.range[1] - edge.range[0]) * i / kSamples);
  }

  /// The corner at a place, made where there is none.
  CornerId corner_at(Point at) {
    for (std::size_t c = 0; c < brep_.corners.size(); ++c)
      if (distance(brep_.corners[CornerId(c)].at, at) <= tolerance_) return CornerId(c);
    brep_.corners.push_back({at, ""});
    return CornerId(brep_.corners.size() - 1);
  }

  void make_edge(std::size_t e) {
    const BuiltCurve& curve = curves_[e];
    BrepEdge edge;
    edge.curve = curve.curve;
    edge.range = curve.range;
    edge.name = text_.edges[e].name;
    edge.corners = ends_[e];
    for (std::size_t k = 0; k < 2; ++k) {
      const Point end = curve.curve->at(curve.range[k]);
      if (!is_finite(end)) throw InputError("the curve is not finite");
      if (!edge.corners[k].is_valid()) {
        if (!curve.is_closed) edge.corners[k] = corner_at(end);
        continue;
      }
      const double away = distance(end, brep_.corners[edge.corners[k]].at);
      if (!(away <= tolerance_))
        throw InputError(
            fmt::format("it {} at ({:g}, {:g}, {:g}), {:g} away from its corner '{}'", k == 0 ? "begins" : "ends",
                        end.x, end.y, end.z, away, brep_.corners[edge.corners[k]].name),
            {{end, {std::uint32_t(e)}}});
    }
    brep_.edges.push_back(std::move(edge));
  }

  ParameterCurvePointer parameter_curve(const TextUse& use, std::size_t e, const SurfacePointer& surface) const {
    const BuiltCurve& curve = curves_[e];
    if (!use.points.empty()) {
      if (!use.uv.empty()) throw InputError("an edge in a loop has uv or points, not both");
      std::vector<Point> points;
      for (const auto& p : use.points) points.push_back({p[0], p[1], 0});
      NurbsCurveData data{use.degree, use.knots, std::move(points), use.weights};
      if (data.knots.empty() && use.degree >= 1 && data.points.size() > std::size_t(use.degree)) {
        data.knots = even_knots(data.points.size(), use.degree);
        for (double& knot : data.knots) knot = (1 - knot) * curve.range[0] + knot * curve.range[1];
      }
      return make_nurbs_parameter_curve(data);
    }
    if (!use.uv.empty()) return build_uv_curve(use.uv, curve.range);
    if (curve.surface == surface) return curve.on_surface;
    const Projection found = project_edge(surface, curve.curve, curve.range, reach_);
    if (!(found.farthest <= 2 * tolerance_))
      throw InputError(
          fmt::format("edge '{}' lies {:g} away from the surface at ({:g}, {:g}, {:g}), where {:g} are allowed; "
                      "is it another surface's? (tolerance = … at the top of the file allows more)",
                      use.edge, found.farthest, found.farthest_at.x, found.farthest_at.y, found.farthest_at.z,
                      tolerance_),
          {{found.farthest_at, {std::uint32_t(e)}}});
    return found.curve;
  }

  void make_face(const TextFace& text) {
    const SurfacePointer surface = find_surface(text.surface);
    if (text.loops.empty()) return make_whole_face(text, surface);
    BrepFace face;
    face.surface = surface;
    face.is_reversed = text.reversed;
    face.name = text.name;
    face.kind = text.kind;
    for (const std::vector<TextUse>& loop : text.loops) {
      if (loop.empty()) throw InputError("a loop has no edges; leave loops out for the whole surface");
      std::vector<LoosePart> parts;
      for (const TextUse& use : loop) {
        const std::size_t e = find_name(edge_names_, use.edge, "edge");
        parts.push_back({{EdgeId(e), parameter_curve(use, e, surface), use.is_reversed}, use.edge});
      }
      try {
        std::vector<BrepUse> placed = place_loop(brep_, *surface, std::move(parts), !face.loops.empty());
        if (!face.loops.empty()) move_hole_into(brep_, *surface, face.loops[0], placed);
        face.loops.push_back(std::move(placed));
      } catch (const InputError& e) {
        throw InputError(fmt::format("loop {}: {}", face.loops.size() + 1, e.what()), e.places);
      }
    }
    brep_.faces.push_back(std::move(face));
  }

  void make_whole_face(const TextFace& text, const SurfacePointer& surface) {
    const ParameterBox box = surface->box();
    if (!std::isfinite(box.high.x - box.low.x) || !std::isfinite(box.high.y - box.low.y))
      throw InputError("the surface goes on for ever; loops say which part of it is the face");
    Brep whole = make_rectangle_on(surface, box);
    for (BrepFace& face : whole.faces) {
      face.name = text.name;
      face.kind = text.kind;
      face.is_reversed = text.reversed;
    }
    append_brep(brep_, std::move(whole));
  }

  using Ends = std::array<CornerId, 2>;
  const GeometryText& text_;
  std::string file_;
  Brep brep_;
  Names corner_names_, edge_names_, surface_names_;
  std::vector<SurfacePointer> surfaces_;
  std::vector<BuiltCurve> curves_;
  std::vector<Ends> ends_;
  double reach_ = 1, tolerance_ = 0;
};

}  // namespace

Brep build_brep(const GeometryText& geometry, const std::string& file) { return TextBuilder(geometry, file).run(); }

}  // namespace delfront
