#include "report/packing.hpp"

#include <zlib.h>

#include <cmath>
#include <stdexcept>

namespace evodevo {
namespace {

using Bytes = std::vector<unsigned char>;

void add_number(Bytes& bytes, std::int64_t number) {
  auto rest = static_cast<std::uint64_t>(number) << 1 ^ static_cast<std::uint64_t>(number >> 63);
  for (; rest >= 0x80; rest >>= 7) bytes.push_back(static_cast<unsigned char>(rest | 0x80));
  bytes.push_back(static_cast<unsigned char>(rest));
}

Bytes deflated(const Bytes& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  Bytes out(size);
  if (compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION) != Z_OK)
    throw std::runtime_error("zlib cannot compress " + std::to_string(bytes.size()) + " bytes");
  out.resize(size);
  return out;
}

std::string base64(const Bytes& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t at) { return at < bytes.size() ? std::uint32_t{bytes[at]} : 0u; };
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

std::string packed(std::span<const std::int64_t> numbers) {
  Bytes bytes;
  bytes.reserve(numbers.size());
  for (const std::int64_t number : numbers) add_number(bytes, number);
  return base64(deflated(bytes));
}

std::string packed_differences(std::span<const std::uint32_t> numbers) {
  std::vector<std::int64_t> differences;
  std::int64_t last = 0;
  for (const std::uint32_t number : numbers) {
    differences.push_back(number - last);
    last = number;
  }
  return packed(differences);
}

std::string packed_places(std::span<const Frame* const> frames, double step) {
  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> last, before_last;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::vector<SeenPlace>& places = frames[f]->places;
    std::vector<std::int64_t> now;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const SeenPlace& place : places) now.push_back(std::llround(place[axis] / step));
    for (std::size_t i = 0; i < now.size(); ++i) {
      std::int64_t guess = 0;
      if (f == 0) guess = i % places.size() == 0 ? 0 : now[i - 1];
      if (f == 1) guess = last[i];
      if (f > 1) guess = 2 * last[i] - before_last[i];
      numbers.push_back(now[i] - guess);
    }
    before_last = std::move(last);
    last = std::move(now);
  }
  return packed(numbers);
}

}  // namespace evodevo
