// SPDX-License-Identifier: Apache-2.0
// The whole of re-gridding on one screen: parts, points on lines, the front on each region, checks, and again where
// something failed, with smaller sizes or given triangles there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "delfront/surface_grid.hpp"
#include "geometry/angles.hpp"
#include "geometry/surface_findings.hpp"
#include "surface/assemble.hpp"
#include "surface/region_check.hpp"
#include "surface/region_fit.hpp"
#include "surface/region_mesh.hpp"
#include "surface/remesh.hpp"
#include "surface/working_size.hpp"

namespace delfront {
namespace {

constexpr int kLowerings = 3;  ///< of sizes, before a region keeps its triangles
constexpr std::size_t kPlacesInRegion = 500;
constexpr double kLowerShare = 0.5;  ///< of the size where a grid failed
constexpr double kShortShare = 0.8;  ///< of the wanted size: sides of lines that lower sizes round them
constexpr double kGrowth = 1.4;      ///< of sizes round those
constexpr std::size_t kMostRounds = 30;

class Regridder {
 public:
  Regridder(const Model& model, const SizeField& size, const SurfaceOptions& options, SurfaceGridReport& report,
            Context& context)
      : model_(model),
        options_(options),
        report_(report),
        context_(context),
        size_(size, build_bend_guard(model, size, context)),
        parts_(model, size_, context) {}

  Model run();

 private:
  struct State {
    int failures = 0;
    bool is_kept = false;
    bool is_asked = false;  ///< to be kept
    bool is_due = true;
    bool is_remeshed = false;
    std::string why;
    Point at;
  };

  void start();
  void divide();
  void grid_regions();
  RegionGrid grid_region(std::uint32_t r) const;
  void remesh(std::uint32_t r);
  RegionGrid given_triangles(std::uint32_t r) const;
  bool mend_regions();
  bool mend_crossings(const AssembledSurface& made);
  void fail(std::uint32_t r, const std::string& why, Point at);
  void lower_at(Point at);
  void keep(std::uint32_t r);
  void make_due(std::uint32_t r);
  void lower_near_short_sides();
  void fill_report(const AssembledSurface& made) const;

  const Model& model_;
  const SurfaceOptions& options_;
  SurfaceGridReport& report_;
  Context& context_;
  WorkingSize size_;
  SurfaceParts parts_;
  std::vector<State> state_;
  std::vector<bool> line_is_due_, line_is_kept_;
  std::vector<std::vector<std::uint32_t>> regions_of_line_;
  LineDivision division_;
  LinePoints lines_;
  BoundarySizes lowered_;
  std::vector<std::unique_ptr<SurfaceSupport>> supports_;
  std::vector<RegionBorder> borders_;
  std::vector<RegionGrid> grids_;
  std::vector<RegionFit> fits_;
};

/// What has the same triangle twice cannot be told apart.
void refuse_bad_triangles(const Model& model) {
  std::vector<Finding> findings;
  find_bad_triangles(Surface(model), findings);
  for (Finding& finding : findings)
    if (finding.severity == Severity::error)
      throw InputError(finding.message + "; " + finding.remedy, std::move(finding.places));
}

void Regridder::start() {
  refuse_bad_triangles(model_);
  const std::size_t n = parts_.regions.size();
  state_.resize(n);
  supports_.resize(n);
  borders_.resize(n);
  grids_.resize(n);
  fits_.resize(n);
  line_is_due_.assign(parts_.lines.size(), true);
  line_is_kept_.assign(parts_.lines.size(), false);
  regions_of_line_.resize(parts_.lines.size());
  for (std::uint32_t r = 0; r < n; ++r)
    for (const RegionSide& side : parts_.regions[r].sides) regions_of_line_[side.line].push_back(r);
  std::vector<bool> is_alone = parts_.is_corner;  // given points on no line
  for (const SurfaceLine& line : parts_.lines)
    for (const VertexId v : line.vertices) is_alone[v.index()] = false;
  for (std::uint32_t r = 0; r < n; ++r) {
    const SurfaceRegion& region = parts_.regions[r];
    if (std::find(options_.kept.begin(), options_.kept.end(), region.patch) != options_.kept.end()) {
      keep(r);
      state_[r].is_asked = true;
    } else if (!region.is_simple) {
      state_[r].why = "a line has it on the same side twice";
      state_[r].at = parts_.corner(region.triangles[0], 0);
      keep(r);
    }
    for (const std::uint32_t t : region.triangles)
      for (std::size_t k = 0; k < 3 && !state_[r].is_kept; ++k) {
        if (!is_alone[model_.triangles[TriangleId(t)][k].index()]) continue;
        state_[r].why = "a point that the grid has to keep lies on it";
        state_[r].at = parts_.corner(t, k);
        keep(r);
      }
  }
  lowered_.growth = kGrowth;
}

/// A region keeps its triangles: its lines keep their points.
void Regridder::keep(std::uint32_t r) {
  state_[r].is_kept = true;
  for (const RegionSide& side : parts_.regions[r].sides) line_is_kept_[side.line] = true;
  make_due(r);
}

/// The region and its lines come anew, and so do the regions on the other sides of these.
void Regridder::make_due(std::uint32_t r) {
  state_[r].is_due = true;
  for (const RegionSide& side : parts_.regions[r].sides) {
    line_is_due_[side.line] = true;
    for (const std::uint32_t other : regions_of_line_[side.line]) state_[other].is_due = true;
  }
}

/// F3, and sizes that grow from where lines are divided more finely than asked for.
void Regridder::divide() {
  size_.lower(lowered_, context_);
  divide_lines(parts_, size_, line_is_due_, line_is_kept_, division_, context_);
  line_is_due_.assign(parts_.lines.size(), false);
  lines_ = make_line_points(parts_, division_, context_);
  lower_near_short_sides();
  for (std::uint32_t r = 0; r < borders_.size(); ++r)
    borders_[r] = find_border(parts_, parts_.regions[r], lines_, division_);
}

void Regridder::lower_near_short_sides() {
  std::vector<double> least(lines_.points.size(), std::numeric_limits<double>::infinity());
  for (const auto& chain : lines_.chain)
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      const double side = distance(lines_.points[chain[i]], lines_.points[chain[i + 1]]);
      for (const std::uint32_t p : {chain[i], chain[i + 1]}) least[p] = std::min(least[p], side);
    }
  std::vector<double> wanted(lines_.points.size());
  evaluate_sizes(size_, lines_.points, wanted, context_);
  BoundarySizes sizes = lowered_;
  for (std::size_t p = 0; p < least.size(); ++p) {
    if (!(least[p] < kShortShare * wanted[p])) continue;
    sizes.points.push_back(lines_.points[p]);
    sizes.size.push_back(least[p]);
  }
  size_.lower(sizes, context_);
}

RegionGrid Regridder::given_triangles(std::uint32_t r) const {
  const RegionBorder& border = borders_[r];
  RegionGrid grid;
  std::unordered_map<std::uint32_t, std::uint32_t> local;
  for (std::uint32_t i = 0; i < border.point.size(); ++i) {
    if (lines_.given[border.point[i]].is_valid()) local.emplace(lines_.given[border.point[i]].value, i);
    grid.points.push_back(border.at[i]);
  }
  grid.num_border = border.point.size();
  for (const std::uint32_t t : parts_.regions[r].triangles) {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = model_.triangles[TriangleId(t)][k];
      const auto [it, is_new] = local.try_emplace(v.value, static_cast<std::uint32_t>(grid.points.size()));
      if (is_new) grid.points.push_back(model_.points[v]);
      corners[k] = it->second;
    }
    grid.triangles.push_back(corners);
  }
  return grid;
}

