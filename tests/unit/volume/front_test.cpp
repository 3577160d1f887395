// SPDX-License-Identifier: Apache-2.0
// The pure front: its crossing test against all pairs, its grids, sizes, threads. That every recovered test surface is
// filled by it is tested where those are (expect_recovered).
#include "volume/front.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "delfront/size_field.hpp"
#include "delfront/surface_check.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "support/tet_fixtures.hpp"
#include "tetra/quality.hpp"
#include "volume/front_neighbourhood.hpp"
#include "volume/front_store.hpp"

namespace delfront {
namespace {

using fixtures::box_facets;
using fixtures::Facets;

/// Rises with the distance from a place, between two bounds.
class Funnel : public SizeField {
 public:
  Funnel(Point at, double least, double slope, double most) : at_(at), least_(least), slope_(slope), most_(most) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = std::clamp(slope_ * distance(at[i], at_), least_, most_);
  }
  double lower_bound(const Box&) const override { return least_; }

 private:
  Point at_;
  double least_, slope_, most_;
};

BoundaryGrid recovered(const Model& model) {
  Context context;
  RecoveryReport report;
  return tetrahedralize_boundary(model, DomainOptions(), std::vector<bool>(model.patches.size(), false), report,
                                 context);
}

Model sphere(int levels) { return fixtures::to_model(fixtures::sphere_facets(levels)); }

/// A tet over a face of the front, corners by number (kNoIndex: a new point).
struct TestTet {
  std::array<VertexIndex, 4> id;
  std::array<Point, 4> at;
};

/// The definition: whether the tet and a face of the front have more in common than a common corner, edge or face, or
/// are one face seen from the same side. Every pair is intersected exactly.
bool crosses(const TestTet& t, const FrontStore& front, std::uint32_t g) {
  const TetComplex& c = front.complex();
  const auto n = front.nodes(g);
  const Point p[3] = {c.point(n[0]), c.point(n[1]), c.point(n[2])};
  const unsigned p_id[3] = {n[0], n[1], n[2]};
  for (unsigned side = 0; side < 4; ++side) {
    const auto& k = kFaceNodes[side];
    const Point q[3] = {t.at[k[0]], t.at[k[1]], t.at[k[2]]};
    const unsigned q_id[3] = {t.id[k[0]], t.id[k[1]], t.id[k[2]]};
    if (std::is_permutation(p_id, p_id + 3, q_id))
      return orient3d(p[0], p[1], p[2], t.at[side]) < 0 && front.find({n[0], n[2], n[1]}) == kNoIndex;
    if (classify_triangles(p, p_id, q, q_id, nullptr) != Crossing::none) return true;
  }
  for (unsigned i = 0; i < 3; ++i) {
    if (std::find(t.id.begin(), t.id.end(), n[i]) != t.id.end()) continue;
    bool inside = true;
    for (const auto& k : kFaceNodes) inside = inside && orient3d(t.at[k[0]], t.at[k[1]], t.at[k[2]], p[i]) > 0;
    if (inside) return true;
  }
  return false;
}

/// The same for what is embedded and has no tet yet.
bool meets_obstacle(const TestTet& t, const FrontStore& front) {
  const auto at = [&](VertexIndex v) { return NumberedPoint{v, front.complex().point(v)}; };
  const FrontObstacles& all = front.obstacles();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].is_pending() &&
        is_met_by_tet({at(all[i].a), at(all[i].b)},
                      {NumberedPoint{t.id[0], t.at[0]}, {t.id[1], t.at[1]}, {t.id[2], t.at[2]}, {t.id[3], t.at[3]}}))
      return true;
  return false;
}

struct Verdicts {
  int free = 0, crossing = 0;
};

