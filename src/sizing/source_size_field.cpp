// SPDX-License-Identifier: Apache-2.0
// The field of sources (S3 to S5): the least over all sources without stretchings, and the intersection of its metric
// with those of the sources with stretchings.
//
// A source whose lengths are in no direction below the greatest length of a metric contains its ellipsoid and leaves it
// as it is. The intersection's greatest length is at most that of each part, so with B the least of them over all
// sources only those with a least length below B matter. They are taken in the order given, so that the result does not
// depend on the search.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/name_pattern.hpp"
#include "delfront/errors.hpp"
#include "delfront/size_sources.hpp"
#include "fmt/format.h"
#include "sizing/source_lists.hpp"
#include "sizing/source_tree.hpp"

namespace delfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kScanBelow = 4;  // sources; docs/sizes/sources.md has the times

class SourceSizeField final : public SizeField {
 public:
  SourceSizeField(const std::vector<SizeSource>& sources, const SourceFieldOptions& options, Context& context);

  void sizes(std::span<const Point> at, std::span<double> size) const override;
  void lower_sizes(std::span<const Point> at, std::span<double> size) const override;
  void metrics(std::span<const Point> at, std::span<Metric> metric) const override;
  bool is_isotropic() const override { return stretching_.empty(); }
  double lower_bound(const Box& box) const override;
  double largest() const override { return std::min(plain_.largest(), greatest_.largest()); }

 private:
  struct Hints {
    SourceTree::Hint plain, greatest;
  };
  double plain_size(Point at, Hints& hints) const;
  Metric metric_at(Point at, Hints& hints) const;
  double stretched_lower_bound(const Box& box) const;

  SourceTree plain_;
  std::unique_ptr<const SourceLists> lists_;
  // Of those with stretchings: what they ask for in their least and in their greatest direction, and as delta.
  SourceTree least_, greatest_;
  std::vector<Stretching> stretching_;
  std::vector<SourceTerm> stretched_;
  bool is_scanned_ = false;
};

double least_factor(const Stretching& s) { return std::min({1.0, s.s1, s.s2}); }
double greatest_factor(const Stretching& s) { return std::max({1.0, s.s1, s.s2}); }

Box widened(const Box& box) {
  const double more = 0.25 * box.longest_side();
  return {box.low - Point{more, more, more}, box.high + Point{more, more, more}};
}

SourceSizeField::SourceSizeField(const std::vector<SizeSource>& sources, const SourceFieldOptions& options,
                                 Context& context) {
  const double slope = std::isfinite(options.growth) ? (options.growth - 1) / options.growth : kInfinity;
  std::vector<SourceTerm> plain, least, greatest;
  for (const SizeSource& source : sources) {
    const Motion motion = source.motion.value_or(Motion{});
    SourceTerm term{PlacedShape(source.shape, motion, options.time), LimitedLaw(source.law, slope), 1};
    if (!source.stretching) {
      plain.push_back(std::move(term));
      continue;
    }
    Stretching turned = *source.stretching;
    turned.first = motion.turned(options.time, turned.first);
    turned.second = motion.turned(options.time, turned.second);
    stretching_.push_back(turned);
    stretched_.push_back(term);
    term.factor = least_factor(turned);
    least.push_back(term);
    term.factor = greatest_factor(turned);
    greatest.push_back(std::move(term));
  }
  is_scanned_ =
      options.search == SourceSearch::scan || (options.search == SourceSearch::automatic && plain.size() < kScanBelow);
  plain_ = SourceTree(std::move(plain), context);
  if (options.search == SourceSearch::lists && !plain_.empty())
    lists_ = std::make_unique<SourceLists>(plain_, options.domain.is_empty() ? widened(plain_.box()) : options.domain,
                                           context);
  least_ = SourceTree(std::move(least), context);
  greatest_ = SourceTree(std::move(greatest), context);
}

double SourceSizeField::plain_size(Point at, Hints& hints) const {
  if (plain_.empty()) return kInfinity;
  return is_scanned_ ? plain_.least_by_scan(at) : plain_.least(at, hints.plain);
}

Metric SourceSizeField::metric_at(Point at, Hints& hints) const {
  const double plain = plain_size(at, hints);
  Metric metric = isotropic_metric(plain);
  const double bound = std::min(plain, greatest_.least(at, hints.greatest));
  // The one that sets the bound is among them, also where its lengths are the same in all directions.
  for (const std::uint32_t i : least_.below({at, at}, std::nextafter(bound, kInfinity))) {
    const double delta = stretched_[i](at);
    if (std::isfinite(delta)) metric = intersection(metric, stretched_metric(delta, stretching_[i]));
  }
  return metric;
}

