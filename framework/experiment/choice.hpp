// Options whose values are enumerators with names. The names are defined in one place, and are used to
// read, write, list and check options.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// The names of an enumeration's values, in the order of the enumerators. Each enumeration has a specialisation.
template <class Enum>
inline constexpr std::array<std::string_view, 0> names_of{};

template <class Enum>
constexpr std::string_view name_of(Enum value) {
  return names_of<Enum>.at(static_cast<std::size_t>(value));
}

/// Declares an option, whose value may be changed.
template <class Enum>
void choice(Parameters& parameters, Enum& value, std::string_view key, std::string_view text) {
  constexpr auto& names = names_of<Enum>;
  std::string name(name_of(value));
  parameters.declare({key, text, parameter::Choice{name, names}});
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) value = static_cast<Enum>(i);
}

}  // namespace evodevo
