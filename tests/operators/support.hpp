// Loads operators from their libraries, for tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "base/philox.hpp"
#include "experiment/toml_reader.hpp"
#include "operators/loader.hpp"

namespace evodevo::test {

inline const Registry& registry() {
  static const Registry registry({builtin_plugin_folder()});
  return registry;
}

/// A context with the paper's materials in alphabetical order.
inline EncodingContext context() {
  const double pi = 3.14159265358979323846;
  return {{"air", "bone", "muscle", "muscle2", "tissue"},
          {{0, 0, 0, 0}, {10000, 0, 0, 0}, {5000, 0.14, 1, 0}, {5000, 0.14, 1, pi}, {4000, 0, 0, 0}},
          0.2,
          philox};
}
enum : std::int32_t { air, bone, muscle, muscle2, tissue };

/// Creates an operator with the parameters that `toml` sets.
template <class T>
std::unique_ptr<T> make(const std::string& name, const std::string& toml = "") {
  const AvailableOperator* available = registry().find(T::kind, name);
  if (available == nullptr) throw std::runtime_error("no " + std::string(T::kind) + " named " + name);
  auto op = create<T>(*available);
  const toml::table table = parse_toml(toml, "test.toml");
  const std::vector<std::string> materials = context().material_names;
  TomlReader reader(table, "test", {&materials});
  op->parameters(reader);
  reader.finish();
  op->prepare(context());
  return op;
}

/// Returns what an encoding makes of a genome of its layout.
inline Blueprint decoded(const Encoding& encoding, const Genome& genome) {
  return encoding.decode(genome, encoding.layout(context()), context());
}

inline Rng stream(std::uint64_t seed) { return Rng(philox, {seed, 1, 2, 3}); }

}  // namespace evodevo::test
