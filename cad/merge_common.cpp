// SPDX-License-Identifier: Apache-2.0
// Solids that lie face to face need no general fuse: corners at one place, edges between the same corners through the
// same places, and faces with the same edges on the same surface are one. By hashing, so that it takes no longer than
// reading; on the plain data, since OpenCASCADE's shapes would have to be built anew for it.
#include <algorithm>
#include <cmath>
#include <memory>
#include <unordered_map>

#include "translation.hpp"

namespace delfront::cad {
namespace {

constexpr double kMostShare = 1e-6;  ///< of the diagonal: what tolerances count at most
constexpr double kRounding = 1e-13;  ///< of the diagonal: what they count at least
constexpr double kSameStep = 1e-12;  ///< parameters that run on as before

bool have_common(const std::vector<int>& a, const std::vector<int>& b) {
  return std::any_of(a.begin(), a.end(), [&](int p) { return std::find(b.begin(), b.end(), p) != b.end(); });
}

void add_to(std::vector<int>& into, const std::vector<int>& from) {
  for (const int p : from)
    if (std::find(into.begin(), into.end(), p) == into.end()) into.push_back(p);
}

Point2 times(double s, Point2 p) { return {s * p.x, s * p.y}; }
Point2 plus(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }

void merge_facts(CadFace& into, const CadFace& from) {
  if (into.name.empty()) into.name = from.name;
  if (into.colour.empty()) into.colour = from.colour;
  if (into.layer.empty()) into.layer = from.layer;
  into.tolerance = std::max(into.tolerance, from.tolerance);
  for (const std::string& solid : from.solids)
    if (std::find(into.solids.begin(), into.solids.end(), solid) == into.solids.end()) into.solids.push_back(solid);
}

/// t of what stays = scale * t of what goes + shift.
struct Step {
  double scale = 1, shift = 0;
  bool is_none() const { return std::abs(scale - 1) <= kSameStep && shift == 0; }
  double back(double t) const { return (t - shift) / scale; }
};

/// Any parameter curve that does not say its parameters as numbers.
class Stepped final : public OtherParameterCurve {
 public:
  Stepped(ParameterCurveData curve, Step step) : curve_(std::move(curve)), step_(step) {}
  ParameterCurveDerivatives derivatives(double t) const noexcept override {
    ParameterCurveDerivatives d = given(step_.back(t));
    const double s = 1 / step_.scale;
    d.first = times(s, d.first);
    d.second = times(s * s, d.second);
    return d;
  }

 private:
  ParameterCurveDerivatives given(double t) const noexcept {
    if (curve_.kind == ParameterCurveData::Kind::other) return curve_.other->derivatives(t);
    const double c = std::cos(t), s = std::sin(t);
    const Point2 out = plus(times(c, curve_.x), times(s, curve_.y));
    return {plus(curve_.origin, out), plus(times(c, curve_.y), times(-s, curve_.x)), times(-1, out)};
  }
  ParameterCurveData curve_;
  Step step_;
};

ParameterCurveData stepped(const ParameterCurveData& given, const Step& step) {
  using Kind = ParameterCurveData::Kind;
  ParameterCurveData made = given;
  if (given.kind == Kind::line) {
    made.origin = plus(given.origin, times(-step.shift / step.scale, given.x));
    made.x = times(1 / step.scale, given.x);
  } else if (given.kind == Kind::nurbs) {
    for (double& knot : made.nurbs.knots) knot = step.scale * knot + step.shift;
    if (step.scale > 0) return made;
    std::reverse(made.nurbs.knots.begin(), made.nurbs.knots.end());
    std::reverse(made.nurbs.points.begin(), made.nurbs.points.end());
    std::reverse(made.nurbs.weights.begin(), made.nurbs.weights.end());
  } else {
    made = {};
    made.kind = Kind::other;
    made.other = std::make_shared<Stepped>(given, step);
  }
  return made;
}

struct CellHash {
  std::size_t operator()(const std::array<std::int64_t, 3>& c) const noexcept {
    std::uint64_t h = 0;
    for (const std::int64_t k : c) h = (h ^ std::uint64_t(k)) * 0x9e3779b97f4a7c15ull, h ^= h >> 31;
    return h;
  }
};

class Merger {
 public:
  Merger(Translation& data, double diagonal) : data_(data), diagonal_(diagonal) {}

