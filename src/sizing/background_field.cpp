// SPDX-License-Identifier: Apache-2.0
// A point is found by walking from the cell of the one before. So that the answer does not depend on the path, it is
// defined without it: the cell that holds the point strictly inside, of several the lowest; else, on faces, the lowest
// cell that holds it within rounding. A walk may end only in a cell of the first kind, and only in grids without
// overlaps; all else asks the tree.
//
// With growth the field is the largest one with that slope below the linear one: h(p) = min over places q of the grid
// of linear(q) + slope |p - q|. Where q is not p, the field rises from q towards p with more than the slope, or the way
// leaves the grid. So q lies on the border of a cell that is too steep, or on the boundary of a grid that is not
// convex: only these are searched, and a field that keeps the slope costs nothing. Outside: where the grid is convex,
// the value of the nearest boundary point (finding that lengthens no distance, so the slope holds); else the least over
// q, after places outside of the grid's box are drawn to it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/hilbert.hpp"
#include "delfront/background.hpp"
#include "delfront/errors.hpp"
#include "sizing/background_growth.hpp"
#include "sizing/background_values.hpp"
#include "sizing/packed_tree.hpp"
#include "sizing/simplex_grid.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNone = SimplexGrid::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kInside = 1e-10;          // barycentric coordinates this near to 0 are rounding
constexpr double kMostInside = 1e-6;       // of slivers
constexpr int kMaxSteps = 8;               // of a walk, then the tree is quicker
constexpr double kBoundSlack = 1 - 1e-12;  // exp, log and cones round
constexpr double kConvex = 1e-9;           // of the grid's size: how far a face may lie under its neighbour's plane

class GridField final : public BackgroundField {
 public:
  GridField(const BackgroundGrid& given, const BackgroundOptions& options, Context& context);

  void sizes(std::span<const Point> at, std::span<double> size) const override;
  void metrics(std::span<const Point> at, std::span<Metric> metric) const override;
  bool is_isotropic() const override { return log_metric_.empty(); }
  double lower_bound(const Box& box) const override;
  double largest() const override { return largest_; }
  double share_outside(std::span<const Point> points) const override;
  Box box() const override;
  void require_overlap(const Box& domain) const override;

 private:
  bool is_plane() const { return grid_.dimension == 2; }
  Point flat(Point p) const { return is_plane() ? Point{p.x, p.y, 0} : p; }
  void check_point(Point p) const;
  bool is_strictly_inside(const std::array<double, 4>& weight, std::size_t cell) const;
  void build_trees(Context& context);
  double largest_at(std::uint32_t node) const;
  void find_tolerances();
  void build_sources();
  bool find_overlaps() const;
  bool find_convexity() const;

  struct Hint {  // what the point before found
    std::uint32_t cell = kNone, source = kNone, rim = kNone;
  };
  std::uint32_t walk(Point p, std::uint32_t from) const;
  std::uint32_t search(Point p) const;
  std::uint32_t locate(Point p, Hint& hint) const;
  struct Weights {
    std::array<std::uint32_t, 4> node;
    std::array<double, 4> weight;  // not negative, sum 1 to rounding
    std::size_t count;
  };
  Weights weights_in(Point p, std::uint32_t cell) const;
  Weights weights_outside(Point p) const;
  Point place_of(const Weights& weights) const;
  double interpolated_size(const Weights& weights) const;
  Metric interpolated_metric(const Weights& weights) const;
  double least_cone(Point p, double start, Hint& hint) const;
  double least_cone_from(const Box& box, double start) const;
  SizedFace face(std::uint32_t index) const;
  double size_at(Point p, Hint& hint) const;

  SimplexGrid grid_;
  std::string name_;
  std::vector<double> node_size_;     // of metrics the least
  std::vector<Metric> log_metric_;    // empty: isotropic
  std::vector<float> inside_;         // one a cell: what counts as 0 among its barycentric coordinates
  std::vector<std::uint32_t> steep_;  // cells from which the limit of growth works
  std::vector<std::uint32_t> rim_;    // faces of the boundary from which it does
  PackedTree cells_, boundary_, sources_, rim_tree_;
  Box box_;
  bool has_overlaps_ = false, has_pockets_ = false;
  double slope_ = kInfinity;
  double largest_ = 0;
};

