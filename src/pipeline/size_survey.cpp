// SPDX-License-Identifier: Apache-2.0
// Sums over boxes of an octree that the size field made; boxes on the border of the domain are halved until they are
// about a cell wide, and taken by samples then.
#include "pipeline/size_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "sizing/asked_sizes.hpp"
#include "sizing/size_octree.hpp"

namespace delfront {

namespace {

constexpr double kCellsPerVolume = 8.48528137423857;  ///< 6 sqrt(2)
constexpr double kCellsPerArea = 2.3094010767585034;  ///< 4 / sqrt(3)
constexpr double kCellsPerPoint = 5.6, kTrianglesPerPoint = 2;
// More than a filling with regular tetrahedra would have: where sizes vary cells are less regular, and cells that end
// at the border are cut off ones. Fitted to grids of 7e4 to 4e6 cells (bodies, a ship, examples/sizes), all within 8 %.
constexpr double kIrregular = 1.04, kPerBorderTriangle = 1.2, kPerBorderSegment = 0.8;
constexpr std::uint64_t kFacesPerCell = 4;  ///< no tetrahedron has more
constexpr double kSurelyOver = 3;           ///< estimates with few boxes are rough
constexpr std::size_t kFewLeaves = 20'000;
constexpr double kBorderWidth = 1.5;  ///< sizes; boxes on the border are halved until they are narrower
constexpr std::size_t kGrain = 1 << 6;
constexpr double kFinestBorder = 1.0 / 128;  ///< of the longest side: no box on the border is halved below that

// Of this program on one core of about 2.5 GHz; bench/compare_peers.py measures them (docs/performance.md).
constexpr double kSecondsPerTet = 0.5e-6, kSecondsPerTetAndThread = 0.8e-6, kSecondsPerTriangle = 0.5e-6;
constexpr double kSecondsPerFrontTet = 6.5e-6;  ///< of one thread; docs/front-volume.md
constexpr double kSecondsPerRefined = 0.15e-6;  ///< a cell that comes of halved edges (docs/refine.md)
constexpr double kBytesAtStart = 40e6, kBytesPerTet = 66, kBytesPerTriangle = 90;

/// Places of two-point Gauss rules: their mean is exact for cubics.
std::vector<Point> gauss_points(const Box& box, bool is_planar) {
  const double t = 0.5 - 0.5 / std::sqrt(3.0);
  std::vector<Point> at;
  for (int k = 0; k < (is_planar ? 4 : 8); ++k) {
    Point p = box.centre();
    for (int axis = 0; axis < (is_planar ? 2 : 3); ++axis) {
      const double w = k >> axis & 1 ? 1 - t : t;
      p[axis] = (1 - w) * box.low[axis] + w * box.high[axis];
    }
    at.push_back(p);
  }
  return at;
}

double measure_of(const Box& box, bool is_planar) {
  const Point side = box.high - box.low;
  return side.x * side.y * (is_planar ? 1 : side.z);
}

struct Sum {
  double measure = 0, cells = 0;
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
};

class Integral {
 public:
  Integral(const KeptDomain& domain, const SizeField& size, const Context& context)
      : domain_(domain), size_(size), context_(context), finest_(kFinestBorder * domain.box().longest_side()) {}

  void add(const Box& box, Sum& sum) const {
    const bool is_crossed = domain_.is_crossed(box);
    if (!is_crossed && !domain_.is_inside(box.centre())) return;
    const Point side = box.high - box.low;
    const bool is_wide = is_crossed && side.x > finest_ && side.x > kBorderWidth * size_.lower_bound(box);
    if (is_wide) return add_parts(box, sum);
    const std::vector<Point> at = gauss_points(box, domain_.is_planar());
    std::vector<double> h(at.size());
    size_.sizes(at, h);
    const double part = measure_of(box, domain_.is_planar()) / static_cast<double>(at.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (is_crossed && !domain_.is_inside(at[i])) continue;
      sum.measure += part;
      sum.cells += part * (domain_.is_planar() ? kCellsPerArea / (h[i] * h[i]) : kCellsPerVolume / std::pow(h[i], 3));
      sum.least = std::min(sum.least, h[i]);
      sum.greatest = std::max(sum.greatest, h[i]);
    }
  }

 private:
  void add_parts(const Box& box, Sum& sum) const {
    context_.check_limits();
    const Point middle = box.centre();
    for (int octant = 0; octant < (domain_.is_planar() ? 4 : 8); ++octant) {
      Box part = box;
      for (int axis = 0; axis < (domain_.is_planar() ? 2 : 3); ++axis)
        (octant >> axis & 1 ? part.low : part.high)[axis] = middle[axis];
      add(part, sum);
    }
  }

