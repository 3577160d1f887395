// SPDX-License-Identifier: Apache-2.0
// The whole of gridding smooth geometry on one screen: points on edges, faces, checks, and again with smaller sizes
// where something failed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <unordered_map>

#include "base/parallel.hpp"
#include "brep/assemble_brep.hpp"
#include "brep/bridge.hpp"
#include "brep/edge_points.hpp"
#include "brep/face_bends.hpp"
#include "brep/face_mesh.hpp"
#include "brep/sharp_corners.hpp"
#include "brep/vague_normals.hpp"
#include "delfront/errors.hpp"
#include "geometry/angles.hpp"
#include "geometry/surface_findings.hpp"
#include "surface/working_size.hpp"

namespace delfront {
namespace {

constexpr double kLowerShare = 0.5;  ///< of the size where a grid failed
constexpr double kShortShare = 0.8;  ///< of the wanted size: sides of edges that lower sizes round them
constexpr double kGrowth = 1.4;      ///< of sizes round those
constexpr std::size_t kPlacesOfFace = 200;
constexpr double kPlane = 1e-9;              ///< difference between unit normals of a plane
constexpr double kNeedleDeg = 20;            ///< in sharp corners, below: their first sides become longer
constexpr double kFairAngleDeg = 15;         ///< below, another way is tried
constexpr std::size_t kMostForDirect = 300;  ///< points of a border: beyond, the direct way takes seconds
constexpr int kFolded = 4;                   ///< failures of a face until its triangles may face against its surface
constexpr int kTooOften = 2;                 ///< failures of a face until even charts are not asked any more
constexpr int kAllOver = 3;                  ///< failures of a face until its sizes are lowered all over it

class BrepGridder {
 public:
  BrepGridder(const Brep& brep, const SizeField& size, const BrepOptions& options, BrepGridReport& report,
              Context& context)
      : brep_(brep),
        options_(options),
        report_(report),
        context_(context),
        working_(size, nullptr),
        wanted_(working_, options.most_turn_deg * kDegree, options.least_size),
        grids_(brep.faces.size()),
        failures_(brep.faces.size(), 0),
        has_failed_(brep.faces.size(), false) {
    wanted_.look_at(brep);
    lowered_.growth = kGrowth;
  }

  Model run() {
    for (report_.rounds = 1; report_.rounds <= std::size_t(options_.most_rounds); ++report_.rounds) {
      context_.progress("surface", report_.rounds - 1, 0, "rounds");
      crossing_.clear();
      if (!grid_faces()) continue;
      const StageTimer timer(context_, "crossings");
      Model model = assemble();
      if (lengthen_sharp_sides(model)) continue;
      if (options_.checks_crossings && !mend_crossings(model)) continue;
      fill_report(model);
      return model;
    }
    if (!crossing_.empty()) throw InputError(crossing_, {{why_at_, {}}});
    if (is_border_wrong_) throw InputError(why_, {{why_at_, {}}});
    throw MeshingError(fmt::format("no valid grid was found: {}; lower the size there", why_), {{why_at_, {}}});
  }

 private:
  /// @return whether all have a grid
  bool grid_faces() {
    const StageTimer timer(context_, "surface");
    const Array<EdgeId, EdgePoints> before = edges_;
    if (is_lengthening_) {
      divide_anew([&](EdgeId e) { return is_divided_otherwise(e); });
    } else {
      keep_sizes();
      divide();
    }
    parallel_for(context_.threads, grids_.size(), [&](std::size_t f) {
      if (!takes_again(FaceId(f), before)) grid_face(FaceId(f));
    });
    is_lengthening_ = false;
    return mend_faces();
  }

  /// After a round that failed: sizes at the points of the faces that did not.
  void keep_sizes() {
    sizes_.assign(grids_.size(), {});
    if (report_.rounds == 1) return;
    parallel_for(context_.threads, grids_.size(), [&](std::size_t f) {
      if (!has_failed_[f]) sizes_[f] = sizes_at(grids_[FaceId(f)]);
    });
    has_failed_.assign(grids_.size(), false);
  }
  std::vector<double> sizes_at(const FaceGrid& grid) const {
    std::vector<Point> at;
    for (const FacePoint& p : grid.points) at.push_back(p.at);
    std::vector<double> size(at.size());
    working_.sizes(at, size);
    return size;
  }