/// Of a metric the geometric mean of its sizes: the least size of a log-Euclidean mean may exceed that of all its
/// parts, but not the largest of these: the greatest eigenvalue of a matrix is no less than a third of its trace.
double GridField::largest_at(std::uint32_t node) const {
  if (is_isotropic()) return node_size_[node];
  const Metric& m = log_metric_[node];
  return is_plane() ? std::exp(-0.25 * (m.xx + m.yy)) : std::exp(-(m.xx + m.yy + m.zz) / 6);
}

// ---- building -------------------------------------------------------------------------------------------------------

void order_boundary(SimplexGrid& grid) {
  std::vector<Point> centres;
  for (const auto& f : grid.boundary)
    centres.push_back((grid.points[f[0]] + grid.points[f[1]] + grid.points[f[2]]) / 3);
  std::vector<std::array<std::uint32_t, 3>> ordered;
  for (std::uint32_t i : hilbert_order(centres)) ordered.push_back(grid.boundary[i]);
  grid.boundary = std::move(ordered);
}

GridField::GridField(const BackgroundGrid& given, const BackgroundOptions& options, Context& context)
    : grid_(build_simplex_grid(given.mesh, given.name, context)), name_(given.name) {
  NodeSizes nodes = read_node_sizes(given, grid_, options);
  order_boundary(grid_);
  const bool has_growth = std::isfinite(options.growth);
  const double slope = slope_of(options.growth);
  node_size_ = std::move(nodes.size);
  if (!nodes.metric.empty()) {
    if (has_growth) limit_metric_growth(grid_, slope, nodes.metric, context);
    for (const Metric& m : nodes.metric) {
      node_size_.push_back(least_size(m));
      log_metric_.push_back(log_of(m));
    }
  } else if (has_growth) {
    slope_ = slope;
  }
  find_tolerances();
  build_trees(context);
  for (std::size_t cell = 0; cell < grid_.cells.size(); ++cell)
    for (std::uint32_t v : grid_.corners(cell)) largest_ = std::max(largest_, largest_at(v));
  has_overlaps_ = grid_.has_crowded_faces || find_overlaps();
  if (!std::isfinite(slope_)) return;
  has_pockets_ = !find_convexity();
  build_sources();
}

/// Rounding of barycentric coordinates: of the order of epsilon times the cube of the longest edge over the volume.
void GridField::find_tolerances() {
  inside_.reserve(grid_.cells.size());
  for (std::size_t cell = 0; cell < grid_.cells.size(); ++cell) {
    const Box box = grid_.box_of(cell);
    const double l = box.diagonal();
    const double full = is_plane() ? l * l : l * l * l;
    const double noise = 1e-15 * full / grid_.measure(cell);
    inside_.push_back(static_cast<float>(std::clamp(noise, kInside, kMostInside)));
  }
}

void GridField::build_trees(Context& context) {
  std::vector<Box> boxes;
  std::vector<double> least;
  for (std::size_t cell = 0; cell < grid_.cells.size(); ++cell) {
    Box box = grid_.box_of(cell);
    box_.add(box);
    const double margin = 4 * static_cast<double>(inside_[cell]) * box.diagonal();
    for (int k = 0; k < grid_.dimension; ++k) {
      box.low[k] -= margin;
      box.high[k] += margin;
    }
    boxes.push_back(box);
    double value = kInfinity;
    for (std::uint32_t v : grid_.corners(cell)) value = std::min(value, node_size_[v]);
    least.push_back(value);
  }
  context.check_limits();
  cells_ = PackedTree(boxes, least);
  boxes.clear();
  least.clear();
  for (const auto& f : grid_.boundary) {
    Box box;
    for (std::uint32_t v : f) box.add(grid_.points[v]);
    boxes.push_back(box);
    least.push_back(std::min({node_size_[f[0]], node_size_[f[1]], node_size_[f[2]]}));
  }
  boundary_ = PackedTree(boxes, least);
}

