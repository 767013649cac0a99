#include "experiment/toml_writer.hpp"

namespace evodevo {

void TomlWriter::declare(const Parameter& parameter) {
  std::visit([&](const auto& variable) { write(parameter.name, variable); }, parameter.variable);
}

template <class Variable>
void TomlWriter::write(std::string_view name, const Variable& variable) {
  add(name, variable.value);
}

void TomlWriter::write(std::string_view name, const parameter::Vector& vector) {
  add(name, toml::array{vector.value.x, vector.value.y, vector.value.z});
}

void TomlWriter::write(std::string_view name, const parameter::VectorOrChoice& either) {
  if (either.word.empty())
    write(name, parameter::Vector{either.value, either.range});
  else
    add(name, either.word);
}

void TomlWriter::write(std::string_view name, const parameter::Counts& counts) {
  add(name, toml::array{counts.value[0], counts.value[1], counts.value[2]});
}

void TomlWriter::write(std::string_view name, const parameter::OptionalReal& real) {
  if (real.value)
    add(name, *real.value);
  else if (!real.none.empty())
    add(name, real.none);
}

void TomlWriter::write(std::string_view name, const parameter::Reals& reals) {
  toml::array numbers;
  for (const double number : reals.value) numbers.push_back(number);
  add(name, std::move(numbers));
}

void TomlWriter::write(std::string_view name, const parameter::File& file) {
  if (!file.value.path.empty()) add(name, file.value.path);
}

void TomlWriter::write(std::string_view name, const parameter::Materials& materials) {
  toml::array names;
  for (const std::string& material : materials.value) names.push_back(material);
  add(name, std::move(names));
}

}  // namespace evodevo
