// SPDX-License-Identifier: Apache-2.0
// Point sets: hull, Delaunay and regular tetrahedrization, Dirichlet cells. docs/points.md shows this file.
#include <cmath>
#include <cstdio>
#include <vector>

#include "delfront/delaunay.hpp"
#include "delfront/dirichlet.hpp"
#include "delfront/io.hpp"

int main(int argc, char** argv) {
  using namespace delfront;
  std::vector<Point> points;  // evenly spread in the unit box
  for (int i = 1; i <= 2000; ++i) {
    const auto part = [&](double step) { return i * step - std::floor(i * step); };
    points.push_back({part(0.8191725134), part(0.6710436067), part(0.5497004779)});
  }
  try {
    Context context;
    context.threads = 2;
    const Tetrahedrization tets = delaunay(points, context);
    std::printf("%zu tets, %zu triangles on the hull\n", tets.tets.size(), tets.hull.size());

    std::vector<double> weights(points.size(), 0.0);
    weights[250] = 0.2 * 0.2;  // a ball of radius 0.2 round one of them
    std::printf("%zu points hidden by it\n", regular(points, weights, context).hidden.size());

    const DirichletCells cells = dirichlet(points, context, Box{{0, 0, 0}, {1, 1, 1}});
    double sum = 0;
    for (const double volume : cells.volumes) sum += volume;
    std::printf("%zu faces, volumes sum to %.12f\n", cells.num_faces(), sum);
    write_mesh(mesh_of(cells), argc > 1 ? argv[1] : "cells.vtu", context);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.exit_code);
  }
}
