// SPDX-License-Identifier: Apache-2.0
// Normals are asked of the surfaces; boxes, places and formulas of the first grid, whose points lie on the faces: a box
// or formula takes a face where it takes all of them.
#include "pipeline/face_selectors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "geometry/angles.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kOneWay = 5 * kDegree;
constexpr int kPlaces = 8;         ///< along each edge of a face
constexpr double kSlack = 1e-6;    ///< of the diagonal: what lies in a box's side is in it, and so near is as near
constexpr std::size_t kTold = 12;  ///< colours in a message

/// Whether the face looks that way at places all along its border, and between those.
bool looks_along(const Brep& brep, const BrepFace& face, Point normal) {
  Point2 first;
  bool has_first = false;
  for (const auto& loop : face.loops)
    for (const BrepUse& use : loop) {
      const auto& range = brep.edges[use.edge].range;
      for (int i = 0; i < kPlaces; ++i) {
        const Point2 uv = use.curve->at(range[0] + (range[1] - range[0]) * (i + 0.5) / kPlaces);
        if (!has_first) first = uv;
        has_first = true;
        for (const Point2 place : {uv, Point2{0.5 * (uv.x + first.x), 0.5 * (uv.y + first.y)}}) {
          const Point n = (face.is_reversed ? -1.0 : 1.0) * face.surface->normal(place);
          if (!(angle_between(n, normal) < kOneWay)) return false;
        }
      }
    }
  return has_first;
}

std::string text_of(Point p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

/// How far a box reaches out of another, along the axis where that is most.
double reach_beyond(const Box& box, const Box& other) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max({most, other.low[k] - box.low[k], box.high[k] - other.high[k]});
  return most;
}

class FaceSelection {
 public:
  FaceSelection(std::string file, const CadReport& cad, const GeometryInput& input)
      : file_(std::move(file)),
        cad_(cad),
        brep_(input.brep),
        grid_(input.look.grid),
        width_(grid_.bounding_box().diagonal()),
        slack_(kSlack * width_) {
    corners_.resize(brep_.faces.size());
    for (std::size_t t = 0; t < grid_.triangles.size(); ++t)
      for (const VertexId v : grid_.triangles[TriangleId(t)])
        corners_[grid_.input_face[TriangleId(t)]].push_back(grid_.points[v]);
  }

  /// @throws UsageError  without the place of the key
  std::vector<std::size_t> select(const BoundaryOptions& boundary) const {
    if (!boundary.faces.empty()) return by_number(boundary.faces);
    if (boundary.normal) return by_normal(*boundary.normal);
    if (!boundary.colours.empty()) return by_colour(boundary.colours);
    if (boundary.box) return by_box(*boundary.box);
    if (!boundary.near.empty()) return by_places(boundary.near);
    return by_expression(boundary.expression);
  }

 private:
  std::string face_text(std::size_t f) const {
    return fmt::format("face {} ('{}')", f + 1, brep_.faces[FaceId(f)].name);
  }

  std::vector<std::size_t> by_number(const std::vector<std::uint32_t>& numbers) const {
    std::vector<std::size_t> faces;
    for (const std::uint32_t face : numbers) {
      if (face > brep_.faces.size())
        throw UsageError(
            fmt::format("{} has no face {}; it has {} (delfront info lists them)", file_, face, brep_.faces.size()));
      faces.push_back(face - 1);
    }
    return faces;
  }

  std::vector<std::size_t> by_normal(Point normal) const {
    std::vector<std::size_t> faces;
    for (std::size_t f = 0; f < brep_.faces.size(); ++f)
      if (looks_along(brep_, brep_.faces[FaceId(f)], normal)) faces.push_back(f);
    if (faces.empty())
      throw UsageError(fmt::format("no face of {} looks along {} all over, within 5 degrees", file_, text_of(normal)));
    return faces;
  }

  std::vector<std::size_t> by_colour(const std::vector<std::string>& colours) const {
    std::map<std::string, std::size_t> count;
    std::set<std::string> found;
    std::vector<std::size_t> faces;
    for (std::size_t f = 0; f < cad_.faces.size(); ++f) {
      const std::string& colour = cad_.faces[f].colour;
      if (!colour.empty()) ++count[colour];
      if (std::find(colours.begin(), colours.end(), colour) == colours.end()) continue;
      faces.push_back(f);
      found.insert(colour);
    }
    for (const std::string& colour : colours) {
      if (found.count(colour) > 0) continue;
      std::vector<std::string> there;
      for (const auto& [one, n] : count)
        if (there.size() < kTold) there.push_back(fmt::format("{} ({} face{})", one, n, n == 1 ? "" : "s"));
      if (count.size() > kTold) there.push_back(fmt::format("{} more", count.size() - kTold));
      throw UsageError(fmt::format("no face of {} has the colour {}; {}", file_, colour,
                                   there.empty() ? std::string("the file gives its faces no colours")
                                                 : fmt::format("there are: {}", fmt::join(there, ", "))));
    }
    return faces;
  }

  Box box_of(std::size_t face) const {
    Box box;
    for (const Point& p : corners_[face]) box.add(p);
    return box;
  }

