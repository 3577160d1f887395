// SPDX-License-Identifier: Apache-2.0
// A tetrahedron from four triangles to a grid.
#include <cstdio>

#include "delfront/generate.hpp"

int main() {
  using namespace delfront;
  Model model;
  for (const Point p : {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}}) model.points.push_back(p);
  const std::size_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  model.patches.push_back({"wall", "wall"});
  for (std::size_t f = 0; f < 4; ++f) {
    model.triangles.push_back({VertexId(faces[f][0]), VertexId(faces[f][1]), VertexId(faces[f][2])});
    model.patch_of_triangle.push_back(PatchId(std::size_t{0}));
    model.input_face.push_back(static_cast<std::uint32_t>(f));
  }
  try {
    Context context;
    const Outcome made = generate(std::move(model), {}, context);
    std::printf("volume %.6f\n", made.report.quality.volume);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.exit_code);
  }
}
