// Takes values from the bytes of an input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace evodevo {

/// Takes values from the front of an input. What is missing reads as 0.
class Input {
 public:
  explicit Input(std::string_view bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }

  template <class Number>
  Number number() {
    Number number{};
    const std::string_view taken = take(sizeof number);
    if (!taken.empty()) std::memcpy(&number, taken.data(), taken.size());
    return number;
  }
  /// Takes a number below `count`, which is at least 1.
  std::size_t below(std::size_t count) { return number<std::uint8_t>() % count; }
  /// Takes a text, before which its length is.
  std::string_view text() { return take(number<std::uint8_t>()); }
  std::string_view rest() { return take(bytes_.size()); }

 private:
  std::string_view take(std::size_t count) {
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(taken.size());
    return taken;
  }

  std::string_view bytes_;
};

}  // namespace evodevo
