// Further test cases for operators of every kind: hidden state, changes of the process, names and texts.
#include <algorithm>
#include <cstring>

#include "conformance/conformance.hpp"
#include "conformance/trials.hpp"
#include "operators/describe.hpp"
#include "operators/surroundings.hpp"

namespace evodevo::conformance {
namespace {

// ---- the process ----

std::string bytes_of(const Numbers& numbers) {
  std::string bytes(numbers.size() * sizeof(double), '\0');
  if (!numbers.empty())
    std::memcpy(bytes.data(), numbers.data(), bytes.size());  // no call if empty: memcpy must not get nullptr
  return bytes;
}

/// Checks that every call gives the same result as if it were the first call in a process, regardless of earlier calls.
void no_hidden_state(const Subject& subject, std::uint64_t seed) {
  constexpr std::uint32_t rounds = 16;
  const std::uint32_t inputs = inputs_for(subject);
  std::vector<std::string> first;
  for (std::uint32_t input = 0; input < inputs; ++input)
    first.push_back(in_new_process([&] { return bytes_of(try_new(subject, seed, input)); }));
  for (std::uint32_t call = 0; call < rounds * inputs; ++call) {
    const std::uint32_t round = call / inputs, next = call % inputs, input = round % 2 ? next : inputs - 1 - next;
    if (bytes_of(try_new(subject, seed, input)) != first[input])
      throw Violation("input " + std::to_string(input) + " gives one result as the first call of a process and " +
                      "another after " + std::to_string(call) +
                      " calls; keep nothing between calls, not even in a variable of the library");
  }
}

/// Checks that the operator leaves the rounding mode, flush-to-zero and the locale as they are, because they apply to
/// the whole process.
void same_surroundings(const Subject& subject, std::uint64_t seed) {
  const Surroundings before;
  const auto require_same = [&](const char* where) {
    if (const std::string changed = before.restore(); !changed.empty())
      throw Violation("it changes " + changed + " in " + where);
  };
  // not made by create<Operator>(), which would restore what the constructor changes
  const std::unique_ptr<Operator> op(subject.available.entry->create());
  require_same("its constructor");
  describe_parameters(*op);
  require_same("parameters()");
  set_parameters(*op, subject);
  require_same("prepare()");
  for (std::uint32_t input = 0; input < inputs_for(subject); ++input) {
    try_out(subject, *op, seed, input);
    require_same("its calls");
  }
}

// ---- names ----

bool is_letter(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0; }

/// Checks that users can type a name and use it as a TOML key. `besides` has the characters that are allowed in
/// addition to letters and digits.
void require_name(const std::string& what, std::string_view name, std::string_view besides) {
  const auto is_allowed = [&](char letter) { return is_letter(letter) || besides.find(letter) != besides.npos; };
  if (name.empty() || !std::all_of(name.begin(), name.end(), is_allowed))
    throw Violation(what + " \"" + std::string(name) + "\" is not a valid name; expected letters, digits and " +
                    std::string(besides));
}

/// Checks that a text has no control characters and no markup, because it is shown on terminals and pages.
void require_plain(const std::string& what, std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto letter = static_cast<unsigned char>(text[i]);
    if (letter < ' ' || letter == 0x7f) throw Violation(what + " has a control character; remove it");
    if (letter == '<' && i + 1 < text.size() && (is_letter(text[i + 1]) || text[i + 1] == '/' || text[i + 1] == '!'))
      throw Violation(what + " looks like markup of a web page: " + std::string(text.substr(i)));
  }
}

void plain_names(const Subject& subject, std::uint64_t) {
  require_name("its name", subject.available.entry->name, "-._");
  require_plain("its summary", subject.available.entry->summary);
  require_plain("its version", subject.available.manifest->version);
  require_plain("its licence", subject.available.manifest->license);
  for (const ParameterDescription& p : describe_parameters(subject.available)) {
    require_name("the parameter", p.name, "-_");
    for (const std::string& text : {p.fallback, p.allowed, p.unit, p.text})
      require_plain("the declaration of parameter \"" + p.name + "\"", text);
  }
  const auto op = create<Operator>(subject);
  if (const auto* fitness = dynamic_cast<const Fitness*>(op.get())) {
    for (const Objective& objective : fitness->objectives()) {
      require_plain("the name of an objective", objective.name);
      require_plain("the unit of an objective", objective.unit);
    }
  }
  if (const auto* devo = dynamic_cast<const Devo*>(op.get())) {
    for (const EditKind edit : edit_kinds) {
      require_plain("the name of a measure", devo->measure(edit).name);
      require_plain("the unit of a measure", devo->measure(edit).unit);
    }
    const MemoryNames names = memory_names(*devo);
    for (const auto& list : {names.masses, names.springs, names.body})
      for (const std::string& name : list) require_plain("the name of a number that it remembers", name);
  }
}

}  // namespace

std::vector<Case> process_cases() {
  return {{"names", plain_names}, {"hidden-state", no_hidden_state}, {"surroundings", same_surroundings}};
}

}  // namespace evodevo::conformance
