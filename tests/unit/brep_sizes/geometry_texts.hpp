// SPDX-License-Identifier: Apache-2.0
// Geometry that is turned, moved and scaled as a whole: wings, prisms, cans, tori, written as text.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "delfront/brep_shapes.hpp"
#include "delfront/geometry_text.hpp"

namespace delfront::fixtures {

inline constexpr double kTau = 2 * std::numbers::pi;

struct Placing {
  double scale = 1;
  SpaceFrame frame;

  Point at(Point p) const { return frame.to_space(scale * p); }
  std::string place(Point p) const { return text(at(p)); }
  std::string way(Point p) const { return text(frame.turn(p)); }
  static std::string text(Point p) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", p.x, p.y, p.z); }
};

/// @brief Turned by angles that no axis fits.
inline Placing odd_placing(double scale = 1) {
  Placing p;
  const double a = 0.7, b = 0.4;
  p.scale = scale;
  p.frame.x = {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
  p.frame.y = {-std::sin(a), std::cos(a), 0};
  p.frame.z = cross(p.frame.x, p.frame.y);
  p.frame.origin = scale * Point{0.3, -2, 1.1};
  return p;
}

inline Brep brep_of(const std::string& text) { return build_brep(parse_geometry(text, "test"), "test"); }

/// @brief A polygon in the plane z = 0, anticlockwise, drawn up to a height.
inline std::string prism_text(const std::vector<Point2>& polygon, double height, const Placing& to = {}) {
  std::string text;
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t i, double z) { return Point{polygon[i % n].x, polygon[i % n].y, z}; };
  std::string low, high;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    text += fmt::format("[[corner]]\nname = \"a{}\"\nat = {}\n[[corner]]\nname = \"b{}\"\nat = {}\n", i,
                        to.place(at(i, 0)), i, to.place(at(i, height)));
    text += fmt::format("[[edge]]\nname = \"low{0}\"\ntype = \"line\"\nfrom = \"a{0}\"\nto = \"a{1}\"\n", i, j);
    text += fmt::format("[[edge]]\nname = \"high{0}\"\ntype = \"line\"\nfrom = \"b{0}\"\nto = \"b{1}\"\n", i, j);
    text += fmt::format("[[edge]]\nname = \"up{0}\"\ntype = \"line\"\nfrom = \"a{0}\"\nto = \"b{0}\"\n", i);
    const Point along = at(j, 0) - at(i, 0);
    text += fmt::format("[[surface]]\nname = \"s{}\"\ntype = \"plane\"\norigin = {}\naxis = {}\nx = {}\n", i,
                        to.place(at(i, 0)), to.way({along.y, -along.x, 0}), to.way(along));
    text += fmt::format(
        "[[face]]\nname = \"side{0}\"\nsurface = \"s{0}\"\nloops = [[\"low{0}\", \"up{1}\", \"-high{0}\", "
        "\"-up{0}\"]]\n",
        i, j);
    low += fmt::format("{}\"low{}\"", i ? ", " : "", i);
    high += fmt::format("{}\"high{}\"", i ? ", " : "", i);
  }
  text += fmt::format("[[surface]]\nname = \"floor\"\ntype = \"plane\"\norigin = {}\naxis = {}\nx = {}\n",
                      to.place({0, 0, 0}), to.way({0, 0, -1}), to.way({1, 0, 0}));
  text += fmt::format("[[surface]]\nname = \"roof\"\ntype = \"plane\"\norigin = {}\naxis = {}\nx = {}\n",
                      to.place({0, 0, height}), to.way({0, 0, 1}), to.way({1, 0, 0}));
  text += "[[face]]\nname = \"floor\"\nsurface = \"floor\"\nloops = [[" + low + "]]\n";
  text += "[[face]]\nname = \"roof\"\nsurface = \"roof\"\nloops = [[" + high + "]]\n";
  return text;
}

inline std::string box_text(double x, double y, double z, const Placing& to = {}) {
  return prism_text({{0, 0}, {x, 0}, {x, y}, {0, y}}, z, to);
}

/// @brief A unit box with a slot of that width, half deep, all through.
inline std::string slot_text(double width, const Placing& to = {}) {
  const double a = 0.5 - width / 2, b = 0.5 + width / 2;
  return prism_text({{0, 0}, {1, 0}, {1, 1}, {b, 1}, {b, 0.5}, {a, 0.5}, {a, 1}, {0, 1}}, 1, to);
}

