// Features that a scene does not use cost no instructions: a kernel with a feature switched off has the same operations
// as a kernel whose source does not contain the feature.
#include "cuda/layout/features.hpp"

#include <elf.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <regex>
#include <span>
#include <stdexcept>

#include "cuda/runtime/compiler.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

/// A feature, and the code that exists only for it.
struct Subject {
  const char* name;
  bool Features::*on;
  std::vector<const char*> constants;     ///< switches in mass_step.cuh, the inner ones first
  std::vector<const char*> declarations;  ///< members and variables
  std::vector<const char*> functions;     ///< functions of the kernels and of physics.hpp
  std::vector<std::pair<const char*, const char*>> replacements = {};  ///< expressions, and what they are without it
};

const std::vector<Subject> subjects{
    // without gravity there is no slope
    {"gravity",
     &Features::gravity,
     {"gravity", "slope"},
     {"height_moment"},
     {"weight", "downhill_force", "height_moment_of", "record_fall"}},
    {"slope", &Features::slope, {"slope"}, {}, {"downhill_force"}},
    // without the floor there is no rough ground and no friction
    {"floor",
     &Features::floor,
     {"static_friction", "elastic_floor", "floor_on", "friction", "rigid_floor", "rough"},
     {"normal_force"},
     {"floor_force", "lowest_rise", "after_friction", "friction_factor"}},
    // no scene has both, but the kernels can
    {"elastic floor", &Features::elastic, {"elastic_floor"}, {}, {"floor_force"}},
    {"rigid floor", &Features::rigid, {"rigid_floor"}, {}, {"lowest_rise"}},
    {"rough ground", &Features::rough, {"rough"}, {}, {"ground_under"}},
    {"friction", &Features::friction, {"static_friction", "friction"}, {}, {"after_friction", "friction_factor"}},
    {"static friction", &Features::static_friction, {"static_friction"}, {}, {}},
    {"damping", &Features::damping, {"damping"}, {}, {}},
    {"drag", &Features::drag, {"drag"}, {}, {"drag_factor"}},
    {"actuation", &Features::actuation, {"actuation"}, {}, {"half_turns"}},
    // a group of masses on the chip is smaller
    {"dashpots",
     &Features::dashpots,
     {"dashpots"},
     {},
     {"velocity_at", "set_dashpot_velocity", "damping_of", "dashpot_factor_by_inverse"},
     {{"group_bytes<Number, dashpots>", "group_bytes<Number, false>"},
      {"halo_set_bytes<Number, dashpots>", "halo_set_bytes<Number, false>"}}},
    // the variable row_stress is not removed, although it becomes unused: it produces no instruction, but without it
    // the compiler would number registers differently
    {"stress", &Features::stress, {"stress"}, {}, {}},
    // the work of single muscles is recorded only together with the work of the body
    {"work",
     &Features::work,
     {"muscle_work", "work"},
     {"power", "rates"},
     {"rate_of", "length_rate", "actuation_power"}},
    {"each muscle's work", &Features::muscle_work, {"muscle_work"}, {}, {}},
    {"peak force", &Features::peak_force, {"peak_force"}, {}, {}},
    {"tension", &Features::tension, {"mean_tension"}, {}, {}},
    // contact is counted only for samples
    {"samples", &Features::samples, {"contacts", "sampled"}, {}, {}},
    {"contacts", &Features::contacts, {"contacts"}, {}, {}},
};

Features every_feature() {
  Features all;
  for (const Subject& subject : subjects) all.*subject.on = true;
  return all;
}

Features without(const Subject& subject) {
  Features features = every_feature();
  features.*subject.on = false;
  features.slope = features.slope && features.gravity;
  for (bool Features::*of_floor : {&Features::elastic, &Features::rigid, &Features::rough, &Features::friction})
    features.*of_floor = features.*of_floor && features.floor;
  features.static_friction = features.static_friction && features.friction;
  features.muscle_work = features.muscle_work && features.work;
  features.contacts = features.contacts && features.samples;
  return features;
}

/// The sources of the kernels, from which code can be removed.
class Sources {
 public:
  Sources() {
    const std::string method = form_of(Method::paper_euler).file;
    for (const EmbeddedSource& source : embedded_sources()) {
      if (source.name.starts_with("cuda/device/methods/") && source.name != method) continue;
      // comments are removed, since they contain the searched names
      names_.emplace_back(source.name);
      texts_.push_back(std::regex_replace(std::string(source.text), std::regex(" *//[^\n]*"), ""));
    }
  }

