#include "cluster/worker.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "base/input_error.hpp"
#include "cluster/ranks.hpp"
#include "experiment/device.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

using Clock = std::chrono::steady_clock;

message::Hello hello_of(const Experiment& experiment, Simulator& simulator) {
  message::Hello hello;
  hello.provenance = this_provenance(experiment, simulator.device());
  hello.host = host_name();
  hello.layout = experiment.layout;
  for (const auto* scores : {&experiment.objectives, &experiment.measures})
    for (const Objective& score : *scores)
      hello.scores.push_back(std::string(score.maximise ? "more " : "less ") + score.name + " in " + score.unit +
                             " as " + name(score.role));
  hello.verified_at_once = verified_at_once(experiment, simulator);
  const std::optional<DeviceUse> gpus = simulator.device_use();
  // a second job of a processor fills the time in which few lives of the first are left
  hello.jobs = gpus ? static_cast<std::uint64_t>(simulator.concurrency()) : 2;
  const std::size_t lives = gpus ? large_cohort : lives_at_once(simulator);
  hello.robots = std::max<std::size_t>(1, lives / static_cast<std::size_t>(experiment.lives));
  return hello;
}

}  // namespace

Worker::Worker(const Experiment& experiment, Simulator& simulator)
    : hello_(hello_of(experiment, simulator)), evaluator_(experiment, simulator) {}

Worker::~Worker() { threads_.clear(); }

void Worker::start(message::Job job) {
  const std::uint64_t number = job.number;
  threads_[number] = std::jthread([this, job = std::move(job)] { work(job); });
}

void Worker::work(const message::Job& job) {
  const BusyClock::Span span(busy_);
  constexpr std::uint64_t cycle = 1 << 20;  // far more jobs than there are at the same time
  const Priority priority(static_cast<int>(job.number % cycle));
  Done done{{job.number, {}}, nullptr};
  try {
    done.answer.outcomes = outcomes(job);
  } catch (...) {
    done.failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  progress_.erase(job.number);
  done_.push_back(std::move(done));
  job_ended_.notify_all();
}

std::vector<message::Outcome> Worker::outcomes(const message::Job& job) {
  std::vector<Newborn> newborns;
  for (const message::JobItem& item : job.items)
    newborns.push_back(
        {.id = item.id, .generation = item.generation, .genome = &item.genome, .life = item.life, .lives = item.lives});
  std::vector<message::Outcome> outcomes;
  if (job.work == message::Work::evaluate) {
    for (Evaluated& one : evaluated(newborns, job.number)) outcomes.push_back({.result = std::move(one.result)});
  } else if (job.work == message::Work::records) {
    const std::vector<std::uint32_t> own(newborns.size());
    for (const std::vector<LifeRecord>& lives : evaluator_.records(newborns, own)) {
      message::Outcome& outcome = outcomes.emplace_back();
      for (const LifeRecord& record : lives) outcome.records.push_back(record.bytes());
    }
  } else {
    std::vector<Champion> champions;
    for (std::size_t i = 0; i < newborns.size(); ++i) champions.push_back({newborns[i], job.items[i].fitness});
    const std::vector<std::uint32_t> own(newborns.size());
    for (Verification& verification : evaluator_.verify(champions, own))
      outcomes.push_back({.verification = std::move(verification)});
  }
  return outcomes;
}

std::vector<Evaluated> Worker::evaluated(std::span<const Newborn> newborns, std::uint64_t job) {
  return evaluator_.evaluate_cohort(newborns, [&](double part) {
    const std::lock_guard lock(mutex_);
    progress_[job] = part * static_cast<double>(newborns.size());
  });
}

std::optional<message::Answer> Worker::answer() {
  Done done;
  {
    const std::lock_guard lock(mutex_);
    if (done_.empty()) return std::nullopt;
    done = std::move(done_.front());
    done_.erase(done_.begin());
  }
  threads_.erase(done.answer.job);
  done.answer.busy = busy_.seconds();
  if (done.failure) std::rethrow_exception(done.failure);
  return std::move(done.answer);
}

void Worker::wait(std::chrono::microseconds time) {
  std::unique_lock lock(mutex_);
  job_ended_.wait_for(lock, time, [&] { return !done_.empty(); });
}

message::Beat Worker::beat() const {
  message::Beat beat{0, busy_.seconds()};
  const std::lock_guard lock(mutex_);
  for (const auto& [job, robots] : progress_) beat.done += robots;
  return beat;
}

namespace {

/// Ends a rank whose leader is lost: no message has come for too long.
class Silence {
 public:
  explicit Silence(std::chrono::seconds patience) : patience_(patience) {}
  void broken() { last_ = Clock::now(); }
  void check() const {
    if (Clock::now() - last_ > patience_)
      throw std::runtime_error("rank 0 has said nothing for " + std::to_string(patience_.count()) +
                               " s; resume the run where its folder is");
  }

 private:
  std::chrono::seconds patience_;
  Clock::time_point last_ = Clock::now();
};

/// Whether a message ends the run. If so, the ranks that it names are given up.
bool ends_run(const Received& received, Channel& channel) {
  if (message::kind_of(received.bytes) != message::Kind::end) return false;
  for (const int rank : message::unpacked<message::End>(received.bytes).lost) channel.give_up(rank);
  return true;
}

/// Waits for a message that ends the run, or that is of one of the given kinds. Returns nullopt in the first case.
std::optional<std::string> awaited(Channel& channel, std::initializer_list<message::Kind> kinds,
                                   std::chrono::seconds patience) {
  Silence silence(patience);
  for (;; std::this_thread::sleep_for(between_looks)) {
    while (std::optional<Received> received = channel.receive()) {
      silence.broken();
      if (ends_run(*received, channel)) return std::nullopt;
      if (std::ranges::find(kinds, message::kind_of(received->bytes)) != kinds.end()) return std::move(received->bytes);
    }
    silence.check();
  }
}

/// Takes all messages that are there. Returns false if one of them ends the run.
bool take_messages(Channel& channel, Worker& worker, Silence& silence) {
  while (const std::optional<Received> received = channel.receive()) {
    silence.broken();
    if (ends_run(*received, channel)) return false;
    const message::Kind kind = message::kind_of(received->bytes);
    if (kind == message::Kind::job) worker.start(message::unpacked<message::Job>(received->bytes));
    if (kind == message::Kind::forget) worker.forget_records();
  }
  return true;
}

/// Sends the answers to the jobs that have ended. Throws what a job has thrown.
void send_answers(Channel& channel, Worker& worker) {
  while (const std::optional<message::Answer> answer = worker.answer()) channel.send(0, message::packed(*answer));
}

}  // namespace

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown host";
}

