// SPDX-License-Identifier: Apache-2.0
// Other data for the same curve: knots inserted, degree raised. Surfaces row by row.
#include "brep/nurbs_edit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "brep/nurbs_basis.hpp"
#include "delfront/errors.hpp"

namespace delfront {
namespace {

/// Control points of many curves over the same knots, as one row of control points each.
struct Rows {
  int degree = 0;
  std::vector<double> knots;
  std::vector<std::vector<Point4>> rows;
};

std::size_t multiplicity(const std::vector<double>& knots, double t) {
  return std::size_t(std::count(knots.begin(), knots.end(), t));
}

/// A5.1 once, for every row.
void insert_once(Rows& data, double t) {
  const auto p = std::size_t(data.degree);
  const std::size_t n = data.rows[0].size();
  const auto above =
      std::upper_bound(data.knots.begin() + std::ptrdiff_t(p), data.knots.begin() + std::ptrdiff_t(n), t);
  const std::size_t k = std::size_t(above - data.knots.begin()) - 1;  // knots[k] <= t
  for (std::vector<Point4>& row : data.rows) {
    std::vector<Point4> made(row.begin(), row.begin() + std::ptrdiff_t(k - p + 1));
    for (std::size_t i = k - p + 1; i <= k; ++i) {
      const double wide = data.knots[i + p] - data.knots[i], f = wide > 0 ? (t - data.knots[i]) / wide : 0;
      made.push_back(f * row[i] + (1 - f) * row[i - 1]);
    }
    made.insert(made.end(), row.begin() + std::ptrdiff_t(k), row.end());
    row = std::move(made);
  }
  data.knots.insert(data.knots.begin() + std::ptrdiff_t(k + 1), t);
}

void insert_knots(Rows& data, double t, int times) {
  const auto p = std::size_t(data.degree);
  const std::size_t n = data.rows[0].size();
  if (!(t >= data.knots[p] && t <= data.knots[n]))
    throw InputError(
        fmt::format("a knot at {:g} lies outside of the range {:g} to {:g}", t, data.knots[p], data.knots[n]));
  if (multiplicity(data.knots, t) + std::size_t(std::max(times, 0)) > p)
    throw InputError(fmt::format("a knot at {:g} would be there more often than the degree {} allows", t, p));
  for (int i = 0; i < times; ++i) insert_once(data, t);
}

/// Knots at the ends of the range as often as the degree; then the knots and points outside are left out.
void clamp_rows(Rows& data) {
  const auto p = std::size_t(data.degree);
  const double low = data.knots[p], high = data.knots[data.rows[0].size()];
  for (const double end : {low, high})
    while (multiplicity(data.knots, end) < p) insert_once(data, end);
  const auto first = std::size_t(std::upper_bound(data.knots.begin(), data.knots.end(), low) - data.knots.begin()) - p;
  const auto last = std::size_t(std::lower_bound(data.knots.begin(), data.knots.end(), high) - data.knots.begin());
  // from p knots at the low end to p at the high one: one more at each side is the clamp
  std::vector<double> knots = {low};
  knots.insert(knots.end(), data.knots.begin() + std::ptrdiff_t(first), data.knots.begin() + std::ptrdiff_t(last + p));
  knots.push_back(high);
  for (std::vector<Point4>& row : data.rows)
    row = std::vector<Point4>(row.begin() + std::ptrdiff_t(first - 1), row.begin() + std::ptrdiff_t(last));
  data.knots = std::move(knots);
}

/// The polar form of the polynomial on a span: de Boor's scheme with another argument at each step.
Point4 blossom(const Rows& data, const std::vector<Point4>& row, std::size_t span, const double* arguments) {
  const auto p = std::size_t(data.degree);
  std::vector<Point4> d(row.begin() + std::ptrdiff_t(span - p), row.begin() + std::ptrdiff_t(span + 1));
  for (std::size_t level = 1; level <= p; ++level)
    for (std::size_t i = p; i >= level; --i) {
      const double low = data.knots[span - p + i], high = data.knots[span + i + 1 - level];
      const double f = (arguments[level - 1] - low) / (high - low);
      d[i] = (1 - f) * d[i - 1] + f * d[i];
    }
  return d[p];
}

/// The control points of degree p + 1 are its polar form at p + 1 successive knots: the mean of the given polar forms
/// with one of these left out.
void raise_rows(Rows& data) {
  clamp_rows(data);
  const auto p = std::size_t(data.degree);
  if (data.degree >= kMostDegree) throw InputError(fmt::format("the degree is {} already", data.degree));
  std::vector<double> knots;
  for (std::size_t i = 0; i < data.knots.size(); ++i) {
    knots.push_back(data.knots[i]);
    if (i + 1 == data.knots.size() || data.knots[i + 1] != data.knots[i]) knots.push_back(data.knots[i]);
  }
  const std::size_t count = knots.size() - p - 2;
  const KnotLine line(data.degree, data.knots);
  std::vector<std::vector<Point4>> raised(data.rows.size());
  std::vector<double> arguments(p);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t span = line.span(0.5 * (knots[i + 1] + knots[i + p + 1]));  // any between them would do
    for (std::size_t r = 0; r < data.rows.size(); ++r) {
      Point4 sum = Point4::Zero();
      for (std::size_t out = 1; out <= p + 1; ++out) {
        for (std::size_t k = 1, m = 0; k <= p + 1; ++k)
          if (k != out) arguments[m++] = knots[i + k];
        sum += blossom(data, data.rows[r], span, arguments.data());
      }
      raised[r].push_back(sum / double(p + 1));
    }
  }
  // ends stay what they are, to the bit
  for (std::size_t r = 0; r < data.rows.size(); ++r) {
    raised[r].front() = data.rows[r].front();
    raised[r].back() = data.rows[r].back();
  }
  data.rows = std::move(raised);
  data.knots = std::move(knots);
  ++data.degree;
}

template <class Edit>
NurbsCurveData edit_curve(const NurbsCurveData& data, const Edit& edit) {
  check_nurbs(data);
  Rows rows{data.degree, data.knots, {weighted(data.points, data.weights)}};
  edit(rows);
  NurbsCurveData made;
  made.degree = rows.degree;
  made.knots = std::move(rows.knots);
  put_weighted(rows.rows[0], made.points, made.weights);
  return made;
}

template <class Edit>
NurbsSurfaceData edit_surface(const NurbsSurfaceData& data, std::size_t along, const Edit& edit) {
  check_nurbs(data);
  const std::size_t across = 1 - along;
  const std::vector<Point4> points = weighted(data.points, data.weights);
  Rows rows{data.degree[along], data.knots[along], {}};
  for (std::size_t r = 0; r < data.count[across]; ++r) {
    rows.rows.emplace_back();
    for (std::size_t k = 0; k < data.count[along]; ++k)
      rows.rows.back().push_back(points[along == 0 ? k * data.count[1] + r : r * data.count[1] + k]);
  }
  edit(rows);
  NurbsSurfaceData made = data;
  made.degree[along] = rows.degree;
  made.knots[along] = rows.knots;
  made.count[along] = rows.rows[0].size();
  std::vector<Point4> all;
  for (std::size_t i = 0; i < made.count[0]; ++i)
    for (std::size_t j = 0; j < made.count[1]; ++j) all.push_back(along == 0 ? rows.rows[j][i] : rows.rows[i][j]);
  put_weighted(all, made.points, made.weights);
  return made;
}

}  // namespace

