// The tables that name operators: [encoding], [[mutation]], [[crossover]], [[development.operator]], [[fitness]] and
// [selection].
#pragma once

#include "base/text.hpp"
#include "experiment/experiment.hpp"
#include "experiment/tables/tables.hpp"
#include "experiment/toml_writer.hpp"
#include "operators/host_keys.hpp"
#include "operators/loader.hpp"

namespace evodevo {

/// Makes the operators that tables name, and fills them with the tables' parameters. Registry and experiment must
/// outlive it. All that it makes it adds to the experiment's uses.
class OperatorFactory {
 public:
  /// `registry_faults` describes the libraries that cannot be used.
  OperatorFactory(const Registry& registry, const Warnings& registry_faults, Experiment& experiment)
      : registry_(registry), registry_faults_(registry_faults), experiment_(experiment) {}

  /// The operator that a table's `name` asks for. What the host itself knows of the table has to be read before.
  template <class T>
  std::unique_ptr<T> make(TomlReader& table) const {
    const AvailableOperator& available = named_in(table, T::kind);
    table.require_read_among(host_key::all);
    return ask(table, [&] {
      std::unique_ptr<T> op = create<T>(available);
      op->parameters(table);
      return op;
    });
  }

  /// Runs the own code of the operator that was made last; what it objects to is reported at its name.
  template <class Call>
  auto ask(const TomlReader& table, const Call& call) const {
    try {
      return in_operator({experiment_.uses.back().title, {}, experiment_.seed}, call);
    } catch (const ConfigError&) {
      throw;
    } catch (const std::exception& error) {
      table.fail("name", printable(error.what(), 2000));
    }
  }

  /// Adds the name and the parameters of the operator that was made last to what is recorded of its table.
  void write(const TomlReader& table, Operator& op, TomlWriter& writer) const;

 private:
  const AvailableOperator& named_in(TomlReader& table, std::string_view kind) const;

  const Registry& registry_;
  const Warnings& registry_faults_;
  Experiment& experiment_;
};

/// Reads the tables of operators into an experiment that has its settings. What it has read it writes into `record`.
void read_operators(TomlReader& top, const OperatorFactory& factory, Experiment& experiment, toml::table& record);

}  // namespace evodevo
