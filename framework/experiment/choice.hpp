// Options whose values are enumerators with names. The names are defined in one place, and are used to
// read, write, list and check options.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// The names of an enumeration's values, in the order of the enumerators. Each enumeration has a specialisation.
template <class Enum>
inline constexpr std::array<std::string_view, 0> names_of{};

template <class Enum>
constexpr std::string_view name_of(Enum value) {
  return names_of<Enum>.at(static_cast<std::size_t>(value));
}

/// Declares an option to a visitor of parameters. The visitor may change `value`.
template <class Enum>
void choice(Parameters& visitor, Enum& value, std::string_view key, std::string_view text) {
  constexpr auto& names = names_of<Enum>;
  std::string name(name_of(value));
  [&]<std::size_t... I>(std::index_sequence<I...>) { visitor.choice(name, key, {names[I]...}, text); }
  (std::make_index_sequence<names.size()>());
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) value = static_cast<Enum>(i);
}

}  // namespace evodevo
