// What the ranks of a run tell each other.
//
//   rank 0 ─► others   Setup once; then Job, forget; end
//   others ─► rank 0   Hello once; then Answer, Beat; Failure
//
// With islands, the first rank of each group does what rank 0 does here, for the ranks of its group, and
//
//   rank 0 ─► others          Lead once; then stop
//   first ranks ─► rank 0     Generation, Done; Failure
//   first ranks ─► the others Migrants, LastMigrants, Beat
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "archive/population.hpp"
#include "archive/provenance.hpp"
#include "evolution/evaluator.hpp"

namespace evodevo::message {

/// Names the form of messages and of the records in them. Different builds of the program can read each other's
/// messages if it is the same. The number before the point grows with every change of a message; the one after it is
/// that of the archive's format.
std::string protocol();

/// A rank with another protocol reads nothing but the beginning of Setup, and answers with Failure. So the numbers of
/// the kinds, Failure and End never change.
enum class Kind : std::uint8_t {
  setup,
  hello,
  job,
  answer,
  beat,
  forget,
  failure,
  end,
  lead,
  generation,
  done,
  migrants,
  last_migrants,
  stop
};

/// The experiment of the run, from which each rank makes its own operators.
struct Setup {
  std::string protocol = message::protocol();
  std::string text;  ///< Experiment::resolved
  std::string name;
  FileContents files;
  bool is_record = false;  ///< ExperimentSource::is_record

  static constexpr auto kind = Kind::setup;
};

/// What a rank is, and how much work it wants to have.
struct Hello {
  std::string host;
  Provenance provenance;
  Layout layout;                       ///< of the genomes that its operators read
  std::vector<std::string> scores;     ///< what its operators score
  std::uint64_t jobs = 1;              ///< number of jobs that it does at the same time
  std::uint64_t robots = 1;            ///< number of robots in a job that keeps its part of the device busy
  std::uint64_t verified_at_once = 1;  ///< Evaluator::verified_at_once()

  static constexpr auto kind = Kind::hello;
};

enum class Work : std::uint8_t { evaluate, records, verify };

/// An individual to evaluate or verify, or whose record is wanted.
struct JobItem {
  std::uint32_t id = 0, generation = 0;
  std::uint32_t life = 1, lives = 1;  ///< Newborn::life and lives
  double fitness = 0;                 ///< Champion::fitness
  Genome genome;
};

struct Job {
  std::uint64_t number = 0;  ///< jobs with lower numbers have priority
  Work work = Work::evaluate;
  std::vector<JobItem> items;

  static constexpr auto kind = Kind::job;
};

/// The outcome of one item, of which only the part that the job asks for is there.
struct Outcome {
  Result result = {};  ///< without its records
  std::vector<std::string> records = {};
  Verification verification = {};
};

struct Answer {
  std::uint64_t job = 0;
  std::vector<Outcome> outcomes;  ///< in the order of the job's items
  double busy = 0;                ///< Beat::busy

  static constexpr auto kind = Kind::answer;
};

/// Sent every second, so that rank 0 knows that the rank is alive.
struct Beat {
  double done = 0;  ///< how many robots of unfinished jobs have been evaluated; parts of evaluations count
  double busy = 0;  ///< time during which the rank had at least one job, s

  static constexpr auto kind = Kind::beat;
};

/// There is no more work for the other ranks. A rank that gets it leaves the channel.
struct End {
  std::vector<int> lost;  ///< ranks that have been given up, for which nobody waits

  static constexpr auto kind = Kind::end;
};

/// The run has islands, whose archives exist. Each rank finds in groups.hpp to which group it belongs.
struct Lead {
  std::string protocol = message::protocol();
  std::string folder;               ///< of the run; all first ranks read and write in it
  std::vector<std::uint32_t> next;  ///< the next generation of each island

  static constexpr auto kind = Kind::lead;
};

/// An island has completed a generation.
struct Generation {
  std::int64_t island = 0;
  Summary summary;

  static constexpr auto kind = Kind::generation;
};

/// A group has ended its work.
struct Done {
  std::vector<int> lost;  ///< ranks of the group that have been given up

  static constexpr auto kind = Kind::done;
};

/// Those who emigrate from one island to another after a generation.
struct Migrants {
  std::int64_t from = 0, to = 0;
  std::uint32_t generation = 0;
  std::vector<Migrant> migrants;

  static constexpr auto kind = Kind::migrants;
};

/// An island has come to its end, and sends nobody any more.
struct LastMigrants {
  std::int64_t island = 0;

  static constexpr auto kind = Kind::last_migrants;
};

/// Why a rank cannot go on.
struct Failure {
  std::string host, reason;
  bool of_input = false;  ///< whether the reason is bad input, such as a missing operator

  static constexpr auto kind = Kind::failure;
};

/// Returns a message as bytes.
template <class Message>
std::string packed(const Message& message);
std::string packed(Kind kind);  ///< of a message without content: forget, stop

/// Returns the kind of a message. Throws WireError if there is none.
Kind kind_of(const std::string& bytes);
/// Returns the protocol of a Setup or a Lead.
std::string protocol_of(const std::string& first);
/// Returns the content of a message of the kind Message::kind. Throws WireError if the bytes are not such a message.
template <class Message>
Message unpacked(const std::string& bytes);

extern template std::string packed(const Setup&);
extern template std::string packed(const Hello&);
extern template std::string packed(const Job&);
extern template std::string packed(const Answer&);
extern template std::string packed(const Beat&);
extern template std::string packed(const End&);
extern template std::string packed(const Failure&);
extern template std::string packed(const Lead&);
extern template std::string packed(const Generation&);
extern template std::string packed(const Done&);
extern template std::string packed(const Migrants&);
extern template std::string packed(const LastMigrants&);
extern template Setup unpacked(const std::string&);
extern template Hello unpacked(const std::string&);
extern template Job unpacked(const std::string&);
extern template Answer unpacked(const std::string&);
extern template Beat unpacked(const std::string&);
extern template End unpacked(const std::string&);
extern template Failure unpacked(const std::string&);
extern template Lead unpacked(const std::string&);
extern template Generation unpacked(const std::string&);
extern template Done unpacked(const std::string&);
extern template Migrants unpacked(const std::string&);
extern template LastMigrants unpacked(const std::string&);

}  // namespace evodevo::message