/// Tree over some simplices of the grid, given by their corners.
template <class Corners>
PackedTree tree_of(const SimplexGrid& grid, const std::vector<double>& size, std::span<const std::uint32_t> items,
                   const Corners& corners_of) {
  std::vector<Box> boxes(items.size());
  std::vector<double> least(items.size(), kInfinity);
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::uint32_t v : corners_of(items[i])) {
      boxes[i].add(grid.points[v]);
      least[i] = std::min(least[i], size[v]);
    }
  return PackedTree(boxes, least);
}

/// The limit works from steep cells and, in a grid with pockets, from the boundary. Not from those that lie above the
/// cone of one node altogether (which they do where their corners do, since a cone is convex).
void GridField::build_sources() {
  const auto corners_of_cell = [&](std::uint32_t cell) { return grid_.corners(cell); };
  const auto corners_of_face = [&](std::uint32_t i) { return std::span<const std::uint32_t>(grid_.boundary[i]); };
  steep_ = find_steep_cells(grid_, node_size_, slope_);
  if (has_pockets_)
    for (std::uint32_t i = 0; i < grid_.boundary.size(); ++i) rim_.push_back(i);
  const std::vector<std::uint32_t> all = steep_;
  const PackedTree nodes = tree_of(grid_, node_size_, all, corners_of_cell);
  const auto cone = [&](std::uint32_t from, std::uint32_t at) {
    return node_size_[from] + slope_ * distance(grid_.points[from], grid_.points[at]);
  };
  const auto lowest_at = [&](std::uint32_t item, std::uint32_t at) {
    const auto v = corners_of_cell(all[item]);
    return *std::min_element(v.begin(), v.end(), [&](auto a, auto b) { return cone(a, at) < cone(b, at); });
  };
  const auto is_above_one = [&](std::span<const std::uint32_t> v) {
    const std::uint32_t low = *std::min_element(
        v.begin(), v.end(), [&](std::uint32_t a, std::uint32_t b) { return node_size_[a] < node_size_[b]; });
    const Point p = grid_.points[low];
    const PackedTree::Best best = nodes.minimize(
        [&](const PackedTree::Node& node) { return node.least + slope_ * std::sqrt(squared_distance(p, node.box)); },
        [&](std::uint32_t item) { return cone(lowest_at(item, low), low); });
    if (!best.found()) return false;
    const std::uint32_t from = lowest_at(best.item, low);
    return std::all_of(v.begin(), v.end(),
                       [&](std::uint32_t at) { return cone(from, at) < kBoundSlack * node_size_[at]; });
  };
  std::erase_if(steep_, [&](std::uint32_t cell) { return is_above_one(corners_of_cell(cell)); });
  std::erase_if(rim_, [&](std::uint32_t i) { return is_above_one(corners_of_face(i)); });
  sources_ = tree_of(grid_, node_size_, steep_, corners_of_cell);
  rim_tree_ = tree_of(grid_, node_size_, rim_, corners_of_face);
}

/// Where cells overlap, some vertex or centre of the boundary lies strictly inside a cell (but for edges that cross).
bool GridField::find_overlaps() const {
  const auto is_covered = [&](Point p) {
    bool found = false;
    cells_.for_each_overlap(
        {p, p}, [&](std::uint32_t cell) { found = found || is_strictly_inside(grid_.barycentric(cell, p), cell); });
    return found;
  };
  for (const auto& f : grid_.boundary) {
    const Point a = grid_.points[f[0]], b = grid_.points[f[1]], c = grid_.points[f[2]];
    if (is_covered(a) || is_covered(is_plane() ? 0.5 * (a + b) : (a + b + c) / 3)) return true;
  }
  return false;
}