/// @brief Chord 1, a section 12 % thick whose trailing edge is `blunt` thick, swept by 20 degrees.
inline std::string wing_text(double blunt, double span, const Placing& to = {}) {
  constexpr int kPoints = 61;
  const double slant = std::tan(kTau / 18) * span;
  const auto half = [&](double x) {
    const double sharp =
        0.6 * (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x);
    return sharp + 0.5 * blunt * x;
  };
  const auto section = [&](int i, double y, double nose) {
    const double t = std::numbers::pi * (2.0 * i / (kPoints - 1) - 1), x = std::pow(std::sin(t / 2), 2);
    return Point{nose + x, y, i == kPoints / 2 ? 0 : std::copysign(half(x), t)};
  };
  std::string rows[2];
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < kPoints; ++i) rows[k] += (i ? ", " : "") + to.place(section(i, k * span, k * slant));
  std::string text =
      "[[surface]]\nname = \"skin\"\ntype = \"interpolated\"\nsections = [[" + rows[0] + "], [" + rows[1] + "]]\n";
  const auto plane = [&](const char* name, Point origin, Point axis) {
    text += fmt::format("[[surface]]\nname = \"{}\"\ntype = \"plane\"\norigin = {}\naxis = {}\nx = {}\n", name,
                        to.place(origin), to.way(axis), to.way({0, 0, 1}));
  };
  plane("root plane", {0, 0, 0}, {0, -1, 0});
  plane("tip plane", {0, span, 0}, {0, 1, 0});
  plane("end plane", section(0, 0, 0), {span, -slant, 0});
  const auto on = [&](const char* name, const char* uv) {
    text += fmt::format("[[edge]]\nname = \"{}\"\ntype = \"on\"\nsurface = \"skin\"\nuv = {}\n", name, uv);
  };
  on("root", "[[0, 0], [1, 0]]");
  on("tip", "[[0, 1], [1, 1]]");
  on("lower end", "[[0, 0], [0, 1]]");
  on("upper end", "[[1, 0], [1, 1]]");
  for (int k = 0; k < 2; ++k) {
    const std::string name = k ? "tip end" : "root end";
    text += fmt::format("[[corner]]\nname = \"{0} low\"\nat = {1}\n[[corner]]\nname = \"{0} high\"\nat = {2}\n", name,
                        to.place(section(0, k * span, k * slant)), to.place(section(kPoints - 1, k * span, k * slant)));
    text += fmt::format("[[edge]]\nname = \"{0}\"\ntype = \"line\"\nfrom = \"{0} low\"\nto = \"{0} high\"\n", name);
  }
  const auto face = [&](const char* name, const char* surface, const char* loop) {
    text += fmt::format("[[face]]\nname = \"{}\"\nsurface = \"{}\"\nloops = [[{}]]\n", name, surface, loop);
  };
  face("wing", "skin", "\"root\", \"upper end\", \"-tip\", \"-lower end\"");
  face("trailing_edge", "end plane", "\"lower end\", \"tip end\", \"-upper end\", \"-root end\"");
  face("root", "root plane", "\"root\", \"-root end\"");
  face("tip", "tip plane", "\"tip\", \"-tip end\"");
  return text;
}

inline std::string can_text(double radius, double height, const Placing& to = {}) {
  return fmt::format(
      "[[shape]]\ntype = \"cylinder\"\norigin = {}\naxis = {}\nx = {}\nradius = {:.17g}\nheight = {:.17g}\n",
      to.place({0, 0, 0}), to.way({0, 0, 1}), to.way({1, 0, 0}), to.scale * radius, to.scale * height);
}

inline std::string torus_text(double radius, double tube, const Placing& to = {}) {
  return fmt::format("[[shape]]\ntype = \"torus\"\norigin = {}\naxis = {}\nx = {}\nradius = {:.17g}\ntube = {:.17g}\n",
                     to.place({0, 0, 0}), to.way({0, 0, 1}), to.way({1, 0, 0}), to.scale * radius, to.scale * tube);
}

}  // namespace delfront::fixtures
