#include "experiment/config_errors.hpp"

#include <algorithm>

namespace evodevo {
namespace {

/// Whether `key` is `table` or lies in it.
bool lies_in(std::string_view key, std::string_view table) {
  return key.starts_with(table) && (key.size() == table.size() || key[table.size()] == '.');
}

bool concerns(const KeyError& error, std::string_view name) {
  return lies_in(error.key, name) || lies_in(name, error.key);
}

}  // namespace

void ErrorCollector::add(const KeyError& error) {
  const auto is_same = [&](const KeyError& other) { return std::string_view(other.what()) == error.what(); };
  if (std::ranges::any_of(errors_, is_same)) return;
  errors_.push_back(error);
  if (errors_.size() == most) throw_errors();
}

void ErrorCollector::throw_error_in(std::string_view name) const {
  for (const KeyError& error : errors_)
    if (concerns(error, name)) throw error;
}

/// Errors that depend on others are found after those on which they depend. Errors that depend on nothing may be found
/// later, such as unknown keys.
bool ErrorCollector::may_be_caused(std::size_t index) const {
  for (const std::string& name : errors_[index].depends_on)
    for (std::size_t i = 0; i < errors_.size(); ++i)
      if ((i < index || errors_[i].depends_on.empty()) && concerns(errors_[i], name)) return true;
  return false;
}

void ErrorCollector::throw_errors() const {
  if (errors_.empty()) return;
  std::vector<KeyError> kept;
  for (std::size_t i = 0; i < errors_.size(); ++i)
    if (!may_be_caused(i)) kept.push_back(errors_[i]);
  std::ranges::stable_sort(kept, [](const KeyError& a, const KeyError& b) { return a.position < b.position; });
  throw ConfigErrors({kept.begin(), kept.end()}, errors_.size() < most);
}

}  // namespace evodevo
