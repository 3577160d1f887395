// SPDX-License-Identifier: Apache-2.0
// Laws of sources (3.10 to 3.13) and the same with their slope limited.
//
// With F(r) = f(r) - k r the limited law is k r + min over r' <= r of F(r'): it follows f while F falls and goes on
// straight, with slope k, from each local minimum of F until F is lower again. For convex laws (gamma >= 1,
// exponential) there is one such place, for gamma < 1 the line starts at r0 and meets the law once; for polynomials
// the minima are among the roots of f' - k.
#include "sizing/size_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fmt/format.h"
#include "fmt/ranges.h"

namespace delfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDip = 1e-12;

double horner(const std::vector<double>& c, double x) {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * x + c[i];
  return sum;
}

std::vector<double> derivative(const std::vector<double>& c) {
  std::vector<double> d;
  for (std::size_t i = 1; i < c.size(); ++i) d.push_back(static_cast<double>(i) * c[i]);
  return d;
}

/// @pre f changes sign between low and high
template <class Function>
double bisect(const Function& f, double low, double high) {
  const bool is_negative = f(low) < 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = low + 0.5 * (high - low);
    if (!(middle > low && middle < high)) break;
    ((f(middle) < 0) == is_negative ? low : high) = middle;
  }
  return low + 0.5 * (high - low);
}

double relative_distance(const SizeLaw& law, double r) { return r > law.r0 ? (r - law.r0) / law.r1 : 0; }

double power(double rho, double gamma) {
  if (gamma == 1) return rho;
  if (gamma == 2) return rho * rho;
  if (gamma == 1.5) return rho * std::sqrt(rho);
  return std::pow(rho, gamma);
}

/// 1 + sum a_i rho^i
std::vector<double> with_one(const SizeLaw& law) {
  std::vector<double> c = {1};
  c.insert(c.end(), law.polynomial.begin(), law.polynomial.end());
  while (c.size() > 1 && c.back() == 0) c.pop_back();
  return c;
}

void check_polynomial(const SizeLaw& law) {
  for (const double a : law.polynomial)
    if (!std::isfinite(a))
      throw UsageError(fmt::format("law.coefficients = [{}]: all must be numbers", fmt::join(law.polynomial, ", ")));
  const std::vector<double> c = with_one(law), slope = derivative(c);
  if (slope.empty()) return;
  // Monotone when it does not fall between neighbouring roots of its derivative, nor behind the last one.
  double before = 0;
  auto fail = [&](double rho) {
    throw UsageError(
        fmt::format("law.coefficients = [{}]: the size decreases near rho = {:.6g} (distance {:.6g}), where it is "
                    "{:.6g}; a law must not decrease, e.g. all coefficients >= 0",
                    fmt::join(law.polynomial, ", "), rho, law.r0 + rho * law.r1, law.delta0 * horner(c, rho)));
  };
  for (const double root : positive_roots(slope)) {
    const double from = horner(c, before), to = horner(c, root);
    if (to < from - kDip * std::abs(from)) fail(root);
    before = root;
  }
  if (c.back() < 0) fail(before > 0 ? 2 * before : 1);
}

std::string name_of(SizeLaw::Kind kind) {
  switch (kind) {
    case SizeLaw::Kind::step:
      return "step";
    case SizeLaw::Kind::power:
      return "power";
    case SizeLaw::Kind::exponential:
      return "exponential";
    case SizeLaw::Kind::polynomial:
      return "polynomial";
  }
  return "unknown";
}

}  // namespace

std::vector<double> positive_roots(std::vector<double> c) {
  while (!c.empty() && c.back() == 0) c.pop_back();
  if (c.size() < 2) return {};
  // Between neighbouring roots of the derivative there is at most one; Cauchy's bound is behind the last.
  double bound = 0;
  for (std::size_t i = 0; i + 1 < c.size(); ++i) bound = std::max(bound, std::abs(c[i] / c.back()));
  bound = 1 + bound;
  std::vector<double> stops = positive_roots(derivative(c)), roots;
  stops.push_back(std::max(bound, stops.empty() ? 0 : 2 * stops.back()));
  double low = 0;
  const auto f = [&](double x) { return horner(c, x); };
  for (const double high : stops) {
    const double at_low = f(low), at_high = f(high);
    if (low > 0 && at_low == 0) roots.push_back(low);
    if ((at_low < 0 && at_high > 0) || (at_low > 0 && at_high < 0)) roots.push_back(bisect(f, low, high));
    low = high;
  }
  return roots;
}