  /// The last round's grid of a face, where neither its border nor the sizes at its points have changed.
  bool takes_again(FaceId f, const Array<EdgeId, EdgePoints>& before) {
    if (!is_lengthening_ && sizes_[f.index()].empty()) return false;
    std::unordered_map<std::uint32_t, std::uint32_t> number;
    for (const auto& loop : brep_.faces[f].loops)
      for (const BrepUse& use : loop) {
        const EdgePoints &was = before[use.edge], &is = edges_[use.edge];
        if (was.t != is.t || was.at != is.at) return false;
        for (std::size_t i = 0; i < was.vertex.size(); ++i) number[was.vertex[i]] = is.vertex[i];
      }
    FaceGrid& grid = grids_[f];
    if (!is_lengthening_ && sizes_at(grid) != sizes_[f.index()]) return false;
    for (FacePoint& p : grid.points)
      if (p.vertex != kNoVertex) p.vertex = number.at(p.vertex);
    return true;
  }

  Model assemble() {
    BrepGrid grid;
    const bool bridges = options_.bridge_below > 0 && is_bridged_;
    const bool keeps_parameters = options_.keeps_parameters || bridges;
    grid.model =
        assemble_brep(brep_, edges_, grids_, num_vertices_, grid.entity, keeps_parameters ? &grid.corner_uv : nullptr);
    report_.bridges.clear();
    if (bridges) report_.bridges = bridge_narrow_parts(brep_, options_.bridge_below, grid, context_);
    report_.entity = std::move(grid.entity);
    report_.corner_uv = options_.keeps_parameters ? std::move(grid.corner_uv) : std::vector<std::array<Point2, 3>>{};
    return std::move(grid.model);
  }

  /// In sharp corners with needles that could not be bridged, once each. @return whether there are any new ones
  bool lengthen_sharp_sides(const Model& model) {
    if (report_.rounds == std::size_t(options_.most_rounds)) return false;
    const std::size_t before = long_sided_.size();
    for (const CornerId c : find_needles_in_corners(brep_, model, report_.entity, kNeedleDeg)) long_sided_.insert(c);
    is_lengthening_ = long_sided_.size() > before;
    return is_lengthening_;
  }

  /// F3, twice: from sides that are shorter than asked for, sizes grow.
  void divide() {
    const auto all = [](EdgeId) { return true; };
    working_.lower(lowered_, context_);
    divide_anew(all);
    const BoundarySizes sizes = find_short_sides();
    if (sizes.points.size() == lowered_.points.size()) return;
    working_.lower(sizes, context_);
    divide_anew(all);
  }
  template <class Which>
  void divide_anew(const Which& which) {
    if (edges_.empty()) edges_ = Array<EdgeId, EdgePoints>(brep_.edges.size());
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (which(EdgeId(e))) edges_[EdgeId(e)].t.clear();
    divide_edges(brep_, wanted_, long_sided_, edges_, num_vertices_, context_);
    divided_long_sided_ = long_sided_;
  }
  bool is_divided_otherwise(EdgeId e) const {
    const auto& ends = brep_.edges[e].corners;
    return std::any_of(ends.begin(), ends.end(),
                       [&](CornerId c) { return long_sided_.contains(c) != divided_long_sided_.contains(c); });
  }

  /// Beside the places where sizes are lowered already.
  BoundarySizes find_short_sides() {
    std::vector<Point> at;
    std::vector<double> side;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (brep_.edges[EdgeId(e)].is_degenerate()) continue;
      const EdgePoints& points = edges_[EdgeId(e)];
      for (std::size_t i = 0; i + 1 < points.t.size(); ++i) {
        at.push_back(0.5 * (points.at[i] + points.at[i + 1]));
        side.push_back(distance(points.at[i], points.at[i + 1]));
      }
    }
    std::vector<double> asked(at.size());
    evaluate_sizes(working_, at, asked, context_);
    BoundarySizes sizes = lowered_;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (!(side[i] < kShortShare * asked[i])) continue;
      sizes.points.push_back(at[i]);
      sizes.size.push_back(std::max(side[i], options_.least_size));
    }
    return sizes;
  }