  const KeptDomain& domain_;
  const SizeField& size_;
  const Context& context_;
  const double finest_;
};

/// Cells are surely no more than this.
double most_cells(const Box& box, double least, bool is_planar) {
  const double measure = measure_of(box, is_planar);
  return is_planar ? kCellsPerArea * measure / (least * least) : kCellsPerVolume * measure / std::pow(least, 3);
}

}  // namespace

Estimate estimate_grid(const KeptDomain& domain, const SizeField& size, double growth, Context& context,
                       std::size_t max_leaves) {
  const StageTimer timer(context, "estimate");
  const double before = context.seconds_since_start();  // a grid takes that long too
  SizeOctreeOptions how;
  how.max_leaves = max_leaves;
  how.rises_at_most = (growth - 1) / growth;
  const SizeOctree octree(size, domain.box(), how, context);
  const std::vector<OctreeLeaf>& leaves = octree.leaves();
  std::vector<Sum> sums((leaves.size() + kGrain - 1) / kGrain);
  const Integral integral(domain, size, context);
  parallel_ranges(context.threads, leaves.size(), kGrain, [&](std::size_t first, std::size_t last) {
    context.check_limits();
    for (std::size_t i = first; i < last; ++i) integral.add(octree.box(leaves[i]), sums[first / kGrain]);
  });
  Sum all;
  for (const Sum& sum : sums) {
    all.measure += sum.measure;
    all.cells += sum.cells;
    all.least = std::min(all.least, sum.least);
    all.greatest = std::max(all.greatest, sum.greatest);
  }
  Estimate estimate;
  const bool is_planar = domain.is_planar();
  estimate.measure = all.measure;
  const auto border = static_cast<double>(domain.num_border());
  const double cells =
      is_planar ? all.cells + kPerBorderSegment * border : kIrregular * all.cells + kPerBorderTriangle * border;
  estimate.cells = cells;
  estimate.points = cells / (is_planar ? kTrianglesPerPoint : kCellsPerPoint);
  estimate.least_size = all.least;
  estimate.greatest_size = all.greatest;
  estimate.memory = kBytesAtStart + cells * (is_planar ? kBytesPerTriangle : kBytesPerTet);
  const double per_cell =
      is_planar ? kSecondsPerTriangle : kSecondsPerTet + kSecondsPerTetAndThread / std::max(1, context.threads);
  estimate.seconds = before + cells * per_cell;
  estimate.is_at_least = octree.is_cut_short();
  return estimate;
}

double growth_of(const SizeOptions& options) {
  const double growth = growth_asked(options);
  return steeper_growth(options.solution.file.empty() ? growth : std::max(growth, options.solution.hgrad),
                        options.steeper);
}

void slow_down_to_front(Estimate& estimate, int threads) {
  estimate.seconds += estimate.cells * kSecondsPerFrontTet / std::pow(std::max(1, threads), 0.8);
}

void refine_estimate(Estimate& estimate, bool is_planar, int levels) {
  if (levels == 0) return;
  const double finer = std::ldexp(1, levels), times = std::pow(finer, is_planar ? 2 : 3);
  estimate.cells *= times;
  estimate.points = estimate.cells / (is_planar ? kTrianglesPerPoint : kCellsPerPoint);
  estimate.least_size /= finer;
  estimate.greatest_size /= finer;
  estimate.memory = kBytesAtStart + estimate.cells * (is_planar ? kBytesPerTriangle : kBytesPerTet);
  estimate.seconds += estimate.cells * kSecondsPerRefined;
}

void refuse_tiny_hmax(double volume, const Options& options, const Context& context) {
  const double limit =
      context.max_cells > 0 ? static_cast<double>(context.max_cells) : static_cast<double>(TetComplex::kMaxSlots);
  const double cells = kCellsPerVolume * volume / std::pow(options.size.hmax->value, 3);
  if (cells < kSurelyOver * limit) return;
  throw LimitError(fmt::format(
      "stopped before gridding: cells no larger than hmax, {:.4g}, are at least {:.1e} up to the far field, over the "
      "limit of {}{}; ask for a larger hmax: it holds everywhere, sizes near the body have keys of their own",
      options.size.hmax->value, cells, limit,
      context.max_cells > 0 ? " (--max-cells)" : ", which is what this version can hold"));
}

namespace {

/// @param limit  of the coarse grid
void refuse_over(std::uint64_t limit, Estimate estimate, bool is_planar, int levels, const Context& context) {
  if (estimate.cells < kSurelyOver * static_cast<double>(limit)) return;
  refine_estimate(estimate, is_planar, levels);
  const std::uint64_t children = std::uint64_t{1} << ((is_planar ? 2 : 3) * levels);
  throw LimitError(fmt::format(
      "stopped before gridding: sizes from {:.3g} ask for about {:.1e} cells, over the limit of {}{}; ask for "
      "larger sizes (--hmax, --growth, or a larger --hmin that bounds all), or see `delfront estimate`",
      estimate.least_size, estimate.cells, context.max_cells > 0 ? context.max_cells : limit * children,
      context.max_cells > 0 ? " (--max-cells)" : ", which is what this version can hold"));
}

}  // namespace

void refuse_too_many_cells(const Prepared& prepared, const SizeOptions& options, int levels, Context& context) {
  const std::uint64_t children = std::uint64_t{1} << (3 * levels);
  const std::uint64_t limit = context.max_cells > 0 ? context.max_cells / children : TetComplex::kMaxSlots;
  Box box;
  const TetComplex& c = prepared.grid.complex;
  for (VertexIndex v = 0; v < c.num_vertices(); ++v)
    if (c.vertex_tet[v] != kNoIndex) box.add(c.point(v));
  if (most_cells(box, prepared.size->lower_bound(box), false) < static_cast<double>(limit)) return;
  const KeptDomain domain(prepared);
  refuse_over(limit, estimate_grid(domain, *prepared.size, growth_of(options), context, kFewLeaves), false, levels,
              context);
}

void refuse_too_many_cells(const PlanarPrepared& prepared, const SizeOptions& options, int levels, Context& context) {
  if (context.max_cells == 0 || prepared.is_kept_too_long || !prepared.size->is_isotropic()) return;
  const std::uint64_t limit = context.max_cells >> (2 * levels);
  Box box;
  for (const Point2 p : prepared.grid.complex.point) box.add(Point{p.x, p.y, 0});
  if (most_cells(box, prepared.size->lower_bound(box), true) < static_cast<double>(limit)) return;
  const KeptDomain domain(prepared);
  refuse_over(limit, estimate_grid(domain, *prepared.size, growth_of(options), context, kFewLeaves), true, levels,
              context);
}

void refuse_too_many_triangles(const Model& look, const SizeField& size, int levels, Context& context) {
  const std::uint64_t most = context.max_cells > 0 ? kFacesPerCell * context.max_cells : TetComplex::kMaxSlots;
  const std::uint64_t limit = most >> (2 * levels);
  std::vector<double> area;
  std::vector<Point> at;
  double all = 0;
  for (const auto& [a, b, c] : look.triangles) {
    const Point p = look.points[a], q = look.points[b], r = look.points[c];
    area.push_back(0.5 * length(cross(q - p, r - p)));
    all += area.back();
    at.push_back((p + q + r) / 3);
  }
  const double least = size.lower_bound(look.bounding_box());
  if (kCellsPerArea * all < least * least * static_cast<double>(limit)) return;
  std::vector<double> h(at.size());
  evaluate_sizes(size, at, h, context);
  Estimate estimate;
  estimate.least_size = *std::min_element(h.begin(), h.end());
  for (std::size_t i = 0; i < h.size(); ++i) estimate.cells += kCellsPerArea * area[i] / (h[i] * h[i]);
  refuse_over(limit, estimate, true, levels, context);
}

Mesh size_mesh(const KeptDomain& domain, const SizeField& size, double growth, Context& context) {
  SizeOctreeOptions how;
  how.rises_at_most = (growth - 1) / growth;
  const SizeOctree octree(size, domain.box(), how, context);
  Mesh mesh;
  mesh.dimension = octree.dimension();
  CellBlock& block = mesh.block(mesh.dimension == 3 ? CellType::hexahedron : CellType::quad);
  const GroupId group = mesh.add_group(mesh.dimension, "sizes");
  std::vector<VertexId> number(octree.corners().size());
  Field h{"h", Field::On::vertices, CellType::vertex, 1, {}};
  constexpr std::size_t kVtkOrder[8] = {0, 1, 3, 2, 4, 5, 7, 6};
  for (const OctreeLeaf& leaf : octree.leaves()) {
    const Box box = octree.box(leaf);
    if (!domain.is_crossed(box) && !domain.is_inside(box.centre())) continue;
    for (std::size_t k = 0; k < static_cast<std::size_t>(octree.num_corners()); ++k) {
      const std::uint32_t corner = leaf.corner[kVtkOrder[k]];
      if (!number[corner].is_valid()) {
        number[corner] = VertexId(mesh.points.size());
        mesh.points.push_back(octree.corners()[corner]);
        h.values.push_back(octree.corner_sizes()[corner]);
      }
      block.vertices.push_back(number[corner]);
    }
    block.group.push_back(group);
  }
  mesh.fields.push_back(std::move(h));
  return mesh;
}

}  // namespace delfront