RegionGrid Regridder::grid_region(std::uint32_t r) const {
  RegionGrid grid = SurfaceFront(*supports_[r], size_).grid(borders_[r], context_);
  if (!grid.gave_up.empty()) return grid;
  RegionMesh mesh(*supports_[r], std::move(grid));
  improve_region(mesh, *supports_[r], size_, options_.method == "delaunay");
  return mesh.take();
}

/// Each region by itself, so that they may be gridded by several threads.
void Regridder::grid_regions() {
  parallel_for(context_.threads, parts_.regions.size(), [&](std::size_t i) {
    const auto r = static_cast<std::uint32_t>(i);
    if (!state_[r].is_due) return;
    state_[r].is_due = false;
    if (state_[r].is_kept) {
      grids_[r] = given_triangles(r);
      fits_[r] = {};
      return;
    }
    if (!supports_[r]) supports_[r] = std::make_unique<SurfaceSupport>(parts_, parts_.regions[r]);
    grids_[r] = grid_region(r);
    fits_[r] = check_region(*supports_[r], borders_[r], grids_[r]);
    state_[r].is_remeshed = false;
    if (!grids_[r].gave_up.empty()) remesh(r);
  });
}

/// Where the front fails, the given triangles are changed locally.
void Regridder::remesh(std::uint32_t r) {
  RegionGrid grid = remesh_region(parts_, parts_.regions[r], *supports_[r], borders_[r], lines_, division_, size_);
  const RegionFit fit = check_region(*supports_[r], borders_[r], grid);
  if (!grid.gave_up.empty()) return;
  state_[r].is_remeshed = true;
  state_[r].why = grids_[r].gave_up;
  state_[r].at = grids_[r].gave_up_at;
  grid.steps = grids_[r].steps;
  grids_[r] = std::move(grid);
  fits_[r] = fit;
}

void Regridder::fail(std::uint32_t r, const std::string& why, Point at) {
  State& state = state_[r];
  if (state.is_kept) return;
  state.why = why;
  state.at = at;
  if (state.failures >= kLowerings) return keep(r);
  lower_at(at);
  if (state.failures > 0) {  // once more: not the place alone is too coarse
    const auto& triangles = parts_.regions[r].triangles;
    const std::size_t step = triangles.size() / kPlacesInRegion + 1;
    for (std::size_t i = 0; i < triangles.size(); i += step)
      lower_at((parts_.corner(triangles[i], 0) + parts_.corner(triangles[i], 1) + parts_.corner(triangles[i], 2)) /
               3.0);
  }
  ++state.failures;
  make_due(r);
}