double SizeLaw::size_at(double r) const {
  const double rho = relative_distance(*this, r);
  switch (kind) {
    case Kind::step:
      return r <= r0 ? delta0 : kInfinity;
    case Kind::power:
      return delta0 * (1 + power(rho, gamma));
    case Kind::exponential:
      return delta0 * std::exp(gamma * rho);
    case Kind::polynomial:
      break;
  }
  double sum = 0;
  for (std::size_t i = polynomial.size(); i-- > 0;)
    if (sum != 0 || polynomial[i] != 0) sum = (sum + polynomial[i]) * rho;
  return delta0 * (1 + sum);
}

void check_law(const SizeLaw& law) {
  auto check = [&](const char* field, double value, bool is_good, const char* allowed) {
    if (!is_good || !std::isfinite(value))
      throw UsageError(fmt::format("{} = {} of a {} law: {}", field, value, name_of(law.kind), allowed));
  };
  check("delta0", law.delta0, law.delta0 > 0, "the size at the source must be a number > 0");
  check("r0", law.r0, law.r0 >= 0, "the distance up to which the size is delta0 must be a number >= 0");
  if (law.kind == SizeLaw::Kind::step) return;
  check("r1", law.r1, law.r1 > 0, "the scaling length must be a number > 0");
  if (law.kind == SizeLaw::Kind::polynomial) return check_polynomial(law);
  check("gamma", law.gamma, law.gamma > 0, "the exponent must be a number > 0 (usually 1 to 2)");
}

LimitedLaw::LimitedLaw(const SizeLaw& law, double slope) : law_(law), slope_(slope) {
  if (!std::isfinite(slope)) return;
  auto add_line = [&](double from, double to) {
    leave_.push_back(from);
    meet_.push_back(to);
    value_at_leave_.push_back(law_.size_at(from));
  };
  const double g = law.gamma, steep = slope * law.r1 / law.delta0;  // the slope in units of delta0 and r1
  switch (law.kind) {
    case SizeLaw::Kind::step:
      add_line(law.r0, kInfinity);
      return;
    case SizeLaw::Kind::power:
      if (g == 1) {
        if (steep < 1) add_line(law.r0, kInfinity);
      } else if (g > 1) {
        add_line(law.r0 + law.r1 * std::pow(steep / g, 1 / (g - 1)), kInfinity);
      } else {
        add_line(law.r0, law.r0 + law.r1 * std::pow(steep, 1 / (g - 1)));
      }
      return;
    case SizeLaw::Kind::exponential:
      add_line(law.r0 + law.r1 * std::max(0.0, std::log(steep / g) / g), kInfinity);
      return;
    case SizeLaw::Kind::polynomial:
      limit_polynomial();
      return;
  }
}

/// The straight lines of a polynomial law: from each local minimum of F until F is below it again.
void LimitedLaw::limit_polynomial() {
  const SizeLaw& law = law_;
  const double steep = slope_ * law.r1 / law.delta0;
  auto add_line = [&](double from, double to) {
    leave_.push_back(from);
    meet_.push_back(to);
    value_at_leave_.push_back(law_.size_at(from));
  };
  std::vector<double> fall = with_one(law);  // F / delta0 as a function of rho, but for a constant
  fall.resize(std::max<std::size_t>(fall.size(), 2), 0.0);
  fall[1] -= steep;
  const auto place = [&](double rho) { return law.r0 + law.r1 * rho; };
  std::vector<double> stops = positive_roots(derivative(fall));
  const double last = stops.empty() ? 1 : 2 * stops.back() + 1;
  bool is_straight = false;
  double from = 0, lowest = 1, behind = 0;  // the line that is being drawn starts at `from`, where F is `lowest`
  auto part = [&](double low, double high, bool is_last) {
    const double middle = 0.5 * (low + high);
    const bool rises = horner(derivative(fall), is_last ? last : middle) > 0;
    if (!is_straight && rises) {
      is_straight = true;
      from = low;
      lowest = horner(fall, low);
    } else if (is_straight && !rises) {
      const double end = is_last ? kInfinity : high;
      double far = std::isfinite(end) ? end : std::max(2 * low, 1.0);
      while (!std::isfinite(end) && far < 1e300 && horner(fall, far) >= lowest) far *= 2;
      if (!(horner(fall, far) < lowest)) return;
      const double meet = bisect([&](double rho) { return horner(fall, rho) - lowest; }, low, far);
      add_line(place(from), place(meet));
      is_straight = false;
    }
  };
  for (const double stop : stops) {
    part(behind, stop, false);
    behind = stop;
  }
  part(behind, last, true);
  if (is_straight) add_line(place(from), kInfinity);
}

