// SPDX-License-Identifier: Apache-2.0
// Sizes follow from the true curvature at the points of a first, coarse grid: it is fine already where the geometry
// turns by more than a side may, so that its points and those along borders see every bend.
#include "pipeline/geometry_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "delfront/geometry_sizes.hpp"
#include "delfront/geometry_text.hpp"
#include "pipeline/boundaries.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {
namespace {

constexpr double kLargestShare = 0.05;  ///< of the diagonal, where no largest size is given
constexpr double kLeastShare = 1e-3;    ///< of the diagonal, from curvature, where no least size is given
constexpr double kCellsPerTurn = 18;
constexpr int kSamples = 24;  ///< along each edge, for the box

/// The same size everywhere.
class ConstantSize : public SizeField {
 public:
  explicit ConstantSize(double h) : h_(h) {}
  void sizes(std::span<const Point>, std::span<double> size) const override { std::fill(size.begin(), size.end(), h_); }
  double lower_bound(const Box&) const override { return h_; }
  double largest() const override { return h_; }

 private:
  double h_;
};

/// Of the edges, and of places within the loops' boxes where a face has no edge but its seam.
Box box_of(const Brep& brep) {
  Box box;
  for (const BrepFace& face : brep.faces)
    for (const auto& loop : face.loops) {
      Box in_plane;
      for (const BrepUse& use : loop) {
        const auto& range = brep.edges[use.edge].range;
        for (int i = 0; i <= kSamples; ++i) {
          const Point2 uv = use.curve->at(range[0] + (range[1] - range[0]) * i / kSamples);
          in_plane.add(Point{uv.x, uv.y, 0});
          box.add(face.surface->at(uv));
        }
      }
      if (&loop != &face.loops[0]) continue;
      const Point size = in_plane.high - in_plane.low;
      for (int i = 0; i <= kSamples; ++i)
        for (int j = 0; j <= kSamples; ++j)
          box.add(face.surface->at({in_plane.low.x + size.x * i / kSamples, in_plane.low.y + size.y * j / kSamples}));
    }
  return box;
}

CurvatureSizes curvature_wish(const SizeOptions& size, double hmin, double hmax) {
  CurvatureSizes wish;
  if (size.curvature > 0) wish.cells_per_turn = size.curvature;
  if (size.angle > 0) wish.angle_deg = size.angle;
  if (size.deviation) wish.deviation = size.deviation->value;
  if (!wish.cells_per_turn && !wish.angle_deg && !wish.deviation) wish.cells_per_turn = kCellsPerTurn;
  if (size.angle_form == "tangent") wish.form = CurvatureSizes::Form::tangent;
  wish.hmin = hmin;
  wish.hmax = hmax;
  return wish;
}

/// Sizes at places by what bends there.
class Bends {
 public:
  Bends(const CurvatureSizes& wish, double growth) : wish_(wish) {
    found_.growth = growth;
    found_.hmin = wish.hmin;
    found_.hmax = wish.hmax;
  }
  void add(const SurfaceDerivatives& s) { add(s.at, largest_curvature(s)); }
  void add(const CurveDerivatives& c) {
    const double speed = length(c.first);
    if (speed > 0) add(c.at, length(cross(c.first, c.second)) / (speed * speed * speed));
  }
  BoundarySizes take() { return std::move(found_); }