  /// In even charts; else on its plane, in charts that are far from lengths in space, or directly in space: the first
  /// with fair angles, or the best. Along long borders any chart comes before the direct way.
  void grid_face(FaceId f) {
    const BrepFace& face = brep_.faces[f];
    FaceGrid& grid = grids_[f];
    FaceGrid border = make_face_border(brep_, face, edges_);
    const std::vector<std::uint64_t> kept_sides = kept_sides_of(border);
    // a surface that folds has no grid that faces as it does; whether one crosses itself is told exactly afterwards
    const bool gives_way = options_.checks_crossings && failures_[f.index()] >= kFolded;
    const double most_angle = gives_way ? 2 * std::numbers::pi : options_.normal_angle_deg * kDegree;
    const auto fill = [&](const auto& gridder) {
      grid = border;
      gridder();
      lift_small_angles(*face.surface, kept_sides, grid);
      check_face_grid(face, most_angle, tolerance_of(face), grid);
      return grid.gave_up.empty();
    };
    const auto map = [&](ChartWay way) {
      return fill([&] { grid_mapped(face, wanted_, options_, way, grid, context_); });
    };
    const bool is_direct = options_.method == BrepOptions::Method::direct;
    const bool may_fold = turns_round(*face.surface, border);
    const bool is_mapped_only = options_.method == BrepOptions::Method::mapped;
    const bool tries_even = !is_direct && !may_fold && failures_[f.index()] < kTooOften;
    if ((is_mapped_only || tries_even) && (map(ChartWay::even) || is_mapped_only)) return;
    const FaceGrid first = grid.is_border_wrong ? grid : FaceGrid{};
    const std::string why = is_direct ? "asked for" : may_fold ? "its normals turn round" : grid.gave_up;
    mark_vague_normals(*face.surface, border);
    FaceGrid best;
    double best_angle = -1;
    const auto keeps = [&](bool is_done) {
      const double angle = is_done ? smallest_angle_of(grid) : -1;
      if (angle > best_angle) best = grid, best_angle = angle;
      return best_angle > kFairAngleDeg;
    };
    const bool is_mapped =
        !is_direct && (keeps(map(ChartWay::flat)) || keeps(map(ChartWay::cut_off)) || keeps(map(ChartWay::any)) ||
                       (best_angle >= 0 && border.points.size() > kMostForDirect));
    if (!is_mapped) keeps(fill([&] { grid_directly(brep_, face, edges_, wanted_, grid, context_); }));
    if (best_angle >= 0) grid = std::move(best);
    if (best_angle < 0 && first.is_border_wrong) grid = first;  // what other ways say is no better
    grid.why_direct = why.empty() ? "its grids in even charts failed" : why;
  }

  double tolerance_of(const BrepFace& face) const {
    double most = face.tolerance;
    for (const auto& loop : face.loops)
      for (const BrepUse& use : loop) most = std::max(most, brep_.edges[use.edge].tolerance);
    return most;
  }

  static double smallest_angle_of(const FaceGrid& grid) {
    double least = 180;
    for (const auto& t : grid.triangles)
      least = std::min(least, smallest_angle_deg(grid.points[t[0]].at, grid.points[t[1]].at, grid.points[t[2]].at));
    return least;
  }

  void lower_at(Point at) {
    lowered_.points.push_back(at);
    lowered_.size.push_back(kLowerShare * wanted_.asked().size(at));
    ++report_.sizes_lowered;
  }

  /// Once a face: sizes are lowered along bends that they do not know.
  /// @return whether there are any
  bool lower_along_bends(FaceId f) {
    const FaceGrid& grid = grids_[f];
    ParameterBox box{grid.points[0].uv, grid.points[0].uv};
    for (const FacePoint& p : grid.points) {
      box.low = {std::min(box.low.x, p.uv.x), std::min(box.low.y, p.uv.y)};
      box.high = {std::max(box.high.x, p.uv.x), std::max(box.high.y, p.uv.y)};
    }
    const std::size_t before = lowered_.points.size();
    find_bends(*brep_.faces[f].surface, box, wanted_, lowered_);
    report_.sizes_lowered += lowered_.points.size() - before;
    return lowered_.points.size() > before;
  }