double LimitedLaw::operator()(double r) const {
  for (std::size_t i = leave_.size(); i-- > 0;)
    if (r > leave_[i]) {
      const double line = value_at_leave_[i] + slope_ * (r - leave_[i]);
      return r < meet_[i] ? line : std::min(line, law_.size_at(r));
    }
  return law_.size_at(r);
}

double LimitedLaw::largest() const {
  if (law_.kind != SizeLaw::Kind::polynomial || with_one(law_).size() > 1) return kInfinity;
  return law_.delta0;
}

/// The largest r of f(r) <= size for size > delta0, of the law itself; infinite where it stays below.
double LimitedLaw::inverse(double size) const {
  const double excess = size / law_.delta0 - 1;
  switch (law_.kind) {
    case SizeLaw::Kind::step:
      return law_.r0;
    case SizeLaw::Kind::power:
      return law_.r0 + law_.r1 * std::pow(excess, 1 / law_.gamma);
    case SizeLaw::Kind::exponential:
      return law_.r0 + law_.r1 * (std::log1p(excess) / law_.gamma);
    case SizeLaw::Kind::polynomial:
      break;
  }
  const std::vector<double> c = with_one(law_);
  if (c.size() == 1) return kInfinity;
  // Where terms cancel, what the rounding of each may take away is taken away.
  const auto is_below = [&](double rho) {
    double value = 0, sum = 0, term = 1;
    for (const double a : c) {
      value += a * term;
      sum += std::abs(a) * term;
      term *= rho;
    }
    return !(value - 1e-14 * sum > 1 + excess);
  };
  double high = 1;
  while (is_below(high) && high < 1e150) high *= 2;
  if (high >= 1e150) return kInfinity;
  double low = 0;
  for (int i = 0; i < 24; ++i) {
    const double middle = 0.5 * (low + high);
    (is_below(middle) ? low : high) = middle;
  }
  return law_.r0 + law_.r1 * high;
}

double LimitedLaw::reach(double size) const {
  // Both the law and its inverse round; 1e-13 covers them where the law is flat, 1e-6 where it is not.
  const double above = size * (1 + 1e-13);
  if (!(above > law_.delta0)) return -1;
  if (std::isinf(size)) return law_.kind == SizeLaw::Kind::step && leave_.empty() ? law_.r0 * (1 + 1e-6) : kInfinity;
  double far = inverse(above);
  for (std::size_t i = 0; i < leave_.size(); ++i) {
    const double on_line = leave_[i] + (above - value_at_leave_[i]) / slope_;
    if (on_line > leave_[i]) far = std::max(far, std::min(on_line, meet_[i]));
  }
  return far * (1 + 1e-6);
}

double LimitedLaw::steepest(double r) const {
  const double rho = relative_distance(law_, r), unit = law_.delta0 / law_.r1;
  double slope = kInfinity;
  if (law_.kind == SizeLaw::Kind::power && law_.gamma >= 1) {
    slope = unit * law_.gamma * std::pow(rho, law_.gamma - 1);
  } else if (law_.kind == SizeLaw::Kind::exponential) {
    slope = unit * law_.gamma * std::exp(law_.gamma * rho);
  } else if (law_.kind == SizeLaw::Kind::polynomial) {
    double sum = 0;
    for (std::size_t i = law_.polynomial.size(); i-- > 0;)
      sum = sum * rho + static_cast<double>(i + 1) * std::abs(law_.polynomial[i]);
    slope = unit * sum;
  }
  return std::min(slope, slope_) * (1 + 1e-9);
}

}  // namespace delfront