/// Random tets over random faces of a front that takes those that fit, so that it gets as rugged as can be.
void compare_with_all_pairs(const Model& model, unsigned seed, int steps, Verdicts& verdicts) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  BoundaryGrid grid = recovered(model);
  FrontStore front(grid.complex);
  TetComplex& c = grid.complex;
  Neighbourhood near(front);
  const double h = 0.3 * model.bounding_box().longest_side();
  std::normal_distribution<double> off(0, h);
  for (int step = 0; step < steps; ++step) {
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < front.num_slots(); ++f)
      if (front.face(f).is_alive) faces.push_back(f);
    if (faces.empty()) break;
    const std::uint32_t f = faces[random() % faces.size()];
    near.start(f);
    for (const std::uint32_t g : faces)
      if (g != f) near.add_face(g);
    for (std::size_t i = 0; i < front.obstacles().size(); ++i)
      if (front.obstacles()[i].is_pending()) near.add_obstacle(front.obstacles()[i]);
    const auto n = front.nodes(f);
    const bool is_new = random() % 4 == 0;
    const std::size_t old = 3 + random() % std::max<std::size_t>(near.num_points() - 3, 1);
    const Point place = c.point(n[random() % 3]) + Point{off(random), off(random), off(random)};
    if (!is_new && old >= near.num_points()) continue;
    const Point apex = is_new ? place : c.point(near.id(old));
    if (orient3d(c.point(n[0]), c.point(n[1]), c.point(n[2]), apex) <= 0) continue;
    const TestTet t{{n[0], n[1], n[2], is_new ? kNoIndex : near.id(old)},
                    {c.point(n[0]), c.point(n[1]), c.point(n[2]), apex}};
    const bool expected =
        std::any_of(faces.begin(), faces.end(), [&](std::uint32_t g) { return g != f && crosses(t, front, g); }) ||
        meets_obstacle(t, front);
    const std::size_t at = is_new ? near.add_place(apex) : old;
    const bool is_free = near.test(at, 0, 1) == Neighbourhood::Verdict::free;
    ASSERT_EQ(is_free, !expected) << "step " << step << ", face " << f << (is_new ? ", a new point" : "");
    if (is_new) near.drop_place();
    ++(is_free ? verdicts.free : verdicts.crossing);
    if (!is_free) continue;
    FrontStock stock = front.take(1);
    std::vector<std::uint32_t> made;
    VertexIndex d = t.id[3];
    if (is_new) {
      d = stock.vertices.back();
      stock.vertices.pop_back();
      c.set_vertex(d, apex, h);
    }
    front.add_tet(f, d, stock, made);
    front.give(stock);
  }
}

TEST(FrontCrossing, agrees_with_all_pairs) {
  Verdicts verdicts;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    compare_with_all_pairs(sphere(1), seed, 300, verdicts);
    compare_with_all_pairs(fixtures::to_model(box_facets({0, 0, 0}, {1, 1, 1})), seed, 200, verdicts);
  }
  EXPECT_GT(verdicts.free, 200);
  EXPECT_GT(verdicts.crossing, 200);
}

TEST(FrontCrossing, agrees_with_all_pairs_where_much_is_flat_or_shared) {
  Facets rooms = box_facets({0, 0, 0}, {2, 1, 1});
  rooms.add(box_facets({2, 0, 0}, {3, 1, 1}));
  Verdicts verdicts;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    compare_with_all_pairs(fixtures::to_model(rooms), seed, 200, verdicts);
    compare_with_all_pairs(fixtures::to_model(fixtures::fan_box(12)), seed, 200, verdicts);
    compare_with_all_pairs(fixtures::to_model(fixtures::chazelle(3, 0.1)), seed, 200, verdicts);
  }
  EXPECT_GT(verdicts.free, 200);
  EXPECT_GT(verdicts.crossing, 200);
}

