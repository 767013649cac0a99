// The declarations that every built-in operator must make.
#include <set>

#include "experiment/toml_writer.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Checks each parameter when it is declared.
class DeclarationCheck final : public Parameters {
 public:
  void real(double& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(value, range);
  }
  void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(static_cast<double>(value), range);
  }
  void flag(bool&, std::string_view name, std::string_view text) override { declare(name, text); }
  void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
              std::string_view text) override {
    declare(name, text);
    EXPECT_NE(std::find(options.begin(), options.end(), value), options.end());
  }
  void vector(Vec3& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    for (const double part : {value.x, value.y, value.z}) check(part, range);
  }
  void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    for (const std::int64_t part : value) check(static_cast<double>(part), range);
  }
  void optional_real(std::optional<double>& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(value.value_or(range.low), range);
  }
  void reals(std::vector<double>& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    for (const double number : value) check(number, range);
  }
  void text(std::string&, std::string_view name, std::string_view text) override { declare(name, text); }
  void file(InputFile& value, std::string_view name, std::string_view text) override {
    declare(name, text);
    if (value.path.empty()) unset_.emplace(name);
  }
  void materials(std::vector<std::string>&, std::string_view name, std::string_view text) override {
    declare(name, text);
  }
  void require(bool holds, std::string_view name, std::string_view) override {
    EXPECT_TRUE(holds || unset_.contains(name)) << name;
  }

  std::set<std::string, std::less<>> names;

 private:
  void declare(std::string_view name, std::string_view text) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(names.emplace(name).second) << "declared twice";
    EXPECT_GT(text.size(), 10u);
    EXPECT_TRUE(text.ends_with('.'));
  }
  static void check(double value, Range range) {
    EXPECT_GE(value, range.low);
    EXPECT_LE(value, range.high);
    EXPECT_TRUE(std::isfinite(range.low) && std::isfinite(range.high)) << "any number at all is allowed";
    EXPECT_FALSE(range.unit.empty());
  }

  std::set<std::string, std::less<>> unset_;  ///< files without a default, which may be required
};

TEST(BuiltIn, AllOperatorsLoad) {
  EXPECT_TRUE(registry().failed().empty()) << registry().failed().front().reason;
  using ::testing::ElementsAre;
  EXPECT_THAT(registry().names("encoding"),
              ElementsAre("cloud", "cppn", "direct", "neat", "neural", "regulatory", "voxel"));
  EXPECT_THAT(registry().names("mutation"), ElementsAre("add-block", "add-link", "add-node", "block-rates",
                                                        "duplicate-block", "gaussian", "remove-block", "reset-weight"));
  EXPECT_THAT(registry().names("crossover"), ElementsAre("sbx", "swap-neuron", "two-point", "uniform"));
  EXPECT_THAT(registry().names("devo"), ElementsAre("amplitude-adaptation", "ballistic-growth", "ballistic-phase",
                                                    "hebbian", "length-adaptation", "mass-growth", "mass-turnover",
                                                    "regulated-growth", "spring-turnover", "stiffness-adaptation"));
  EXPECT_THAT(registry().names("fitness"),
              ElementsAre("actuation-work", "descriptor", "distance", "efficiency", "jump", "reach", "straightness"));
  EXPECT_THAT(registry().names("selection"),
              ElementsAre("age-fitness-pareto", "cma-es", "comma", "differential", "elitist", "lexicase", "map-elites",
                          "novelty", "nsga2", "pareto-layers", "species", "tournament"));
}

TEST(BuiltIn, DefaultsAreInRangeAndDescribed) {
  for (const AvailableOperator& available : registry().operators()) {
    SCOPED_TRACE(available.entry->name);
    EXPECT_TRUE(std::string_view(available.entry->summary).ends_with('.'));
    const std::unique_ptr<Operator> op(available.entry->create());
    DeclarationCheck check;
    op->parameters(check);
  }
}

TEST(BuiltIn, PapersValuesAreTheDefaults) {
  const auto values = [](std::string_view kind, std::string_view name) {
    const std::unique_ptr<Operator> op(registry().find(kind, name)->entry->create());
    TomlWriter writer;
    op->parameters(writer);
    return writer.take();
  };
  EXPECT_EQ(values("devo", "spring-turnover")["springs"].value<int>(), 125);
  EXPECT_EQ(values("devo", "mass-turnover")["threshold"].value<int>(), 20);
  EXPECT_EQ(values("devo", "mass-turnover")["springs"].value<int>(), 25);
  EXPECT_EQ(values("devo", "mass-turnover")["limit"].value<int>(), 10);
  EXPECT_EQ(values("encoding", "neural")["points"].value<int>(), 1000);
  EXPECT_EQ(values("encoding", "neural")["neighbours"].value<int>(), 25);
  EXPECT_EQ(values("encoding", "neural")["hidden"].value<int>(), 25);
  EXPECT_EQ(values("encoding", "neural")["side"].value<double>(), 2);
  EXPECT_EQ(values("fitness", "distance")["window"].value<double>(), 10);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
