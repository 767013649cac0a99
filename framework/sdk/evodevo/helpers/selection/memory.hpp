// The memory of selection operators as bytes: finite numbers, lists of numbers and lists of such lists, written and
// read in the same order.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace evodevo {

/// Writes numbers, lists of numbers and lists of such lists as bytes. Throws std::runtime_error if a number is not
/// finite.
class MemoryWriter {
 public:
  template <class T>
  void write(T number) {
    static_assert(std::is_arithmetic_v<T>, "only numbers have the same bytes in every process");
    append(&number, 1);
  }
  template <class T>
  void write(const std::vector<T>& numbers) {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>, "a list of numbers");
    write(static_cast<std::uint64_t>(numbers.size()));
    append(numbers.data(), numbers.size());
  }
  template <class T>
  void write(const std::vector<std::vector<T>>& lists) {
    write(static_cast<std::uint64_t>(lists.size()));
    for (const std::vector<T>& list : lists) write(list);
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }

  /// Whether all of `count` numbers are finite, as whole numbers always are.
  template <class T>
  static bool are_finite(const T* numbers, std::size_t count) {
    if constexpr (std::is_floating_point_v<T>)
      return std::all_of(numbers, numbers + count, [](T number) { return std::isfinite(number); });
    return true;
  }

 private:
  template <class T>
  void append(const T* numbers, std::size_t count) {
    if (!are_finite(numbers, count)) throw std::runtime_error("remembers a number that is not finite");
    const auto* first = reinterpret_cast<const std::byte*>(numbers);
    bytes_.insert(bytes_.end(), first, first + count * sizeof(T));
  }

  std::vector<std::byte> bytes_;
};

/// Reads what MemoryWriter has written, in the same order. Throws std::runtime_error if there are too few bytes, or if
/// a number is not finite.
class MemoryReader {
 public:
  explicit MemoryReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T read() {
    static_assert(std::is_arithmetic_v<T>, "a number");
    T number{};
    take(&number, 1);
    return number;
  }
  template <class T>
  std::vector<T> read_list() {
    const auto count = read<std::uint64_t>();
    require(count, sizeof(T));  // before memory is allocated for them
    std::vector<T> numbers(count);
    take(numbers.data(), count);
    return numbers;
  }
  template <class T>
  std::vector<std::vector<T>> read_lists() {
    const auto count = read<std::uint64_t>();
    require(count, sizeof count);  // at least the length of each list
    std::vector<std::vector<T>> lists(count);
    for (std::vector<T>& list : lists) list = read_list<T>();
    return lists;
  }

  /// The number of bytes that have not been read.
  std::size_t left() const { return bytes_.size() - next_; }
  /// Throws std::runtime_error if bytes are left.
  void finish() const {
    if (left() > 0) fail("has " + std::to_string(left()) + " bytes too many");
  }
  /// Throws std::runtime_error: the memory is not what the operator writes. `what` says why, after "memory ".
  [[noreturn]] static void fail(const std::string& what) {
    throw std::runtime_error("memory " + what + "; it was written by another version of this operator");
  }

 private:
  void require(std::uint64_t count, std::size_t size) const {
    if (count > left() / size)
      fail("ends after " + std::to_string(bytes_.size()) + " bytes; expected " + std::to_string(count) +
           " numbers of " + std::to_string(size) + " bytes at byte " + std::to_string(next_));
  }
  template <class T>
  void take(T* to, std::uint64_t count) {
    require(count, sizeof(T));
    if (count > 0) std::memcpy(to, bytes_.data() + next_, count * sizeof(T));
    if (!MemoryWriter::are_finite(to, count))
      fail("has a number that is not finite before byte " + std::to_string(next_ + count * sizeof(T)));
    next_ += count * sizeof(T);
  }

  std::span<const std::byte> bytes_;
  std::size_t next_ = 0;
};

}  // namespace evodevo
