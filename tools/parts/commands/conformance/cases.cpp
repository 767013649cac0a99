// Test cases for operators of every kind.
#include <unistd.h>

#include <cmath>
#include <future>

#include "archive/archive.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/text.hpp"
#include "conformance/conformance.hpp"
#include "conformance/trials.hpp"
#include "evolution/evolution.hpp"
#include "experiment/device.hpp"
#include "experiment/toml_reader.hpp"
#include "operators/declarations.hpp"
#include "operators/describe.hpp"
#include "operators/host_keys.hpp"

namespace evodevo::conformance {
namespace {

namespace fs = std::filesystem;

// ---- declarations ----

void declarations(const Subject& subject, std::uint64_t) {
  const auto op = evodevo::create<Operator>(subject.available);
  if (const std::string fault = wrong_default(*op); !fault.empty()) throw Violation("the default " + fault);
  if (const auto faults = declaration_faults(*op); !faults.empty()) throw Violation(joined(faults, "; "));
  if (!std::string_view(subject.available.entry->summary).ends_with('.'))
    throw Violation("its summary is not a sentence that ends with a full stop: \"" +
                    std::string(subject.available.entry->summary) + "\"");
  const std::string_view version = subject.available.manifest->version, licence = subject.available.manifest->license;
  if (version.empty() || licence.empty())
    throw Violation("its library gives no version or no licence; give both in EVODEVO_PLUGIN(...)");
}

/// Collects, for every declared parameter, values that must be refused.
class Refusable final : public Parameters {
 public:
  std::vector<std::pair<std::string, toml::table>> tables;

  void declare(const Parameter& parameter) override {
    std::visit([&](const auto& variable) { refuse(parameter.name, variable); }, parameter.variable);
  }
  void require(bool, std::string_view, std::string_view) override {}

 private:
  void refuse(std::string_view name, const parameter::Real& real) {
    add(name, "text");
    beyond(name, real.range);
  }
  void refuse(std::string_view name, const parameter::Integer& integer) {
    add(name, 0.5);
    beyond(name, integer.range);
  }
  void refuse(std::string_view name, const parameter::OptionalReal& real) {
    add(name, "text");
    beyond(name, real.range);
  }
  void refuse(std::string_view name, const parameter::Choice&) { add(name, "none of the options"); }
  void refuse(std::string_view name, const parameter::VectorOrChoice&) {
    add(name, "none of the options");
    add(name, 1.0);
  }
  void refuse(std::string_view name, const parameter::File&) { add(name, "/no such file"); }
  void refuse(std::string_view name, const parameter::Materials&) { add(name, toml::array{"none of the materials"}); }
  void refuse(std::string_view name, const auto&) { add(name, 1); }  // neither true or false, a list nor a text

