// SPDX-License-Identifier: Apache-2.0
// Growth for fields that know nothing of it. Where an octree of the field finds sizes that rise faster than growth
// allows, each leaf's least size becomes a cone that rises as growth allows; the result is the minimum of the field and
// the cones. So the field stays exact wherever it keeps the growth by itself, and what is sampled is only its steep
// places, in leaves of half a size.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"
#include "sizing/size_octree.hpp"

namespace delfront {

namespace {

constexpr int kSamples = 3;  ///< an axis, in a steep leaf
constexpr std::size_t kGrain = 1 << 6;
constexpr std::size_t kMostBoxes = 1'000'000;
constexpr double kTighter = 1 - 1e-6;

/// The places of a regular pattern in the box, its corners among them.
void add_samples(const Box& box, int dimension, std::vector<Point>& at) {
  const int nz = dimension == 3 ? kSamples : 1;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < kSamples; ++j)
      for (int i = 0; i < kSamples; ++i) {
        const Point t = Point{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} / (kSamples - 1);
        const Point side = box.high - box.low;
        at.push_back(box.low + Point{t.x * side.x, t.y * side.y, t.z * side.z});
      }
}

/// The least size in each box by such places; all are asked for at once.
std::vector<double> sampled_least(const SizeField& size, const std::vector<Box>& boxes, int dimension) {
  std::vector<Point> at;
  for (const Box& box : boxes) add_samples(box, dimension, at);
  std::vector<double> sizes(at.size()), least(boxes.size());
  size.sizes(at, sizes);
  const std::size_t n = boxes.empty() ? 0 : at.size() / boxes.size();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto first = sizes.begin() + static_cast<std::ptrdiff_t>(n * i);
    least[i] = *std::min_element(first, first + static_cast<std::ptrdiff_t>(n));
  }
  return least;
}

/// Where a box beyond the domain is asked for, the field is still right; only growth is not seen to there.
BoundarySizes steep_places(const SizeField& size, const Box& domain, double slope, Context& context) {
  SizeOctreeOptions options;
  options.slope = slope;
  options.max_leaves = kMostBoxes;
  const SizeOctree octree(size, domain, options, context);
  if (octree.is_cut_short())
    context.warn(
        fmt::format("a size field changes so much that {} boxes are not enough to see to its growth everywhere; larger "
                    "hmin or a smoother field helps",
                    octree.leaves().size()));
  std::vector<const OctreeLeaf*> steep;
  for (const OctreeLeaf& leaf : octree.leaves())
    if (octree.is_steep(leaf)) steep.push_back(&leaf);
  BoundarySizes cones;
  cones.points.resize(steep.size());
  cones.size.resize(steep.size());
  parallel_ranges(context.threads, steep.size(), kGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Box> boxes;
    for (std::size_t i = first; i < last; ++i) boxes.push_back(octree.box(*steep[i]));
    const std::vector<double> least = sampled_least(size, boxes, octree.dimension());
    for (std::size_t i = first; i < last; ++i) {
      cones.points[i] = boxes[i - first].centre();
      cones.size[i] = least[i - first];
    }
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cones.size.size(); ++i) {
    if (!std::isfinite(cones.size[i])) continue;
    cones.points[kept] = cones.points[i];
    cones.size[kept++] = cones.size[i];
  }
  cones.points.resize(kept);
  cones.size.resize(kept);
  return cones;
}

}  // namespace

std::shared_ptr<const SizeField> limit_growth(std::shared_ptr<const SizeField> field, const Box& domain, double growth,
                                              Context& context) {
  if (!(growth > 1)) throw UsageError(fmt::format("growth is {}; it must be greater than 1, e.g. 1.2", growth));
  if (!std::isfinite(growth)) return field;
  BoundarySizes cones = steep_places(*field, domain, kTighter * (growth - 1) / growth, context);
  if (cones.points.empty()) return field;
  cones.growth = growth;
  std::shared_ptr<const SizeField> limit = build_boundary_size_field(cones, context);
  return combine_size_fields({std::move(field), std::move(limit)}, 0, std::numeric_limits<double>::infinity());
}

}  // namespace delfront
