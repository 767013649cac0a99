// A plugin as the host sees it: its manifest, the parameters that its operator declares, what the operator asks to
// observe and scores, and then the text of an experiment that uses it.

#include "base/text.hpp"
#include "experiment/tables/fitness.hpp"
#include "fuzz/input.hpp"
#include "fuzz/plugin_library.hpp"
#include "fuzz/target.hpp"
#include "operators/declarations.hpp"
#include "operators/describe.hpp"

namespace evodevo {
namespace {

/// A declared parameter, with a variable of each type.
struct Declared {
  std::size_t type = 0;
  std::string name, unit, text, option;
  std::array<std::string, 3> options;
  Range range;
  double real = 0;
  std::int64_t integer = 0;
  bool flag = false;
  std::optional<double> optional_real;
  std::vector<double> reals;
  Vec3 vector;
  std::array<std::int64_t, 3> counts{};
  std::string words;
  InputFile file;
  std::vector<std::string> materials;

  static constexpr std::size_t types = 13;
};

std::string text_in(Input& input) { return std::string(input.text()); }

/// Takes a number: often a small whole one, so that ranges and values meet.
double number_in(Input& input) {
  const auto whole = input.number<std::int8_t>();
  return whole == -128 ? input.number<double>() : whole;
}

Declared declared_in(Input& input) {
  Declared one{.type = input.below(Declared::types), .name = text_in(input)};
  one.range = {number_in(input), number_in(input)};
  one.unit = text_in(input);
  one.range.unit = "1";
  one.text = text_in(input);
  one.real = one.vector.y = number_in(input);
  one.integer = one.counts[1] = static_cast<std::int64_t>(input.number<std::int16_t>());
  if (input.below(2) == 1) one.optional_real = one.real;
  one.reals.assign(input.below(4), one.real);
  for (std::string& option : one.options) option = text_in(input);
  one.option = one.words = text_in(input);
  one.flag = input.below(2) == 1;
  return one;
}

/// Everything that an input says about a plugin.
struct Plugin {
  PluginManifest manifest{};
  OperatorEntry entry{};
  std::array<std::string, 7> texts;  ///< that the two refer to
  std::vector<Declared> parameters;
  std::vector<Objective> objectives;
  Request request;
};

/// The plugin of the present input.
Plugin& present() {
  static Plugin plugin;
  return plugin;
}

/// An operator that declares the parameters of the present input. Each object has variables of its own.
class Fuzzed final : public Fitness {
 public:
  void parameters(Parameters& p) override {
    for (Declared& one : parameters_) declare(p, one);
  }
  Request observes() const override { return present().request; }
  std::vector<Objective> objectives() const override { return present().objectives; }
  std::vector<double> score(const Observation&) const override { return {}; }

  /// Returns whether the numbers of a parameter are in its range.
  bool are_in_range() const {
    const auto holds = [](const Declared& one) {
      std::vector<double> numbers;
      if (one.type == 0) numbers = {one.real};
      if (one.type == 1) numbers = {static_cast<double>(one.integer)};
      if (one.type == 4 || (one.type == 11 && one.option.empty())) numbers = {one.vector.x, one.vector.y, one.vector.z};
      if (one.type == 5) numbers = {one.counts.begin(), one.counts.end()};
      if (one.type == 6 && one.optional_real) numbers = {*one.optional_real};
      if (one.type == 7) numbers = one.reals;
      const auto is_in = [&](double number) { return number >= one.range.low && number <= one.range.high; };
      return std::all_of(numbers.begin(), numbers.end(), is_in);
    };
    return std::all_of(parameters_.begin(), parameters_.end(), holds);
  }

 private:
  static void declare(Parameters& p, Declared& one) {
    Range range = one.range;
    range.unit = one.unit;
    if (one.type == 0) return p.real(one.real, one.name, range, one.text);
    if (one.type == 1) return p.integer(one.integer, one.name, range, one.text);
    if (one.type == 2) return p.flag(one.flag, one.name, one.text);
    if (one.type == 3)
      return p.choice(one.option, one.name, {one.options[0], one.options[1], one.options[2]}, one.text);
    if (one.type == 4) return p.vector(one.vector, one.name, range, one.text);
    if (one.type == 5) return p.counts(one.counts, one.name, range, one.text);
    if (one.type == 6) return p.optional_real(one.optional_real, one.name, range, one.text);
    if (one.type == 7) return p.reals(one.reals, one.name, range, one.text);
    if (one.type == 8) return p.text(one.words, one.name, one.text);
    if (one.type == 9) return p.file(one.file, one.name, one.text);
    if (one.type == 10) return p.materials(one.materials, one.name, one.text);
    if (one.type == 11)
      return p.vector_or_choice(one.vector, one.option, one.name, range,
                                {one.options[0], one.options[1], one.options[2]}, one.text);
    p.require(one.flag, one.name, one.text);
  }

