// SPDX-License-Identifier: Apache-2.0
#include "report/canvas.hpp"

#include <algorithm>
#include <cmath>

namespace delfront {
namespace {

constexpr int kFine = 2;        ///< dots of the canvas along one of the picture
constexpr double kLine = 0.75;  ///< half of a line's width, in dots

/// Twice the area of a, b, p: its share of that of the whole triangle is the weight of the corner opposite a b.
double side_of(const Canvas::Corner& a, const Canvas::Corner& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

int clamped(double value, int last) { return static_cast<int>(std::clamp(value, 0.0, double(last))); }

}  // namespace

Canvas::Canvas(int width, int height)
    : width_(kFine * width), height_(kFine * height), dots_(std::size_t(width_) * std::size_t(height_)) {}

void Canvas::fill(const std::array<Corner, 3>& c, Ink ink, Colour line, const std::array<bool, 3>& has_line) {
  const double area = side_of(c[0], c[1], c[2].x, c[2].y);
  if (!(std::abs(area) > 0)) return;
  const auto [x_low, x_high] = std::minmax({c[0].x, c[1].x, c[2].x});
  const auto [y_low, y_high] = std::minmax({c[0].y, c[1].y, c[2].y});
  if (x_high < 0 || y_high < 0 || x_low > width_ - 1 || y_low > height_ - 1) return;
  std::array<double, 3> reach{};  // of lines, as a share of the area
  for (std::size_t k = 0; k < 3; ++k) {
    const Corner &a = c[k], &b = c[(k + 1) % 3];
    if (has_line[k]) reach[k] = kLine * std::hypot(b.x - a.x, b.y - a.y) / std::abs(area);
  }
  for (int y = clamped(std::ceil(y_low), height_ - 1); y <= clamped(y_high, height_ - 1); ++y)
    for (int x = clamped(std::ceil(x_low), width_ - 1); x <= clamped(x_high, width_ - 1); ++x) {
      std::array<double, 3> share;  // of sides 0, 1, 2
      for (std::size_t k = 0; k < 3; ++k) share[k] = side_of(c[k], c[(k + 1) % 3], x, y) / area;
      if (share[0] < 0 || share[1] < 0 || share[2] < 0) continue;
      const auto depth = static_cast<float>(share[1] * c[0].z + share[2] * c[1].z + share[0] * c[2].z);
      Dot& at = dot(x, y);
      if (!(depth > at.depth)) continue;
      const bool is_on_line = share[0] < reach[0] || share[1] < reach[1] || share[2] < reach[2];
      at = {{is_on_line ? line : ink.colour, ink.owner}, depth};
    }
}

void Canvas::stroke(Corner from, Corner to, Ink ink, double lift) {
  const double steps = std::ceil(std::max({std::abs(to.x - from.x), std::abs(to.y - from.y), 1.0}));
  if (!(steps < 1e5)) return;  // as good as at infinity
  for (double k = 0; k <= steps; ++k) {
    const double t = k / steps;
    const auto depth = static_cast<float>(from.z + t * (to.z - from.z) + lift);
    const double x = from.x + t * (to.x - from.x), y = from.y + t * (to.y - from.y);
    for (int i = 0; i < kFine; ++i)
      for (int j = 0; j < kFine; ++j) {
        const double column = std::floor(x) + i, row = std::floor(y) + j;
        if (column < 0 || row < 0 || column >= width_ || row >= height_) continue;
        Dot& at = dot(int(column), int(row));
        if (depth > at.depth) at = {ink, depth};
      }
  }
}

std::set<std::uint32_t> Canvas::seen() const {
  std::set<std::uint32_t> owners;
  for (const Dot& at : dots_)
    if (at.is_drawn()) owners.insert(at.ink.owner);
  return owners;
}

std::string Canvas::to_png() const {
  const int width = width_ / kFine, height = height_ / kFine;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(std::size_t(4 * width) * std::size_t(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::array<float, 3> sum{};
      int drawn = 0;
      for (int i = 0; i < kFine * kFine; ++i) {
        const Dot& at = dot(kFine * x + i % kFine, kFine * y + i / kFine);
        if (!at.is_drawn()) continue;
        ++drawn;
        for (std::size_t k = 0; k < 3; ++k) sum[k] += at.ink.colour[k];
      }
      for (const float part : sum)
        bytes.push_back(
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(drawn ? part / float(drawn) : 0, 0.f, 1.f))));
      bytes.push_back(static_cast<std::uint8_t>(255 * drawn / (kFine * kFine)));
    }
  return delfront::to_png(width, height, bytes);
}

}  // namespace delfront
