// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>

namespace delfront {

/// @brief Memory of `bytes` at a multiple of 64 that takes over what `old` (of old_bytes) held, which is freed. Large
/// pieces are moved page by page, not copied. Either size may be 0 (null).
/// @throws std::bad_alloc
void* move_memory(void* old, std::size_t old_bytes, std::size_t bytes);

/// @brief A growing array for the largest data of the program: what std::vector does, at half its peak memory.
///
/// Growth moves pages instead of copying bytes where arrays are large, so that the old and the new one are never both
/// resident; new elements are not touched before they are written; it grows by a quarter at a time.
template <class T>
class FlatArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  FlatArray() = default;
  FlatArray(const FlatArray& other) { assign(other.begin(), other.end()); }
  FlatArray(FlatArray&& other) noexcept { swap(other); }
  FlatArray& operator=(FlatArray other) noexcept {
    swap(other);
    return *this;
  }
  ~FlatArray() { move_memory(data_, capacity_ * sizeof(T), 0); }
  void swap(FlatArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  T& back() { return data_[size_ - 1]; }
  const T& back() const { return data_[size_ - 1]; }

  void push_back(const T& value) {
    const T copy = value;  // may be one of ours
    grow_to(size_ + 1);
    data_[size_++] = copy;
  }
  void reserve_more(std::size_t count) { grow_to(size_ + count); }
  /// @brief push_back where bit is 1, nothing where it is 0, without a branch. @pre there is room: reserve_more()
  void push_if(T value, unsigned bit) {
    data_[size_] = value;
    size_ += bit;
  }
  void pop_back() { --size_; }
  void clear() { size_ = 0; }
  /// @brief New elements hold nothing in particular.
  void resize(std::size_t size) {
    grow_to(size);
    size_ = size;
  }
  void resize(std::size_t size, const T& value) {
    const T copy = value;
    const std::size_t old = size_;
    resize(size);
    if (size > old) std::fill(data_ + old, data_ + size, copy);
  }
  template <class Iterator>
  void assign(Iterator first, Iterator last) {
    resize(static_cast<std::size_t>(std::distance(first, last)));
    std::copy(first, last, data_);
  }
  void assign(std::size_t size, const T& value) {
    clear();
    resize(size, value);
  }
  void reserve(std::size_t capacity) {
    if (capacity > capacity_) reallocate(capacity);
  }
  void shrink_to_fit() {
    if (capacity_ > size_) reallocate(size_);
  }
  /// @brief Give everything back.
  void release() { FlatArray().swap(*this); }

  friend bool operator==(const FlatArray& a, const FlatArray& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  void grow_to(std::size_t size) {
    if (size > capacity_) reallocate(std::max(size, capacity_ + capacity_ / 4 + 16));
  }
  void reallocate(std::size_t capacity) {
    data_ = static_cast<T*>(move_memory(data_, capacity_ * sizeof(T), capacity * sizeof(T)));
    capacity_ = capacity;
  }

  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace delfront
