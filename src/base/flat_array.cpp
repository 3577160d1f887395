// SPDX-License-Identifier: Apache-2.0
#include "base/flat_array.hpp"

#include <sys/mman.h>

#include <cstdint>
#include <cstring>
#include <new>

namespace delfront {

namespace {

constexpr std::size_t kLargePage = std::size_t{1} << 21;
constexpr std::size_t kLarge = kLargePage;  ///< bytes: from here on pages of their own, large ones where there are
constexpr std::align_val_t kAlignment{64};

std::size_t whole_pages(std::size_t bytes) { return (bytes + kLargePage - 1) / kLargePage * kLargePage; }

void prefer_large_pages([[maybe_unused]] void* pages, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  madvise(pages, bytes, MADV_HUGEPAGE);  // a wish: nothing is lost where it is not heard
#endif
}

/// Addresses that begin at a large page: elsewhere memory is had in small ones, at ten times the price of a first
/// touch.
/// @param bytes  of whole pages
void* map_pages(std::size_t bytes) {
  const std::size_t more = bytes + kLargePage;
  void* const mapped = mmap(nullptr, more, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  char* const begin = static_cast<char*>(mapped);
  const std::size_t before = (kLargePage - reinterpret_cast<std::uintptr_t>(begin) % kLargePage) % kLargePage;
  if (before > 0) munmap(begin, before);
  munmap(begin + before + bytes, more - before - bytes);
  prefer_large_pages(begin + before, bytes);
  return begin + before;
}

void* allocate(std::size_t bytes) {
  return bytes < kLarge ? ::operator new(bytes, kAlignment) : map_pages(whole_pages(bytes));
}

void release(void* memory, std::size_t bytes) {
  if (bytes < kLarge)
    ::operator delete(memory, kAlignment);
  else
    munmap(memory, whole_pages(bytes));
}

#ifdef __linux__
/// Both of whole pages.
void* move_pages(void* old, std::size_t old_bytes, std::size_t bytes) {
  void* moved = mremap(old, old_bytes, bytes, 0);  // in its place, where there is room behind it
  if (moved == MAP_FAILED) {
    void* const fresh = map_pages(bytes);
    moved = mremap(old, old_bytes, bytes, MREMAP_MAYMOVE | MREMAP_FIXED, fresh);
    if (moved == MAP_FAILED) {
      munmap(fresh, bytes);
      throw std::bad_alloc();
    }
  }
  prefer_large_pages(moved, bytes);
  return moved;
}
#endif

}  // namespace

void* move_memory(void* old, std::size_t old_bytes, std::size_t bytes) {
#ifdef __linux__
  if (old_bytes >= kLarge && bytes >= kLarge) return move_pages(old, whole_pages(old_bytes), whole_pages(bytes));
#endif
  void* const fresh = bytes > 0 ? allocate(bytes) : nullptr;
  if (old && fresh) std::memcpy(fresh, old, old_bytes < bytes ? old_bytes : bytes);
  if (old) release(old, old_bytes);
  return fresh;
}

}  // namespace delfront
