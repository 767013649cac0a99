// The functions of Archive that write.
#include <algorithm>
#include <ranges>

#include "archive/archive.hpp"
#include "archive/database.hpp"
#include "archive/genes.hpp"
#include "archive/remembered.hpp"

namespace evodevo {
namespace {

std::string_view gene_bytes(const Genome& genome) {
  return {reinterpret_cast<const char*>(genome.data()), genome.size() * sizeof(float)};
}

/// Writes the scores of individuals.
class ScoreWriter {
 public:
  explicit ScoreWriter(const RunDatabase& run)
      : score_(run, "scores", "INSERT INTO scores VALUES(?, ?, ?)"),
        measure_(run, "measured", "INSERT INTO measured VALUES(?, ?, ?)"),
        life_(run, "life_scores", "INSERT INTO life_scores VALUES(?, ?, ?, ?)"),
        test_(run, "tests", "INSERT INTO tests VALUES(?, ?, ?, ?, ?, ?)") {}

  void write(const Individual& individual) {
    const Result& result = individual.result;
    for (std::size_t i = 0; i < result.objectives.size(); ++i)
      score_.execute(individual.id, static_cast<std::uint32_t>(i), result.objectives[i]);
    for (std::size_t i = 0; i < result.measures.size(); ++i)
      measure_.execute(individual.id, static_cast<std::uint32_t>(i), result.measures[i]);
    if (result.status != Status::ok) return;
    for (std::uint32_t life = 0; result.lives.size() > 1 && life < result.lives.size(); ++life)
      for (std::uint32_t i = 0; i < result.lives[life].size(); ++i)
        life_.execute(individual.id, life + 1, i, result.lives[life][i]);
    for (const TestScore& test : result.tests)
      test_.execute(individual.id, test.life, static_cast<std::uint32_t>(test.scenario), test.repeat,
                    static_cast<std::uint32_t>(test.objective), test.value);
  }

