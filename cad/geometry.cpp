// SPDX-License-Identifier: Apache-2.0
// Kinds whose parameters mean the same here and there are taken over as numbers. Everything else is wrapped: Geom_…
// objects evaluate without caches (those are the adaptors'), so that several threads may ask one.
#include "geometry.hpp"

#include <Geom2dConvert.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <cmath>
#include <gp_Lin2d.hxx>
#include <limits>

namespace delfront::cad {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kBeyond = 1e-9;  ///< of a spline's range: that an edge may go on
const Point kNoPoint{kNan, kNan, kNan};
const Point2 kNoPoint2{kNan, kNan};

class WrappedCurve final : public OtherCurve {
 public:
  explicit WrappedCurve(Handle(Geom_Curve) curve) : curve_(std::move(curve)) {}
  CurveDerivatives derivatives(double t) const noexcept override {
    try {
      gp_Pnt p;
      gp_Vec first, second;
      curve_->D2(t, p, first, second);
      return {point_of(p), point_of(first), point_of(second)};
    } catch (...) {
      return {kNoPoint, kNoPoint, kNoPoint};
    }
  }

 private:
  Handle(Geom_Curve) curve_;
};

class WrappedParameterCurve final : public OtherParameterCurve {
 public:
  explicit WrappedParameterCurve(Handle(Geom2d_Curve) curve) : curve_(std::move(curve)) {}
  ParameterCurveDerivatives derivatives(double t) const noexcept override {
    try {
      gp_Pnt2d p;
      gp_Vec2d first, second;
      curve_->D2(t, p, first, second);
      return {{p.X(), p.Y()}, {first.X(), first.Y()}, {second.X(), second.Y()}};
    } catch (...) {
      return {kNoPoint2, kNoPoint2, kNoPoint2};
    }
  }

 private:
  Handle(Geom2d_Curve) curve_;
};

class WrappedSurface final : public OtherSurface {
 public:
  explicit WrappedSurface(Handle(Geom_Surface) surface) : surface_(std::move(surface)) {}
  SurfaceDerivatives derivatives(Point2 uv) const noexcept override {
    try {
      gp_Pnt p;
      gp_Vec u, v, uu, uv2, vv;
      surface_->D2(uv.x, uv.y, p, u, v, uu, vv, uv2);
      return {point_of(p), point_of(u), point_of(v), point_of(uu), point_of(uv2), point_of(vv)};
    } catch (...) {
      return {kNoPoint, kNoPoint, kNoPoint, kNoPoint, kNoPoint, kNoPoint};
    }
  }

 private:
  Handle(Geom_Surface) surface_;
};

SpaceFrame frame_of(const gp_Pnt& at, const gp_Dir& x, const gp_Dir& y, const gp_Dir& z) {
  return {point_of(at), point_of(x), point_of(y), point_of(z)};
}
SpaceFrame frame_of(const gp_Ax3& a) { return frame_of(a.Location(), a.XDirection(), a.YDirection(), a.Direction()); }
SpaceFrame frame_of(const gp_Ax2& a) { return frame_of(a.Location(), a.XDirection(), a.YDirection(), a.Direction()); }

template <class Sequence>
std::vector<double> numbers(const Sequence& values) {
  std::vector<double> result;
  for (int i = values.Lower(); i <= values.Upper(); ++i) result.push_back(values(i));
  return result;
}

bool covers(const std::vector<double>& knots, int degree, double low, double high) {
  const double first = knots[std::size_t(degree)], last = knots[knots.size() - 1 - std::size_t(degree)];
  return low >= first - kBeyond * (last - first) && high <= last + kBeyond * (last - first);
}

/// Knots within that are there more often than the degree are not for us.
bool is_usable(const std::vector<double>& knots, int degree) {
  if (degree < 1 || degree > kMostDegree) return false;
  int times = 0;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    times = i > 0 && knots[i] == knots[i - 1] ? times + 1 : 1;
    if (times > degree && knots[i] != knots.front() && knots[i] != knots.back()) return false;
  }
  return true;
}

Point pole_of(const gp_Pnt& p) { return point_of(p); }
Point pole_of(const gp_Pnt2d& p) { return {p.X(), p.Y(), 0}; }

/// A spline in space or in the plane, periodic ones unrolled.
template <class Spline>
NurbsCurveData nurbs_of(opencascade::handle<Spline> c) {
  if (c->IsPeriodic()) {
    c = opencascade::handle<Spline>::DownCast(c->Copy());
    c->SetNotPeriodic();
  }
  NurbsCurveData data;
  data.degree = c->Degree();
  data.knots = numbers(c->KnotSequence());
  for (int i = 1; i <= c->NbPoles(); ++i) {
    data.points.push_back(pole_of(c->Pole(i)));
    if (c->IsRational()) data.weights.push_back(c->Weight(i));
  }
  return data;
}

