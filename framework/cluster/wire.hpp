// Turns messages into bytes and back. Numbers are not converted: all ranks run on machines whose numbers have the same
// sizes and the same order of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace evodevo {

/// Thrown if bytes are not the message that a reader expects.
class WireError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Types other than numbers, enumerations, texts and containers say of what they consist in a function
/// for_each_part(wire, value), which both ends call. For each enumeration, whose values are numbered from 0, a function
/// last_of(value) returns the last one.
class WireWriter {
 public:
  /// Appends values.
  template <class... Values>
  void operator()(const Values&... values) {
    (write(values), ...);
  }

  std::string bytes() && { return std::move(bytes_); }

 private:
  template <class Value>
  void write(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>)
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    else
      for_each_part(*this, const_cast<Value&>(value));  // which only reads it
  }
  void write(const std::string& text) {
    write(text.size());
    bytes_ += text;
  }
  template <class Value>
  void write(const std::vector<Value>& values) {
    write(values.size());
    if constexpr (std::is_arithmetic_v<Value>)
      bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
    else
      for (const Value& value : values) write(value);
  }
  template <class Key, class Value>
  void write(const std::map<Key, Value>& entries) {
    write(entries.size());
    for (const auto& [key, value] : entries) write(key), write(value);
  }
  template <class Value>
  void write(const std::optional<Value>& value) {
    write(value.has_value());
    if (value) write(*value);
  }

  std::string bytes_;
};

/// Reads what a WireWriter has written.
class WireReader {
 public:
  /// The bytes must outlive the reader.
  explicit WireReader(std::string_view bytes) : bytes_(bytes) {}

  /// Reads values, in the order in which they were written. Throws WireError if there are too few bytes.
  template <class... Values>
  void operator()(Values&... values) {
    (read(values), ...);
  }

  /// Throws WireError if there are bytes that have not been read.
  void expect_end() const {
    if (!bytes_.empty()) throw WireError("a message between ranks is too long");
  }

  template <class Value>
  Value next() {
    Value value{};
    read(value);
    return value;
  }

 private:
  const char* take(std::size_t count) {
    if (count > bytes_.size()) throw WireError("a message between ranks is too short");
    const char* const begin = bytes_.data();
    bytes_.remove_prefix(count);
    return begin;
  }
  template <class Value>
  void read(Value& value) {
    if constexpr (std::is_arithmetic_v<Value>)
      std::memcpy(&value, take(sizeof value), sizeof value);
    else if constexpr (std::is_enum_v<Value>)
      read_enumerator(value);
    else
      for_each_part(*this, value);
  }
  template <class Enumeration>
  void read_enumerator(Enumeration& value) {
    using Number = std::underlying_type_t<Enumeration>;
    static_assert(std::is_unsigned_v<Number>);
    const auto number = next<Number>();
    constexpr auto last = static_cast<Number>(last_of(Enumeration{}));
    if (number > last)
      throw WireError("a message between ranks has " + std::to_string(number) + " where it names one of " +
                      std::to_string(last + 1) + " values");
    value = static_cast<Enumeration>(number);
  }
  void read(bool& value) {
    const auto byte = next<std::uint8_t>();
    if (byte > 1) throw WireError("a message between ranks has " + std::to_string(byte) + " where it says yes or no");
    value = byte == 1;
  }
  void read(std::string& text) {
    const auto size = next<std::size_t>();
    text.assign(take(size), size);
  }
  template <class Value>
  void read(std::vector<Value>& values) {
    const auto size = next<std::size_t>();
    if constexpr (std::is_arithmetic_v<Value>) {
      if (size > bytes_.size() / sizeof(Value)) throw WireError("a message between ranks is too short");
      values.resize(size);
      if (size > 0)  // memcpy() must not get the null pointer that data() may return
        std::memcpy(values.data(), take(size * sizeof(Value)), size * sizeof(Value));
    } else {
      values.clear();
      for (std::size_t i = 0; i < size; ++i) values.push_back(next<Value>());
    }
  }
  template <class Key, class Value>
  void read(std::map<Key, Value>& entries) {
    const auto size = next<std::size_t>();
    for (std::size_t i = 0; i < size; ++i) {
      Key key = next<Key>();
      entries[std::move(key)] = next<Value>();
    }
  }
  template <class Value>
  void read(std::optional<Value>& value) {
    value.reset();
    if (next<bool>()) value.emplace(next<Value>());
  }

  std::string_view bytes_;
};

}  // namespace evodevo
