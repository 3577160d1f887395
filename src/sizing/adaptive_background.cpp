// SPDX-License-Identifier: Apache-2.0
#include "delfront/adaptive_background.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/hilbert.hpp"
#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"
#include "sizing/background_values.hpp"
#include "sizing/packed_tree.hpp"
#include "sizing/refined_grid.hpp"
#include "sizing/simplex_grid.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNone = SimplexGrid::kNone;
constexpr double kInside = 1e-10;

double orientation(int dimension, Point a, Point b, Point c, Point d) {
  if (dimension == 2) return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  return dot(b - a, cross(c - a, d - a));
}

/// The least barycentric coordinate of p: how far inside it is.
double depth(const RefinedGrid& grid, const RefinedGrid::Cell& cell, Point p) {
  const auto point = [&](std::size_t k) { return cell[k] == kNone ? Point{} : grid.points()[cell[k]]; };
  const std::array<Point, 4> v = {point(0), point(1), point(2), point(3)};
  const double whole = orientation(grid.dimension(), v[0], v[1], v[2], v[3]);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < grid.num_corners(); ++k) {
    std::array<Point, 4> w = v;
    w[k] = p;
    least = std::min(least, orientation(grid.dimension(), w[0], w[1], w[2], w[3]) / whole);
  }
  return least;
}

void check_options(const AdaptiveBackgroundOptions& o, std::size_t points, std::size_t sizes) {
  if (!(o.growth > 1 && std::isfinite(o.growth)))
    throw UsageError(fmt::format("growth is {}; it must be a number greater than 1, e.g. 1.2", o.growth));
  if (!(o.refine_above > 1))
    throw UsageError(fmt::format("refine_above is {}; it must be greater than 1, e.g. 1.5", o.refine_above));
  if (points != sizes) throw InputError(fmt::format("adaptive background: {} points but {} sizes", points, sizes));
}

/// What the points allow anywhere.
class AllowedSizes {
 public:
  AllowedSizes(const BoundarySizes& points, PointRule rule, Context& context) {
    sequence_ = build_boundary_size_field(points, context);  // checks the points too
    if (rule == PointRule::sequence) return;
    slope_ = 1 - 1 / points.growth;
    std::vector<Box> boxes;
    for (std::uint32_t i : hilbert_order(points.points, context.threads)) {
      boxes.push_back({points.points[i], points.points[i]});
      place_.push_back(points.points[i]);
      size_.push_back(points.size[i]);
    }
    tree_ = PackedTree(boxes, size_);
  }

  void at(std::span<const Point> places, std::span<double> most) const {
    if (tree_.is_empty()) return sequence_->sizes(places, most);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Point p = places[i];
      most[i] = tree_
                    .minimize(
                        [&](const PackedTree::Node& node) {
                          return node.least + slope_ * std::sqrt(squared_distance(p, node.box));
                        },
                        [&](std::uint32_t k) { return size_[k] + slope_ * distance(p, place_[k]); })
                    .value;
    }
  }

 private:
  std::unique_ptr<SizeField> sequence_;
  double slope_ = 0;
  std::vector<Point> place_;
  std::vector<double> size_;
  PackedTree tree_;
};

