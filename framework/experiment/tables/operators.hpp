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

/// Makes the operators that tables name, sets their parameters from the tables, and adds each to Experiment::uses.
/// Registry and experiment must outlive this object.
class OperatorFactory {
 public:
  /// `registry_faults` are the warnings about libraries that cannot be used.
  OperatorFactory(const Registry& registry, const Warnings& registry_faults, Experiment& experiment)
      : registry_(registry), registry_faults_(registry_faults), experiment_(experiment) {}

  /// Makes the operator that the key `name` of a table names. The host's own keys of the table must have been read
  /// already. Throws a KeyError if any key of the table is wrong.
  template <class T>
  std::unique_ptr<T> make(TomlReader& table) const {
    const AvailableOperator& available = named_in(table, T::kind);
    table.require_read_among(host_key::all);
    return ask(table, [&] {
      std::unique_ptr<T> op = create<T>(available);
      op->parameters(table);
      table.finish();
      table.stop_if_wrong();
      op->prepare(experiment_.context);
      return op;
    });
  }

  /// Runs code of the operator that was made last. If the code throws, throws KeyError with the place of the key
  /// `name`.
  template <class Call>
  auto ask(const TomlReader& table, const Call& call) const {
    try {
      return in_operator({experiment_.uses.back().title, {}, experiment_.seed}, call);
    } catch (const ConfigError&) {
      throw;
    } catch (const std::exception& error) {
      table.fail("name", printable(error.what(), 2000), {"encoding", "materials"});
    }
  }

  /// Writes the name and the parameters of the operator that was made last to the record of its table.
  void write(const TomlReader& table, Operator& op, TomlWriter& writer) const;

 private:
  const AvailableOperator& named_in(TomlReader& table, std::string_view kind) const;

  const Registry& registry_;
  const Warnings& registry_faults_;
  Experiment& experiment_;
};

/// Calls `read` for each table of the array [[name]] of operators in `parent`, and adds these tables to `record`.
template <class Read>
void read_operator_list(TomlReader& parent, std::string_view name, const References& references, toml::table& record,
                        const Read& read) {
  toml::array written;
  visit_tables(parent, name, rng_stream::most_operators, references, [&](TomlReader& reader) {
    TomlWriter writer;
    read(reader, writer);
    written.push_back(writer.take());
  });
  if (!written.empty()) record.insert_or_assign(name, std::move(written));
}

/// Reads the tables of operators into an experiment whose settings have been read. Writes these tables, with every
/// default, into `record`.
void read_operators(TomlReader& top, const OperatorFactory& factory, const ExperimentSource& source,
                    Experiment& experiment, toml::table& record);

}  // namespace evodevo
