#include "cluster/messages.hpp"

#include "archive/schema.hpp"
#include "cluster/wire.hpp"

namespace evodevo {

constexpr Status last_of(Status) { return Status::lucky; }

template <class Wire>
void for_each_part(Wire& wire, Block& block) {
  wire(block.type, block.first, block.count, block.id);
}

template <class Wire>
void for_each_part(Wire& wire, Genome& genome) {
  wire(genome.genes, genome.blocks);
}

template <class Wire>
void for_each_part(Wire& wire, TestScore& score) {
  wire(score.life, score.scenario, score.repeat, score.objective, score.value);
}

template <class Wire>
void for_each_part(Wire& wire, Result& result) {
  wire(result.status, result.reason, result.ended_at, result.objectives, result.spring_evaluations, result.measures,
       result.tests, result.lives);
}

template <class Wire>
void for_each_part(Wire& wire, Trial& trial) {
  wire(trial.name, trial.status, trial.reason, trial.value);
}

template <class Wire>
void for_each_part(Wire& wire, Verification& verification) {
  wire(verification.individual, verification.fitness, verification.trials);
}

template <class Wire>
void for_each_part(Wire& wire, std::filesystem::path& path) {
  std::string text = path.string();
  wire(text);
  if constexpr (std::is_same_v<Wire, WireReader>) path = text;
}

template <class Wire>
void for_each_part(Wire& wire, OperatorUse& use) {
  wire(use.kind, use.name, use.version, use.file, use.hash, use.label);
}

template <class Wire>
void for_each_part(Wire& wire, Provenance& provenance) {
  wire(provenance.device, provenance.version, provenance.program, provenance.operators);
}

template <class Wire>
void for_each_part(Wire& wire, GeneSpec& gene) {
  wire(gene.low, gene.high, gene.choices, gene.refers_to);
}

template <class Wire>
void for_each_part(Wire& wire, BlockType& type) {
  wire(type.name, type.genes, type.least, type.most, type.gene_names, type.section, type.option_names);
}

template <class Wire>
void for_each_part(Wire& wire, Layout& layout) {
  wire(layout.types, layout.first_blocks, layout.sections, layout.own);
}

template <class Wire>
void for_each_part(Wire& wire, Migrated& from) {
  wire(from.island, from.individual);
}

template <class Wire>
void for_each_part(Wire& wire, Migrant& migrant) {
  wire(migrant.from, migrant.origin, migrant.genome);
}

template <class Wire>
void for_each_part(Wire& wire, Summary& s) {
  wire(s.generation, s.evaluations, s.best, s.median, s.diverged, s.invalid, s.artefact, s.lucky, s.passive, s.clones,
       s.spring_evaluations, s.wall_time);
}

namespace message {

constexpr Kind last_of(Kind) { return Kind::stop; }
constexpr Work last_of(Work) { return Work::verify; }

template <class Wire>
void for_each_part(Wire& wire, Setup& setup) {
  wire(setup.protocol, setup.text, setup.name, setup.files, setup.is_record);
}

template <class Wire>
void for_each_part(Wire& wire, Hello& hello) {
  wire(hello.host, hello.provenance, hello.layout, hello.scores, hello.jobs, hello.robots, hello.verified_at_once);
}

template <class Wire>
void for_each_part(Wire& wire, JobItem& item) {
  wire(item.id, item.generation, item.life, item.lives, item.fitness, item.genome);
}

template <class Wire>
void for_each_part(Wire& wire, Job& job) {
  wire(job.number, job.work, job.items);
}

template <class Wire>
void for_each_part(Wire& wire, Outcome& outcome) {
  wire(outcome.result, outcome.records, outcome.verification);
}

template <class Wire>
void for_each_part(Wire& wire, Answer& answer) {
  wire(answer.job, answer.outcomes, answer.busy);
}

template <class Wire>
void for_each_part(Wire& wire, Beat& beat) {
  wire(beat.done, beat.busy);
}

template <class Wire>
void for_each_part(Wire& wire, End& end) {
  wire(end.lost);
}

template <class Wire>
void for_each_part(Wire& wire, Failure& failure) {
  wire(failure.host, failure.reason, failure.of_input);
}

template <class Wire>
void for_each_part(Wire& wire, Lead& lead) {
  wire(lead.protocol, lead.folder, lead.next);
}

template <class Wire>
void for_each_part(Wire& wire, Generation& one) {
  wire(one.island, one.summary);
}

template <class Wire>
void for_each_part(Wire& wire, Done& done) {
  wire(done.lost);
}

template <class Wire>
void for_each_part(Wire& wire, Migrants& m) {
  wire(m.from, m.to, m.generation, m.migrants);
}

template <class Wire>
void for_each_part(Wire& wire, LastMigrants& last) {
  wire(last.island);
}

template <class Message>
std::string packed(const Message& message) {
  WireWriter writer;
  writer(Message::kind, message);
  return std::move(writer).bytes();
}

std::string packed(Kind kind) {
  WireWriter writer;
  writer(kind);
  return std::move(writer).bytes();
}

Kind kind_of(const std::string& bytes) { return WireReader(bytes).next<Kind>(); }

std::string protocol() { return std::string("3.") + archive_format; }

std::string protocol_of(const std::string& first) {
  WireReader reader(first);
  reader.next<Kind>();
  return reader.next<std::string>();
}

template <class Message>
Message unpacked(const std::string& bytes) {
  WireReader reader(bytes);
  if (reader.next<Kind>() != Message::kind) throw WireError("a message between ranks is of another kind");
  Message message = reader.next<Message>();
  reader.expect_end();
  return message;
}

template std::string packed(const Setup&);
template std::string packed(const Hello&);
template std::string packed(const Job&);
template std::string packed(const Answer&);
template std::string packed(const Beat&);
template std::string packed(const End&);
template std::string packed(const Failure&);
template std::string packed(const Lead&);
template std::string packed(const Generation&);
template std::string packed(const Done&);
template std::string packed(const Migrants&);
template std::string packed(const LastMigrants&);
template Setup unpacked(const std::string&);
template Hello unpacked(const std::string&);
template Job unpacked(const std::string&);
template Answer unpacked(const std::string&);
template Beat unpacked(const std::string&);
template End unpacked(const std::string&);
template Failure unpacked(const std::string&);
template Lead unpacked(const std::string&);
template Generation unpacked(const std::string&);
template Done unpacked(const std::string&);
template Migrants unpacked(const std::string&);
template LastMigrants unpacked(const std::string&);

}  // namespace message
}  // namespace evodevo