Mesh box_grid(const Box& box, std::size_t cells, double size) {
  if (box.is_empty() || !(box.longest_side() > 0) || !is_finite(box.low) || !is_finite(box.high))
    throw UsageError("adaptive background: the box to be covered is empty or without end");
  if (cells < 1) throw UsageError("adaptive background: it needs one cell at least along the box");
  if (!(size > 0 && std::isfinite(size)))
    throw UsageError(fmt::format("adaptive background: the size {} must be a positive number", size));
  const bool is_plane = box.low.z == 0 && box.high.z == 0;
  const double step = box.longest_side() / static_cast<double>(cells);
  std::array<std::size_t, 3> n{1, 1, 1};
  Point side = box.high - box.low;
  for (int k = 0; k < (is_plane ? 2 : 3); ++k) {
    if (!(side[k] > 0)) side[k] = step;  // a flat box still needs cells
    n[static_cast<std::size_t>(k)] = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(side[k] / step)));
  }
  Mesh mesh;
  mesh.dimension = is_plane ? 2 : 3;
  const std::size_t layers = is_plane ? 1 : n[2] + 1;
  for (std::size_t k = 0; k < layers; ++k)
    for (std::size_t j = 0; j <= n[1]; ++j)
      for (std::size_t i = 0; i <= n[0]; ++i)
        mesh.points.push_back(
            {box.low.x + side.x * static_cast<double>(i) / static_cast<double>(n[0]),
             box.low.y + side.y * static_cast<double>(j) / static_cast<double>(n[1]),
             box.low.z + (is_plane ? 0 : side.z * static_cast<double>(k) / static_cast<double>(n[2]))});
  const auto id = [&](std::array<std::size_t, 3> at) {
    return VertexId(at[0] + (n[0] + 1) * (at[1] + (n[1] + 1) * at[2]));
  };
  static constexpr std::size_t kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  CellBlock& block = mesh.block(is_plane ? CellType::triangle : CellType::tetrahedron);
  for (std::size_t k = 0; k < (is_plane ? 1 : n[2]); ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i)
        for (const auto& order : kOrders) {  // Kuhn: from corner to corner along the axes in each order
          if (is_plane && order[2] != 2) continue;
          std::array<std::size_t, 3> at{i, j, k};
          block.vertices.push_back(id(at));
          for (std::size_t a = 0; a < (is_plane ? 2u : 3u); ++a) {
            ++at[order[a]];
            block.vertices.push_back(id(at));
          }
          block.group.push_back(GroupId());
        }
  mesh.fields.push_back(
      {"size", Field::On::vertices, CellType::vertex, 1, std::vector<double>(mesh.points.size(), size)});
  return mesh;
}

RefinedGrid start_from(const BackgroundGrid& given, Context& context) {
  const SimplexGrid grid = build_simplex_grid(given.mesh, given.name, context);
  const NodeSizes nodes = read_node_sizes(given, grid, {});
  if (!nodes.metric.empty())
    throw UsageError(fmt::format("{}: an adaptive background holds sizes, not metrics; name a size field", given.name));
  if (grid.has_crowded_faces)
    throw InputError(fmt::format("{}: some faces have more than two cells; it cannot be refined", given.name));
  std::vector<RefinedGrid::Cell> cells(grid.cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[grid.rank[i]] = grid.cells[i];
  // Nodes that no cell uses are left out.
  std::vector<std::uint32_t> number(grid.points.size(), kNone);
  std::vector<Point> points;
  std::vector<double> size;
  const std::vector<char> used = used_vertices(grid);
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (!used[v]) continue;
    number[v] = static_cast<std::uint32_t>(points.size());
    points.push_back(grid.points[v]);
    size.push_back(nodes.size[v]);
  }
  for (RefinedGrid::Cell& cell : cells)
    for (std::size_t k = 0; k < grid.num_corners(); ++k) cell[k] = number[cell[k]];
  return {grid.dimension, std::move(points), std::move(size), std::move(cells)};
}

BackgroundGrid start_grid(const Box& box, std::size_t cells, double size) {
  BackgroundGrid grid;
  grid.mesh = box_grid(box, cells, size);
  grid.size = "size";
  return grid;
}

}  // namespace

class AdaptiveBackground::Impl {
 public:
  explicit Impl(RefinedGrid grid) : grid_(std::move(grid)) {}