  /// Sizes are lowered along the face's bends first, then at the place, each third time all over the face.
  void fail(FaceId f, const std::string& why, Point at) {
    const BrepFace& face = brep_.faces[f];
    why_ =
        face.name.empty() ? fmt::format("face {}: {}", f.value + 1, why) : fmt::format("face '{}': {}", face.name, why);
    why_at_ = at;
    is_border_wrong_ = grids_[f].is_border_wrong;
    has_failed_[f.index()] = true;
    if (++failures_[f.index()] == 1 && !is_border_wrong_ && lower_along_bends(f)) return;
    lower_at(at);
    const auto& points = grids_[f].points;
    if (failures_[f.index()] % kAllOver == 0)
      for (std::size_t i = 0; i < points.size(); i += points.size() / kPlacesOfFace + 1) lower_at(points[i].at);
  }

  bool mend_faces() {
    bool is_whole = true;
    for (std::size_t f = 0; f < grids_.size(); ++f) {
      const FaceGrid& grid = grids_[FaceId(f)];
      if (grid.gave_up.empty()) continue;
      is_whole = false;
      fail(FaceId(f), grid.gave_up, grid.gave_up_at);
    }
    return is_whole;
  }

  /// What is wrong with the surface as a whole: triangles that do not meet in common corners and sides alone.
  std::vector<Finding> find_crossings(const Model& model) {
    const Surface surface(model);
    std::vector<Finding> findings;
    find_bad_triangles(surface, findings);
    find_intersections(surface, findings, context_);
    std::erase_if(findings, [](const Finding& finding) { return finding.severity != Severity::error; });
    return findings;
  }

  /// Sizes are lowered where triangles cross; but first bridges are left out, and bends that ask for sides far below
  /// the sizes are left alone, as surfaces may cross by less than such sides: at lips, and where a tolerance says that
  /// they meet.
  /// @return whether there was nothing to mend
  bool mend_crossings(Model& model) {
    std::vector<Finding> findings = find_crossings(model);
    if (!findings.empty() && !report_.bridges.empty()) {
      is_bridged_ = false;
      model = assemble();
      findings = find_crossings(model);
    }
    if (!findings.empty() && wanted_.forgo_fine_bends()) {
      has_failed_.assign(grids_.size(), true);
      return false;
    }
    std::vector<bool> is_done(grids_.size(), false);
    for (const Finding& finding : findings)
      for (const Place& place : finding.places)
        for (const std::uint32_t f : place.ids) {
          if (f >= is_done.size() || is_done[f]) continue;
          is_done[f] = true;
          fail(FaceId(std::size_t(f)),
               finding.kind == "self_intersection" ? "its triangles cross, as the surface itself may do" : finding.kind,
               place.at);
        }
    note_crossing(findings);
    return findings.empty();
  }