  /// Removes the code of a feature. Throws if there is no such code, or if part of it remains.
  void remove(const Subject& subject) {
    for (const auto& [expression, without] : subject.replacements) replace_all(expression, without);
    for (const char* constant : subject.constants) {
      // replaces the constant with another one, because the compiler numbers constants and uses the numbers in
      // instructions
      replace_all("constexpr bool " + std::string(constant) + " = \\w+;",
                  "constexpr bool no_" + std::string(constant) + " = true;");
      if (remove_statements(constant) == 0) throw std::runtime_error("nothing is for " + std::string(constant));
    }
    for (const char* function : subject.functions) remove_function(function);
    for (const char* name : subject.declarations)
      replace_all("\n *\\w+ " + std::string(name) + "(\\[\\w+\\])?( = [^;\n]*)?;(?=\n)", "");
    for (const auto& names : {subject.constants, subject.declarations, subject.functions})
      for (const char* name : names) expect_gone(name);
  }

  std::vector<EmbeddedSource> all() const {
    std::vector<EmbeddedSource> sources;
    for (std::size_t i = 0; i < texts_.size(); ++i) sources.push_back({names_[i], texts_[i]});
    return sources;
  }

 private:
  /// Returns the end of the text that the bracket at `begin` opens.
  static std::size_t closing(const std::string& text, std::size_t begin) {
    const char open = text[begin], close = open == '(' ? ')' : '}';
    int depth = 0;
    for (std::size_t i = begin; i < text.size(); ++i) {
      depth += (text[i] == open) - (text[i] == close);
      if (depth == 0) return i + 1;
    }
    throw std::runtime_error("a bracket is not closed");
  }

  /// Replaces all matches of an expression in the kernels.
  void replace_all(const std::string& expression, const std::string& replacement) {
    bool found = false;
    for (std::size_t i = 0; i < texts_.size(); ++i) {
      if (names_[i] == formats) continue;
      const std::string replaced = std::regex_replace(texts_[i], std::regex(expression), replacement);
      found = found || replaced != texts_[i];
      texts_[i] = replaced;
    }
    if (!found) throw std::runtime_error("nothing to remove: " + expression);
  }

  /// Removes the statements that are compiled only if `constant` is true; returns their number.
  int remove_statements(const std::string& constant) {
    const std::regex condition("\n *if constexpr \\((\\w+ && )*" + constant + "( && \\w+)*\\)");
    int count = 0;
    for (std::string& text : texts_) {
      for (std::smatch match; std::regex_search(text, match, condition); ++count) {
        const auto begin = static_cast<std::size_t>(match.position());
        std::size_t end = text.find_first_not_of(" \n", begin + static_cast<std::size_t>(match.length()));
        end = text[end] == '{' ? closing(text, end) : text.find(';', end) + 1;
        if (text.compare(text.find_first_not_of(" \n", end), 4, "else") == 0)
          throw std::runtime_error("an alternative to " + constant);
        text.erase(begin, end - begin);
      }
    }
    return count;
  }

  /// Removes the definitions of a function, each from the empty line before it to its closing brace.
  void remove_function(const std::string& name) {
    const std::regex head("\n *\n(template <class T>\n)?[\\w<> ]+ " + name + "\\([^{;]*\\) (const )?\\{");
    bool found = false;
    for (std::string& text : texts_) {
      std::smatch match;
      if (!std::regex_search(text, match, head)) continue;
      const auto begin = static_cast<std::size_t>(match.position());
      text.erase(begin, closing(text, begin + static_cast<std::size_t>(match.length()) - 1) - begin);
      found = true;
    }
    if (!found) throw std::runtime_error("no function " + name);
  }

  void expect_gone(const std::string& name) const {
    for (std::size_t i = 0; i < texts_.size(); ++i)
      if (names_[i] != formats && std::regex_search(texts_[i], std::regex("\\b" + name + "\\b")))
        throw std::runtime_error(names_[i] + " still has " + name);
  }

  /// The format of the data that the host sends; kernels read only parts of it.
  static constexpr const char* formats = "cuda/layout/formats.hpp";

  std::vector<std::string> names_, texts_;
};

/// Returns all instructions in an ELF file of machine code, which are its concatenated sections .text.*.
std::string text_of(const std::vector<char>& file) {
  const auto read = [&]<class T>(T& value, std::size_t offset) { std::memcpy(&value, &file.at(offset), sizeof value); };
  Elf64_Ehdr header;
  read(header, 0);
  std::vector<Elf64_Shdr> sections(header.e_shnum);
  for (std::size_t i = 0; i < sections.size(); ++i) read(sections[i], header.e_shoff + i * header.e_shentsize);
  std::string code;
  for (const Elf64_Shdr& section : sections) {
    const std::string name = &file.at(sections.at(header.e_shstrndx).sh_offset + section.sh_name);
    if (name.starts_with(".text.")) code.append(&file.at(section.sh_offset), section.sh_size);
  }
  return code;
}