TEST(FrontCrossing, agrees_with_all_pairs_where_curves_and_points_are_embedded) {
  Verdicts verdicts;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> place(1, 7);  // a lattice, so that much is flat
    for (Facets body : {box_facets({0, 0, 0}, {1, 1, 1}), fixtures::sphere_facets(1)}) {
      const Point middle = body.faces.size() == 6 ? Point{0.5, 0.5, 0.5} : Point{};
      for (int i = 0; i < 4; ++i) {
        const auto anywhere = [&] {
          return body.add_point(
              middle + Point{place(random) / 16. - 0.25, place(random) / 16. - 0.25, place(random) / 16. - 0.25});
        };
        body.curves.push_back({anywhere(), anywhere()});
        body.corners.push_back(anywhere());
      }
      const Model model = fixtures::to_model(body);
      Context context;
      if (has_errors(check_surface(model, context).findings)) continue;  // curves that meet
      compare_with_all_pairs(model, seed, 200, verdicts);
    }
  }
  EXPECT_GT(verdicts.free, 200);
  EXPECT_GT(verdicts.crossing, 200);
}

double least_edge(const TetComplex& c) {
  double least = 1e300;
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    if (!c.is_dead(t) && !c.is_ghost(t))
      for (const auto& e : kEdgeNodes)
        least = std::min(least, distance(c.point(c.node[4 * t + e[0]]), c.point(c.node[4 * t + e[1]])));
  return least;
}

TEST(Front, fills_a_sphere_with_regular_cells) {
  const Model model = sphere(3);
  const auto r = fixtures::expect_filled_by_front(model, recovered(model));
  EXPECT_EQ(r.report.closed_by_delaunay, 0u);
  EXPECT_TRUE(r.report.gave_up.empty());
  double sum = 0;
  std::size_t cells = 0;
  const TetComplex& c = r.grid.complex;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const std::uint32_t* n = &c.node[4 * t];
    sum += measure_dihedrals(c.point(n[0]), c.point(n[1]), c.point(n[2]), c.point(n[3])).least;
    ++cells;
  }
  EXPECT_GT(sum / static_cast<double>(cells), 45 * std::numbers::pi / 180);
}

TEST(Front, follows_sizes_down_to_a_ten_thousandth) {
  const Model model = sphere(2);
  BoundaryGrid grid = recovered(model);
  Context context;
  const double volume = fixtures::total_volume(grid.complex);
  const Funnel field({0.2, 0.1, -0.3}, 1e-4, 0.25, 0.3);
  const FrontReport report = fill_by_front(grid, field, context);
  EXPECT_EQ(grid.complex.find_defect(), "");
  EXPECT_NEAR(fixtures::total_volume(grid.complex), volume, 1e-11);
  EXPECT_LT(static_cast<double>(report.closed_by_delaunay), 1e-3 * static_cast<double>(report.cells));
  EXPECT_LT(least_edge(grid.complex), 1e-3);
}

TEST(Front, the_same_grid_for_any_number_of_threads) {
  const Model model = sphere(4);
  const BoundaryGrid empty = recovered(model);
  BoundaryGrid first = empty;
  Context context;
  const Funnel field({0, 0, 0}, 0.04, 0.06, 0.06);
  fill_by_front(first, field, context);
  for (const int threads : {2, 3}) {
    BoundaryGrid other = empty;
    context.threads = threads;
    fill_by_front(other, field, context);
    EXPECT_EQ(first.complex.node, other.complex.node);
    EXPECT_EQ(first.complex.neigh, other.complex.neigh);
  }
}

TEST(Front, scaling_by_powers_of_two_changes_nothing) {
  const Model model = sphere(2);
  Model large = model;
  for (Point& p : large.points) p = 0x1p20 * p;
  const auto a = fixtures::expect_filled_by_front(model, recovered(model));
  const auto b = fixtures::expect_filled_by_front(large, recovered(large));
  EXPECT_EQ(a.grid.complex.node, b.grid.complex.node);
}

