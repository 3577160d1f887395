// SPDX-License-Identifier: Apache-2.0
#include "planar/far_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/enclose.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {

namespace {

constexpr double kFewestOnCircle = 16;
constexpr double kMostSegments = 5e7;

double mean_segment(const PlanarDomain& domain) {
  double sum = 0;
  for (const auto& [a, b] : domain.segments)
    sum += std::hypot(domain.points[a].x - domain.points[b].x, domain.points[a].y - domain.points[b].y);
  return sum / static_cast<double>(std::max<std::size_t>(domain.segments.size(), 1));
}

std::vector<Point2> make_circle(Point2 centre, double radius, double h) {
  const double n = std::max(kFewestOnCircle, std::round(2 * std::numbers::pi * radius / h));
  std::vector<Point2> loop;
  for (double i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    loop.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return loop;
}

std::vector<Point2> make_box(Point2 low, Point2 high, double h) {
  const Point2 corner[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
  std::vector<Point2> loop;
  for (int side = 0; side < 4; ++side) {
    const Point2 a = corner[side], b = corner[(side + 1) % 4];
    const double n = std::max(1.0, std::round(std::hypot(b.x - a.x, b.y - a.y) / h));
    for (double i = 0; i < n; ++i) loop.push_back({a.x + (b.x - a.x) * (i / n), a.y + (b.y - a.y) * (i / n)});
  }
  return loop;
}

void check_encloses(const PlanarDomain& domain, const std::vector<Point2>& loop, Point2 centre) {
  // Enough: every point nearer to the centre than the nearest line of the loop, or inside of the box itself.
  for (std::size_t v = 0; v < domain.points.size(); ++v) {
    const Point2 p = domain.points[VertexId(v)];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Point2 a = loop[i], b = loop[(i + 1) % loop.size()];
      if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0) continue;
      throw InputError(
          fmt::format("the far field round ({:g}, {:g}) does not enclose the input: ({:g}, {:g}) is on it or outside; "
                      "make it larger",
                      centre.x, centre.y, p.x, p.y),
          {{{p.x, p.y, 0}, {static_cast<std::uint32_t>(v)}}});
    }
  }
}

/// What growth from the body's mean segment makes of the distance to the far field.
double side_by_growth(const PlanarDomain& domain, const SizeOptions& sizes, double distance) {
  const double growth = growth_asked(sizes), h = mean_segment(domain);
  const double grown = std::max(h, (distance * (growth - 1) + h) / growth);
  return sizes.hmax ? std::min(grown, sizes.hmax->value) : grown;
}

std::string unused_name(const PlanarDomain& domain, const std::string& wanted) {
  std::string name = wanted;
  const auto is_taken = [&](const PlanarCurve& curve) { return curve.name == name; };
  for (int k = 2; std::any_of(domain.curves.begin(), domain.curves.end(), is_taken); ++k)
    name = fmt::format("{}_{}", wanted, k);
  return name;
}

/// The outer line of the domain, and how far it is from what it encloses.
struct Outline2 {
  Point2 centre, low, high;  ///< low and high: of a box
  double reach = 0;          ///< radius, or shortest half side
  bool is_box = false;
};

Outline2 outline_of(const Box& box, const EncloseOptions& options, const LengthScale& scale) {
  Outline2 outline;
  outline.is_box = options.shape == "box";
  outline.centre = {box.centre().x, box.centre().y};
  if (outline.is_box && options.corners) {
    const auto& c = *options.corners;
    outline.low = {c[0], c[1]};
    outline.high = {c[3], c[4]};
    outline.reach = 0.5 * std::min(c[3] - c[0], c[4] - c[1]);
    return outline;
  }
  const double size = to_model_units(options.size, scale);
  if (!(size > 0 && std::isfinite(size)))
    throw UsageError(fmt::format("enclose: the {} is {:g}; it must be positive and finite",
                                 outline.is_box ? "half side" : "radius", size));
  outline.low = {outline.centre.x - size, outline.centre.y - size};
  outline.high = {outline.centre.x + size, outline.centre.y + size};
  outline.reach = size;
  return outline;
}

void append_loop(PlanarDomain& domain, const std::vector<Point2>& loop, CurveId curve) {
  const std::size_t first = domain.points.size();
  for (const Point2 p : loop) domain.points.push_back(p);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    domain.segments.push_back({VertexId(first + i), VertexId(first + (i + 1) % loop.size())});
    domain.curve_of_segment.push_back(curve);
  }
}

}  // namespace

CurveId add_far_field(PlanarDomain& domain, const EncloseOptions& options, const SizeOptions& sizes,
                      const LengthScale& scale, Context& context) {
  if (options.shape == "none") return {};
  Box box;
  for (const Point2 p : domain.points) box.add(Point{p.x, p.y, 0});
  const Outline2 outline = outline_of(box, options, scale);
  const double distance = std::max(outline.reach - 0.5 * box.longest_side(), 0.0);
  const double h = options.h ? to_model_units(*options.h, scale) : side_by_growth(domain, sizes, distance);
  if (!(h > 0) || outline.reach / h > kMostSegments)
    throw UsageError(fmt::format("enclose: sides of {:g} on the far field; ask for a larger h", h));
  const std::vector<Point2> loop =
      outline.is_box ? make_box(outline.low, outline.high, h) : make_circle(outline.centre, outline.reach, h);
  check_encloses(domain, loop, outline.centre);
  const std::string name = unused_name(domain, options.name);
  if (name != options.name)
    context.warn(fmt::format("the far field is called '{}', as the name '{}' is taken", name, options.name));
  const CurveId curve = domain.curves.next_id();
  domain.curves.push_back({name, "farfield"});
  append_loop(domain, loop, curve);
  return curve;
}

}  // namespace delfront