  template <class Value>
  void add(std::string_view name, Value&& value) {
    toml::table table;
    table.insert(name, std::forward<Value>(value));
    tables.emplace_back(name, std::move(table));
  }
  void beyond(std::string_view name, Range range) {
    constexpr double most = 9e15;  // of the whole numbers that a double holds exactly
    const double above = std::min(2 * std::abs(range.high) + 1, most);
    const double below = std::max(-2 * std::abs(range.low) - 1, -most);
    if (above > range.high) add(name, static_cast<std::int64_t>(above));
    if (below < range.low) add(name, static_cast<std::int64_t>(below));
  }
};

/// Returns whether the operator accepts the parameters that it is tried with if those in `table` replace some of them.
bool accepts(const Subject& subject, const toml::table& table) {
  const EncodingContext context = subject.context();
  toml::table all = subject.use ? subject.use->own : toml::table{};
  for (const std::string_view key : host_key::all) all.erase(key);
  for (const auto& [key, value] : table) all.insert_or_assign(key, value);
  References references{&context.material_names};
  if (subject.use) references.recorded_files = &subject.use->experiment.files;
  TomlReader reader(all, "operator", references);
  try {
    evodevo::create<Operator>(subject.available)->parameters(reader);
    reader.finish();
  } catch (const ConfigError&) {
    return false;
  }
  return true;
}

void refusals(const Subject& subject, std::uint64_t) {
  create<Operator>(subject);  // throws Skipped if a required parameter is missing
  if (!accepts(subject, {})) throw Violation("it does not accept its own parameters; correct parameters()");
  if (accepts(subject, toml::table{{"a-key-that-nobody-knows", 1}}))
    throw Violation("it accepts an unknown key, a-key-that-nobody-knows");
  Refusable refusable;
  evodevo::create<Operator>(subject.available)->parameters(refusable);
  for (const auto& [name, table] : refusable.tables)
    if (accepts(subject, table))
      throw Violation("it accepts " + name + " = " + value_text(*table.get(name)) +
                      ", which is not allowed; parameters() must not catch what the host throws");
}

// ---- calls ----

void same_seed(const Subject& subject, std::uint64_t seed) {
  for (std::uint32_t input = 0; input < inputs_for(subject); ++input)
    if (!same(try_new(subject, seed, input), try_new(subject, seed, input)))
      throw Violation("two calls with input " + std::to_string(input) +
                      " and equal random numbers give different results; draw random numbers only from the Rng that is "
                      "passed in, and keep nothing between calls");
}

void threads(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Operator>(subject);
  std::vector<Numbers> alone;
  for (std::uint32_t input = 0; input < inputs_for(subject); ++input)
    alone.push_back(try_out(subject, *op, seed, input));
  const auto all = [&] {
    std::vector<Numbers> results;
    for (std::uint32_t input = 0; input < alone.size(); ++input) results.push_back(try_out(subject, *op, seed, input));
    return results;
  };
  std::vector<std::future<std::vector<Numbers>>> others;
  for (int i = 0; i < 8; ++i) others.push_back(std::async(std::launch::async, all));
  for (auto& other : others) {
    const auto results = other.get();
    for (std::size_t i = 0; i < alone.size(); ++i)
      if (!same(results[i], alone[i]))
        throw Violation("input " + std::to_string(i) +
                        " gives one result on one thread and another on eight threads; "
                        "calls may not change what an operator holds");
  }
}

void batch(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Operator>(subject);
  for (std::uint32_t left = inputs_for(subject); left > 0; --left) {
    const std::uint32_t input = left - 1;
    if (!same(try_out(subject, *op, seed, input), try_new(subject, seed, input)))
      throw Violation("input " + std::to_string(input) +
                      " gives one result by itself and another after other inputs; "
                      "calls may not change what an operator holds");
  }
}

void untouched_inputs(const Subject& subject, std::uint64_t seed) {
  for (std::uint32_t input = 0; input < inputs_for(subject); ++input) try_new(subject, seed, input);
}

/// Sets every parameter to a different allowed value.
class Changer final : public Parameters {
 public:
  void declare(const Parameter& parameter) override {
    std::visit([](const auto& variable) { change(variable); }, parameter.variable);
  }
  void require(bool, std::string_view, std::string_view) override {}

 private:
  static void change(const parameter::Real& real) { real.value = other(real.value, real.range); }
  static void change(const parameter::Integer& integer) { integer.value = other(integer.value, integer.range); }
  static void change(const parameter::Flag& flag) { flag.value = !flag.value; }
  static void change(const parameter::Choice& choice) { change(choice.value, choice.options); }
  static void change(const parameter::Vector& vector) { vector.value.x = other(vector.value.x, vector.range); }
  static void change(const parameter::VectorOrChoice& either) { change(either.word, either.options); }
  static void change(const parameter::Counts& counts) { counts.value[0] = other(counts.value[0], counts.range); }
  static void change(const parameter::OptionalReal& real) {
    real.value = other(real.value.value_or(real.range.high), real.range);
  }
  static void change(const parameter::Reals& reals) { reals.value.push_back(reals.range.low); }
  static void change(const parameter::Text& text) { text.value += "other"; }
  static void change(const parameter::File& file) { file.value = {"other", "content"}; }
  static void change(const parameter::Materials& materials) { materials.value = {"bone"}; }