using Operations = std::vector<std::uint16_t>;

/// Returns the sorted operations of the instructions in a file, without instructions that only pad a section. Since
/// Volta, an instruction has 16 bytes, whose low twelve bits name the operation. Registers are not compared, since the
/// compiler's choice may depend on names.
Operations operations(const std::vector<char>& file) {
  const std::string instructions = text_of(file);
  Operations all;
  for (std::size_t i = 0; i < instructions.size(); i += 16) {
    std::uint16_t bits;
    std::memcpy(&bits, &instructions[i], sizeof bits);
    constexpr std::uint16_t nop = 0x918;
    if ((bits & 0xfff) != nop) all.push_back(bits & 0xfff);
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// One form of a kernel.
struct Form {
  const char* name;
  const char* source;
  ResidentForm layout;
  bool float64 = false;
  Materials materials = Materials::table;

  std::vector<std::string> definitions(Features features) const {
    features.float64 = float64;
    features.materials = materials;
    return layout.rows == 0 ? cuda::definitions(features) : cuda::definitions(features, layout);
  }
  friend void PrintTo(const Form& form, std::ostream* stream) { *stream << form.name; }
};

const std::vector<Form> forms{
    {"resident", "cuda/device/resident.cu", {.rows = most_rows, .masses_per_thread = 1, .records_on_chip = true}},
    {"resident, springs streamed",
     "cuda/device/resident.cu",
     {.rows = rows_of_a_chunk, .masses_per_thread = 5, .chunked = true, .wide_offsets = true}},
    {"resident, in a cluster",
     "cuda/device/resident.cu",
     {.rows = most_rows, .masses_per_thread = 1, .records_on_chip = true, .clustered = true}},
    {"streamed", "cuda/device/streamed/streamed.cu", {}},
    {"resident, float64",
     "cuda/device/resident.cu",
     {.rows = most_rows, .masses_per_thread = 2, .records_on_chip = true},
     true},
    {"resident, computed materials",
     "cuda/device/resident.cu",
     {.rows = most_rows, .masses_per_thread = 1, .records_on_chip = true},
     false,
     Materials::computed},
};

class FeatureCode : public ::testing::TestWithParam<Form> {
 protected:
  Operations code(const Sources& sources, const Features& features) const {
    return operations(compile(sources.all(), GetParam().source, GetParam().definitions(features), "sm_90"));
  }
};

TEST_P(FeatureCode, IsNotThereWhereTheFeatureIsOff) {
  const auto count = [](const Operations& operations) { return static_cast<int>(operations.size()); };
  const Operations all = code({}, every_feature());
  std::printf("%s: %d instructions with every feature\n", GetParam().name, count(all));
  for (const Subject& subject : subjects) {
    Sources sources;
    sources.remove(subject);
    const Operations off = code({}, without(subject));
    std::printf("  without %-18s %5d fewer\n", subject.name, count(all) - count(off));
    EXPECT_FALSE(off == all) << subject.name << " is not compiled at all";
    EXPECT_TRUE(off == code(sources, every_feature())) << subject.name << " leaves something where it is off";
  }
}

TEST_P(FeatureCode, IsNotThereWhereAllAreOff) {
  Sources sources;
  for (const Subject& subject : subjects)
    // the excluded features have been removed together with gravity, the floor and the body's work
    if (subject.on != &Features::slope && subject.on != &Features::elastic && subject.on != &Features::rigid &&
        subject.on != &Features::rough && subject.on != &Features::friction &&
        subject.on != &Features::static_friction && subject.on != &Features::muscle_work &&
        subject.on != &Features::contacts)
      sources.remove(subject);
  const Operations bare = code({}, {});
  std::printf("%s: %zu instructions without any\n", GetParam().name, bare.size());
  EXPECT_TRUE(bare == code(sources, every_feature()));
}

INSTANTIATE_TEST_SUITE_P(Cuda, FeatureCode, ::testing::ValuesIn(forms), [](const auto& test) {
  return std::regex_replace(std::string(test.param.name), std::regex("\\W+"), "_");
});

}  // namespace
}  // namespace evodevo::cuda::EVODEVO_FILE