void require_protocol(const std::string& bytes) {
  if (const std::string protocol = message::protocol_of(bytes); protocol != message::protocol())
    throw InputError("speaks protocol " + message::protocol() + ", but rank 0 speaks protocol " + protocol +
                     "; give all ranks evodevo programs of the same version");
}

std::optional<std::string> first_message(Channel& channel) {
  return awaited(channel, {message::Kind::setup, message::Kind::lead}, patience_with_leader);
}

void report_failure(const std::exception& error, Channel& channel, std::chrono::seconds patience) {
  const bool of_input = dynamic_cast<const InputError*>(&error) != nullptr;
  channel.send(0, message::packed(message::Failure{host_name(), error.what(), of_input}));
  awaited(channel, {}, patience);
}

void do_jobs(Channel& channel, Worker& worker, std::chrono::seconds patience) {
  Silence silence(patience);
  for (Clock::time_point next_beat = Clock::now();; worker.wait(between_looks)) {
    silence.check();
    try {
      if (!take_messages(channel, worker, silence)) return;
      send_answers(channel, worker);
    } catch (const std::exception& error) {
      return report_failure(error, channel, patience);
    }
    if (Clock::now() < next_beat) continue;
    channel.send(0, message::packed(worker.beat()));
    next_beat = Clock::now() + between_beats;
  }
}

void serve(Channel& channel, const std::string& bytes, const std::function<RankOptions()>& options) {
  Experiment experiment;
  std::unique_ptr<Simulator> simulator;
  std::unique_ptr<Worker> worker;
  try {
    require_protocol(bytes);
    const message::Setup setup = message::unpacked<message::Setup>(bytes);
    RankOptions given = options();
    experiment = read_experiment(setup.text, {.file = setup.name,
                                              .overrides = std::move(given.overrides),
                                              .plugin_path = std::move(given.plugin_path),
                                              .is_record = setup.is_record,
                                              .gpus = std::move(given.gpus),
                                              .files = setup.files});
    experiment.name = setup.name;
    share_host(experiment, channel, given.mixed);
    simulator = make_simulator(experiment);
    worker = std::make_unique<Worker>(experiment, *simulator);
  } catch (const std::exception& error) {
    return report_failure(error, channel, patience_with_leader);
  }
  channel.send(0, message::packed(worker->hello()));
  do_jobs(channel, *worker);
}

}  // namespace evodevo