  std::size_t run() {
    note_owners();
    merge_corners();
    merge_edges();
    const std::size_t gone = merge_faces();
    rewrite_uses();
    drop_unused();
    return gone;
  }

 private:
  void note_owners() {
    of_edge_.resize(data_.edges.size());
    of_corner_.resize(data_.vertices.size());
    for (std::size_t f = 0; f < data_.faces.size(); ++f)
      for (const auto& loop : data_.faces[f].loops)
        for (const Use& use : loop) add_to(of_edge_[std::size_t(use.edge)], data_.owners[f].pieces);
    for (std::size_t e = 0; e < data_.edges.size(); ++e)
      for (const int c : data_.edges[e].corners)
        if (c >= 0) add_to(of_corner_[std::size_t(c)], of_edge_[e]);
  }

  /// Sheets beside sheets stay as they are.
  bool may_merge(const std::vector<int>& a, const std::vector<int>& b) const {
    const auto is_closed = [&](int p) { return bool(data_.is_closed[std::size_t(p)]); };
    return !have_common(a, b) &&
           (std::any_of(a.begin(), a.end(), is_closed) || std::any_of(b.begin(), b.end(), is_closed));
  }

  double reach(double a, double b) const {
    return std::max(kRounding * diagonal_, std::min(a + b, kMostShare * diagonal_));
  }

  /// The nearest of those that stay, if it is near enough.
  int find_corner(std::size_t c, const std::array<std::int64_t, 3>& cell) const {
    int best = -1;
    double nearest = 0;
    for (std::int64_t k = 0; k < 27; ++k) {
      const auto found = cells_.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
      if (found == cells_.end()) continue;
      for (const int r : found->second) {
        const double away = distance(data_.vertices[c].at, data_.vertices[std::size_t(r)].at);
        if (away > reach(given_[c], given_[std::size_t(r)]) || (best >= 0 && away >= nearest)) continue;
        if (!may_merge(of_corner_[c], of_corner_[std::size_t(r)])) continue;
        best = r;
        nearest = away;
      }
    }
    return best;
  }

  void merge_corners() {
    corner_.resize(data_.vertices.size());
    double widest = 0;
    for (const Vertex& v : data_.vertices) {
      given_.push_back(v.tolerance);
      widest = std::max(widest, v.tolerance);
    }
    const double side = 2 * reach(widest, widest);
    for (std::size_t c = 0; c < corner_.size(); ++c) {
      corner_[c] = int(c);
      const Point at = data_.vertices[c].at;
      std::array<std::int64_t, 3> cell{};
      bool is_place = side > 0;
      for (int k = 0; k < 3; ++k) {
        is_place = is_place && std::abs(at[k] / side) < 1e18;  // not a number: no
        if (is_place) cell[std::size_t(k)] = std::int64_t(std::floor(at[k] / side));
      }
      if (!is_place) continue;
      const int r = find_corner(c, cell);
      if (r < 0) {
        cells_[cell].push_back(int(c));
        continue;
      }
      corner_[c] = r;
      Vertex& kept = data_.vertices[std::size_t(r)];
      kept.tolerance = std::max({kept.tolerance, given_[c], distance(kept.at, at)});
      add_to(of_corner_[std::size_t(r)], of_corner_[c]);
    }
    for (Edge& edge : data_.edges)
      for (int& c : edge.corners)
        if (c >= 0) c = corner_[std::size_t(c)];
  }

  /// The largest distance between places of two edges, the second run through in either direction.
  double apart(std::size_t a, std::size_t b, bool is_turned) const {
    double most = 0;
    for (std::size_t i = 0; i < kEdgeSamples; ++i)
      most = std::max(most, distance(data_.samples[a][i], data_.samples[b][is_turned ? kEdgeSamples - 1 - i : i]));
    return most;
  }