/// Convex: the boundary is one piece, and at each of its edges (in the plane vertices) it bends outward or not at all.
bool GridField::find_convexity() const {
  struct Side {
    std::uint32_t a, b, face, other;
  };
  std::vector<Side> sides;
  for (std::uint32_t i = 0; i < grid_.boundary.size(); ++i) {
    const auto& f = grid_.boundary[i];
    if (is_plane()) {
      sides.push_back({f[0], kNone, i, f[1]});
      sides.push_back({f[1], kNone, i, f[0]});
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = f[k], b = f[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), i, f[(k + 2) % 3]});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& p, const Side& q) { return std::tie(p.a, p.b, p.face) < std::tie(q.a, q.b, q.face); });
  const double allowance = kConvex * box_.diagonal();
  std::vector<std::uint32_t> root(grid_.boundary.size());
  for (std::uint32_t i = 0; i < root.size(); ++i) root[i] = i;
  const auto find = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::size_t pieces = root.size();
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const bool is_pair = i + 1 < sides.size() && sides[i].a == sides[i + 1].a && sides[i].b == sides[i + 1].b &&
                         (i + 2 == sides.size() || sides[i].a != sides[i + 2].a || sides[i].b != sides[i + 2].b);
    if (!is_pair) return false;
    const auto& f = grid_.boundary[sides[i].face];
    const Point a = grid_.points[f[0]], u = grid_.points[f[1]] - a, v = grid_.points[f[2]] - a;
    const Point normal = is_plane() ? Point{u.y, -u.x, 0} : cross(u, v);
    if (dot(grid_.points[sides[i + 1].other] - a, normal) > allowance * length(normal)) return false;
    const std::uint32_t p = find(sides[i].face), q = find(sides[i + 1].face);
    if (p != q) {
      root[p] = q;
      --pieces;
    }
  }
  return pieces == 1;
}

// ---- finding --------------------------------------------------------------------------------------------------------

void GridField::check_point(Point p) const {
  if (!is_finite(p))
    throw InputError(
        fmt::format("{}: a size was asked for at ({}, {}, {}); all coordinates must be finite", name_, p.x, p.y, p.z));
}

bool GridField::is_strictly_inside(const std::array<double, 4>& weight, std::size_t cell) const {
  for (std::size_t k = 0; k < grid_.num_corners(); ++k)
    if (!(weight[k] > static_cast<double>(inside_[cell]))) return false;
  return true;
}

/// @return a cell that holds p strictly inside, or kNone
std::uint32_t GridField::walk(Point p, std::uint32_t from) const {
  std::uint32_t cell = from;
  for (int step = 0; step < kMaxSteps && cell != kNone; ++step) {
    const std::array<double, 4> weight = grid_.barycentric(cell, p);
    std::size_t worst = 0;
    for (std::size_t k = 1; k < grid_.num_corners(); ++k)
      if (weight[k] < weight[worst]) worst = k;
    if (weight[worst] > static_cast<double>(inside_[cell])) return cell;
    if (weight[worst] >= -static_cast<double>(inside_[cell])) return kNone;
    cell = grid_.neighbours[cell][worst];
  }
  return kNone;
}

std::uint32_t GridField::search(Point p) const {
  std::uint32_t strict = kNone, loose = kNone;
  cells_.for_each_overlap({p, p}, [&](std::uint32_t cell) {
    const std::array<double, 4> weight = grid_.barycentric(cell, p);
    const double worst = *std::min_element(weight.begin(), weight.begin() + static_cast<int>(grid_.num_corners()));
    const auto inside = static_cast<double>(inside_[cell]);
    if (worst > inside) strict = std::min(strict, cell);
    if (worst >= -inside) loose = std::min(loose, cell);
  });
  return strict != kNone ? strict : loose;
}

/// @return the cell of p, kNone outside; the hint's is that of the point before and becomes that of this one
std::uint32_t GridField::locate(Point p, Hint& hint) const {
  std::uint32_t cell = hint.cell != kNone && !has_overlaps_ ? walk(p, hint.cell) : kNone;
  if (cell == kNone) cell = search(p);
  if (cell != kNone) hint.cell = cell;
  return cell;
}

GridField::Weights GridField::weights_in(Point p, std::uint32_t cell) const {
  Weights result{grid_.cells[cell], grid_.barycentric(cell, p), grid_.num_corners()};
  double sum = 0;
  for (std::size_t k = 0; k < result.count; ++k) {
    result.weight[k] = std::max(result.weight[k], 0.0);
    sum += result.weight[k];
  }
  for (std::size_t k = 0; k < result.count; ++k) result.weight[k] /= sum;
  return result;
}

