// SPDX-License-Identifier: Apache-2.0
// Smooth geometry gridded: analytic shapes at several sizes, uniform and graded by 20, mapped and directly in space.
// Prints the table of docs/brep.md. Usage: brep_bench [largest number of triangles, 1e5] [name of one shape]
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>

#include "delfront/brep_shapes.hpp"
#include "delfront/errors.hpp"

namespace {

using namespace delfront;

/// h at the place, rising evenly to 20 h at the far end of the box; grading 1: uniform.
class LinearSize : public SizeField {
 public:
  LinearSize(double h, double grading, const Box& box) : h_(h), grading_(grading), box_(box) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    const double wide = box_.high.x - box_.low.x;
    for (std::size_t i = 0; i < at.size(); ++i)
      size[i] = h_ * (1 + (grading_ - 1) * std::abs(at[i].x - box_.low.x) / wide);
  }
  double lower_bound(const Box&) const override { return h_; }
  double largest() const override { return h_ * grading_; }

 private:
  double h_, grading_;
  Box box_;
};

std::array<std::array<Point, 4>, 4> wavy_patch() {
  std::array<std::array<Point, 4>, 4> b;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      b[i][j] = {double(i) + 0.3 * double(j % 2), double(j) - 0.2 * double(i * i) / 3, (i + j) % 2 ? 0.5 : -0.3};
  return b;
}

struct Shape {
  std::string name;
  Brep brep;
  Box box;
  double area;
};

Box box(double x, double y, double z) {
  Box b;
  b.add(Point{-x, -y, -z});
  b.add(Point{x, y, z});
  return b;
}

std::vector<Shape> shapes() {
  const double pi = M_PI;
  const SpaceFrame frame;
  std::vector<Shape> all;
  all.push_back({"sphere", make_sphere({0, 0, 0}, 1), box(1, 1, 1), 4 * pi});
  all.push_back({"torus", make_torus(frame, 2, 0.6), box(2.6, 2.6, 0.6), 4 * pi * pi * 1.2});
  all.push_back({"cylinder", make_cylinder(frame, 1, 3), box(1, 1, 3), 8 * pi});
  all.push_back({"cone", make_cone(frame, pi / 6, 2), box(1.155, 1.155, 2), 4 * pi});
  Box wavy;
  wavy.add(Point{0, -2, -1});
  wavy.add(Point{3.3, 3, 1});
  all.push_back({"bicubic", make_bicubic(wavy_patch()), wavy, 11});
  const SurfacePointer sphere = make_sphere_surface(frame, 1);
  all.push_back({"half sphere", make_rectangle_on(sphere, {{0, -pi / 2}, {pi, pi / 2}}), box(1, 1, 1), 2 * pi});
  Brep holed = make_bicubic(wavy_patch());
  cut_hole(holed, FaceId(std::size_t(0)), {0.5, 0.5}, 0.2, 0.15);
  all.push_back({"holed bicubic", std::move(holed), wavy, 10});
  return all;
}

/// Share of edges between 0.6 and 1.5 of the size at their middle, in percent.
double right_lengths(const Model& m, const SizeField& size) {
  std::vector<Point> middle;
  std::vector<double> side;
  for (const auto& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = m.points[t[k]], b = m.points[t[(k + 1) % 3]];
      middle.push_back(0.5 * (a + b));
      side.push_back(distance(a, b));
    }
  std::vector<double> h(side.size());
  size.sizes(middle, h);
  std::size_t right = 0;
  for (std::size_t i = 0; i < h.size(); ++i) right += side[i] >= 0.6 * h[i] && side[i] <= 1.5 * h[i];
  return 100.0 * double(right) / double(h.size());
}

void print_row(const Shape& shape, double grading, double h, BrepOptions::Method method) {
  const LinearSize size(h, grading, shape.box);
  BrepOptions options;
  options.method = method;
  Context context;
  BrepGridReport r;
  Model model;
  const std::clock_t begin = std::clock();  // processor time: one thread, on a machine that others use too
  try {
    model = grid_brep(shape.brep, size, options, r, context);
  } catch (const Error& e) {
    std::printf("| %s | %g | failed: %s |\n", shape.name.c_str(), grading, e.what());
    return;
  }
  const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
  bool is_mapped = true;
  for (const BrepFaceReport& face : r.faces) is_mapped = is_mapped && face.is_mapped;
  std::printf("| %s | %g | %s | %zu | %.1f | %.1f | %zu | %.1f | %.2g | %.1f | %.0f |\n", shape.name.c_str(), grading,
              is_mapped ? "mapped" : "direct", r.triangles, r.min_angle_deg, r.mean_min_angle_deg, r.below_25_deg,
              right_lengths(model, size), r.largest_distance, r.largest_normal_angle_deg,
              1e-3 * double(r.triangles) / seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const double largest = argc > 1 ? std::atof(argv[1]) : 1e5;
  std::printf(
      "| shape | grading | way | triangles | smallest angle | mean of smallest | under 25 | right lengths | distance "
      "| normals | 1000 triangles/s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Shape& shape : shapes()) {
    if (argc > 2 && shape.name != argv[2]) continue;
    for (const auto method : {BrepOptions::Method::choose, BrepOptions::Method::direct})
      for (const double grading : {1.0, 20.0})
        for (double n = 1e4; n <= largest * 1.01; n *= 100) {
          if (method == BrepOptions::Method::direct && n > 1e4) continue;
          // triangles of side s have sqrt(3) / 4 s^2; a grading's mean of 1 / s^2 is about 1 / grading
          const double h = std::sqrt(shape.area / n / (std::sqrt(3.0) / 4) / grading);
          print_row(shape, grading, h, method);
        }
  }
}
