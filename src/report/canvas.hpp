// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// Red, green, blue: 0 to 1.
using Colour = std::array<float, 3>;

/// @brief Paper with a depth for each dot: what is nearer to the reader stays. Drawn with twice as many dots each way
/// as the picture has, so that slanted borders are smooth.
class Canvas {
 public:
  Canvas(int width, int height);

  /// In dots of the canvas, y down; z towards the reader.
  struct Corner {
    double x, y, z;
  };

  /// What is drawn with, and whose it is.
  struct Ink {
    Colour colour{};
    std::uint32_t owner = 0;
  };
  /// @brief A triangle with lines of `line` along those of its sides that are asked for: side k begins at corner k.
  void fill(const std::array<Corner, 3>& corners, Ink ink, Colour line, const std::array<bool, 3>& has_line);
  /// @brief A line, over what is not nearer by more than `lift`.
  void stroke(Corner from, Corner to, Ink ink, double lift);

  int width() const { return width_; }
  int height() const { return height_; }
  /// @brief Owners of what can be seen.
  std::set<std::uint32_t> seen() const;
  /// @brief The picture at half of the canvas's dots: PNG with 8 bits a colour, transparent where nothing was drawn.
  std::string to_png() const;

 private:
  struct Dot {
    Ink ink;
    float depth = -std::numeric_limits<float>::infinity();
    bool is_drawn() const { return depth > -std::numeric_limits<float>::infinity(); }
  };
  Dot& dot(int x, int y) { return dots_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }
  const Dot& dot(int x, int y) const { return dots_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }

  int width_, height_;  ///< in dots
  std::vector<Dot> dots_;
};

/// @brief A picture as PNG (ISO/IEC 15948): colours with alpha, 8 bits each, rows from the top.
/// @param bytes  4 a dot
std::string to_png(int width, int height, const std::vector<std::uint8_t>& bytes);

}  // namespace delfront