GridField::Weights GridField::weights_outside(Point p) const {
  const auto on = [&](std::uint32_t i) {
    const auto& f = grid_.boundary[i];
    return nearest_on_face(p, grid_.points[f[0]], grid_.points[f[1]], grid_.points[f[2]]);
  };
  const PackedTree::Best best = boundary_.nearest(p, [&](std::uint32_t i) { return squared_length(on(i).at - p); });
  DELFRONT_CHECK(best.found());
  const std::array<double, 3> weight = on(best.item).weight;
  const auto& f = grid_.boundary[best.item];
  return {{f[0], f[1], f[2], kNone}, {weight[0], weight[1], weight[2], 0}, 3};
}

SizedFace GridField::face(std::uint32_t index) const {
  const auto& f = grid_.boundary[index];
  return {{grid_.points[f[0]], grid_.points[f[1]], grid_.points[f[2]]},
          {node_size_[f[0]], node_size_[f[1]], node_size_[f[2]]}};
}

// ---- asking ---------------------------------------------------------------------------------------------------------

Point GridField::place_of(const Weights& weights) const {
  Point sum;
  for (std::size_t k = 0; k < weights.count; ++k) sum = sum + weights.weight[k] * grid_.points[weights.node[k]];
  return sum;
}

double GridField::interpolated_size(const Weights& weights) const {
  double sum = 0, least = kInfinity, most = 0;
  for (std::size_t k = 0; k < weights.count; ++k) {
    const double h = node_size_[weights.node[k]];
    sum += weights.weight[k] * h;
    least = std::min(least, h);
    most = std::max(most, h);
  }
  return std::clamp(sum, least, most);
}

Metric GridField::interpolated_metric(const Weights& weights) const {
  Metric sum{0, 0, 0, 0, 0, 0};
  for (std::size_t k = 0; k < weights.count; ++k) {
    const Metric& m = log_metric_[weights.node[k]];
    const double w = weights.weight[k];
    sum = {sum.xx + w * m.xx, sum.xy + w * m.xy, sum.xz + w * m.xz,
           sum.yy + w * m.yy, sum.yz + w * m.yz, sum.zz + w * m.zz};
  }
  const Metric result = exp_of(sum);
  return is_plane() ? plane_metric(result) : result;
}

/// The least over all places from which the limit works, at most `start`. Bounds are a little low, so that nothing
/// below the result is ever passed over, wherever the search began.
double GridField::least_cone(Point p, double start, Hint& hint) const {
  const auto bound = [&](const PackedTree::Node& node) {
    return kBoundSlack * (node.least + slope_ * std::sqrt(squared_distance(p, node.box)));
  };
  const auto from_steep = [&](std::uint32_t i) { return least_cone_on_cell(p, grid_, steep_[i], node_size_, slope_); };
  const auto from_boundary = [&](std::uint32_t i) { return least_cone_on_face(p, face(rim_[i]), slope_); };
  PackedTree::Best best{kNone, start};
  const auto search_from = [&](const PackedTree& tree, const auto& value_of, std::uint32_t& last) {
    if (last != kNone) best.value = std::min(best.value, value_of(last));
    best.item = kNone;
    best = tree.minimize(bound, value_of, best);
    if (best.found()) last = best.item;
  };
  search_from(sources_, from_steep, hint.source);
  search_from(rim_tree_, from_boundary, hint.rim);
  return best.value;
}

double GridField::size_at(Point p, Hint& hint) const {
  if (has_pockets_)
    for (int k = 0; k < grid_.dimension; ++k) p[k] = std::clamp(p[k], box_.low[k], box_.high[k]);
  const std::uint32_t cell = locate(p, hint);
  if (cell == kNone && has_pockets_) return least_cone(p, largest_, hint);
  const Weights weights = cell == kNone ? weights_outside(p) : weights_in(p, cell);
  if (!is_isotropic()) return least_size(interpolated_metric(weights));
  const double size = interpolated_size(weights);
  if (steep_.empty() && rim_.empty()) return size;
  return least_cone(cell == kNone ? place_of(weights) : p, size, hint);
}

