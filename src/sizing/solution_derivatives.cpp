// SPDX-License-Identifier: Apache-2.0
// The fit works in coordinates in which the neighbours of a node are spread alike in all directions, so that stretched
// grids are no worse than others; it goes through the node's own value. Nearer neighbours weigh more.
#include "sizing/solution_derivatives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "Eigen/Eigenvalues"
#include "Eigen/QR"
#include "base/parallel.hpp"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = 1024;
constexpr int kMostRings = 4;
constexpr double kRank = 1e-7;   // of the least-squares matrix, relative
constexpr double kFlat = 1e-24;  // ratio of squared spreads below which neighbours lie in a plane

void add(Metric& m, double w, Point a, Point b) {
  m.xx += w * a.x * b.x;
  m.xy += 0.5 * w * (a.x * b.y + a.y * b.x);
  m.xz += 0.5 * w * (a.x * b.z + a.z * b.x);
  m.yy += w * a.y * b.y;
  m.yz += 0.5 * w * (a.y * b.z + a.z * b.y);
  m.zz += w * a.z * b.z;
}

NodeDerivatives project(const SimplexGrid& grid, const std::vector<double>& values) {
  const std::vector<double> volume = lumped_volumes(grid);
  const std::size_t n = grid.points.size();
  NodeDerivatives result{std::vector<Point>(n), std::vector<Metric>(n, Metric{0, 0, 0, 0, 0, 0})};
  const auto share = [&](std::size_t cell, std::uint32_t v) {
    return grid.measure(cell) / (static_cast<double>(grid.num_corners()) * volume[v]);
  };
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell) {
    const std::array<Point, 4> g = grid.gradients(cell);
    const std::span<const std::uint32_t> v = grid.corners(cell);
    Point rise;
    for (std::size_t k = 1; k < v.size(); ++k) rise = rise + (values[v[k]] - values[v[0]]) * g[k];
    for (std::uint32_t node : v) result.gradient[node] = result.gradient[node] + share(cell, node) * rise;
  }
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell) {
    const std::array<Point, 4> g = grid.gradients(cell);
    const std::span<const std::uint32_t> v = grid.corners(cell);
    for (std::uint32_t node : v)
      for (std::size_t k = 0; k < v.size(); ++k)
        add(result.hessian[node], share(cell, node), g[k], result.gradient[v[k]]);
  }
  return result;
}

/// Fits quadratics around nodes.
class Fitter {
 public:
  Fitter(const SimplexGrid& grid, const VertexNeighbours& neighbours, const std::vector<double>& values)
      : grid_(grid), neighbours_(neighbours), values_(values), dimension_(grid.dimension) {}

  /// @return false where even several rings have no unique quadratic
  bool fit(std::uint32_t node, Point& gradient, Metric& hessian) {
    ring_.assign(1, node);
    std::size_t begin = 0;
    for (int round = 0; round < kMostRings; ++round) {
      const std::size_t end = ring_.size();
      for (; begin < end; ++begin)
        for (std::uint32_t other : neighbours_[ring_[begin]])
          if (std::find(ring_.begin(), ring_.end(), other) == ring_.end()) ring_.push_back(other);
      if (ring_.size() - 1 >= unknowns() + 1 && solve(gradient, hessian)) return true;
    }
    return false;
  }

 private:
  std::size_t unknowns() const { return dimension_ == 2 ? 5 : 9; }

