// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace delfront {

/// @brief A typed 32-bit id: `points[cell]` does not compile.
template <class Tag>
struct Id {
  std::uint32_t value = kNone;

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  constexpr Id() = default;
  constexpr explicit Id(std::size_t index) : value(static_cast<std::uint32_t>(index)) {}
  constexpr std::size_t index() const { return value; }
  constexpr bool is_valid() const { return value != kNone; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using VertexId = Id<struct VertexTag>;
using CellId = Id<struct CellTag>;
using TriangleId = Id<struct TriangleTag>;
using PatchId = Id<struct PatchTag>;
using CurveId = Id<struct CurveTag>;
using RegionId = Id<struct RegionTag>;
using GroupId = Id<struct GroupTag>;

/// @brief A contiguous array that only its own kind of id can index.
template <class IdType, class T>
class Array : public std::vector<T> {
 public:
  using std::vector<T>::vector;
  T& operator[](IdType id) { return std::vector<T>::operator[](id.index()); }
  const T& operator[](IdType id) const { return std::vector<T>::operator[](id.index()); }
  /// @brief The id that the next push_back will get.
  IdType next_id() const { return IdType(this->size()); }
};

}  // namespace delfront

template <class Tag>
struct std::hash<delfront::Id<Tag>> {
  std::size_t operator()(delfront::Id<Tag> id) const noexcept { return id.value; }
};