 private:
  Statement score_, measure_, life_, test_;
};

/// Removes the scores of individuals, and what is only kept of those with a fitness.
template <class Ids>
void remove_scores(const RunDatabase& run, const Ids& ids) {
  for (const std::string table : {"scores", "measured", "life_scores", "tests", "verifications"}) {
    Statement remove(run, table, "DELETE FROM " + table + " WHERE individual = ?");
    for (const std::uint32_t id : ids) remove.execute(id);
  }
}

std::optional<std::string> reason_in(const Result& result) {
  return result.status != Status::ok ? std::optional(result.reason) : std::nullopt;
}

std::optional<double> end_in(const Result& result) {
  return result.status == Status::diverged ? std::optional(result.ended_at) : std::nullopt;
}

void insert_newborns(const RunDatabase& run, const std::vector<Individual>& newborns, const Layout& layout) {
  Statement insert(
      run, "individuals",
      "INSERT INTO individuals(id, born, origin, parent, mate, made_by, provenance, lives, measured, genes, blocks, "
      "status, reason, ended_at, spring_evaluations, died) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, NULL)");
  Statement insert_immigrant(run, "immigrants", "INSERT INTO immigrants VALUES(?, ?, ?)");
  ScoreWriter scores(run);
  for (const Individual& individual : newborns) {
    const Result& result = individual.result;
    const auto parent = [&](std::size_t i) {
      return i < individual.parents.size() ? std::optional(individual.parents[i]) : std::nullopt;
    };
    const std::string blocks = block_bytes(individual.genome, layout);
    insert.execute(individual.id, individual.born, individual.origin, parent(0), parent(1), individual.made_by,
                   individual.provenance, individual.lives, individual.measured, gene_bytes(individual.genome),
                   layout.is_fixed() ? std::nullopt : std::optional<std::string_view>(blocks), name(result.status),
                   reason_in(result), end_in(result), static_cast<std::int64_t>(result.spring_evaluations));
    if (const auto& from = individual.migrated) insert_immigrant.execute(individual.id, from->island, from->individual);
    scores.write(individual);
  }
}

/// Replaces the results of individuals that have lived again.
void update_measured(const RunDatabase& run, const std::vector<Individual>& individuals) {
  if (individuals.empty()) return;
  Statement update(run, "individuals",
                   "UPDATE individuals SET lives = ?, measured = ?, status = ?, reason = ?, ended_at = ?, "
                   "spring_evaluations = ? WHERE id = ?");
  remove_scores(run, individuals | std::views::transform(&Individual::id));
  ScoreWriter scores(run);
  for (const Individual& individual : individuals) {
    const Result& result = individual.result;
    update.execute(individual.lives, individual.measured, name(result.status), reason_in(result), end_in(result),
                   static_cast<std::int64_t>(result.spring_evaluations), individual.id);
    scores.write(individual);
  }
}

/// Sets the status of individuals whose fitness does not hold, and removes what is only kept of those with a fitness.
void write_refusals(const RunDatabase& run, const std::vector<Refusal>& refusals) {
  Statement update(run, "individuals", "UPDATE individuals SET status = ?, reason = ? WHERE id = ?");
  for (const Refusal& refusal : refusals) update.execute(name(refusal.status), refusal.reason, refusal.individual);
  remove_scores(run, refusals | std::views::transform(&Refusal::individual));
}

}  // namespace

void Archive::commit(const FinishedGeneration& generation) {
  const Summary& summary = generation.summary;
  WriteTransaction transaction(*run_);
  insert_newborns(*run_, generation.newborns, layout());
  update_measured(*run_, generation.measured_again);
  write_refusals(*run_, generation.refusals);
  Statement insert_life(*run_, "lives", "INSERT INTO lives VALUES(?, ?, ?)");
  for (const auto& [id, lives] : generation.lives)
    for (std::uint32_t i = 0; i < lives.records.size(); ++i)
      insert_life.execute(id, lives.first + i, std::string_view(lives.records[i].bytes()));
  Statement drop(*run_, "individuals", "UPDATE individuals SET died = ? WHERE id = ?");
  for (const std::uint32_t id : generation.dropped) drop.execute(summary.generation, id);
  Statement(*run_, "generations", "INSERT INTO generations VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .execute(summary.generation, summary.evaluations, summary.best, summary.median, summary.diverged, summary.invalid,
               summary.artefact, summary.lucky, summary.passive, summary.clones,
               static_cast<std::int64_t>(summary.spring_evaluations), summary.wall_time);
  write_remembered(*run_, generation.remembered, summary.generation);
  run_->execute("DELETE FROM signal");  // it was that of a population which lives no longer
  Statement emigrate(*run_, "emigrants", "INSERT INTO emigrants VALUES(?, ?, ?)");
  for (const auto& [island, individual] : generation.emigrations)
    emigrate.execute(summary.generation, island, individual);
  transaction.commit();
}

void Archive::add_verifications(const std::vector<Verification>& verifications) {
  WriteTransaction transaction(*run_);
  Statement insert(*run_, "verifications",
                   "INSERT OR REPLACE INTO verifications SELECT ?1, ?2, ?3, ?4, ?5, ?6 "
                   "WHERE EXISTS (SELECT 1 FROM scores WHERE individual = ?1 AND objective = 0 AND value = ?7)");
  for (const Verification& verification : verifications) {
    std::uint32_t position = 0;
    for (const Trial& trial : verification.trials)
      insert.execute(verification.individual, trial.name, position++, name(trial.status),
                     trial.status != Status::ok ? std::optional(trial.reason) : std::nullopt, trial.value,
                     verification.fitness);
  }
  transaction.commit();
}

void Archive::insert_record(const std::string& key, const std::string& value) {
  Statement(*run_, "record", "INSERT OR REPLACE INTO record VALUES(?, ?)").execute(key, value);
}

void Archive::set_record(const std::string& key, const std::string& value) { set_records({{key, value}}); }

void Archive::set_records(const std::map<std::string, std::string>& entries) {
  WriteTransaction transaction(*run_);
  for (const auto& [key, value] : entries) insert_record(key, value);
  transaction.commit();
}

void Archive::insert_provenance(std::uint32_t position, const Provenance& provenance) {
  Statement(*run_, "provenances", "INSERT INTO provenances VALUES(?, ?, ?, ?)")
      .execute(position, provenance.device, provenance.version, provenance.program);
  Statement insert(*run_, "operators", "INSERT INTO operators VALUES(?, ?, ?, ?, ?, ?)");
  for (const OperatorUse& use : provenance.operators)
    insert.execute(position, use.kind, use.name, use.version, use.file.string(), use.hash);
}

std::uint32_t Archive::add_provenance(const Provenance& provenance) {
  const std::vector<Provenance> there = provenances();
  const auto same =
      std::find_if(there.begin(), there.end(), [&](const Provenance& one) { return are_same(one, provenance); });
  const auto position = static_cast<std::uint32_t>(same - there.begin());
  if (same != there.end()) return position;
  WriteTransaction transaction(*run_);
  insert_provenance(position, provenance);
  transaction.commit();
  return position;
}

}  // namespace evodevo
