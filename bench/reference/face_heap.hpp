// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

namespace delfront::reference {

/// @brief The heap of the literature: the face that would make the smallest element stands at the root; any may go.
/// @par Source  Williams (1964); Löhner (2008), 2.5, 3.6 (F13)
/// @par Cost    O(log n) each
class FaceHeap {
 public:
  bool empty() const { return heap_.empty(); }
  std::uint32_t smallest() const { return heap_[0].second; }

  void insert(std::uint32_t face, float size) {
    if (place_.size() <= face) place_.resize(face + 1);
    heap_.push_back({size, face});
    place_[face] = static_cast<std::uint32_t>(heap_.size() - 1);
    rise(heap_.size() - 1);
  }

  void remove(std::uint32_t face) {
    const std::size_t at = place_[face];
    put(at, heap_.back());
    heap_.pop_back();
    if (at >= heap_.size()) return;
    rise(at);
    sink(at);
  }

 private:
  using Item = std::pair<float, std::uint32_t>;

  void put(std::size_t at, Item item) {
    heap_[at] = item;
    place_[item.second] = static_cast<std::uint32_t>(at);
  }
  void rise(std::size_t at) {
    const Item item = heap_[at];
    for (; at > 0 && item < heap_[(at - 1) / 2]; at = (at - 1) / 2) put(at, heap_[(at - 1) / 2]);
    put(at, item);
  }
  void sink(std::size_t at) {
    const Item item = heap_[at];
    for (;;) {
      std::size_t child = 2 * at + 1;
      if (child >= heap_.size()) break;
      if (child + 1 < heap_.size() && heap_[child + 1] < heap_[child]) ++child;
      if (!(heap_[child] < item)) break;
      put(at, heap_[child]);
      at = child;
    }
    put(at, item);
  }

  std::vector<Item> heap_;
  std::vector<std::uint32_t> place_;  ///< by face
};

}  // namespace delfront::reference
