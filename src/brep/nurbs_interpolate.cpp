// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "brep/nurbs_basis.hpp"
#include "brep/nurbs_edit.hpp"
#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr std::size_t kBand = 3;

/// Chord lengths from 0 to 1 along rows of points, the mean of all rows; rows that are one point do not count.
std::vector<double> chord_parameters(const std::vector<std::vector<Point>>& rows, bool is_closed) {
  const std::size_t n = rows[0].size(), chords = is_closed ? n : n - 1;
  std::vector<double> sum(chords + 1, 0);
  std::size_t counted = 0;
  for (const std::vector<Point>& row : rows) {
    std::vector<double> at = {0};
    for (std::size_t i = 0; i < chords; ++i) at.push_back(at.back() + distance(row[i], row[(i + 1) % n]));
    if (!(at.back() > 0)) continue;
    ++counted;
    for (std::size_t i = 0; i <= chords; ++i) sum[i] += at[i] / at.back();
  }
  if (counted == 0) throw InputError("all points are the same; nothing goes through them");
  for (double& t : sum) t /= double(counted);
  sum.back() = 1;
  for (std::size_t i = 0; i < chords; ++i)
    if (!(sum[i] < sum[i + 1]))
      throw InputError(fmt::format("points {} and {} are the same; leave one out", i + 1, (i + 1) % n + 1));
  return sum;
}

/// Clamped, for as many control points as parameters; of a cubic none at the second and the last but one.
std::vector<double> knots_through(const std::vector<double>& at, std::size_t degree) {
  std::vector<double> knots(degree + 1, at.front());
  for (std::size_t j = 0; j + degree + 1 < at.size(); ++j)
    knots.push_back(degree % 2 == 1 ? at[j + (degree + 1) / 2] : 0.5 * (at[j + degree / 2] + at[j + degree / 2 + 1]));
  knots.insert(knots.end(), degree + 1, at.back());
  return knots;
}

/// A row that is one point stays one, to the bit: a pole.
bool is_one_point(const std::vector<Point4>& row) {
  return std::all_of(row.begin(), row.end(), [&](const Point4& p) { return (p == row[0]).all(); });
}

void solve_open(const std::vector<double>& at, const KnotLine& line, std::vector<Point4>& values) {
  if (is_one_point(values)) return;
  const std::size_t n = at.size(), p = std::size_t(line.degree());
  std::vector<std::vector<double>> rows(n, std::vector<double>(2 * kBand + 1, 0));
  for (std::size_t i = 0; i < n; ++i) {
    Basis b;
    const std::size_t span = line.span(at[i]);
    line.basis<0>(span, at[i], 0, b);
    for (std::size_t k = 0; k <= p; ++k) rows[i][span - p + k + kBand - i] = b.value[k];
  }
  const Point4 first = values.front(), last = values.back();
  solve_banded(rows, kBand, values);
  values.front() = first;  // to the bit
  values.back() = last;
}

/// Periodic: three diagonals and two corners, which Sherman's and Morrison's formula takes apart.
void solve_periodic(const std::vector<double>& at, const KnotLine& line, std::vector<Point4>& values) {
  if (is_one_point(values)) return;
  const std::size_t n = values.size();
  std::vector<std::vector<double>> rows(n, std::vector<double>(2 * kBand + 1, 0));
  for (std::size_t i = 0; i < n; ++i) {
    Basis b;
    line.basis<3>(i + 3, at[i], 0, b);
    for (std::size_t k = 0; k < 3; ++k) rows[i][kBand + k - 1] = b.value[k];
  }
  const double corner = rows[0][kBand - 1], other = rows[n - 1][kBand + 1], shift = -rows[0][kBand];
  rows[0][kBand - 1] = rows[n - 1][kBand + 1] = 0;
  rows[0][kBand] -= shift;
  rows[n - 1][kBand] -= corner * other / shift;
  std::vector<Point4> spread(n, Point4::Zero());
  spread[0] = Point4::Constant(shift);
  spread[n - 1] = Point4::Constant(other);
  std::vector<std::vector<double>> copy = rows;
  solve_banded(copy, kBand, spread);
  solve_banded(rows, kBand, values);
  const double part = corner / shift;
  const Point4 factor = (values[0] + part * values[n - 1]) / (1 + spread[0] + part * spread[n - 1]);
  for (std::size_t i = 0; i < n; ++i) values[i] -= factor * spread[i];
}

/// What rows of values become control points over.
struct Through {
  std::size_t degree;
  std::vector<double> knots;
};

