// Text that can be composed where no memory may be allocated, such as in a signal handler.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>

namespace evodevo {

/// A text in a buffer of fixed size. Text that does not fit is cut off.
class Line {
 public:
  Line& operator<<(std::string_view text) {
    const std::size_t fits = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.data(), fits, text_.data() + size_);
    size_ += fits;
    return *this;
  }
  Line& operator<<(std::int64_t number) {
    std::array<char, 24> digits;
    const char* end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return *this << std::string_view(digits.data(), end);
  }

  std::string_view text() const { return {text_.data(), size_}; }
  void write_to(int file) const { [[maybe_unused]] const ssize_t written = write(file, text_.data(), size_); }

 private:
  std::array<char, 8192> text_;  // enough for two paths of the maximum length that Linux allows
  std::size_t size_ = 0;
};

}  // namespace evodevo