void Regridder::lower_at(Point at) {
  lowered_.points.push_back(at);
  lowered_.size.push_back(kLowerShare * size_.size(at));
  ++report_.sizes_lowered;
}

/// @return whether all regions have grids
bool Regridder::mend_regions() {
  bool is_whole = true;
  for (std::uint32_t r = 0; r < grids_.size(); ++r) {
    report_.front_steps += grids_[r].steps;
    grids_[r].steps = 0;
    if (grids_[r].gave_up.empty()) continue;
    is_whole = false;
    fail(r, grids_[r].gave_up, grids_[r].gave_up_at);
  }
  return is_whole;
}

/// @return whether triangles meet in common corners and sides alone
bool Regridder::mend_crossings(const AssembledSurface& made) {
  const Surface surface(made.model);
  std::vector<Finding> findings;
  find_bad_triangles(surface, findings);
  find_intersections(surface, findings, context_);
  std::vector<bool> is_done(state_.size(), false);
  bool is_sound = true;
  for (const Finding& finding : findings) {
    if (finding.severity != Severity::error) continue;
    for (const Place& place : finding.places)
      for (const std::uint32_t t : place.ids) {
        const std::uint32_t r = made.region_of_triangle[t];
        is_sound = is_sound && state_[r].is_kept;
        if (is_done[r]) continue;
        is_done[r] = true;
        fail(r, finding.kind, place.at);
      }
  }
  return is_sound;
}

void Regridder::fill_report(const AssembledSurface& made) const {
  const Model& m = made.model;
  SurfaceGridReport& r = report_;
  r.regions = parts_.regions.size();
  r.lines = parts_.lines.size();
  r.corners = std::size_t(std::count(parts_.is_corner.begin(), parts_.is_corner.end(), true));
  r.triangles_given = model_.triangles.size();
  r.triangles = m.triangles.size();
  r.points = m.points.size();
  r.shortest_edge = std::numeric_limits<double>::infinity();
  r.patches.assign(m.patches.size(), {});
  for (std::size_t p = 0; p < m.patches.size(); ++p) r.patches[p].name = m.patches[PatchId(p)].name;
  for (const PatchId p : model_.patch_of_triangle) ++r.patches[p.index()].triangles_given;
  SmallestAngles angles;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& [v, w, x] = m.triangles[TriangleId(t)];
    const Point a = m.points[v], b = m.points[w], c = m.points[x];
    const auto [shortest, longest] = std::minmax({distance(a, b), distance(b, c), distance(c, a)});
    r.shortest_edge = std::min(r.shortest_edge, shortest);
    r.longest_edge = std::max(r.longest_edge, longest);
    const double least = smallest_angle_deg(a, b, c);
    angles.add(least);
    SurfacePatchReport& patch = r.patches[m.patch_of_triangle[TriangleId(t)].index()];
    ++patch.triangles;
    patch.min_angle_deg = std::min(patch.min_angle_deg, least);
  }
  r.min_angle_deg = angles.min_deg;
  r.mean_min_angle_deg = angles.mean_deg();
  r.below_25_deg = angles.below_25_deg;
  for (const RegionFit& fit : fits_)
    if (fit.distance > r.largest_distance) {
      r.largest_distance = fit.distance;
      r.largest_distance_at = fit.at;
    }
  for (std::size_t i = 0; i < state_.size(); ++i) {
    if (state_[i].is_asked || (!state_[i].is_kept && !state_[i].is_remeshed)) continue;
    r.fallbacks.push_back({state_[i].is_kept ? SurfaceFallback::Kind::kept : SurfaceFallback::Kind::remeshed,
                           m.patches[parts_.regions[i].patch].name, state_[i].at, state_[i].why});
  }
}

Model Regridder::run() {
  start();
  for (report_.rounds = 1; report_.rounds <= kMostRounds; ++report_.rounds) {
    context_.progress("surface", report_.rounds - 1, 0, "rounds");
    divide();
    grid_regions();
    if (!mend_regions()) continue;
    AssembledSurface made = assemble(parts_, lines_, borders_, grids_);
    if (!mend_crossings(made)) continue;
    fill_report(made);
    return std::move(made.model);
  }
  report_.fallbacks.push_back({SurfaceFallback::Kind::kept, "", {}, "no grid without faults was found"});
  report_.triangles = model_.triangles.size();
  report_.points = model_.points.size();
  return model_;
}

}  // namespace

Model regrid_surface(const Model& model, const SizeField& size, const SurfaceOptions& options,
                     SurfaceGridReport& report, Context& context) {
  report = {};
  if (options.method == "keep" || model.triangles.empty()) return model;
  const StageTimer timer(context, "surface");
  return Regridder(model, size, options, report, context).run();
}

}  // namespace delfront