void SourceSizeField::sizes(std::span<const Point> at, std::span<double> size) const {
  DELFRONT_CHECK(at.size() == size.size());
  if (is_isotropic() && lists_) {
    std::fill(size.begin(), size.end(), kInfinity);
    return lists_->lower(plain_, at, size);
  }
  if (is_isotropic() && !is_scanned_) return plain_.least(at, size);
  Hints hints;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (is_isotropic()) {
      size[i] = plain_size(at[i], hints);
      continue;
    }
    const Metric metric = metric_at(at[i], hints);
    size[i] = metric == Metric{0, 0, 0, 0, 0, 0} ? kInfinity : least_size(metric);
  }
}

void SourceSizeField::lower_sizes(std::span<const Point> at, std::span<double> size) const {
  DELFRONT_CHECK(at.size() == size.size());
  if (!is_isotropic() || is_scanned_) return SizeField::lower_sizes(at, size);
  lists_ ? lists_->lower(plain_, at, size) : plain_.lower(at, size);
}

void SourceSizeField::metrics(std::span<const Point> at, std::span<Metric> metric) const {
  DELFRONT_CHECK(at.size() == metric.size());
  Hints hints;
  for (std::size_t i = 0; i < at.size(); ++i)
    metric[i] = is_isotropic() ? isotropic_metric(plain_size(at[i], hints)) : metric_at(at[i], hints);
}

/// An intersection by simultaneous reduction is (as a quadratic form) at most the sum of its parts, so that its
/// greatest eigenvalue is at most the sum of theirs.
double SourceSizeField::stretched_lower_bound(const Box& box) const {
  double sum = 0;
  auto add = [&](double size) { sum += 1 / (size * size); };
  if (!plain_.empty()) add(box.is_empty() ? plain_.smallest() : plain_.lower_bound(box));
  for (std::size_t i = 0; i < stretched_.size(); ++i)
    add(least_factor(stretching_[i]) * (box.is_empty() ? stretched_[i].law.delta0() : stretched_[i].lower_bound(box)));
  return sum > 0 ? (1 - 1e-9) / std::sqrt(sum) : kInfinity;
}

double SourceSizeField::lower_bound(const Box& box) const {
  if (!stretching_.empty()) return stretched_lower_bound(box);
  return box.is_empty() ? plain_.smallest() : plain_.lower_bound(box);
}

void check_motion(const Motion& motion) {
  if (!is_finite(motion.velocity) || !is_finite(motion.centre) || !is_finite(motion.axis) ||
      !std::isfinite(motion.degrees_rate))
    throw UsageError("motion: velocity, centre, axis and rate must be numbers");
  if (motion.degrees_rate != 0 && motion.axis == Point{})
    throw UsageError(
        fmt::format("motion: rate = {} but the axis is [0, 0, 0]; give the axis to turn about", motion.degrees_rate));
}

void check_sources(const std::vector<SizeSource>& sources, const SourceFieldOptions& options) {
  if (sources.empty())
    throw UsageError("size sources: there is none; give at least one [[size.source]] or [[size.box]]");
  if (!(options.growth > 1))
    throw UsageError(fmt::format("growth is {}; it must be a number greater than 1, e.g. 1.2", options.growth));
  if (!std::isfinite(options.time)) throw UsageError(fmt::format("size.time = {}: it must be a number", options.time));
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const SizeSource& source = sources[i];
    try {
      check_shape(source.shape);
      check_law(source.law);
      if (source.motion) check_motion(*source.motion);
      if (source.stretching) stretched_metric(1, *source.stretching);
    } catch (const UsageError& error) {
      const std::string group = source.group.empty() ? "" : fmt::format(" of group \"{}\"", source.group);
      throw UsageError(fmt::format("size source {}{}: {}", i + 1, group, error.what()));
    }
  }
}

}  // namespace

std::vector<SizeSource> select_sources(std::span<const SizeSource> sources, const std::string& pattern) {
  std::vector<SizeSource> selected;
  for (const SizeSource& source : sources)
    if (matches_pattern(source.group, pattern)) selected.push_back(source);
  return selected;
}

std::unique_ptr<SizeField> build_source_size_field(std::vector<SizeSource> sources, const SourceFieldOptions& options,
                                                   Context& context) {
  check_sources(sources, options);
  return std::make_unique<SourceSizeField>(sources, options, context);
}

}  // namespace delfront