  AdaptReport adapt(std::span<const Point> points, std::span<const double> size,
                    const AdaptiveBackgroundOptions& options, Context& context) {
    check_options(options, points.size(), size.size());
    AdaptReport report;
    if (points.empty()) return report;
    BoundarySizes cones{{points.begin(), points.end()}, {size.begin(), size.end()}, options.growth};
    if (grid_.dimension() == 2)
      for (Point& p : cones.points) p.z = 0;
    const AllowedSizes allowed(cones, options.rule, context);
    report.nodes_lowered = lower_nodes(allowed, 0);
    std::vector<std::uint32_t> cell_of = locate(cones.points, context);
    report.points_outside = static_cast<std::size_t>(std::count(cell_of.begin(), cell_of.end(), kNone));
    for (;;) {
      context.check_limits();
      ++report.rounds;
      std::vector<char> is_marked = find_too_coarse(cones, cell_of, options.refine_above);
      const auto marked = static_cast<std::size_t>(std::count(is_marked.begin(), is_marked.end(), 1));
      if (marked == 0) return report;
      if (grid_.cells().size() + 7 * marked > options.max_cells) {
        report.is_converged = false;
        return report;
      }
      const std::size_t before = grid_.points().size();
      const RefinedGrid::Refinement done = grid_.refine(std::move(is_marked));
      report.cells_refined += done.refined;
      lower_nodes(allowed, before);
      follow(done, cones.points, cell_of);
    }
  }

  Mesh mesh(Context& context) const {
    Mesh mesh;
    mesh.dimension = grid_.dimension();
    mesh.points.assign(grid_.points().begin(), grid_.points().end());
    CellBlock& block = mesh.block(mesh.dimension == 2 ? CellType::triangle : CellType::tetrahedron);
    const GroupId region = mesh.add_group(mesh.dimension, "background");
    std::vector<RefinedGrid::Cell> pieces;
    for (std::size_t i = 0; i < grid_.cells().size(); ++i) {
      pieces.clear();
      grid_.pieces(i, pieces);
      for (const RefinedGrid::Cell& cell : pieces) {
        for (std::size_t k = 0; k < grid_.num_corners(); ++k) block.vertices.push_back(VertexId(cell[k]));
        block.group.push_back(region);
      }
    }
    const SimplexGrid cells = build_simplex_grid(mesh, "adaptive background", context);
    const GroupId patch = mesh.add_group(mesh.dimension - 1, "boundary");
    CellBlock& border = mesh.block(mesh.dimension == 2 ? CellType::line : CellType::triangle);
    for (const auto& face : cells.boundary) {
      for (int k = 0; k < mesh.dimension; ++k) border.vertices.push_back(VertexId(face[static_cast<std::size_t>(k)]));
      border.group.push_back(patch);
    }
    mesh.fields.push_back({"size", Field::On::vertices, CellType::vertex, 1, grid_.size()});
    return mesh;
  }