  std::vector<std::size_t> by_box(const Box& asked) const {
    std::vector<std::size_t> faces;
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      if (corners_[f].empty()) continue;
      const double beyond = reach_beyond(box_of(f), asked);
      if (beyond <= slack_) faces.push_back(f);
      if (!(beyond < least)) continue;
      least = beyond;
      nearest = f;
    }
    if (!faces.empty()) return faces;
    const Box box = box_of(nearest);
    throw UsageError(fmt::format(
        "no face of {} lies in the box from {} to {}; {} comes nearest to that: it reaches from "
        "{} to {}",
        file_, text_of(asked.low), text_of(asked.high), face_text(nearest), text_of(box.low), text_of(box.high)));
  }

  double distance_to(std::size_t face, Point p) const {
    const std::vector<Point>& at = corners_[face];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < at.size(); i += 3)
      least = std::min(least, distance(p, nearest_point_on_triangle(p, at[i], at[i + 1], at[i + 2])));
    return least;
  }

  std::vector<std::size_t> by_places(const std::vector<Point>& places) const {
    std::vector<std::size_t> faces;
    for (const Point& p : places) faces.push_back(nearest_face(p));
    return faces;
  }

  std::size_t nearest_face(Point p) const {
    std::vector<double> away;
    for (std::size_t f = 0; f < corners_.size(); ++f) away.push_back(distance_to(f, p));
    const std::size_t first = std::size_t(std::min_element(away.begin(), away.end()) - away.begin());
    if (away[first] > width_)
      throw UsageError(
          fmt::format("{} is {:g} away from the nearest face of {}, farther than that is wide ({:g}): is it "
                      "in the file's unit?",
                      text_of(p), away[first], file_, width_));
    for (std::size_t f = first + 1; f < away.size(); ++f)
      if (away[f] <= away[first] + slack_)
        throw UsageError(fmt::format("{} is as near to {} as to {}: give a place within one of them", text_of(p),
                                     face_text(first), face_text(f)));
    return first;
  }

  std::vector<std::size_t> by_expression(const std::string& text) const {
    const Expression expression(text);
    std::vector<std::size_t> faces;
    std::size_t nearest = 0;
    double most = -1;
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      if (corners_[f].empty()) continue;
      std::vector<double> value(corners_[f].size());
      expression.evaluate(corners_[f], value);
      const auto is_true = [](double v) { return v != 0 && !std::isnan(v); };
      const double share = double(std::count_if(value.begin(), value.end(), is_true)) / double(value.size());
      if (share == 1) faces.push_back(f);
      if (!(share > most)) continue;
      most = share;
      nearest = f;
    }
    if (faces.empty())
      throw UsageError(fmt::format("'{}' is true all over no face of {}; {}", text, file_,
                                   most > 0 ? fmt::format("{} comes nearest to that, with {:.0f} % of it",
                                                          face_text(nearest), std::floor(100 * most))
                                            : std::string("it is true nowhere on it")));
    return faces;
  }

  std::string file_;
  const CadReport& cad_;
  const Brep& brep_;
  const Model& grid_;
  double width_, slack_;
  std::vector<std::vector<Point>> corners_;  ///< by face, three a triangle of the first grid
};

/// As grid_brep() has them: one a name, in the order of the faces.
void name_patches(const Brep& brep, Model& grid) {
  std::map<std::string, PatchId> patch_of;
  std::vector<PatchId> of_face;
  grid.patches.clear();
  for (const BrepFace& face : brep.faces) {
    const auto [it, is_new] = patch_of.try_emplace(face.name, grid.patches.next_id());
    if (is_new) grid.patches.push_back({face.name, face.kind});
    of_face.push_back(it->second);
  }
  for (std::size_t t = 0; t < grid.triangles.size(); ++t)
    grid.patch_of_triangle[TriangleId(t)] = of_face[grid.input_face[TriangleId(t)]];
}

}  // namespace

void name_selected_faces(const std::vector<BoundaryOptions>& boundaries, const std::string& file, const CadReport& cad,
                         GeometryInput& input) {
  if (std::none_of(boundaries.begin(), boundaries.end(), [](const auto& b) { return b.selects_faces(); })) return;
  std::vector<std::pair<std::size_t, std::string>> named;  // messages name faces as the file does
  std::map<std::size_t, std::string> last;                 // by face
  const FaceSelection selection(file, cad, input);
  const auto fail = [](const BoundaryOptions& boundary, const std::string& why) {
    throw UsageError(
        fmt::format("{}boundaries.{}: {}", boundary.set_at.empty() ? "" : boundary.set_at + ": ", boundary.name, why));
  };
  for (const BoundaryOptions& boundary : boundaries) {
    if (!boundary.selects_faces()) continue;
    try {
      for (const std::size_t face : selection.select(boundary)) named.emplace_back(face, boundary.name);
    } catch (const UsageError& e) {
      fail(boundary, e.what());
    }
  }
  for (const auto& [face, name] : named) last[face] = name;
  for (const BoundaryOptions& boundary : boundaries)
    for (const auto& [face, name] : named)
      if (name == boundary.name &&
          std::none_of(last.begin(), last.end(), [&](const auto& l) { return l.second == boundary.name; }))
        fail(boundary,
             fmt::format("boundaries that come later select all of its faces (face {}: '{}'); of those that select "
                         "the same face the last one has it",
                         face + 1, last[face]));
  for (const auto& [face, name] : last) input.brep.faces[FaceId(face)].name = name;
  name_patches(input.brep, input.look.grid);
}

}  // namespace delfront