/// Its notches leave narrow places that no point sees whole: quadratically many convex parts (Chazelle 1984).
TEST(Front, F17_fills_what_no_point_sees_without_delaunay) {
  for (const auto& [notches, gap] : {std::pair{2, 0.1}, {3, 0.1}, {3, 0.01}, {4, 0.05}}) {
    SCOPED_TRACE(std::to_string(notches) + " notches, gap " + std::to_string(gap));
    const Facets facets = fixtures::chazelle(notches, gap);
    const Model model = fixtures::to_model(facets);
    const auto r = fixtures::expect_filled_by_front(model, recovered(model));
    EXPECT_EQ(r.report.gave_up, "");
    EXPECT_GT(r.report.cavities_by_stars, 0u);
    EXPECT_EQ(r.report.closed_by_delaunay, 0u);
    EXPECT_NEAR(fixtures::total_volume(r.grid.complex), facets.volume(), 1e-9 * facets.volume());
  }
}

/// Thin slots, wedges and coarse walls with sizes that vary by 1e4. Next to nothing is left to Delaunay.
TEST(Front, random_rooms_with_any_sizes) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 300);
  std::size_t cells = 0, by_delaunay = 0;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    Facets facets = box_facets({0, 0, 0}, {1, 1, 1});
    const double slot = std::pow(10.0, -4 * unit(random)), at = 0.2 + 0.3 * unit(random);
    Facets left = box_facets({0.1, 0.1, 0.1}, {at, 0.9, 0.9});
    Facets right = box_facets({at + 0.3 * slot, 0.2, 0.15}, {0.95, 0.8, 0.7});
    left.turn();
    right.turn();
    facets.add(left);
    facets.add(right);
    const Model model = fixtures::to_model(facets);
    BoundaryGrid grid = recovered(model);
    const double volume = fixtures::total_volume(grid.complex);
    const double least = std::pow(10.0, -4 * unit(random));
    const Funnel field({unit(random), unit(random), unit(random)}, std::max(least, 2e-4), 0.2 + 0.3 * unit(random), 1);
    Context context;
    const FrontReport report = fill_by_front(grid, field, context);
    ASSERT_EQ(grid.complex.find_defect(), "");
    ASSERT_NEAR(fixtures::total_volume(grid.complex), volume, 1e-11);
    EXPECT_EQ(report.gave_up, "");
    cells += report.cells + report.cells_refilled;
    by_delaunay += report.closed_by_delaunay;
  }
  RecordProperty("by_delaunay", static_cast<int>(by_delaunay));
  EXPECT_LE(static_cast<double>(by_delaunay), 1e-3 * static_cast<double>(cells));
}

/// No room between the shells for cells of a fair shape: Delaunay fills it, and that is said.
TEST(VolumeFront, F17_much_by_delaunay_is_worth_a_warning_with_a_place) {
  for (const double gap : {0.3, 0.001}) {
    SCOPED_TRACE(gap);
    Facets body = fixtures::sphere_facets(2);
    body.add(fixtures::sphere_facets(2), {}, 1 - gap);
    BoundaryGrid grid = recovered(fixtures::to_model(body));
    Context context;
    std::vector<std::string> warnings;
    context.on_log = [&](LogLevel level, const std::string& message) {
      if (level == LogLevel::warning) warnings.push_back(message);
    };
    const FrontReport report = fill_by_front(grid, Funnel({}, 0.2, 0, 0.2), context);
    const double share = double(report.closed_by_delaunay) / double(grid.complex.num_live());
    EXPECT_EQ(share > 0.01, !warnings.empty()) << share;
    EXPECT_EQ(report.delaunay_places.empty(), report.closed_by_delaunay == 0);
    if (gap < 0.1) ASSERT_GT(share, 0.01);
    if (warnings.empty()) continue;
    EXPECT_NE(warnings[0].find("put in by constrained Delaunay"), std::string::npos) << warnings[0];
    EXPECT_NEAR(length(report.delaunay_places[0].at), 1, 0.1) << "between the shells";
  }
}

}  // namespace
}  // namespace delfront
