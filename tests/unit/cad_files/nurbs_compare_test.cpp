// SPDX-License-Identifier: Apache-2.0
// Our splines against OpenCASCADE's evaluation of the same numbers: random ones, and those of real files.
#include <gtest/gtest.h>

#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "delfront/brep.hpp"
#include "delfront/nurbs.hpp"
#include "occ_files.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

constexpr double kClose = 1e-12;  ///< of the size of what is compared

using Random = std::mt19937;

double between(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
int whole(Random& random, int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); }

Point point_of(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

/// Distinct knots and how often they are there.
struct Knots {
  std::vector<double> at;
  std::vector<int> times;

  int sum() const {
    int all = 0;
    for (const int n : times) all += n;
    return all;
  }
};

Knots random_knots(Random& random, int degree, bool is_periodic) {
  Knots knots;
  const int spans = whole(random, is_periodic ? degree + 2 : 1, degree + 5);
  double t = between(random, -1, 1);
  for (int i = 0; i <= spans; ++i, t += between(random, 0.2, 1)) {
    const bool is_end = i == 0 || i == spans;
    const bool is_plain = whole(random, 0, 2) > 0;
    knots.at.push_back(t);
    knots.times.push_back(is_end ? (is_periodic ? 1 : degree + 1) : is_plain ? 1 : whole(random, 1, degree));
  }
  return knots;
}

TColStd_Array1OfReal places_of(const Knots& knots) {
  TColStd_Array1OfReal result(1, int(knots.at.size()));
  for (int i = 1; i <= result.Length(); ++i) result(i) = knots.at[std::size_t(i - 1)];
  return result;
}
TColStd_Array1OfInteger times_of(const Knots& knots) {
  TColStd_Array1OfInteger result(1, int(knots.times.size()));
  for (int i = 1; i <= result.Length(); ++i) result(i) = knots.times[std::size_t(i - 1)];
  return result;
}

gp_Pnt random_point(Random& random, double size) {
  return {between(random, -size, size), between(random, -size, size), between(random, -size, size)};
}

struct Kind {
  int degree = 3;
  bool is_rational = false, is_periodic = false;
};

Handle(Geom_BSplineCurve) random_curve(Random& random, const Kind& kind, double size) {
  const Knots knots = random_knots(random, kind.degree, kind.is_periodic);
  const int n = knots.sum() - (kind.is_periodic ? 1 : kind.degree + 1);
  TColgp_Array1OfPnt poles(1, n);
  TColStd_Array1OfReal weights(1, n);
  for (int i = 1; i <= n; ++i) {
    poles(i) = random_point(random, size);
    weights(i) = kind.is_rational ? between(random, 0.3, 3) : 1;
  }
  return new Geom_BSplineCurve(poles, weights, places_of(knots), times_of(knots), kind.degree, kind.is_periodic);
}

Handle(Geom_BSplineSurface) random_surface(Random& random, const Kind& u, const Kind& v, double size) {
  const Knots a = random_knots(random, u.degree, u.is_periodic), b = random_knots(random, v.degree, v.is_periodic);
  const int n = a.sum() - (u.is_periodic ? 1 : u.degree + 1), m = b.sum() - (v.is_periodic ? 1 : v.degree + 1);
  TColgp_Array2OfPnt poles(1, n, 1, m);
  TColStd_Array2OfReal weights(1, n, 1, m);
  for (int i = 1; i <= n; ++i)
    for (int j = 1; j <= m; ++j) {
      poles(i, j) = random_point(random, size);
      weights(i, j) = u.is_rational || v.is_rational ? between(random, 0.3, 3) : 1;
    }
  return new Geom_BSplineSurface(poles, weights, places_of(a), places_of(b), times_of(a), times_of(b), u.degree,
                                 v.degree, u.is_periodic, v.is_periodic);
}

std::vector<double> numbers(const TColStd_Array1OfReal& values) {
  std::vector<double> result;
  for (int i = values.Lower(); i <= values.Upper(); ++i) result.push_back(values(i));
  return result;
}

/// Our data with the same knots; of a periodic one points are repeated.
NurbsCurveData data_of(const Handle(Geom_BSplineCurve) & c) {
  NurbsCurveData data;
  data.degree = c->Degree();
  data.knots = numbers(c->KnotSequence());
  const int count = int(data.knots.size()) - data.degree - 1;
  for (int i = 0; i < count; ++i) {
    const int pole = i % c->NbPoles() + 1;
    data.points.push_back(point_of(c->Pole(pole).XYZ()));
    if (c->IsRational()) data.weights.push_back(c->Weight(pole));
  }
  return data;
}

NurbsSurfaceData data_of(const Handle(Geom_BSplineSurface) & s) {
  NurbsSurfaceData data;
  data.degree = {s->UDegree(), s->VDegree()};
  data.knots = {numbers(s->UKnotSequence()), numbers(s->VKnotSequence())};
  for (std::size_t k = 0; k < 2; ++k) data.count[k] = data.knots[k].size() - std::size_t(data.degree[k]) - 1;
  for (int i = 0; i < int(data.count[0]); ++i)
    for (int j = 0; j < int(data.count[1]); ++j) {
      const int a = i % s->NbUPoles() + 1, b = j % s->NbVPoles() + 1;
      data.points.push_back(point_of(s->Pole(a, b).XYZ()));
      if (s->IsURational() || s->IsVRational()) data.weights.push_back(s->Weight(a, b));
    }
  return data;
}

double extent_of(const std::vector<Point>& points) {
  double most = 0;
  for (const Point& p : points) most = std::max(most, length(p));
  return most;
}

/// Places within spans: at knots derivatives may jump.
std::vector<double> places(Random& random, const TColStd_Array1OfReal& knots, int each) {
  std::vector<double> result;
  for (int i = knots.Lower(); i < knots.Upper(); ++i)
    for (int k = 0; k < each; ++k) result.push_back(knots(i) + (knots(i + 1) - knots(i)) * between(random, 0.01, 0.99));
  return result;
}

/// The largest difference, as a share of what it is measured by.
struct Difference {
  double most = 0;
  void add(const Point& ours, const gp_XYZ& theirs, double size) {
    most = std::max(most, distance(ours, point_of(theirs)) / size);
  }
};

/// Derivatives are sums of differences of points, each over a span: what rounding there is, is a share of the size by
/// the degree over the shortest span near t, to the order.
double steepness(const std::vector<double>& knots, int degree, double t) {
  double shortest = knots.back() - knots.front();
  const auto after = std::size_t(std::upper_bound(knots.begin(), knots.end(), t) - knots.begin());
  const std::size_t reach = std::size_t(degree);
  for (std::size_t i = after > reach ? after - reach : 0; i + 1 < std::min(knots.size(), after + reach); ++i)
    if (knots[i + 1] > knots[i]) shortest = std::min(shortest, knots[i + 1] - knots[i]);
  return degree / shortest;
}

void expect_same(const Handle(Geom_BSplineCurve) & theirs, Random& random, const std::string& what) {
  const NurbsCurveData data = data_of(theirs);
  const CurvePointer ours = make_nurbs_curve(data);
  Difference at, first, second;
  const double size = extent_of(data.points);
  for (const double t : places(random, theirs->Knots(), 3)) {
    const double steep = steepness(data.knots, data.degree, t);
    gp_Pnt p;
    gp_Vec d1, d2;
    theirs->D2(t, p, d1, d2);
    const CurveDerivatives mine = ours->derivatives(t);
    at.add(mine.at, p.XYZ(), size);
    first.add(mine.first, d1.XYZ(), size * steep);
    second.add(mine.second, d2.XYZ(), size * steep * steep);
  }
  for (const double t : numbers(theirs->Knots())) at.add(ours->at(t), theirs->Value(t).XYZ(), size);
  EXPECT_LE(at.most, kClose) << what;
  EXPECT_LE(first.most, kClose) << what;
  EXPECT_LE(second.most, kClose) << what;
}

void expect_same(const Handle(Geom_BSplineSurface) & theirs, Random& random, const std::string& what, int each = 1) {
  const NurbsSurfaceData data = data_of(theirs);
  const SurfacePointer ours = make_nurbs_surface(data);
  TColStd_Array1OfReal u(1, theirs->NbUKnots()), v(1, theirs->NbVKnots());
  theirs->UKnots(u);
  theirs->VKnots(v);
  Difference at, first, second;
  const double size = extent_of(data.points);
  for (const double s : places(random, u, each))
    for (const double t : places(random, v, each)) {
      gp_Pnt p;
      gp_Vec du, dv, duu, dvv, duv;
      theirs->D2(s, t, p, du, dv, duu, dvv, duv);
      const SurfaceDerivatives mine = ours->derivatives({s, t});
      const double a = steepness(data.knots[0], data.degree[0], s), b = steepness(data.knots[1], data.degree[1], t);
      at.add(mine.at, p.XYZ(), size);
      first.add(mine.u, du.XYZ(), size * a);
      first.add(mine.v, dv.XYZ(), size * b);
      second.add(mine.uu, duu.XYZ(), size * a * a);
      second.add(mine.uv, duv.XYZ(), size * a * b);
      second.add(mine.vv, dvv.XYZ(), size * b * b);
      const SurfaceTangents also = ours->tangents({s, t});
      at.add(also.at, p.XYZ(), size);
      first.add(also.u, du.XYZ(), size * a);
      first.add(also.v, dv.XYZ(), size * b);
    }
  for (const double s : numbers(u))
    for (const double t : numbers(v)) at.add(ours->at({s, t}), theirs->Value(s, t).XYZ(), size);
  EXPECT_LE(at.most, kClose) << what;
  EXPECT_LE(first.most, kClose) << what;
  EXPECT_LE(second.most, kClose) << what;
}

std::string words(unsigned seed, const Kind& u) {
  return "seed " + std::to_string(seed) + ", degree " + std::to_string(u.degree) + (u.is_rational ? ", rational" : "") +
         (u.is_periodic ? ", periodic" : "");
}

TEST(NurbsCompare, D1_curves_of_all_kinds) {
  unsigned seed = 1;
  for (int degree = 1; degree <= 9; ++degree)
    for (const bool is_rational : {false, true})
      for (const bool is_periodic : {false, true})
        for (int round = 0; round < 10; ++round, ++seed) {
          Random random(seed);
          const Kind kind{degree, is_rational, is_periodic};
          const double size = std::pow(10, whole(random, -6, 6));
          expect_same(random_curve(random, kind, size), random, words(seed, kind));
        }
}

TEST(NurbsCompare, D1_surfaces_of_all_kinds) {
  unsigned seed = 1001;
  for (int degree = 1; degree <= 9; ++degree)
    for (const bool is_rational : {false, true})
      for (const int periodic : {0, 1, 2, 3})
        for (int round = 0; round < 4; ++round, ++seed) {
          Random random(seed);
          const Kind u{degree, is_rational, (periodic & 1) != 0};
          const Kind v{whole(random, 1, 9), is_rational, (periodic & 2) != 0};
          const double size = std::pow(10, whole(random, -6, 6));
          expect_same(random_surface(random, u, v, size), random, words(seed, u) + " by " + words(seed, v));
        }
}

/// A surface that does not cross itself: a net, each place of which is moved by up to a third of its meshes.
Handle(Geom_BSplineSurface) random_sheet(Random& random, const Kind& kind) {
  const auto s = random_surface(random, kind, kind, 1);
  for (int i = 1; i <= s->NbUPoles(); ++i)
    for (int j = 1; j <= s->NbVPoles(); ++j)
      s->SetPole(i, j,
                 gp_Pnt(i + between(random, -0.3, 0.3), j + between(random, -0.3, 0.3), between(random, -0.3, 0.3)));
  return s;
}

TEST(NurbsCompare, D1_inversion_finds_places_that_OpenCASCADE_gives) {
  unsigned seed = 3001;
  for (int degree = 2; degree <= 9; ++degree)
    for (const bool is_rational : {false, true}) {
      Random random(seed);
      const Kind kind{degree, is_rational, false};
      const auto theirs = random_sheet(random, kind);
      const NurbsSurfaceData data = data_of(theirs);
      const SurfacePointer ours = make_nurbs_surface(data);
      const double size = extent_of(data.points);
      const SurfaceSearch search(ours);
      const ParameterBox box = ours->box();
      for (int i = 0; i < 20; ++i) {
        const Point2 uv = {between(random, box.low.x, box.high.x), between(random, box.low.y, box.high.y)};
        const auto found = search.closest(point_of(theirs->Value(uv.x, uv.y).XYZ()));
        EXPECT_LE(found.distance, kClose * size) << words(seed, kind) << " at " << uv.x << " " << uv.y;
        EXPECT_NEAR(found.uv.x, uv.x, 1e-7 * (box.high.x - box.low.x)) << words(seed, kind);
        EXPECT_NEAR(found.uv.y, uv.y, 1e-7 * (box.high.y - box.low.y)) << words(seed, kind);
      }
      ++seed;
    }
}

TEST(NurbsCompare, D1_inversion_from_a_near_start_of_surfaces_that_are_all_over_the_place) {
  for (unsigned seed = 3501; seed < 3541; ++seed) {
    Random random(seed);
    const Kind kind{whole(random, 2, 9), seed % 2 == 0, false};
    const auto theirs = random_surface(random, kind, kind, 1);
    const SurfacePointer ours = make_nurbs_surface(data_of(theirs));
    const auto curve = random_curve(random, kind, 1);
    const CurvePointer our_curve = make_nurbs_curve(data_of(curve));
    const ParameterBox box = ours->box();
    for (int i = 0; i < 10; ++i) {
      const Point2 uv = {between(random, box.low.x, box.high.x), between(random, box.low.y, box.high.y)};
      const Point p = point_of(theirs->Value(uv.x, uv.y).XYZ());
      const Point2 found = ours->closest(p, {uv.x + 1e-4, uv.y - 1e-4});
      EXPECT_LE(distance(ours->at(found), p), kClose) << words(seed, kind) << " at " << uv.x << " " << uv.y;
      const Point q = point_of(curve->Value(between(random, our_curve->range()[0], our_curve->range()[1])).XYZ());
      EXPECT_LE(closest_on_curve(*our_curve, our_curve->range(), q, 257).distance, kClose) << words(seed, kind);
    }
  }
}

/// Where a curve may have a kink, Newton's method comes as near as the samples it starts from.
bool is_at_knot(double t, const TColStd_Array1OfReal& knots) {
  for (int i = knots.Lower(); i <= knots.Upper(); ++i)
    if (std::abs(knots(i) - t) < 1e-6) return true;
  return false;
}

TEST(NurbsCompare, D1_projection_is_as_near_as_OpenCASCADEs) {
  for (unsigned seed = 4001; seed < 4041; ++seed) {
    Random random(seed);
    const Kind kind{whole(random, 2, 5), seed % 2 == 0, false};
    const auto theirs = random_sheet(random, kind);
    const SurfaceSearch search(make_nurbs_surface(data_of(theirs)));
    const auto curve = random_curve(random, kind, 1);
    const CurvePointer ours = make_nurbs_curve(data_of(curve));
    for (int i = 0; i < 5; ++i) {
      const gp_Pnt p(between(random, 1, theirs->NbUPoles()), between(random, 1, theirs->NbVPoles()),
                     between(random, -1, 1));
      const GeomAPI_ProjectPointOnSurf on(p, theirs);
      if (on.NbPoints() > 0) {
        EXPECT_LE(search.closest(point_of(p.XYZ())).distance, on.LowerDistance() + 1e-9) << words(seed, kind);
      }
      const gp_Pnt q = random_point(random, 1);
      const GeomAPI_ProjectPointOnCurve along(q, curve);
      if (along.NbPoints() > 0 && !is_at_knot(along.LowerDistanceParameter(), curve->Knots())) {
        EXPECT_LE(closest_on_curve(*ours, ours->range(), point_of(q.XYZ()), 257).distance, along.LowerDistance() + 1e-9)
            << words(seed, kind);
      }
    }
  }
}

TEST(NurbsCompare, D1_all_splines_of_the_shared_files) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  std::size_t curves = 0, surfaces = 0;
  Random random(5);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "cad")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& path : files) {
    const TopoDS_Shape shape = occ::read(path.string(), "MM");
    TopTools_IndexedMapOfShape faces, edges;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    TopExp::MapShapes(shape, TopAbs_EDGE, edges);
    for (int i = 1; i <= faces.Extent(); ++i) {
      const auto s = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(faces(i))));
      if (s.IsNull()) continue;
      expect_same(s, random, path.filename().string() + ", face " + std::to_string(i));
      ++surfaces;
    }
    for (int i = 1; i <= edges.Extent(); ++i) {
      double first = 0, last = 0;
      const auto c = Handle(Geom_BSplineCurve)::DownCast(BRep_Tool::Curve(TopoDS::Edge(edges(i)), first, last));
      if (c.IsNull()) continue;
      expect_same(c, random, path.filename().string() + ", edge " + std::to_string(i));
      ++curves;
    }
  }
  EXPECT_GT(curves, 300u);
  EXPECT_GT(surfaces, 150u);
}

}  // namespace
}  // namespace delfront