  void merge_edges() {
    const std::size_t n = data_.edges.size();
    edge_.resize(n);
    step_.resize(n);
    std::unordered_map<std::uint64_t, std::vector<int>> between;
    for (std::size_t e = 0; e < n; ++e) {
      edge_[e] = int(e);
      Edge& edge = data_.edges[e];
      if (edge.curve.kind == CurveData::Kind::none || edge.corners[0] < 0 || edge.corners[1] < 0) continue;
      const auto [low, high] = std::minmax(edge.corners[0], edge.corners[1]);
      std::vector<int>& known = between[std::uint64_t(std::uint32_t(low)) << 32 | std::uint32_t(high)];
      const auto same =
          std::find_if(known.begin(), known.end(), [&](int r) { return is_same_edge(e, std::size_t(r)); });
      if (same == known.end())
        known.push_back(int(e));
      else
        put_edge(e, std::size_t(*same));
    }
  }

  bool is_same_edge(std::size_t e, std::size_t r) const {
    if (!may_merge(of_edge_[e], of_edge_[r])) return false;
    const double allowed = reach(data_.edges[e].tolerance, data_.edges[r].tolerance);
    return apart(e, r, false) <= allowed || apart(e, r, true) <= allowed;
  }

  void put_edge(std::size_t e, std::size_t r) {
    const Edge& goes = data_.edges[e];
    Edge& stays = data_.edges[r];
    const bool is_turned = apart(e, r, true) < apart(e, r, false);
    edge_[e] = int(r);
    const double scale = (stays.range[1] - stays.range[0]) / (goes.range[1] - goes.range[0]);
    step_[e] = is_turned ? Step{-scale, stays.range[1] + scale * goes.range[0]}
                         : Step{scale, stays.range[0] - scale * goes.range[0]};
    stays.tolerance = std::max(stays.tolerance, goes.tolerance + apart(e, r, is_turned));
    add_to(of_edge_[r], of_edge_[e]);
  }

  std::vector<int> edges_of(const Face& face) const {
    std::vector<int> edges;
    for (const auto& loop : face.loops)
      for (const Use& use : loop)
        if (data_.edges[std::size_t(use.edge)].curve.kind != CurveData::Kind::none)
          edges.push_back(edge_[std::size_t(use.edge)]);
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  std::size_t merge_faces() {
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> by_edges;
    is_gone_.assign(data_.faces.size(), false);
    std::size_t gone = 0;
    for (std::size_t f = 0; f < data_.faces.size(); ++f) {
      const std::vector<int> edges = edges_of(data_.faces[f]);
      if (edges.empty()) continue;
      std::uint64_t hash = edges.size();
      for (const int e : edges) hash = (hash ^ std::uint64_t(e)) * 0x9e3779b97f4a7c15ull, hash ^= hash >> 31;
      std::vector<std::size_t>& known = by_edges[hash];
      const auto same = std::find_if(known.begin(), known.end(),
                                     [&](std::size_t r) { return edges_of(data_.faces[r]) == edges && is_same(f, r); });
      if (same == known.end()) {
        known.push_back(f);
        continue;
      }
      put_face(f, *same);
      is_gone_[f] = true;
      ++gone;
    }
    return gone;
  }

  bool is_same(std::size_t f, std::size_t r) const {
    const Face &a = data_.faces[f], &b = data_.faces[r];
    if (!may_merge(data_.owners[f].pieces, data_.owners[r].pieces)) return false;
    if (a.surface.kind == SurfaceData::Kind::plane && b.surface.kind == SurfaceData::Kind::plane) return true;
    return is_same_surface(data_.shapes[f], data_.shapes[r], reach(a.tolerance, b.tolerance));
  }

  /// Whether the face runs along an edge of the other in its direction, seen from outside both.
  bool is_same_way(std::size_t f, std::size_t r) const {
    const auto direction = [&](const Face& face, int edge, bool& is_once) {
      int count = 0;
      bool is_reversed = false;
      for (const auto& loop : face.loops)
        for (const Use& use : loop) {
          const auto e = std::size_t(use.edge);
          if (edge_[e] != edge) continue;
          ++count;
          is_reversed = use.is_reversed != (step_[e].scale < 0);
        }
      is_once = count == 1;
      return is_reversed != face.is_reversed;
    };
    for (const int edge : edges_of(data_.faces[r])) {
      bool is_once = false, is_once_there = false;
      const bool way = direction(data_.faces[f], edge, is_once), there = direction(data_.faces[r], edge, is_once_there);
      if (is_once && is_once_there) return way == there;
    }
    return looks_the_same_way(data_.shapes[f], data_.shapes[r]);
  }

  void put_face(std::size_t f, std::size_t r) {
    const Face& goes = data_.faces[f];
    Face& stays = data_.faces[r];
    stays.tolerance = std::max(stays.tolerance, goes.tolerance);
    merge_facts(stays.facts, goes.facts);
    auto& solids = data_.owners[r].solids;
    const auto& more = data_.owners[f].solids;
    const bool is_same = is_same_way(f, r);
    for (std::size_t k = 0; k < 2; ++k)
      if (int& solid = solids[is_same ? k : 1 - k]; solid < 0) solid = more[k];
    add_to(data_.owners[r].pieces, data_.owners[f].pieces);
  }

  void rewrite_uses() {
    for (std::size_t f = 0; f < data_.faces.size(); ++f) {
      if (is_gone_[f]) continue;
      for (auto& loop : data_.faces[f].loops)
        for (Use& use : loop) {
          const auto e = std::size_t(use.edge);
          if (edge_[e] == int(e)) continue;
          if (use.has_curve && !step_[e].is_none()) use.curve = stepped(use.curve, step_[e]);
          use.is_reversed = use.is_reversed != (step_[e].scale < 0);
          use.edge = edge_[e];
        }
    }
  }

  template <class Value>
  static void keep(std::vector<Value>& values, const std::vector<bool>& stays) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!stays[i]) continue;
      if (to != i) values[to] = std::move(values[i]);
      ++to;
    }
    values.erase(values.begin() + std::ptrdiff_t(to), values.end());
  }