void GridField::sizes(std::span<const Point> at, std::span<double> size) const {
  DELFRONT_CHECK(at.size() == size.size());
  Hint hint;
  for (std::size_t i = 0; i < at.size(); ++i) {
    check_point(at[i]);
    size[i] = size_at(flat(at[i]), hint);
  }
}

void GridField::metrics(std::span<const Point> at, std::span<Metric> metric) const {
  if (is_isotropic()) return SizeField::metrics(at, metric);
  DELFRONT_CHECK(at.size() == metric.size());
  Hint hint;
  for (std::size_t i = 0; i < at.size(); ++i) {
    check_point(at[i]);
    const Point p = flat(at[i]);
    const std::uint32_t cell = locate(p, hint);
    metric[i] = interpolated_metric(cell == kNone ? weights_outside(p) : weights_in(p, cell));
  }
}

/// A place of the box that lies outside has its nearest boundary point no farther from the box than the centre's
/// nearest one and half the diagonal.
double GridField::lower_bound(const Box& asked) const {
  if (asked.is_empty()) return std::numeric_limits<double>::min();
  Box box{flat(asked.low), flat(asked.high)};
  if (has_pockets_)
    for (int k = 0; k < grid_.dimension; ++k) {
      box.low[k] = std::clamp(box.low[k], box_.low[k], box_.high[k]);
      box.high[k] = std::clamp(box.high[k], box_.low[k], box_.high[k]);
    }
  const double inside = cells_.least_over(box, largest_);
  if (has_pockets_) return kBoundSlack * least_cone_from(box, inside);
  bool meets_boundary = false;
  boundary_.for_each_overlap(box, [&](std::uint32_t) { meets_boundary = true; });
  const Point centre = box.centre();
  if (!meets_boundary && search(centre) != kNone) return kBoundSlack * least_cone_from(box, inside);
  const PackedTree::Best best = boundary_.nearest(centre, [&](std::uint32_t i) {
    const SizedFace f = face(i);
    return squared_length(nearest_on_face(centre, f.corner[0], f.corner[1], f.corner[2]).at - centre);
  });
  const double reach = (1 + 1e-9) * (std::sqrt(best.value) + 0.5 * box.diagonal());
  for (int k = 0; k < grid_.dimension; ++k) {
    box.low[k] -= reach;
    box.high[k] += reach;
  }
  return kBoundSlack * least_cone_from(box, boundary_.least_over(box, inside));
}

/// No place of the box gets less from the limit of growth; at most `start`.
double GridField::least_cone_from(const Box& box, double start) const {
  const auto bound = [&](const PackedTree::Node& node) {
    Point away;
    for (int k = 0; k < 3; ++k) away[k] = std::max({node.box.low[k] - box.high[k], 0.0, box.low[k] - node.box.high[k]});
    return node.least + slope_ * length(away);
  };
  const double best = sources_.least_bound(bound, start);
  return rim_tree_.least_bound(bound, best);
}

double GridField::share_outside(std::span<const Point> points) const {
  Hint hint;
  std::size_t outside = 0;
  for (const Point& p : points) {
    check_point(p);
    outside += locate(flat(p), hint) == kNone;
  }
  return points.empty() ? 0 : static_cast<double>(outside) / static_cast<double>(points.size());
}

Box GridField::box() const {
  Box box = box_;
  if (is_plane()) {
    box.low.z = -kInfinity;
    box.high.z = kInfinity;
  }
  return box;
}

void GridField::require_overlap(const Box& domain) const {
  if (domain.is_empty() || box().overlaps(domain)) return;
  const auto text = [](const Box& b) {
    return fmt::format("({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})", b.low.x, b.low.y, b.low.z, b.high.x, b.high.y,
                       b.high.z);
  };
  throw InputError(
      fmt::format("{}: the grid lies in {} and the region to be gridded in {}; they have no place in common (are the "
                  "units the same?)",
                  name_, text(box_), text(domain)));
}

}  // namespace

std::unique_ptr<BackgroundField> build_background_size_field(const BackgroundGrid& grid,
                                                             const BackgroundOptions& options, Context& context) {
  return std::make_unique<GridField>(grid, options, context);
}

}  // namespace delfront