  /// Faces without a common edge that meet: where that stays so however short sides get, the geometry is to blame.
  void note_crossing(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings)
      for (const Place& place : finding.places) {
        if (place.ids.size() != 2 || std::max(place.ids[0], place.ids[1]) >= grids_.size()) continue;
        const FaceId a(std::size_t(place.ids[0])), b(std::size_t(place.ids[1]));
        if (a == b || have_common_edge(brep_.faces[a], brep_.faces[b])) continue;
        crossing_ = fmt::format(
            "{} and {} cross or touch each other at ({:.6g}, {:.6g}, {:.6g}) without a common edge there; join their "
            "shapes "
            "where the geometry is made, or move them apart",
            name_of(a), name_of(b), place.at.x, place.at.y, place.at.z);
        why_at_ = place.at;
        if (is_plane(a) && is_plane(b)) throw InputError(crossing_, {{why_at_, {}}});  // at any size
        return;
      }
  }

  bool is_plane(FaceId f) const {
    const SmoothSurface& surface = *brep_.faces[f].surface;
    const auto& points = grids_[f].points;
    const Point first = surface.normal(points[0].uv);
    return std::all_of(points.begin(), points.end(),
                       [&](const FacePoint& p) { return length(surface.normal(p.uv) - first) < kPlane; });
  }

  static bool have_common_edge(const BrepFace& a, const BrepFace& b) {
    std::set<EdgeId> edges;
    for (const auto& loop : a.loops)
      for (const BrepUse& use : loop) edges.insert(use.edge);
    for (const auto& loop : b.loops)
      for (const BrepUse& use : loop)
        if (edges.contains(use.edge)) return true;
    return false;
  }

  std::string name_of(FaceId f) const {
    const std::string& name = brep_.faces[f].name;
    return name.empty() ? fmt::format("face {}", f.value + 1) : fmt::format("face {} ('{}')", f.value + 1, name);
  }

  void fill_report(const Model& m) {
    BrepGridReport& r = report_;
    r.triangles = m.triangles.size();
    r.points = m.points.size();
    r.faces.assign(grids_.size(), {});
    for (std::size_t f = 0; f < grids_.size(); ++f) {
      const FaceGrid& grid = grids_[FaceId(f)];
      r.faces[f].name = brep_.faces[FaceId(f)].name;
      r.faces[f].is_mapped = grid.is_mapped;
      r.faces[f].why = grid.why_direct;
      r.largest_distance = std::max(r.largest_distance, grid.largest_distance);
      r.largest_normal_angle_deg = std::max(r.largest_normal_angle_deg, grid.largest_angle / kDegree);
      if (grid.is_folded)
        context_.log(
            LogLevel::warning,
            fmt::format("face '{}' folds over itself in its parameters: it is gridded on its plane", r.faces[f].name));
      if (grid.largest_angle > options_.normal_angle_deg * kDegree)
        context_.log(LogLevel::warning,
                     fmt::format("face '{}' folds: triangles of it differ from its normals by up to {:.0f} degrees; "
                                 "nothing crosses, but look at it",
                                 r.faces[f].name, grid.largest_angle / kDegree));
    }
    SmallestAngles angles;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const auto& [a, b, c] = m.triangles[TriangleId(t)];
      const double least = smallest_angle_deg(m.points[a], m.points[b], m.points[c]);
      angles.add(least);
      BrepFaceReport& face = r.faces[m.input_face[TriangleId(t)]];
      ++face.triangles;
      face.min_angle_deg = std::min(face.min_angle_deg, least);
    }
    r.min_angle_deg = angles.min_deg;
    r.mean_min_angle_deg = angles.mean_deg();
    r.below_25_deg = angles.below_25_deg;
  }

  const Brep& brep_;
  const BrepOptions& options_;
  BrepGridReport& report_;
  Context& context_;
  WorkingSize working_;
  WantedSize wanted_;
  BoundarySizes lowered_;
  std::set<CornerId> long_sided_;          ///< sharp corners whose first sides are longer than sizes say
  std::set<CornerId> divided_long_sided_;  ///< the same, when edges were divided
  bool is_lengthening_ = false;            ///< this round changes nothing but those sides
  Array<EdgeId, EdgePoints> edges_;
  Array<FaceId, FaceGrid> grids_;
  std::vector<int> failures_;
  std::vector<bool> has_failed_;            ///< by face: in the last round
  std::vector<std::vector<double>> sizes_;  ///< by face: at its points in the last round; empty: it failed
  std::size_t num_vertices_ = 0;
  bool is_bridged_ = true;  ///< where that is asked for; no longer where bridges made triangles cross
  std::string crossing_;    ///< faces that the last round found to cross
  std::string why_;
  bool is_border_wrong_ = false;  ///< what why_ says is about a border as given
  Point why_at_;
};

}  // namespace

Model grid_brep(const Brep& brep, const SizeField& size, const BrepOptions& options, BrepGridReport& report,
                Context& context) {
  check_floating_point_mode();
  report = {};
  check_brep(brep);
  return BrepGridder(brep, size, options, report, context).run();
}

}  // namespace delfront
