// SPDX-License-Identifier: Apache-2.0
// Distances to sets of simplices through the tree of their boxes. What was nearest to the point before bounds the
// search for the next, by more than rounding: what is left out would have been passed over anyway, so that the last bit
// does not depend on the batch.
#include <algorithm>
#include <cmath>
#include <limits>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "fmt/format.h"
#include "sizing/model_names.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

/// Beyond a height of 1e-4 of its sides the place over a triangle is found to 1e-12 of them; slimmer ones are asked for
/// their edges too.
constexpr double kSlim = 1e-8;
constexpr double kRelativeError = 1e-11;

double squared_distance_to(Point p, const std::array<Point, 3>& corner) {
  const auto& [a, b, c] = corner;
  double best = squared_length(nearest_point_on_triangle(p, a, b, c) - p);
  const double squared = squared_length(b - a) * squared_length(c - a);
  if (squared_length(cross(b - a, c - a)) < kSlim * squared)
    for (int k = 0; k < 3; ++k) {
      const Point& from = corner[std::size_t(k)];
      const Point& to = corner[std::size_t((k + 1) % 3)];
      best = std::min(best, squared_length(nearest_point_on_triangle(p, from, to, to) - p));
    }
  return best;
}

class TreeDistanceField final : public DistanceField {
 public:
  explicit TreeDistanceField(const SimplexSet& set) {
    for (const Point& p : set.points) corners_.push_back({p, p, p});
    for (const auto& [a, b] : set.segments) corners_.push_back({a, b, b});
    corners_.insert(corners_.end(), set.triangles.begin(), set.triangles.end());
    if (corners_.empty()) throw UsageError("distance to an empty set: it has no points, curves or triangles");
    std::vector<Box> boxes(corners_.size());
    for (std::size_t i = 0; i < corners_.size(); ++i)
      for (const Point& p : corners_[i]) {
        if (!is_finite(p)) throw UsageError("distance to a set with a coordinate that is not finite");
        boxes[i].add(p);
      }
    bvh_ = Bvh(boxes);
  }

  void distances(std::span<const Point> at, std::span<double> distance) const override {
    std::uint32_t near = 0;
    for (std::size_t i = 0; i < at.size(); ++i) distance[i] = one(at[i], near);
  }

  Range range(const Box& box) const override {
    const Point centre = box.low + 0.5 * (box.high - box.low);
    if (!is_finite(centre)) return {0, std::numeric_limits<double>::infinity()};
    std::uint32_t near = 0;
    const double middle = one(centre, near), half = 0.5 * box.diagonal();
    const double error = error_from(box);
    return {std::max(0.0, middle - half - error), middle + half + error};
  }

 private:
  /// @param near  where to begin; becomes what is nearest
  double one(Point p, std::uint32_t& near) const {
    if (!is_finite(p)) return std::numeric_limits<double>::quiet_NaN();
    const auto distance_to = [&](std::uint32_t i) { return squared_distance_to(p, corners_[i]); };
    const double reach = std::sqrt(distance_to(near)) + 2 * error_from({p, p});
    const double limit = std::isnan(reach) ? std::numeric_limits<double>::infinity() : reach * reach;
    const Bvh::Nearest found = bvh_.nearest(p, distance_to, limit);
    if (found.found()) near = found.item;
    return std::sqrt(found.squared_distance);
  }

  /// Of distances from places in the box.
  double error_from(const Box& box) const {
    Box all = bvh_.box_of_all();
    all.add(box);
    double largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(all.low[k]), std::abs(all.high[k])});
    return kRelativeError * all.diagonal() + 32 * std::numeric_limits<double>::epsilon() * largest;
  }

  std::vector<std::array<Point, 3>> corners_;
  Bvh bvh_;
};

[[noreturn]] void fail_unknown(const Model& model, const std::string& name) {
  std::vector<std::string> known = names_on(model);
  for (const Region& region : model.regions)
    if (!region.name.empty()) known.push_back(region.name);
  throw UsageError(fmt::format("no patch, curve or corner is called '{}'{}", name, say_names(name, known)));
}

}  // namespace

std::shared_ptr<const DistanceField> build_distance_field(const SimplexSet& set) {
  return std::make_shared<TreeDistanceField>(set);
}

SimplexSet named_part(const Model& model, const std::string& name) {
  SimplexSet set;
  const auto add = [&](std::size_t t) {
    const auto& [a, b, c] = model.triangles[TriangleId(t)];
    set.triangles.push_back({model.points[a], model.points[b], model.points[c]});
  };
  bool is_known = false;
  for (std::size_t p = 0; p < model.patches.size(); ++p) is_known = is_known || model.patches[PatchId(p)].name == name;
  for (std::size_t t = 0; t < model.triangles.size(); ++t)
    if (model.patches[model.patch_of_triangle[TriangleId(t)]].name == name) add(t);
  for (const Curve& curve : model.curves) {
    if (curve.name != name) continue;
    is_known = true;
    for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i)
      set.segments.push_back({model.points[curve.vertices[i]], model.points[curve.vertices[i + 1]]});
  }
  for (std::size_t i = 0; i < model.corner_names.size(); ++i) {
    if (model.corner_names[i] != name) continue;
    is_known = true;
    set.points.push_back(model.points[model.corners[i]]);
  }
  if (is_known) return set;
  for (std::size_t r = 0; r < model.regions.size(); ++r) {
    if (model.regions[RegionId(r)].name != name) continue;
    for (std::size_t t = 0; t < model.sides.size(); ++t)
      if (const auto& [behind, ahead] = model.sides[TriangleId(t)]; behind == RegionId(r) || ahead == RegionId(r))
        add(t);
    if (!set.triangles.empty()) return set;
    if (model.regions.size() > 1)
      throw UsageError(
          fmt::format("distance to '{}': of several regions the distance is not known before gridding; "
                      "name the patches around it",
                      name));
    for (std::size_t t = 0; t < model.triangles.size(); ++t) add(t);
    return set;
  }
  fail_unknown(model, name);
}

}  // namespace delfront