 private:
  /// Pass 1 (3.18) for the nodes from `first` on.
  std::size_t lower_nodes(const AllowedSizes& allowed, std::size_t first) {
    const std::vector<Point> nodes(grid_.points().begin() + static_cast<std::ptrdiff_t>(first), grid_.points().end());
    std::vector<Point> in_order;
    const std::vector<std::uint32_t> order = hilbert_order(nodes);
    for (std::uint32_t i : order) in_order.push_back(nodes[i]);
    std::vector<double> most(in_order.size());
    allowed.at(in_order, most);
    std::size_t lowered = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      double& size = grid_.size()[first + order[i]];
      lowered += most[i] < size;
      size = std::min(size, most[i]);
    }
    return lowered;
  }

  /// The regular cell of each point, the lowest of several; kNone outside.
  std::vector<std::uint32_t> locate(const std::vector<Point>& points, Context& context) const {
    std::vector<Box> boxes(grid_.cells().size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = 0; k < grid_.num_corners(); ++k) boxes[i].add(grid_.points()[grid_.cells()[i][k]]);
      const double margin = 4 * kInside * boxes[i].diagonal();
      boxes[i].low = boxes[i].low - Point{margin, margin, margin};
      boxes[i].high = boxes[i].high + Point{margin, margin, margin};
    }
    std::vector<Point> centres;
    for (const Box& box : boxes) centres.push_back(box.centre());
    const std::vector<std::uint32_t> order = hilbert_order(centres, context.threads);
    std::vector<Box> in_order;
    for (std::uint32_t i : order) in_order.push_back(boxes[i]);
    const PackedTree tree(in_order);
    std::vector<std::uint32_t> found(points.size(), kNone);
    for (std::size_t i = 0; i < points.size(); ++i)
      tree.for_each_overlap({points[i], points[i]}, [&](std::uint32_t item) {
        const std::uint32_t cell = order[item];
        if (cell < found[i] && depth(grid_, grid_.cells()[cell], points[i]) >= -kInside) found[i] = cell;
      });
    return found;
  }

  /// The piece of the cell in which p lies deepest.
  RefinedGrid::Cell piece_of(std::uint32_t cell, Point p) {
    pieces_.clear();
    grid_.pieces(cell, pieces_);
    std::size_t best = 0;
    for (std::size_t k = 1; k < pieces_.size(); ++k)
      if (depth(grid_, pieces_[k], p) > depth(grid_, pieces_[best], p)) best = k;
    return pieces_[best];
  }

  /// Pass 2 (3.19).
  std::vector<char> find_too_coarse(const BoundarySizes& points, const std::vector<std::uint32_t>& cell_of,
                                    double refine_above) {
    std::vector<char> is_marked(grid_.cells().size(), 0);
    for (std::size_t i = 0; i < cell_of.size(); ++i) {
      if (cell_of[i] == kNone || is_marked[cell_of[i]]) continue;
      const RefinedGrid::Cell piece = piece_of(cell_of[i], points.points[i]);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < grid_.num_corners(); ++k) least = std::min(least, grid_.size()[piece[k]]);
      if (least > refine_above * points.size[i]) is_marked[cell_of[i]] = 1;
    }
    return is_marked;
  }

  /// Points move on into the parts of their cell.
  void follow(const RefinedGrid::Refinement& done, const std::vector<Point>& points,
              std::vector<std::uint32_t>& cell_of) const {
    std::vector<std::uint32_t> first;  // parts of one cell stand side by side
    for (std::uint32_t i = 0; i < done.parent_of.size(); ++i)
      if (i == 0 || done.parent_of[i] != done.parent_of[i - 1]) first.push_back(i);
    first.push_back(static_cast<std::uint32_t>(done.parent_of.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (cell_of[i] == kNone) continue;
      const std::uint32_t begin = first[cell_of[i]], end = first[cell_of[i] + 1];
      std::uint32_t best = begin;
      double deepest = -std::numeric_limits<double>::infinity();
      for (std::uint32_t cell = begin; cell < end && end - begin > 1; ++cell) {
        const double d = depth(grid_, grid_.cells()[cell], points[i]);
        if (d > deepest) {
          deepest = d;
          best = cell;
        }
      }
      cell_of[i] = best;
    }
  }

  RefinedGrid grid_;
  std::vector<RefinedGrid::Cell> pieces_;
};

AdaptiveBackground::AdaptiveBackground(const Box& box, std::size_t cells, double size, Context& context)
    : AdaptiveBackground(start_grid(box, cells, size), context) {}
AdaptiveBackground::AdaptiveBackground(const BackgroundGrid& grid, Context& context)
    : impl_(std::make_unique<Impl>(start_from(grid, context))) {}
AdaptiveBackground::~AdaptiveBackground() = default;
AdaptiveBackground::AdaptiveBackground(AdaptiveBackground&&) noexcept = default;
AdaptiveBackground& AdaptiveBackground::operator=(AdaptiveBackground&&) noexcept = default;

AdaptReport AdaptiveBackground::adapt(std::span<const Point> points, std::span<const double> size,
                                      const AdaptiveBackgroundOptions& options, Context& context) {
  return impl_->adapt(points, size, options, context);
}

BackgroundGrid AdaptiveBackground::grid(Context& context) const {
  BackgroundGrid grid;
  grid.mesh = impl_->mesh(context);
  grid.name = "adaptive background";
  grid.size = "size";
  return grid;
}

}  // namespace delfront
