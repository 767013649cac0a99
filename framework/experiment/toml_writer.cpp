#include "experiment/toml_writer.hpp"

namespace evodevo {

void TomlWriter::real(double& value, std::string_view name, Range, std::string_view) { add(name, value); }

void TomlWriter::integer(std::int64_t& value, std::string_view name, Range, std::string_view) { add(name, value); }

void TomlWriter::flag(bool& value, std::string_view name, std::string_view) { add(name, value); }

void TomlWriter::choice(std::string& value, std::string_view name, std::initializer_list<std::string_view>,
                        std::string_view) {
  add(name, value);
}

void TomlWriter::vector(Vec3& value, std::string_view name, Range, std::string_view) {
  add(name, toml::array{value.x, value.y, value.z});
}

void TomlWriter::vector_or_choice(Vec3& value, std::string& word, std::string_view name, Range range,
                                  std::initializer_list<std::string_view> options, std::string_view text) {
  if (word.empty())
    vector(value, name, range, text);
  else
    choice(word, name, options, text);
}

void TomlWriter::counts(std::array<std::int64_t, 3>& value, std::string_view name, Range, std::string_view) {
  add(name, toml::array{value[0], value[1], value[2]});
}

void TomlWriter::optional_real(std::optional<double>& value, std::string_view name, Range, std::string_view) {
  if (value) add(name, *value);
}

void TomlWriter::reals(std::vector<double>& value, std::string_view name, Range, std::string_view) {
  toml::array numbers;
  for (const double number : value) numbers.push_back(number);
  add(name, std::move(numbers));
}

void TomlWriter::text(std::string& value, std::string_view name, std::string_view) { add(name, value); }

void TomlWriter::file(InputFile& value, std::string_view name, std::string_view) {
  if (!value.path.empty()) add(name, value.path);
}

void TomlWriter::materials(std::vector<std::string>& value, std::string_view name, std::string_view) {
  toml::array names;
  for (const std::string& material : value) names.push_back(material);
  add(name, std::move(names));
}

void TomlWriter::require(bool, std::string_view, std::string_view) {}

void TomlWriter::real_or_auto(std::optional<double>& value, std::string_view name, Range, std::string_view) {
  if (value)
    add(name, *value);
  else
    add(name, "auto");
}

}  // namespace evodevo
