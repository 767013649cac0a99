#include "report/packing.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

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

std::string packed_changes(std::span<const std::uint32_t> before, std::span<const std::uint32_t> after) {
  std::vector<std::uint32_t> changed;
  std::ranges::set_symmetric_difference(before, after, std::back_inserter(changed));
  return packed_differences(changed);
}

std::string ValuePacking::next(std::span<const std::uint32_t> numbers, std::span<const std::int64_t> values) {
  std::vector<std::int64_t> differences;
  for (std::size_t i = 0; i < values.size(); ++i)
    differences.push_back(values[i] - std::exchange(last_[numbers[i]], values[i]));
  return packed(differences);
}

std::int64_t whole_steps(double value, double step) {
  constexpr double most = 1 << 29;
  return std::llround(std::clamp(value / step, -most, most));
}

std::string PlacePacking::next(std::span<const Frame* const> frames, std::span<const std::uint32_t> numbers) {
  std::vector<std::int64_t> differences, last, before_last;
  for (const Frame* frame : frames) {
    std::vector<std::int64_t> now = positions(*frame);
    const bool first = last.empty();
    if (first) before_last = last = first_guess(now, numbers);
    for (std::size_t i = 0; i < now.size(); ++i)
      differences.push_back(now[i] - (last[i] + ((last[i] - before_last[i]) >> 1)));
    before_last = first ? now : std::move(last);
    last = std::move(now);
  }
  keep(last, numbers);
  return packed(differences);
}

std::vector<std::int64_t> PlacePacking::positions(const Frame& frame) const {
  std::vector<std::int64_t> positions;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const SeenPlace& position : frame.positions) positions.push_back(whole_steps(position[axis], step_));
  return positions;
}

std::vector<std::int64_t> PlacePacking::first_guess(std::span<const std::int64_t> now,
                                                    std::span<const std::uint32_t> numbers) const {
  const std::size_t masses = numbers.size();
  std::vector<std::int64_t> guess(now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    const std::size_t mass = i % masses;
    if (known_[numbers[mass]])
      guess[i] = last_[i / masses * known_.size() + numbers[mass]];
    else if (mass > 0)
      guess[i] = now[i - 1];
  }
  return guess;
}

void PlacePacking::keep(std::span<const std::int64_t> last, std::span<const std::uint32_t> numbers) {
  for (std::size_t i = 0; i < last.size(); ++i)
    last_[i / numbers.size() * known_.size() + numbers[i % numbers.size()]] = last[i];
  for (const std::uint32_t number : numbers) known_[number] = true;
}

}  // namespace evodevo
