// SPDX-License-Identifier: Apache-2.0
#include "report/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/with_commas.hpp"

namespace delfront {

namespace {

constexpr double kWidth = 340, kHeight = 132, kLeft = 34, kRight = 8, kTop = 8, kBottom = 20;
constexpr double kPlotWidth = kWidth - kLeft - kRight, kPlotHeight = kHeight - kTop - kBottom;

/// 1, 10, 1k, 1M.
std::string power_text(int power) {
  static const char* const kPrefix[] = {"", "k", "M", "G", "T"};
  const int group = std::min(power / 3, 4);
  std::string text = "1";
  text.append(static_cast<std::size_t>(power - 3 * group), '0');
  return text + kPrefix[group];
}

/// Heights go with log10, and one is a tenth of the first power, so that it can be seen.
class Scale {
 public:
  explicit Scale(std::size_t most) : top_(std::max(1.0, std::ceil(std::log10(std::max<double>(2, double(most)))))) {}
  double height(double count) const {
    constexpr double kOne = 0.25;  // powers of ten that a bar of one is high
    return count < 1 ? 0 : kPlotHeight * (std::log10(count) + kOne) / (top_ + kOne);
  }
  int top() const { return static_cast<int>(top_); }

 private:
  double top_;
};

std::string value_text(double value) { return fmt::format("{:.3g}", value); }

std::string axis(double low, double high, const std::string& unit, const Scale& scale) {
  std::string svg;
  const int step = scale.top() > 4 ? 2 : 1;
  for (int power = 0; power <= scale.top(); power += step) {
    const double y = kTop + kPlotHeight - scale.height(std::pow(10, power));
    svg += fmt::format(R"(<line class="grid" x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}"/>)", kLeft,
                       kWidth - kRight, y, y);
    svg += fmt::format(R"(<text class="tick" text-anchor="end" x="{:.1f}" y="{:.1f}">{}</text>)", kLeft - 5, y + 3.5,
                       power_text(power));
  }
  constexpr int kTicks = 4;
  for (int i = 0; i <= kTicks; ++i) {
    const double share = double(i) / kTicks;
    svg += fmt::format(R"(<text class="tick" text-anchor="{}" x="{:.1f}" y="{:.1f}">{}{}</text>)",
                       i == 0        ? "start"
                       : i == kTicks ? "end"
                                     : "middle",
                       kLeft + share * kPlotWidth, kHeight - 6, value_text(low + share * (high - low)),
                       unit == "deg" ? "°" : "");
  }
  return svg;
}

bool is_bad(double low, double high, const Marks& marks) {
  return (marks.at_least && high <= *marks.at_least) || (marks.at_most && low >= *marks.at_most);
}

}  // namespace

std::string histogram_svg(const Json& histogram, const std::string& unit, const Marks& marks) {
  const auto counts = part_of(histogram, "counts").get<std::vector<std::size_t>>();
  if (!part_of(histogram, "low").is_number() || !part_of(histogram, "high").is_number()) return "";  // not finite
  const double low = part_of(histogram, "low").get<double>(), high = part_of(histogram, "high").get<double>();
  const std::size_t bins = counts.size();
  if (bins == 0) return "";
  const Scale scale(*std::max_element(counts.begin(), counts.end()));
  std::string svg = fmt::format(R"(<svg class="chart" viewBox="0 0 {} {}" role="img">)", kWidth, kHeight);
  svg += axis(low, high, unit, scale);
  const double step = kPlotWidth / double(bins), width = (high - low) / double(bins);
  for (std::size_t i = 0; i < bins; ++i) {
    const double height = scale.height(double(counts[i]));
    const double from = low + double(i) * width, to = from + width;
    const std::string range =
        fmt::format("{} to {}{}", value_text(from), value_text(to), i + 1 == bins ? " and more" : "");
    svg += fmt::format(
        R"(<rect class="bar{}" x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}"><title>{}: {}</title></rect>)",
        is_bad(from, to, marks) ? " bad" : "", kLeft + double(i) * step + 0.5, kTop + kPlotHeight - height,
        std::max(step - 1, 0.5), height, range, with_commas(counts[i]));
  }
  return svg + fmt::format(R"(<line class="axis" x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}"/></svg>)", kLeft,
                           kWidth - kRight, kTop + kPlotHeight, kTop + kPlotHeight);
}

}  // namespace delfront
