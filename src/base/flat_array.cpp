// SPDX-License-Identifier: Apache-2.0
#include "base/flat_array.hpp"

#include <sys/mman.h>

#include <cstring>
#include <new>

namespace delfront {

namespace {

constexpr std::size_t kLarge = std::size_t{1} << 21;  ///< from here on pages of their own, large ones where there are
constexpr std::align_val_t kAlignment{64};

void prefer_large_pages([[maybe_unused]] void* pages, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  madvise(pages, bytes, MADV_HUGEPAGE);  // a wish: nothing is lost where it is not heard
#endif
}

void* allocate(std::size_t bytes) {
  if (bytes < kLarge) return ::operator new(bytes, kAlignment);
  void* const pages = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED) throw std::bad_alloc();
  prefer_large_pages(pages, bytes);
  return pages;
}

void release(void* memory, std::size_t bytes) {
  if (bytes < kLarge)
    ::operator delete(memory, kAlignment);
  else
    munmap(memory, bytes);
}

}  // namespace

void* move_memory(void* old, std::size_t old_bytes, std::size_t bytes) {
#ifdef __linux__
  if (old_bytes >= kLarge && bytes >= kLarge) {
    void* const moved = mremap(old, old_bytes, bytes, MREMAP_MAYMOVE);
    if (moved == MAP_FAILED) throw std::bad_alloc();
    prefer_large_pages(moved, bytes);
    return moved;
  }
#endif
  void* const fresh = bytes > 0 ? allocate(bytes) : nullptr;
  if (old && fresh) std::memcpy(fresh, old, old_bytes < bytes ? old_bytes : bytes);
  if (old) release(old, old_bytes);
  return fresh;
}

}  // namespace delfront