  static std::vector<int> numbers(const std::vector<bool>& stays) {
    std::vector<int> number(stays.size(), -1);
    int next = 0;
    for (std::size_t i = 0; i < stays.size(); ++i)
      if (stays[i]) number[i] = next++;
    return number;
  }

  void drop_unused() {
    is_gone_.flip();
    keep(data_.faces, is_gone_);
    keep(data_.shapes, is_gone_);
    keep(data_.owners, is_gone_);
    std::vector<bool> edge_stays(data_.edges.size()), corner_stays(data_.vertices.size());
    for (const Face& face : data_.faces)
      for (const auto& loop : face.loops)
        for (const Use& use : loop) edge_stays[std::size_t(use.edge)] = true;
    const std::vector<int> edge_number = numbers(edge_stays);
    keep(data_.edges, edge_stays);
    keep(data_.samples, edge_stays);
    for (const Edge& edge : data_.edges)
      for (const int c : edge.corners)
        if (c >= 0) corner_stays[std::size_t(c)] = true;
    const std::vector<int> corner_number = numbers(corner_stays);
    keep(data_.vertices, corner_stays);
    for (Edge& edge : data_.edges)
      for (int& c : edge.corners)
        if (c >= 0) c = corner_number[std::size_t(c)];
    for (Face& face : data_.faces)
      for (auto& loop : face.loops)
        for (Use& use : loop) use.edge = edge_number[std::size_t(use.edge)];
  }

  Translation& data_;
  double diagonal_;
  std::vector<std::vector<int>> of_edge_, of_corner_;  ///< pieces
  std::vector<int> corner_, edge_;                     ///< the one that stays, by number
  std::vector<double> given_;                          ///< tolerances of corners, before any was raised
  std::vector<Step> step_;                             ///< by edge: its parameters on the one that stays
  std::vector<bool> is_gone_;                          ///< by face
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<int>, CellHash> cells_;
};

}  // namespace

std::size_t merge_common(Translation& data, double diagonal) {
  if (data.is_closed.size() < 2) return 0;
  return Merger(data, diagonal).run();
}

}  // namespace delfront::cad
