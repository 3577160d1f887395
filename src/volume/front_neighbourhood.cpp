// SPDX-License-Identifier: Apache-2.0
#include "volume/front_neighbourhood.hpp"

#include <algorithm>
#include <cmath>

#include "predicates/predicates.hpp"

namespace delfront {

namespace {

/// Of a height times the length of its normal: some 60 roundings of products of three lengths, with room to spare.
constexpr double kHeightBound = 0x1p-46;
constexpr std::uint8_t kAllSides = 15;
constexpr double kSpread = 10;  ///< clearances from a common corner, where an edge must have one from the tet

}  // namespace

void Neighbourhood::start(std::uint32_t f) {
  ++step_;
  id_.clear();
  x_.clear();
  y_.clear();
  z_.clear();
  norm_.clear();
  height_.clear();
  exact_.clear();
  faces_.clear();
  edges_.clear();
  const auto n = front_.nodes(f);
  const Point a = c_.point(n[0]), b = c_.point(n[1]), c = c_.point(n[2]);
  if (front_.sizes().are_stretched()) frame_ = front_.frame(f);
  bound_ = kHeightBound * frame_.condition();
  origin_ = (1.0 / 3) * (a + b + c);
  normal_ = cross(frame_.along(b - a), frame_.along(c - a));
  const double l = length(normal_);
  base_ = {normal_, dot(normal_, frame_.along(a - origin_)), 0, l};
  if (l > 0) normal_ = normal_ / l;
  for (const VertexIndex v : n) local(v);
  for (unsigned i = 0; i < 3; ++i) {
    const Point p = at(i), q = at(i == 2 ? 0 : i + 1);
    Point inwards = cross(normal_, q - p);
    wedge_[i].inwards = inwards / std::max(length(inwards), 1e-300);
    wedge_[i].middle = p;
    wedge_[i].is_there = false;
  }
  double extent = 0;
  for (std::size_t p = 0; p < 3; ++p) extent = std::max(extent, norm_[p]);
  base_.bound = bound_ * extent * extent;
}

std::uint32_t Neighbourhood::local(VertexIndex v) {
  std::size_t h = slot_of(v);
  for (; table_[h].step == step_; h = (h + 1) & (table_.size() - 1))
    if (table_[h].id == v) return table_[h].index;
  const auto index = static_cast<std::uint32_t>(id_.size());
  table_[h] = {v, index, step_};
  const Point at = c_.point(v), r = frame_.along(at - origin_);
  id_.push_back(v);
  x_.push_back(r.x);
  y_.push_back(r.y);
  z_.push_back(r.z);
  norm_.push_back(std::fabs(r.x) + std::fabs(r.y) + std::fabs(r.z));
  height_.push_back(dot(normal_, r));
  exact_.push_back(at);
  if (2 * id_.size() > table_.size()) grow_table();
  return index;
}

void Neighbourhood::grow_table() {
  table_.assign(2 * table_.size(), {});
  for (std::size_t p = 0; p < id_.size(); ++p) {
    std::size_t h = slot_of(id_[p]);
    while (table_[h].step == step_) h = (h + 1) & (table_.size() - 1);
    table_[h] = {id_[p], static_cast<std::uint32_t>(p), step_};
  }
}

void Neighbourhood::add_face(std::uint32_t f) {
  const auto n = front_.nodes(f);
  faces_.push_back({{local(n[0]), local(n[1]), local(n[2])}});
  add_wedge(faces_.back());
}

void Neighbourhood::add_obstacle(const FrontObstacle& obstacle) {
  edges_.push_back({local(obstacle.a), local(obstacle.b)});
}

bool Neighbourhood::has_obstacle(const FrontObstacle& obstacle) const {
  return std::any_of(edges_.begin(), edges_.end(),
                     [&](const Edge& e) { return id_[e.a] == obstacle.a && id_[e.b] == obstacle.b; });
}

void Neighbourhood::add_wedge(const Face& face) {
  const auto& k = face.corner;
  if ((k[0] < 3) + (k[1] < 3) + (k[2] < 3) != 2) return;
  const unsigned far = k[0] >= 3 ? 0 : k[1] >= 3 ? 1 : 2;
  // The side runs against ours: it is ours from its end to its start.
  const std::uint32_t start = k[(far + 2) % 3];
  if (k[(far + 1) % 3] != (start == 2 ? 0u : start + 1)) return;
  Wedge& w = wedge_[start];
  const double c = dot(w.inwards, at(k[far]) - w.middle), s = height_[k[far]] - height_[start];
  const double l = std::max(std::sqrt(c * c + s * s), 1e-300);
  const auto half_turns = [](double cosine, double sine) { return sine >= 0 ? 1 - cosine : 3 + cosine; };
  if (w.is_there && half_turns(w.cosine, w.sine) <= half_turns(c / l, s / l)) return;
  w.cosine = c / l, w.sine = s / l, w.apex = k[far], w.is_there = true;
}

double Neighbourhood::measure_wedges(std::size_t apex) const {
  double narrowest = 1;
  for (unsigned i = 0; i < 3; ++i) {
    const Wedge& w = wedge_[i];
    if (!w.is_there || w.apex == apex) continue;
    const double c = dot(w.inwards, at(apex) - w.middle), s = height_[apex] - height_[i];
    const double sine = w.sine * c - w.cosine * s, cosine = w.cosine * c + w.sine * s;  // of what is left, times l
    if (sine <= 0 && w.sine >= 0) return -1;
    if (sine > 0 && cosine > 0) narrowest = std::min(narrowest, sine * sine / (c * c + s * s));
  }
  return narrowest;
}

/// A face that has the edge from the apex to a corner: what is left between it and the tet's sides there.
bool Neighbourhood::leaves_narrow_wedge(const Face& face, std::size_t apex, double widest_cosine) const {
  const auto& k = face.corner;
  if ((k[0] < 3) + (k[1] < 3) + (k[2] < 3) != 1) return false;
  std::uint32_t corner = 0, far = 0;
  for (const std::uint32_t p : k) {
    if (p < 3) corner = p;
    if (p >= 3 && p != apex) far = p;
  }
  const Point from = at(corner), axis = at(apex) - from, to_far = at(far) - from;
  const double l2 = squared_length(axis);
  const Point u = to_far - (dot(to_far, axis) / l2) * axis;
  const Point normal = cross(at(k[1]) - at(k[0]), at(k[2]) - at(k[0]));
  for (std::uint32_t other = 0; other < 3; ++other) {
    if (other == corner) continue;
    const Point to_other = at(other) - from, v = to_other - (dot(to_other, axis) / l2) * axis;
    const double cosine = dot(u, v);
    if (dot(normal, to_other) <= 0 || cosine <= 0) continue;
    if (cosine * cosine > widest_cosine * widest_cosine * squared_length(u) * squared_length(v)) return true;
  }
  return false;
}

std::size_t Neighbourhood::add_place(Point absolute) {
  const Point r = frame_.along(absolute - origin_);
  id_.push_back(kNoIndex);
  x_.push_back(r.x);
  y_.push_back(r.y);
  z_.push_back(r.z);
  norm_.push_back(std::fabs(r.x) + std::fabs(r.y) + std::fabs(r.z));
  height_.push_back(dot(normal_, r));
  exact_.push_back(absolute);
  return id_.size() - 1;
}

void Neighbourhood::drop_place() {
  id_.pop_back();
  x_.pop_back();
  y_.pop_back();
  z_.pop_back();
  norm_.pop_back();
  height_.pop_back();
  exact_.pop_back();
}

Neighbourhood::Plane Neighbourhood::plane_through(std::size_t a, std::size_t b, std::size_t c) const {
  const Point p = at(a), u = at(b) - p, v = at(c) - p;
  Plane plane;
  plane.normal = cross(u, v);
  plane.offset = dot(plane.normal, p);
  plane.length = length(plane.normal);
  const double extent = std::max({norm_[a], norm_[b], norm_[c]});
  plane.bound = bound_ * extent * extent;
  return plane;
}

/// Which sides of the tet each point is known to lie beyond, or within. Side i is the one opposite node i.
Neighbourhood::Verdict Neighbourhood::mark_points(std::size_t apex, const std::array<Plane, 3>& planes,
                                                  double clearance) {
  const std::size_t n = id_.size();
  outside_.resize(n);
  inside_.resize(n);
  const double extent = std::max({norm_[0], norm_[1], norm_[2], norm_[apex]});
  Verdict verdict = Verdict::free;
  for (std::size_t p = 3; p < n; ++p) {
    const double reach = norm_[p] + extent;
    std::uint8_t out = 0, in = 0, near = 0;
    for (unsigned i = 0; i < 4; ++i) {
      const Plane& s = i < 3 ? planes[i] : base_;
      const double value = s.normal.x * x_[p] + s.normal.y * y_[p] + s.normal.z * z_[p] - s.offset;
      const double bound = s.bound * reach;
      out = static_cast<std::uint8_t>(out | (value < -bound) << i);
      in = static_cast<std::uint8_t>(in | (value > bound) << i);
      near = static_cast<std::uint8_t>(near | (value > -clearance * s.length) << i);
    }
    outside_[p] = out;
    inside_[p] = in;
    if (p == apex) continue;
    if (in == kAllSides) return Verdict::crosses;
    if (near == kAllSides) verdict = Verdict::too_close;
  }
  // Nodes of the tet lie on three of its sides, and count as beyond these: what meets the tet in them alone is apart.
  for (unsigned i = 0; i < 3; ++i) outside_[i] = static_cast<std::uint8_t>(kAllSides & ~(1u << i)), inside_[i] = 0;
  outside_[apex] = static_cast<std::uint8_t>(kAllSides & ~8u);
  inside_[apex] = 0;
  return verdict;
}

Neighbourhood::Verdict Neighbourhood::test(std::size_t apex, double clearance, double widest_cosine) {
  ++counts.tests;
  // Normals into the tet (0, 1, 2, apex), as kFaceNodes has them.
  const std::array<Plane, 3> planes = {plane_through(1, apex, 2), plane_through(0, 2, apex), plane_through(0, apex, 1)};
  const Verdict verdict = mark_points(apex, planes, clearance);
  if (verdict != Verdict::free) return verdict;
  for (const Face& face : faces_) {
    const auto& k = face.corner;
    if (widest_cosine < 1 && (k[0] == apex || k[1] == apex || k[2] == apex) &&
        leaves_narrow_wedge(face, apex, widest_cosine))
      return Verdict::too_close;
    if (outside_[k[0]] & outside_[k[1]] & outside_[k[2]]) continue;
    ++counts.plane_tests;
    if (crosses(face, apex)) return Verdict::crosses;
  }
  return edges_.empty() ? Verdict::free : test_obstacles(apex, planes, clearance);
}

Neighbourhood::Verdict Neighbourhood::test_obstacles(std::size_t apex, const std::array<Plane, 3>& planes,
                                                     double clearance) {
  const auto numbered = [&](std::size_t p) { return NumberedPoint{static_cast<VertexIndex>(p), place(p)}; };
  const std::array<NumberedPoint, 4> tet = {numbered(0), numbered(1), numbered(2), numbered(apex)};
  for (const Edge& edge : edges_) {
    if (outside_[edge.a] & outside_[edge.b]) continue;
    if (is_met_by_tet({numbered(edge.a), numbered(edge.b)}, tet)) return Verdict::crosses;
  }
  if (clearance > 0)
    for (const Edge& edge : edges_)
      if (is_too_close(edge, apex, planes, clearance)) return Verdict::too_close;
  return Verdict::free;
}

/// Clipped by the sides of the tet, moved outwards; from a corner of the tet on, only what lies further off counts.
bool Neighbourhood::is_too_close(const Edge& edge, std::size_t apex, const std::array<Plane, 3>& planes,
                                 double clearance) const {
  const auto is_corner = [&](std::uint32_t p) { return p < 3 || p == apex; };
  if (edge.a == edge.b || (is_corner(edge.a) && is_corner(edge.b))) return false;  // points have been looked at
  const Point a = at(edge.a), along = at(edge.b) - a;
  const double off = std::min(kSpread * clearance / std::max(length(along), 1e-300), 1.0);
  double from = is_corner(edge.a) ? off : 0, to = is_corner(edge.b) ? 1 - off : 1;
  for (unsigned i = 0; i < 4 && from <= to; ++i) {
    const Plane& s = i < 3 ? planes[i] : base_;
    const double start = dot(s.normal, a) - s.offset + clearance * s.length, slope = dot(s.normal, along);
    if (slope > 0) from = std::max(from, -start / slope);
    if (slope < 0) to = std::min(to, -start / slope);
    if (slope == 0 && start <= 0) return false;
  }
  return from <= to;
}

bool Neighbourhood::crosses(const Face& face, std::size_t apex) {
  const std::array<std::uint32_t, 4> node = {0, 1, 2, static_cast<std::uint32_t>(apex)};
  unsigned common = 0;
  int missing = -1;
  for (int i = 0; i < 4; ++i) {
    const bool has = std::find(face.corner.begin(), face.corner.end(), node[i]) != face.corner.end();
    common += has;
    if (!has) missing = i;
  }
  if (common == 3) {  // a side of the tet that is a face already: it has to look into the tet
    const auto& k = face.corner;
    return orient3d(place(k[0]), place(k[1]), place(k[2]), place(node[missing])) <= 0 &&
           front_.find({id_[k[0]], id_[k[2]], id_[k[1]]}) == kNoIndex;
  }
  if (is_apart_by_its_plane(face, node)) return false;
  ++counts.exact_tests;
  return has_corner_inside(face, node) || meets_new_faces(face, node);
}

bool Neighbourhood::is_apart_by_its_plane(const Face& face, const std::array<std::uint32_t, 4>& node) const {
  const auto& k = face.corner;
  int side = 0;
  for (const std::uint32_t p : node) {
    if (std::find(k.begin(), k.end(), p) != k.end()) continue;
    const int sign = orient3d(place(k[0]), place(k[1]), place(k[2]), place(p));
    if (sign == 0 || sign * side < 0) return false;
    side = sign;
  }
  return true;
}

bool Neighbourhood::has_corner_inside(const Face& face, const std::array<std::uint32_t, 4>& node) const {
  for (const std::uint32_t p : face.corner) {
    if (std::find(node.begin(), node.end(), p) != node.end() || outside_[p] != 0) continue;
    bool inside = true;
    for (const auto& f : kFaceNodes)
      inside = inside && orient3d(place(node[f[0]]), place(node[f[1]]), place(node[f[2]]), place(p)) > 0;
    if (inside) return true;
  }
  return false;
}

/// Sides of the tet that are faces already meet others as they should.
bool Neighbourhood::meets_new_faces(const Face& face, const std::array<std::uint32_t, 4>& node) {
  const auto& k = face.corner;
  const Point p[3] = {place(k[0]), place(k[1]), place(k[2])};
  const unsigned p_id[3] = {k[0], k[1], k[2]};
  for (unsigned side = 0; side < 3; ++side) {
    const auto& f = kFaceNodes[side];
    const Point q[3] = {place(node[f[0]]), place(node[f[1]]), place(node[f[2]])};
    const unsigned q_id[3] = {node[f[0]], node[f[1]], node[f[2]]};
    if (classify_triangles(p, p_id, q, q_id, nullptr) != Crossing::none) return true;
  }
  return false;
}

double Neighbourhood::distance_to_points(std::size_t place) const {
  double nearest = 1e300;
  for (std::size_t p = 0; p < place; ++p) nearest = std::min(nearest, squared_length(at(p) - at(place)));
  return std::sqrt(nearest);
}

double Neighbourhood::distance_to_edges(std::size_t place) const {
  double nearest = 1e300;
  for (const Edge& edge : edges_) {
    const Point to = at(place) - at(edge.a), along = at(edge.b) - at(edge.a);
    const double l2 = squared_length(along), t = l2 > 0 ? std::clamp(dot(to, along) / l2, 0.0, 1.0) : 0;
    nearest = std::min(nearest, squared_length(to - t * along));
  }
  return std::sqrt(nearest);
}

double Neighbourhood::distance_to_faces(std::size_t place) const {
  double nearest = 1e300;
  const Point q = at(place);
  for (const Face& face : faces_) {
    const Point a = at(face.corner[0]), b = at(face.corner[1]), c = at(face.corner[2]);
    const Point n = cross(b - a, c - a);
    const double area = squared_length(n), up = dot(n, q - a);
    if (up * up >= nearest * nearest * area) continue;
    if (dot(cross(b - a, q - a), n) < 0 || dot(cross(c - b, q - b), n) < 0 || dot(cross(a - c, q - c), n) < 0) continue;
    nearest = std::fabs(up) / std::sqrt(area);
  }
  return nearest;
}

}  // namespace delfront
