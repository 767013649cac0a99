// Reads JSON files that people write. Error messages give the place, the value and a remedy.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace evodevo {

/// One JSON file. All functions throw ConfigError if the file is faulty. The message begins with the name of the file
/// and `at`, the place in the file, such as "masses[3].mass".
class JsonInput {
 public:
  using Json = nlohmann::ordered_json;

  static constexpr double any = std::numeric_limits<double>::max();  ///< no upper bound

  explicit JsonInput(std::string file) : file_(std::move(file)) {}

  /// Parses the whole file. Throws ConfigError if the file is not JSON, has the same key twice in one object, has more
  /// than 16 levels of nesting, or is larger than 1 GiB.
  Json read() const;

  /// Throws ConfigError if `item` is not an object, or has a key that is not one of `keys`.
  void expect(const Json& item, const std::string& at, const std::vector<std::string>& keys) const;
  /// Returns the value of a key of `item`. Throws ConfigError if `item` has no such key.
  const Json& member(const Json& item, const std::string& at, const std::string& key) const;
  /// Returns `value` as a number. Throws ConfigError if it is not a finite number from `least` to `most`.
  double finite(const Json& value, const std::string& at, double least, double most = any) const;
  /// Returns the value of a key as a number. Throws like member() and finite().
  double number(const Json& item, const std::string& at, const std::string& key, double least, double most = any) const;
  /// Returns the value of a key as an index. Throws ConfigError if it is not a whole number from 0 to count-1.
  std::uint32_t index(const Json& item, const std::string& at, const std::string& key, std::size_t count) const;

  /// Calls `read(item, at)` for each item of the list that is the value of `key`.
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