/// Whether ours has places wherever an edge goes.
bool is_for(const NurbsCurveData& data, std::array<double, 2> range) {
  return is_usable(data.knots, data.degree) && covers(data.knots, data.degree, range[0], range[1]);
}

CurveData spline_data(const Handle(Geom_Curve) & given, std::array<double, 2> range) {
  Handle(Geom_BSplineCurve) c = Handle(Geom_BSplineCurve)::DownCast(given);
  if (c.IsNull()) c = GeomConvert::CurveToBSplineCurve(given);
  CurveData data;
  data.kind = CurveData::Kind::nurbs;
  data.nurbs = nurbs_of(c);
  return is_for(data.nurbs, range) ? data : other_curve(given);
}

ParameterCurveData other_parameter_curve(const Handle(Geom2d_Curve) & curve) {
  ParameterCurveData data;
  data.kind = ParameterCurveData::Kind::other;
  data.other = std::make_shared<WrappedParameterCurve>(curve);
  return data;
}

ParameterCurveData spline_data(const Handle(Geom2d_Curve) & given, std::array<double, 2> range) {
  Handle(Geom2d_BSplineCurve) c = Handle(Geom2d_BSplineCurve)::DownCast(given);
  if (c.IsNull()) c = Geom2dConvert::CurveToBSplineCurve(given);
  ParameterCurveData data;
  data.kind = ParameterCurveData::Kind::nurbs;
  data.nurbs = nurbs_of(c);
  return is_for(data.nurbs, range) ? data : other_parameter_curve(given);
}

/// Where it has places, and periods, as OpenCASCADE says.
void set_bounds(const Handle(Geom_Surface) & s, SurfaceData& data) {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  s->Bounds(u0, u1, v0, v1);
  const auto finite = [](double x) { return Precision::IsInfinite(x) ? std::copysign(kInfinite, x) : x; };
  data.box = {{finite(u0), finite(v0)}, {finite(u1), finite(v1)}};
  if (s->IsUPeriodic()) data.period[0] = s->UPeriod();
  if (s->IsVPeriodic()) data.period[1] = s->VPeriod();
}

SurfaceData nurbs_surface(const Handle(Geom_Surface) & given, const ParameterBox& box) {
  Handle(Geom_BSplineSurface) s = Handle(Geom_BSplineSurface)::DownCast(given);
  if (s.IsNull()) s = GeomConvert::SurfaceToBSplineSurface(given);
  s = Handle(Geom_BSplineSurface)::DownCast(s->Copy());
  if (s->IsUPeriodic()) s->SetUNotPeriodic();
  if (s->IsVPeriodic()) s->SetVNotPeriodic();
  SurfaceData data;
  data.kind = SurfaceData::Kind::nurbs;
  NurbsSurfaceData& n = data.nurbs;
  n.degree = {s->UDegree(), s->VDegree()};
  n.knots = {numbers(s->UKnotSequence()), numbers(s->VKnotSequence())};
  n.count = {std::size_t(s->NbUPoles()), std::size_t(s->NbVPoles())};
  const bool is_rational = s->IsURational() || s->IsVRational();
  for (int i = 1; i <= s->NbUPoles(); ++i)
    for (int j = 1; j <= s->NbVPoles(); ++j) {
      n.points.push_back(point_of(s->Pole(i, j)));
      if (is_rational) n.weights.push_back(s->Weight(i, j));
    }
  set_bounds(given, data);
  const bool is_whole = is_usable(n.knots[0], n.degree[0]) && is_usable(n.knots[1], n.degree[1]) &&
                        covers(n.knots[0], n.degree[0], box.low.x, box.high.x) &&
                        covers(n.knots[1], n.degree[1], box.low.y, box.high.y);
  if (is_whole) return data;
  data.other = std::make_shared<WrappedSurface>(given);  // for what goes over a period that is none of ours
  return data;
}

SurfaceData round_surface(SurfaceData::Kind kind, const gp_Ax3& axes, double a, double b) {
  SurfaceData data;
  data.kind = kind;
  data.frame = frame_of(axes);
  data.a = a;
  data.b = b;
  return data;
}

SurfaceData swept_surface(SurfaceData::Kind kind, const Handle(Geom_Surface) & s, const Handle(Geom_Curve) & basis,
                          const gp_Pnt& at, const gp_Dir& axis, std::array<double, 2> range) {
  SurfaceData data;
  data.kind = kind;
  data.frame.origin = point_of(at);
  data.frame.z = point_of(axis);
  data.curve = curve_data(basis, range);
  set_bounds(s, data);
  return data;
}

}  // namespace

CurveData other_curve(const Handle(Geom_Curve) & curve) {
  CurveData data;
  data.kind = CurveData::Kind::other;
  data.other = std::make_shared<WrappedCurve>(curve);
  data.range = {curve->FirstParameter(), curve->LastParameter()};
  return data;
}

