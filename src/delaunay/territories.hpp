// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "base/hilbert.hpp"
#include "delaunay/delaunay.hpp"

namespace delfront {

/// @brief Curves over the vertices of a complex, each with its cells elsewhere, so that borders of territories along
/// one lie inside of territories along another.
inline constexpr int kNumCurves = 3;
HilbertCurve curve_over(const TetComplex& complex, int number);

/// @brief The upper half of a place along a curve: what territories are told apart by.
inline std::uint32_t territory_key(std::uint64_t place) { return static_cast<std::uint32_t>(place >> 31); }

/// @brief Items in the order of their keys, cut into parts of equal number, with a kernel confined to each.
///
/// The parts depend on the items alone, never on the number of threads.
class Territories {
 public:
  struct Part {
    std::size_t begin, end;  ///< items
    Territory territory;
    SlotStock slots;
    DelaunayKernel kernel;
  };

  /// @param key_of_item     by item, not falling
  /// @param slots_per_item  how many tets an item may add, on average over a part
  /// With one part its kernel may touch everything.
  Territories(TetComplex& complex, std::size_t num_parts, std::size_t num_items,
              const std::function<std::uint32_t(std::size_t)>& key_of_item, std::size_t slots_per_item);

  /// @brief Run `work` on every part, with its kernel, in up to `threads` threads.
  /// @param key_of_vertex  by vertex of the complex
  void run(const std::uint32_t* key_of_vertex, int threads, const std::function<void(Part&, std::size_t number)>& work);

  /// @brief Give the slots back and add up what the kernels did.
  void finish(KernelCounts& counts);

  std::size_t size() const { return parts_.size(); }
  Part& operator[](std::size_t i) { return parts_[i]; }

 private:
  TetComplex& c_;
  std::vector<Part> parts_;
};

/// @brief Insert vertices that stand in the complex already, in biased random order and on all threads.
/// @param vertices  along a space-filling curve, numbered so that those of near numbers are near
/// @param start     a live tet to walk from where no better one is known
///
/// Those that `limits` refuses stay without a tet.
/// @par Source  insertion order: Amenta, Choi & Rote (2003)
void insert_batch(TetComplex& complex, std::span<const VertexIndex> vertices, const DelaunayKernel::Limits& limits,
                  TetIndex start, KernelCounts& counts, Context& context);

}  // namespace delfront