  std::vector<Declared> parameters_ = present().parameters;
};

/// Takes a text for a manifest; null if it is empty.
const char* pointer_to(std::string& text, Input& input) {
  text = text_in(input);
  return text.empty() ? nullptr : text.c_str();
}

void take_manifest(Plugin& plugin, Input& input) {
  constexpr std::size_t most_faults = 8;  // one of which is the input's, or none
  const std::size_t fault = input.below(2 * most_faults);
  PluginManifest& manifest = plugin.manifest;
  manifest = {plugin_magic,
              plugin_epoch,
              sizeof(PluginManifest),
              plugin_struct_digest,
              plugin_toolchain,
              plugin_switches,
              "1.0.0",
              "MIT",
              &plugin.entry,
              1};
  plugin.entry = {"fitness", "fuzzed", "Scores what an input says.", []() -> Operator* { return new Fuzzed; }};
  auto text = plugin.texts.begin();
  if (fault == 1) manifest.magic = input.number<std::uint64_t>();
  if (fault == 2) manifest.epoch = input.number<std::uint32_t>();
  if (fault == 3) manifest.manifest_size = input.number<std::uint32_t>();
  if (fault == 4) manifest.struct_digest = input.number<std::uint32_t>();
  if (fault == 5) {
    manifest.toolchain = pointer_to(*text++, input);
    manifest.switches = pointer_to(*text++, input);
  }
  if (fault == 6) {
    manifest.version = pointer_to(*text++, input);
    manifest.license = pointer_to(*text++, input);
  }
  if (fault == 7) {
    plugin.entry.kind = pointer_to(*text++, input);
    plugin.entry.name = pointer_to(*text++, input);
    plugin.entry.summary = pointer_to(*text++, input);
  }
}

void take_scores(Plugin& plugin, Input& input) {
  plugin.request = {.settle = number_in(input), .window = number_in(input), .rate = number_in(input)};
  plugin.objectives.resize(input.below(4));
  for (Objective& objective : plugin.objectives) {
    objective.name = text_in(input);
    objective.unit = text_in(input);
    objective.role = static_cast<Role>(input.number<std::uint8_t>());
    objective.low = number_in(input);
    objective.high = number_in(input);
    objective.bins = input.number<std::uint8_t>();
  }
}

/// Reads the table [[fitness]] of an experiment, and returns its record.
toml::table read(const toml::table& root, const Registry& registry) {
  ErrorCollector errors;
  TomlReader top(root, "", {}, &errors);
  Experiment experiment;
  experiment.context.material_names = {"bone"};
  const FileContents files{{"shape.obj", "content"}};
  const References references{&experiment.context.material_names, "", &files, &experiment.files};
  const Warnings none;
  toml::table record;
  read_fitness(top, OperatorFactory(registry, none, experiment), references, experiment, record);
  errors.throw_errors();
  for (const Scored& scored : experiment.fitness)
    require(dynamic_cast<const Fuzzed&>(*scored.op).are_in_range(), "a parameter has a value out of its range");
  for (const auto* scores : {&experiment.objectives, &experiment.measures})
    for (const Objective& score : *scores) {
      require(std::string_view(name(score.role)) != "?", "a score has a role that there is not");
      require(text_fault(score.name).empty() && text_fault(score.unit).empty(), "the name of a score is no line");
    }
  return record;
}

std::string text_of(const toml::table& table) {
  std::ostringstream text;
  text << table;
  return text.str();
}

}  // namespace

void fuzz(std::string_view bytes) {
  Input input(bytes);
  Plugin& plugin = present();
  take_manifest(plugin, input);
  plugin.parameters.clear();
  for (std::size_t count = input.below(5); count > 0; --count) plugin.parameters.push_back(declared_in(input));
  take_scores(plugin, input);

  const Registry registry({EVODEVO_FUZZ_LIBRARY});
  for (const FailedLibrary& failed : registry.failed())
    require(text_fault(failed.reason, 2000).empty(), "the reason why a library cannot be used is no line");
  for (const AvailableOperator& available : registry.operators()) {
    describe_parameters(available);
    declaration_faults(*create<Operator>(available));
  }
  try {
    const toml::table record = read(parse_toml(input.rest(), "input.toml"), registry);
    const std::string text = text_of(record);
    require(text_of(read(parse_toml(text, "record.toml"), registry)) == text,
            "the record of parameters reads back as another one");
  } catch (const ConfigError&) {
  }
}

}  // namespace evodevo

const evodevo::PluginManifest* fuzzed_manifest() { return &evodevo::present().manifest; }
