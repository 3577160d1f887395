// SPDX-License-Identifier: Apache-2.0
#include "surface/region_fit.hpp"

namespace delfront {
namespace {

constexpr double kFarTooShort = 0.55, kFarTooLong = 1.5;  ///< of the wanted size, after the front
constexpr int kFlipPasses = 4, kMostFlipPasses = 100;

/// Sizes at points, asked for once; new points get those of their neighbours' mean.
class PointSizes {
 public:
  PointSizes(const RegionMesh& mesh, const SizeField& size) : mesh_(mesh), h_(mesh.num_points()) {
    size.sizes(mesh.points(), h_);
  }
  double wanted(std::uint32_t side) const {
    const auto [a, b] = mesh_.ends(side);
    return 0.5 * (h_[a] + h_[b]);
  }
  double ratio(std::uint32_t side) const {
    const auto [a, b] = mesh_.ends(side);
    return distance(mesh_.place(a), mesh_.place(b)) / wanted(side);
  }
  void add(double h) { h_.push_back(h); }

 private:
  const RegionMesh& mesh_;
  std::vector<double> h_;
};

}  // namespace

std::size_t fit_lengths(RegionMesh& mesh, const SurfaceSupport& support, const SizeField& size, double least,
                        double most) {
  PointSizes sizes(mesh, size);
  std::size_t count = 0;
  for (std::uint32_t s = 0; s < mesh.num_sides(); ++s) {
    if (!mesh.is_alive(s) || mesh.is_border(s) || sizes.ratio(s) >= least) continue;
    const auto [v, u] = mesh.ends(s);
    if (mesh.is_inner(v)) count += mesh.collapse(v, u, most * sizes.wanted(s));
  }
  const auto num_sides = static_cast<std::uint32_t>(mesh.num_sides());
  for (std::uint32_t s = 0; s < num_sides; ++s) {
    if (!mesh.is_alive(s) || mesh.is_border(s) || sizes.ratio(s) <= most) continue;
    const auto [a, b] = mesh.ends(s);
    const double length = distance(mesh.place(a), mesh.place(b));
    const auto foot =
        support.project(0.5 * (mesh.place(a) + mesh.place(b)), mesh.normal(s), mesh.foot(a), 0.5 * length);
    if (!foot.found()) continue;
    sizes.add(sizes.wanted(s));
    mesh.split(s, mesh.add_point(foot.at, foot.triangle));
    ++count;
  }
  return count;
}

void improve_region(RegionMesh& mesh, const SurfaceSupport& support, const SizeField& size, bool to_delaunay) {
  mesh.flip_to_delaunay(kFlipPasses);
  mesh.smooth(2);
  if (fit_lengths(mesh, support, size, kFarTooShort, kFarTooLong) > 0) mesh.flip_to_delaunay(kFlipPasses);
  mesh.smooth(2);
  mesh.flip_to_delaunay(kFlipPasses);
  mesh.smooth(1);
  mesh.flip_to_delaunay(to_delaunay ? kMostFlipPasses : kFlipPasses);
}

}  // namespace delfront
