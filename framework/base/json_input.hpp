// JSON files that people write: read with errors that name place, value and remedy.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace evodevo {

/// One file. All complaints are ConfigErrors that begin with the file and `at`, a place in it such as "masses[3].mass".
class JsonInput {
 public:
  using Json = nlohmann::ordered_json;

  explicit JsonInput(std::string file) : file_(std::move(file)) {}

  /// The whole file. Refuses what is no JSON, keys that stand twice in one object, more than 16 levels, and more than 1
  /// GiB.
  Json read() const;

  /// Refuses what is no object, and any key but `keys`.
  void expect(const Json& item, const std::string& at, const std::vector<std::string>& keys) const;
  /// Refuses an object without the key.
  const Json& member(const Json& item, const std::string& at, const std::string& key) const;
  /// A finite number that is at least `least`.
  double finite(const Json& value, const std::string& at, double least) const;
  double number(const Json& item, const std::string& at, const std::string& key, double least) const;
  /// A whole number from 0 that is less than `count`.
  std::uint32_t index(const Json& item, const std::string& at, const std::string& key, std::size_t count) const;

  /// Calls `read(item, at)` for all items of a list.
  template <class Read>
  void each(const Json& root, const std::string& key, const Read& read) const {
    const Json& list = member(root, "", key);
    if (!list.is_array()) fail(key, "expected a list");
    for (std::size_t i = 0; i < list.size(); ++i) read(list[i], key + "[" + std::to_string(i) + "]");
  }

  [[noreturn]] void fail(const std::string& at, const std::string& message) const;

 private:
  std::string file_;
};

}  // namespace evodevo