  static void change(std::string& word, parameter::Options options) {
    for (const std::string_view option : options)
      if (option != word) return void(word = option);
  }
  static std::int64_t other(std::int64_t value, Range range) {
    return static_cast<std::int64_t>(other(static_cast<double>(value), range));
  }
  static double other(double value, Range range) {
    const double end = value == range.low ? range.high : range.low;
    return std::isfinite(end) ? end : value + 1;
  }
};

void instances(const Subject& subject, std::uint64_t seed) {
  const auto values = [](Operator& op) {
    std::string text;
    for (const ParameterDescription& p : describe_parameters(op)) text += p.name + " = " + p.fallback + "\n";
    return text;
  };
  const auto one = create<Operator>(subject), other = create<Operator>(subject);
  const std::string defaults = values(*one);
  if (defaults.empty()) throw Skipped("it has no parameters");
  const Numbers before = try_out(subject, *one, seed, 0);
  Changer changer;
  other->parameters(changer);
  try {
    other->prepare(subject.context());
  } catch (const std::exception&) {
    // the changed parameters need not fit each other
  }
  if (values(*one) != defaults)
    throw Violation("a parameter that is set in one instance changes in another; use no static members");
  if (!same(try_out(subject, *one, seed, 0), before))
    throw Violation("parameters that are set in one instance change the results of another; use no static members");
}

// ---- a run ----

/// Continues the run in the archive. If `stop_early`, stops after generation 1, the first one that is bred from
/// parents.
void live(const Experiment& experiment, Archive& archive, bool stop_early) {
  const auto simulator = make_simulator(experiment, experiment.stepping, Device::cpu);
  std::atomic<bool> stop = false;
  Observer observer;
  observer.generation_done = [&](std::int64_t, const Summary& summary) {
    stop = stop_early && summary.generation == 1;
  };
  evolve(experiment, *simulator, archive, stop, observer);
}

std::string transcript(const Archive& archive) {
  std::string text;
  for (std::uint32_t id = 0; const auto individual = archive.individual(id); ++id) {
    text += std::to_string(id) + " " + name(individual->result.status) + " ";
    for (const float gene : individual->genome) text += to_text(gene) + " ";
    for (const double value : individual->result.objectives) text += to_text(value) + " ";
    for (const ArchivedNote& note : archive.notes(id)) text += note.name + " " + to_text(note.value) + " ";
    text += individual->died ? std::to_string(*individual->died) + "\n" : "lives\n";
  }
  const Memories memories = archive.memory();
  for (const SelectionMemory* memory : {&memories.survivors, &memories.parents})
    for (const auto& [name, numbers] : memory->lists) {
      text += "\n" + name + " ";
      for (const double number : numbers) text += to_text(number) + " ";
    }
  return text;
}

/// A temporary folder for runs. The destructor removes it.
struct RunFolder {
  fs::path path;
  RunFolder() {
    std::string pattern = (fs::temp_directory_path() / "evodevo-conform-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw std::runtime_error(pattern +
                               ": cannot be created; make its parent folder writable, or set TMPDIR to another folder");
    path = pattern;
  }
  ~RunFolder() { fs::remove_all(path); }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
};

void resuming(const Subject& subject, std::uint64_t seed) {
  const RunFolder folder;
  const std::string text = small_experiment(subject, seed);
  ExperimentSource source{"the conformance kit's experiment", {}, subject.plugin_path()};
  if (subject.use) source.files = subject.use->experiment.files;
  const auto begin = [&](const char* name, bool stop_early) {
    return in_new_process([&] {
      const Experiment experiment = read_experiment(text, source);
      Archive archive = Archive::create(folder.path / name, experiment, "cpu");
      live(experiment, archive, stop_early);
      return transcript(archive);
    });
  };
  const std::string straight = begin("straight", false);
  begin("stopped", true);
  const std::string resumed = in_new_process([&] {
    Archive archive = Archive::resume(folder.path / "stopped");
    live(recorded_experiment(archive, subject.plugin_path()), archive, false);
    return transcript(archive);
  });
  if (straight != resumed)
    throw Violation(
        "a run that was stopped and resumed ends differently from one that was not; keep nothing between calls");
}

}  // namespace

std::vector<Case> general_cases() {
  return {{"declarations", declarations}, {"refusals", refusals}, {"same-seed", same_seed},
          {"threads", threads},           {"batch", batch},       {"inputs", untouched_inputs},
          {"instances", instances},       {"resuming", resuming}};
}

}  // namespace evodevo::conformance