SurfaceData other_surface(const Handle(Geom_Surface) & surface) {
  SurfaceData data;
  data.kind = SurfaceData::Kind::other;
  data.other = std::make_shared<WrappedSurface>(surface);
  set_bounds(surface, data);
  return data;
}

CurveData curve_data(const Handle(Geom_Curve) & given, std::array<double, 2> range) {
  Handle(Geom_Curve) curve = given;
  while (const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve)) curve = trimmed->BasisCurve();
  CurveData data;
  if (const auto line = Handle(Geom_Line)::DownCast(curve)) {
    data.kind = CurveData::Kind::line;
    data.frame.origin = point_of(line->Lin().Location());
    data.frame.x = point_of(line->Lin().Direction());
  } else if (const auto circle = Handle(Geom_Circle)::DownCast(curve)) {
    data.kind = CurveData::Kind::ellipse;
    data.frame = frame_of(circle->Position());
    data.a = data.b = circle->Radius();
  } else if (const auto ellipse = Handle(Geom_Ellipse)::DownCast(curve)) {
    data.kind = CurveData::Kind::ellipse;
    data.frame = frame_of(ellipse->Position());
    data.a = ellipse->MajorRadius();
    data.b = ellipse->MinorRadius();
  } else if (curve->IsKind(STANDARD_TYPE(Geom_BSplineCurve)) || curve->IsKind(STANDARD_TYPE(Geom_BezierCurve))) {
    data = spline_data(curve, range);
  } else {
    data = other_curve(curve);
  }
  return data;
}

ParameterCurveData parameter_curve_data(const Handle(Geom2d_Curve) & given, std::array<double, 2> range) {
  Handle(Geom2d_Curve) curve = given;
  while (const auto trimmed = Handle(Geom2d_TrimmedCurve)::DownCast(curve)) curve = trimmed->BasisCurve();
  const auto pair = [](const gp_XY& p) { return Point2{p.X(), p.Y()}; };
  const auto round = [&](const gp_Ax22d& at, double a, double b) {
    ParameterCurveData data;
    data.kind = ParameterCurveData::Kind::ellipse;
    data.origin = pair(at.Location().XY());
    data.x = pair(a * at.XDirection().XY());
    data.y = pair(b * at.YDirection().XY());
    return data;
  };
  ParameterCurveData data;
  if (const auto line = Handle(Geom2d_Line)::DownCast(curve)) {
    data.origin = pair(line->Lin2d().Location().XY());
    data.x = pair(line->Lin2d().Direction().XY());
    return data;
  }
  if (const auto circle = Handle(Geom2d_Circle)::DownCast(curve))
    return round(circle->Position(), circle->Radius(), circle->Radius());
  if (const auto ellipse = Handle(Geom2d_Ellipse)::DownCast(curve))
    return round(ellipse->Position(), ellipse->MajorRadius(), ellipse->MinorRadius());
  if (curve->IsKind(STANDARD_TYPE(Geom2d_BSplineCurve)) || curve->IsKind(STANDARD_TYPE(Geom2d_BezierCurve)))
    return spline_data(curve, range);
  return other_parameter_curve(curve);
}

SurfaceData surface_data(const Handle(Geom_Surface) & given, const ParameterBox& box) {
  using Kind = SurfaceData::Kind;
  Handle(Geom_Surface) s = given;
  while (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(s)) s = trimmed->BasisSurface();
  if (const auto plane = Handle(Geom_Plane)::DownCast(s)) return round_surface(Kind::plane, plane->Position(), 0, 0);
  if (const auto c = Handle(Geom_CylindricalSurface)::DownCast(s))
    return round_surface(Kind::cylinder, c->Position(), c->Radius(), 0);
  if (const auto c = Handle(Geom_ConicalSurface)::DownCast(s))
    return round_surface(Kind::cone, c->Position(), c->RefRadius(), c->SemiAngle());
  if (const auto c = Handle(Geom_SphericalSurface)::DownCast(s))
    return round_surface(Kind::sphere, c->Position(), c->Radius(), 0);
  if (const auto c = Handle(Geom_ToroidalSurface)::DownCast(s))
    return round_surface(Kind::torus, c->Position(), c->MajorRadius(), c->MinorRadius());
  if (s->IsKind(STANDARD_TYPE(Geom_BSplineSurface)) || s->IsKind(STANDARD_TYPE(Geom_BezierSurface)))
    return nurbs_surface(s, box);
  if (const auto e = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(s))
    return swept_surface(Kind::extrusion, s, e->BasisCurve(), gp_Pnt(), e->Direction(), {box.low.x, box.high.x});
  if (const auto r = Handle(Geom_SurfaceOfRevolution)::DownCast(s))
    return swept_surface(Kind::revolution, s, r->BasisCurve(), r->Location(), r->Direction(), {box.low.y, box.high.y});
  return other_surface(s);
}

}  // namespace delfront::cad