NurbsCurveData insert_knot(const NurbsCurveData& data, double t, int times) {
  return edit_curve(data, [&](Rows& rows) { insert_knots(rows, t, times); });
}
NurbsCurveData raise_degree(const NurbsCurveData& data) {
  return edit_curve(data, [](Rows& rows) { raise_rows(rows); });
}
NurbsCurveData clamp_ends(const NurbsCurveData& data) {
  return edit_curve(data, [](Rows& rows) { clamp_rows(rows); });
}
NurbsSurfaceData insert_knot(const NurbsSurfaceData& data, std::size_t along, double t, int times) {
  return edit_surface(data, along, [&](Rows& rows) { insert_knots(rows, t, times); });
}
NurbsSurfaceData raise_degree(const NurbsSurfaceData& data, std::size_t along) {
  return edit_surface(data, along, [](Rows& rows) { raise_rows(rows); });
}

void make_compatible(std::vector<NurbsCurveData>& curves) {
  int degree = 1;
  for (NurbsCurveData& curve : curves) {
    curve = clamp_ends(curve);
    const auto [low, high] = curve.range();
    for (double& knot : curve.knots) knot = knot == high ? 1 : (knot - low) / (high - low);
    degree = std::max(degree, curve.degree);
  }
  for (NurbsCurveData& curve : curves)
    while (curve.degree < degree) curve = raise_degree(curve);
  std::vector<double> all;  // the most often that any has it
  for (const NurbsCurveData& curve : curves) {
    std::vector<double> both;
    std::set_union(all.begin(), all.end(), curve.knots.begin(), curve.knots.end(), std::back_inserter(both));
    all = std::move(both);
  }
  for (NurbsCurveData& curve : curves)
    for (std::size_t i = 0; i < all.size(); ++i)
      if (i == 0 || all[i] != all[i - 1])
        if (const std::size_t wanted = multiplicity(all, all[i]), has = multiplicity(curve.knots, all[i]); has < wanted)
          curve = insert_knot(curve, all[i], int(wanted - has));
}

}  // namespace delfront