  bool solve(Point& gradient, Metric& hessian) {
    const auto d = static_cast<Eigen::Index>(dimension_);
    const Point centre = grid_.points[ring_[0]];
    const auto away = [&](std::size_t i) {
      const Point p = grid_.points[ring_[i]] - centre;
      return dimension_ == 2 ? Eigen::VectorXd(Eigen::Vector2d(p.x, p.y))
                             : Eigen::VectorXd(Eigen::Vector3d(p.x, p.y, p.z));
    };
    double largest = 0;
    for (std::size_t i = 1; i < ring_.size(); ++i) largest = std::max(largest, away(i).norm());
    Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(d, d);
    for (std::size_t i = 1; i < ring_.size(); ++i) {
      const Eigen::VectorXd x = away(i) / largest;
      spread += x * x.transpose() / static_cast<double>(ring_.size() - 1);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(spread);
    if (!(axes.eigenvalues()[0] > kFlat * axes.eigenvalues()[d - 1])) return false;
    // x = turn x', with x' spread alike in all directions
    const Eigen::MatrixXd turn = largest * axes.eigenvectors() * axes.eigenvalues().cwiseSqrt().asDiagonal();
    const Eigen::MatrixXd back =
        axes.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal() * axes.eigenvectors().transpose() / largest;
    const auto rows = static_cast<Eigen::Index>(ring_.size() - 1), columns = static_cast<Eigen::Index>(unknowns());
    Eigen::MatrixXd matrix(rows, columns);
    Eigen::VectorXd right(rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const auto i = static_cast<std::size_t>(row) + 1;
      const Eigen::VectorXd x = back * away(i);
      const double weight = 1 / x.norm();
      Eigen::Index column = 0;
      for (Eigen::Index a = 0; a < d; ++a) matrix(row, column++) = weight * x[a];
      for (Eigen::Index a = 0; a < d; ++a)
        for (Eigen::Index b = a; b < d; ++b) matrix(row, column++) = weight * (a == b ? 0.5 : 1.0) * x[a] * x[b];
      right[row] = weight * (values_[ring_[i]] - values_[ring_[0]]);
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
    qr.setThreshold(kRank);
    if (qr.rank() < columns) return false;
    take(qr.solve(right), back, gradient, hessian);
    return true;
  }

  void take(const Eigen::VectorXd& solution, const Eigen::MatrixXd& back, Point& gradient, Metric& hessian) const {
    const auto d = static_cast<Eigen::Index>(dimension_);
    const Eigen::VectorXd g = back.transpose() * solution.head(d);
    Eigen::MatrixXd h(d, d);
    Eigen::Index column = d;
    for (Eigen::Index a = 0; a < d; ++a)
      for (Eigen::Index b = a; b < d; ++b) h(a, b) = h(b, a) = solution[column++];
    h = (back.transpose() * h * back).eval();
    gradient = {g[0], g[1], d == 3 ? g[2] : 0};
    hessian = d == 3 ? Metric{h(0, 0), h(0, 1), h(0, 2), h(1, 1), h(1, 2), h(2, 2)}
                     : Metric{h(0, 0), h(0, 1), 0, h(1, 1), 0, 0};
  }

  const SimplexGrid& grid_;
  const VertexNeighbours& neighbours_;
  const std::vector<double>& values_;
  int dimension_;
  std::vector<std::uint32_t> ring_;
};

NodeDerivatives fit(const SimplexGrid& grid, const std::vector<double>& values, Context& context) {
  const VertexNeighbours neighbours(grid);
  const std::size_t n = grid.points.size();
  NodeDerivatives result{std::vector<Point>(n), std::vector<Metric>(n, Metric{0, 0, 0, 0, 0, 0})};
  parallel_ranges(context.threads, n, kGrain, [&](std::size_t first, std::size_t last) {
    context.check_limits();
    Fitter fitter(grid, neighbours, values);
    for (std::size_t node = first; node < last; ++node) {
      if (neighbours[node].empty()) continue;
      if (fitter.fit(static_cast<std::uint32_t>(node), result.gradient[node], result.hessian[node])) continue;
      const Point p = grid.points[node];
      throw InputError(
          fmt::format("node {} at ({:g}, {:g}, {:g}): too few nodes around it to fit a quadratic; use recovery = "
                      "\"projection\" or a finer grid",
                      node, p.x, p.y, p.z),
          {{p, {static_cast<std::uint32_t>(node)}}});
    }
  });
  return result;
}

}  // namespace

std::vector<double> lumped_volumes(const SimplexGrid& grid) {
  std::vector<double> volume(grid.points.size(), 0);
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell)
    for (std::uint32_t v : grid.corners(cell))
      volume[v] += grid.measure(cell) / static_cast<double>(grid.num_corners());
  return volume;
}

NodeDerivatives recover_derivatives(const SimplexGrid& grid, const std::vector<double>& values, Recovery recovery,
                                    Context& context) {
  return recovery == Recovery::projection ? project(grid, values) : fit(grid, values, context);
}

Principal principal_axes(const Metric& m, int dimension) {
  if (dimension == 3) {
    const MetricAxes axes = metric_axes(m);
    return {axes.value, axes.direction};
  }
  const double mean = 0.5 * (m.xx + m.yy), half = 0.5 * (m.xx - m.yy), radius = std::hypot(half, m.xy);
  const double angle = 0.5 * std::atan2(m.xy, half);
  const Point first{std::cos(angle), std::sin(angle), 0};
  return {{mean + radius, mean - radius, 0}, {first, Point{-first.y, first.x, 0}, Point{0, 0, 1}}};
}

Metric tensor_of(const Principal& axes, int dimension) {
  MetricAxes result{axes.value, axes.direction};
  if (dimension == 2) result.value[2] = std::max(axes.value[0], axes.value[1]);
  return metric_from_axes(result);
}

}  // namespace delfront