/// @param at  parameters; of closed rows with the end of the period
Through interpolate_rows(const std::vector<double>& at, std::size_t degree, bool is_closed,
                         std::vector<std::vector<Point4>>& rows) {
  if (!is_closed) {
    Through through{std::min(degree, at.size() - 1), {}};
    through.knots = knots_through(at, through.degree);
    const KnotLine line(int(through.degree), through.knots);
    for (std::vector<Point4>& row : rows) solve_open(at, line, row);
    return through;
  }
  const std::size_t n = at.size() - 1;
  const double period = at[n] - at[0];
  Through through{3, {}};
  for (std::size_t k = 0; k < n + 7; ++k) {  // knot k is parameter k - 3, turned round
    const std::size_t i = k + 3 * n - 3;
    through.knots.push_back(at[i % n] + period * (double(i / n) - 3));
  }
  through.knots[n + 3] = at[n];
  const KnotLine line(3, through.knots);
  for (std::vector<Point4>& row : rows) {
    solve_periodic(at, line, row);
    std::rotate(row.begin(), row.end() - 1, row.end());
    for (std::size_t k = 0; k < 3; ++k) row.push_back(row[k]);
  }
  return through;
}

std::vector<Point4> as_point4(std::span<const Point> points) {
  std::vector<Point4> result;
  for (const Point& p : points) result.push_back(to_point4(p, 1));
  return result;
}

void check_count(std::size_t points, bool is_closed) {
  const std::size_t least = is_closed ? 3 : 2;
  if (points < least)
    throw InputError(fmt::format("{} point{} given; a {}curve goes through {} at least", points,
                                 points == 1 ? " is" : "s are", is_closed ? "closed " : "", least));
}

/// Across sections that have control points over common knots already.
NurbsSurfaceData join_sections(Through along, std::vector<std::vector<Point4>> sections, int degree_across) {
  std::vector<std::vector<Point4>> columns(sections[0].size());
  std::vector<std::vector<Point>> places(sections[0].size());
  for (const std::vector<Point4>& section : sections)
    for (std::size_t i = 0; i < section.size(); ++i) {
      columns[i].push_back(section[i]);
      places[i].push_back(to_point(section[i]) / section[i][3]);
    }
  if (degree_across < 1 || degree_across > 3)
    throw InputError(fmt::format("the degree across sections is {}; it can be 1, 2 or 3", degree_across));
  const Through across = interpolate_rows(chord_parameters(places, false), std::size_t(degree_across), false, columns);
  NurbsSurfaceData made;
  made.degree = {int(along.degree), int(across.degree)};
  made.knots = {std::move(along.knots), across.knots};
  made.count = {columns.size(), columns[0].size()};
  std::vector<Point4> all;
  for (const std::vector<Point4>& column : columns) all.insert(all.end(), column.begin(), column.end());
  put_weighted(all, made.points, made.weights);
  return made;
}

void check_sections(std::size_t sections) {
  if (sections < 2) throw InputError("a surface through sections needs two of them at least");
}

}  // namespace

NurbsCurveData interpolate_points(std::span<const Point> points, bool is_closed) {
  check_count(points.size(), is_closed);
  const std::vector<double> at = chord_parameters({{points.begin(), points.end()}}, is_closed);
  std::vector<std::vector<Point4>> rows = {as_point4(points)};
  Through through = interpolate_rows(at, 3, is_closed, rows);
  NurbsCurveData made;
  made.degree = int(through.degree);
  made.knots = std::move(through.knots);
  for (Point4& p : rows[0]) made.points.push_back(to_point(p));
  return made;
}

NurbsSurfaceData interpolate_sections(const std::vector<std::vector<Point>>& sections, bool is_closed,
                                      int degree_across) {
  check_sections(sections.size());
  std::vector<std::vector<Point4>> rows;
  for (const std::vector<Point>& section : sections) {
    check_count(section.size(), is_closed);
    if (section.size() != sections[0].size())
      throw InputError(fmt::format("section {} has {} points, the first has {}; give equally many", rows.size() + 1,
                                   section.size(), sections[0].size()));
    rows.push_back(as_point4(section));
  }
  Through along = interpolate_rows(chord_parameters(sections, is_closed), 3, is_closed, rows);
  for (std::vector<Point4>& row : rows)
    for (Point4& p : row) p[3] = 1;
  NurbsSurfaceData made = join_sections(std::move(along), std::move(rows), degree_across);
  made.weights.clear();  // all 1 but for rounding
  return made;
}

NurbsSurfaceData loft(std::vector<NurbsCurveData> sections, int degree_across) {
  check_sections(sections.size());
  make_compatible(sections);
  const bool is_rational = std::any_of(sections.begin(), sections.end(),
                                       [](const NurbsCurveData& section) { return !section.weights.empty(); });
  std::vector<std::vector<Point4>> rows;
  for (const NurbsCurveData& section : sections) rows.push_back(weighted(section.points, section.weights));
  NurbsSurfaceData made =
      join_sections({std::size_t(sections[0].degree), sections[0].knots}, std::move(rows), degree_across);
  if (!is_rational) made.weights.clear();
  check_nurbs(made);
  return made;
}

}  // namespace delfront
