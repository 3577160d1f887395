// SPDX-License-Identifier: Apache-2.0
#include "delfront/metric.hpp"

#include <fmt/format.h>

#include "Eigen/Cholesky"
#include "Eigen/Eigenvalues"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr double kOrthonormal = 1e-6;

Eigen::Matrix3d matrix(const Metric& m) {
  Eigen::Matrix3d result;
  result << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return result;
}

Metric metric(const Eigen::Matrix3d& m) { return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)}; }

template <class Function>
Metric with_eigenvalues(const Metric& m, const Function& f) {
  MetricAxes axes = metric_axes(m);
  for (double& value : axes.value) value = f(value);
  return metric_from_axes(axes);
}

void check_stretching(double delta, const Stretching& s) {
  if (!(delta > 0 && std::isfinite(delta)))
    throw UsageError(fmt::format("size {} with stretchings: it must be a positive number", delta));
  if (!(s.s1 > 0 && s.s2 > 0 && std::isfinite(s.s1) && std::isfinite(s.s2)))
    throw UsageError(fmt::format("stretchings {} and {}: both must be positive numbers", s.s1, s.s2));
  const bool is_orthonormal = std::abs(length(s.first) - 1) <= kOrthonormal &&
                              std::abs(length(s.second) - 1) <= kOrthonormal &&
                              std::abs(dot(s.first, s.second)) <= kOrthonormal;
  if (!is_orthonormal)
    throw UsageError(
        fmt::format("directions of stretching ({:g} {:g} {:g}) and ({:g} {:g} {:g}): they must have "
                    "length 1 and stand at right angles",
                    s.first.x, s.first.y, s.first.z, s.second.x, s.second.y, s.second.z));
}

}  // namespace

Metric isotropic_metric(double delta) {
  const double m = 1 / (delta * delta);
  return {m, 0, 0, m, 0, m};
}

Metric stretched_metric(double delta, const Stretching& stretching) {
  check_stretching(delta, stretching);
  auto weight = [](double size) { return 1 / (size * size); };
  return metric_from_axes({{weight(delta * stretching.s1), weight(delta * stretching.s2), weight(delta)},
                           {stretching.first, stretching.second, cross(stretching.first, stretching.second)}});
}

MetricAxes metric_axes(const Metric& m) {
  // In units of its own size, so that squares neither overflow nor vanish.
  const double unit = std::max({std::abs(m.xx), std::abs(m.yy), std::abs(m.zz)});
  if (!(unit > 0)) return {{0, 0, 0}, {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}}};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix(m) / unit);
  MetricAxes axes;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    axes.value[i] = unit * solver.eigenvalues()[k];
    const Eigen::Vector3d v = solver.eigenvectors().col(k);
    axes.direction[i] = {v[0], v[1], v[2]};
  }
  axes.direction[2] = cross(axes.direction[0], axes.direction[1]);
  return axes;
}

Metric metric_from_axes(const MetricAxes& axes) {
  Metric m{0, 0, 0, 0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const double w = axes.value[k];
    const Point d = axes.direction[k];
    m.xx += w * d.x * d.x;
    m.xy += w * d.x * d.y;
    m.xz += w * d.x * d.z;
    m.yy += w * d.y * d.y;
    m.yz += w * d.y * d.z;
    m.zz += w * d.z * d.z;
  }
  return m;
}

double least_size(const Metric& m) {
  if (m.xy == 0 && m.xz == 0 && m.yz == 0) return 1 / std::sqrt(std::max({m.xx, m.yy, m.zz}));
  return 1 / std::sqrt(metric_axes(m).value[2]);
}

double greatest_size(const Metric& m) {
  if (m.xy == 0 && m.xz == 0 && m.yz == 0) return 1 / std::sqrt(std::min({m.xx, m.yy, m.zz}));
  return 1 / std::sqrt(metric_axes(m).value[0]);
}

double length_in(const Metric& m, Point e) {
  return std::sqrt(m.xx * e.x * e.x + m.yy * e.y * e.y + m.zz * e.z * e.z +
                   2 * (m.xy * e.x * e.y + m.xz * e.x * e.z + m.yz * e.y * e.z));
}

Metric intersection(const Metric& a, const Metric& b) {
  // Reduced with their sum, in whose basis the two have eigenvalues l and 1 - l: symmetric in a and b, and one of the
  // two may be singular (a field without an opinion has the metric 0).
  const Eigen::Matrix3d ma = matrix(a), mb = matrix(b);
  const double unit = (ma + mb).trace();
  if (!(unit > 0)) return a;
  const Eigen::LLT<Eigen::Matrix3d> sum((ma + mb) / unit);
  if (sum.info() != Eigen::Success) return ma.trace() >= mb.trace() ? a : b;  // both singular: the smaller lengths
  const Eigen::Matrix3d lower = sum.matrixL();
  const Eigen::Matrix3d half = lower.triangularView<Eigen::Lower>().solve(ma / unit);
  const Eigen::Matrix3d reduced = lower.triangularView<Eigen::Lower>().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(0.5 * (reduced + reduced.transpose()));
  const Eigen::Matrix3d basis = lower * solver.eigenvectors();
  const Eigen::Vector3d larger = solver.eigenvalues().array().max(1 - solver.eigenvalues().array());
  return metric(unit * (basis * larger.asDiagonal() * basis.transpose()));
}

Metric clamped(const Metric& m, double hmin, double hmax) {
  const double most = hmin > 0 ? 1 / (hmin * hmin) : std::numeric_limits<double>::infinity();
  const double least = 1 / (hmax * hmax);
  return with_eigenvalues(m, [&](double value) { return std::clamp(value, least, most); });
}

Metric log_of(const Metric& m) {
  return with_eigenvalues(m, [](double value) { return std::log(value); });
}

Metric exp_of(const Metric& log_metric) {
  return with_eigenvalues(log_metric, [](double value) { return std::exp(value); });
}

}  // namespace delfront