 private:
  void add(Point at, double curvature) {
    if (!(curvature > 0) || !is_finite(at)) return;
    const double h = std::max(size_on_radius(1 / curvature, wish_), wish_.hmin);
    if (!(h < wish_.hmax)) return;
    found_.points.push_back(at);
    found_.size.push_back(h);
  }
  CurvatureSizes wish_;
  BoundarySizes found_;
};

BoundarySizes find_bends(const Brep& brep, const std::vector<VertexEntity>& points, Bends bends) {
  std::vector<std::vector<double>> along(brep.edges.size());
  for (const VertexEntity& p : points) {
    if (p.dimension == 1) along[p.id].push_back(p.u);
    if (p.dimension == 2) bends.add(brep.faces[FaceId(std::size_t(p.id))].surface->derivatives({p.u, p.v}));
  }
  for (std::size_t e = 0; e < along.size(); ++e) {
    const BrepEdge& edge = brep.edges[EdgeId(e)];
    along[e].insert(along[e].end(), {edge.range[0], edge.range[1]});
    std::sort(along[e].begin(), along[e].end());
    for (std::size_t i = along[e].size() - 1; i > 0; --i) along[e].push_back(0.5 * (along[e][i] + along[e][i - 1]));
    if (!edge.is_degenerate())
      for (const double t : along[e]) bends.add(edge.curve->derivatives(t));
  }
  for (const BrepFace& face : brep.faces)
    for (const auto& loop : face.loops)
      for (const BrepUse& use : loop)
        for (const double t : along[use.edge.index()]) bends.add(face.surface->derivatives(use.curve->at(t)));
  return bends.take();
}

/// The first of each kind, and how many more there are.
void tell_notes(const std::vector<CadNote>& notes, const std::string& path, LogLevel level, Context& context) {
  std::map<std::string, std::size_t> count;
  for (const CadNote& note : notes) ++count[note.kind];
  for (const CadNote& note : notes) {
    const std::size_t all = std::exchange(count[note.kind], 0);
    if (all == 0) continue;
    context.log(level, fmt::format("{}: {}{}", path, note.message,
                                   all > 1 ? fmt::format(" (and {} more of this kind)", all - 1) : ""));
  }
}

void tell(const CadReport& cad, const std::string& path, Context& context) {
  tell_notes(cad.repairs, path, LogLevel::info, context);
  tell_notes(cad.suspicious, path, LogLevel::warning, context);
  if (cad.free_edges > 0)
    context.warn(
        fmt::format("{}: {} edges bound one face only: the surface is open there, and bounds no volume unless "
                    "something else closes it (the surface alone: --stop-after surface)",
                    path, cad.free_edges));
}

}  // namespace

std::shared_ptr<const SizeField> geometry_sizes(const Brep& brep, const Options& options,
                                                std::shared_ptr<const SizeField> asked, Context& context) {
  check_brep(brep);
  const double diagonal = box_of(brep).diagonal();
  const SizeOptions& size = options.size;
  const double hmax = size.hmax                             ? size.hmax->value
                      : asked && has_field_everywhere(size) ? diagonal
                                                            : size.steeper * kLargestShare * diagonal;
  const double hmin = std::min(hmax, size.hmin ? size.hmin->value : kLeastShare * diagonal);
  BrepGridReport first;
  Context quiet;  // a look only
  quiet.threads = context.threads;
  BrepOptions how;
  how.checks_crossings = false;
  grid_brep(brep, ConstantSize(std::max(hmin, std::min(hmax, kLargestShare * diagonal))), how, first, quiet);
  const double growth = size.growth.value_or(kDefaultGrowth);
  BoundarySizes bends = find_bends(brep, first.entity, Bends(curvature_wish(size, hmin, hmax), growth));
  std::vector<std::shared_ptr<const SizeField>> parts = {std::make_shared<ConstantSize>(hmax), std::move(asked)};
  if (!bends.points.empty()) parts.push_back(build_boundary_size_field(bends, context));
  return combine_size_fields(std::move(parts), size.hmin ? hmin : 0, hmax);
}

Mesh grid_to_look_at(const Brep& brep, Context& context, BrepGridReport& report) {
  const Options usual;
  return grid_geometry(brep, *geometry_sizes(brep, usual, nullptr, context), usual, context, report);
}

Mesh grid_geometry(const Brep& brep, const SizeField& size, const Options& options, Context& context,
                   BrepGridReport& report) {
  BrepOptions how;
  if (options.surface.method == "front") how.method = BrepOptions::Method::direct;
  return surface_mesh(grid_brep(brep, size, how, report, context));
}

bool is_smooth_file(const std::string& path) { return is_geometry_file(path) || is_cad_file(path); }

Brep read_brep(const std::string& path, Context& context, CadReport& cad) {
  Brep brep;
  if (is_cad_file(path)) {
    brep = read_cad(path, {}, cad, context);
    tell(cad, path, context);
  } else {
    brep = build_brep(read_geometry(path), path);
  }
  for (BrepFace& face : brep.faces)
    if (face.name.empty()) face.name = geometry_stem(path);
  return brep;
}

std::string geometry_stem(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (is_cad_file(path)) return std::filesystem::path(path).stem().string();
  return name.substr(0, name.size() - std::string(kGeometrySuffix).size());
}

}  // namespace delfront
