#include "cluster/farm.hpp"

#include <algorithm>
#include <iostream>
#include <ranges>
#include <utility>

#include "base/input_error.hpp"
#include "cluster/wire.hpp"

namespace evodevo {
namespace {

message::JobItem item_of(const Newborn& newborn, double fitness) {
  return {newborn.id, newborn.generation, newborn.life, newborn.lives, fitness, *newborn.genome};
}

std::vector<message::JobItem> items_of(std::span<const Newborn> newborns) {
  std::vector<message::JobItem> items;
  for (const Newborn& newborn : newborns) items.push_back(item_of(newborn, 0));
  return items;
}

const std::string same_for_all = "; results would depend on which rank simulates a robot; give all ranks the same ";
constexpr const char* or_mixed = ", or allow this with --mixed, so that the run records what evaluated each robot";

const Progress silent = [](double) {};

void tell_all(Channel& channel, const std::string& bytes) {
  for (int rank = 1; rank < channel.size(); ++rank) channel.send(rank, bytes);
}

std::string name_of(const OperatorUse& use) { return use.kind + " operator \"" + use.name + "\""; }

}  // namespace

std::size_t job_size(std::size_t left, std::size_t jobs, std::size_t share, const message::Hello& rank) {
  const std::size_t small_jobs = (rank.jobs + 3) / 4;
  const std::size_t of_share = std::max(share / small_jobs, std::min(share, smallest_cohort));
  const std::size_t least = std::clamp<std::size_t>(of_share, 1, rank.robots);
  return std::min(left, std::clamp(left / (2 * jobs), least, 4 * rank.robots));
}

void end_run(Channel& channel) { tell_all(channel, message::packed(message::End{channel.given_up()})); }

Farm::Farm(const Experiment& experiment, Simulator& simulator, Channel& channel, const message::Setup& setup,
           const FarmOptions& options)
    : channel_(channel),
      options_(options),
      worker_(experiment, simulator),
      provenances_{worker_.hello().provenance},
      ranks_(static_cast<std::size_t>(channel.size())) {
  if (options_.mixed && experiment.remeasure > 0)
    throw InputError("--mixed: selection.remeasure = " + std::to_string(experiment.remeasure) +
                     " lets robots live again, perhaps on a rank that simulates otherwise than that of their first "
                     "lives; leave out --mixed or remeasure");
  ranks_.front().hello = worker_.hello();
  ranks_.front().ready = true;
  tell_all(channel_, message::packed(setup));
  wait_for_hellos();
}

void Farm::wait_for_hellos() {
  const Clock::time_point end = Clock::now() + setup_patience * options_.patience;
  for (std::size_t missing = ranks_.size() - 1; missing > 0;) {
    const std::optional<Received> received = channel_.receive();
    if (!received) {
      if (Clock::now() > end) throw std::runtime_error(who_is_missing());
      worker_.wait(between_looks);
      continue;
    }
    Rank& rank = ranks_[static_cast<std::size_t>(received->from)];
    rank.heard = Clock::now();
    if (message::kind_of(received->bytes) == message::Kind::failure)
      fail(received->from, message::unpacked<message::Failure>(received->bytes));
    if (message::kind_of(received->bytes) != message::Kind::hello) continue;  // a beat
    rank.hello = message::unpacked<message::Hello>(received->bytes);
    check_questions(received->from, rank.hello);
    if (!options_.mixed) check_equal(received->from, rank.hello);
    rank.provenance = known_provenance(rank.hello.provenance);
    rank.ready = true;
    --missing;
  }
}

std::string Farm::title(int rank, const std::string& host) const {
  return "rank " + std::to_string(channel_.number_in_run(rank)) + " on " + host;
}

std::string Farm::who_is_missing() const {
  std::string missing;
  for (std::size_t i = 0; i < ranks_.size(); ++i)
    if (!ranks_[i].ready)
      missing += (missing.empty() ? "" : ", ") + std::to_string(channel_.number_in_run(static_cast<int>(i)));
  return "of " + std::to_string(ranks_.size()) + " ranks, these have not become ready in " +
         std::to_string((setup_patience * options_.patience).count()) + " s: " + missing +
         "; look whether their hosts and disks work, or start fewer ranks";
}

/// Throws if the operators of a rank read other genomes than those of this one, or score something else.
void Farm::check_questions(int rank, const message::Hello& hello) const {
  const message::Hello& here = worker_.hello();
  const char* const what = hello.layout != here.layout   ? "have genomes with another layout"
                           : hello.scores != here.scores ? "score something else"
                                                         : nullptr;
  if (what)
    throw InputError("the operators of " + title(rank, hello.host) + " " + what + " than those of " +
                     title(0, here.host) + "; give all ranks operators of the same version");
}

/// Returns the index of a provenance, which is new if no rank has had it.
std::uint32_t Farm::known_provenance(const Provenance& provenance) {
  const auto known =
      std::ranges::find_if(provenances_, [&](const Provenance& one) { return are_same(one, provenance); });
  const auto index = static_cast<std::uint32_t>(known - provenances_.begin());
  if (known == provenances_.end()) provenances_.push_back(provenance);
  return index;
}

/// Throws if a rank could give other results than this one.
void Farm::check_equal(int rank, const message::Hello& hello) const {
  const Provenance& here = worker_.hello().provenance;
  const Provenance& there = hello.provenance;
  const std::string who = title(rank, hello.host);
  if (there.program != here.program)
    throw InputError(who + " runs another build of evodevo (" + there.program + ") than " +
                     title(0, worker_.hello().host) + " (" + here.program + ")" + same_for_all + "program" + or_mixed);
  for (std::size_t i = 0; i < here.operators.size(); ++i)
    if (there.operators.at(i).hash != here.operators[i].hash)
      throw InputError(who + " has another build of the " + name_of(here.operators[i]) + " (" +
                       there.operators[i].hash + ") than " + title(0, worker_.hello().host) + " (" +
                       here.operators[i].hash + ")" + same_for_all + "libraries" + or_mixed);
  if (there.device != here.device)
    throw InputError(who + " simulates on " + there.device + ", and " + title(0, worker_.hello().host) +
                     " simulates on " + here.device + same_for_all + "type of device (--device)" + or_mixed);
}

std::vector<Evaluated> Farm::evaluate(std::span<const Newborn> newborns, const Progress& progress) {
  Batch batch = work({message::Work::evaluate, items_of(newborns)}, progress);
  std::vector<Evaluated> evaluated;
  for (std::size_t i = 0; i < newborns.size(); ++i)
    evaluated.push_back({std::move(batch.outcomes[i].result), batch.found_by[i]});
  return evaluated;
}

std::vector<std::vector<LifeRecord>> Farm::records(std::span<const Newborn> newborns,
                                                   std::span<const std::uint32_t> provenances) {
  Batch batch = work({message::Work::records, items_of(newborns), {provenances.begin(), provenances.end()}}, silent);
  std::vector<std::vector<LifeRecord>> records;
  for (message::Outcome& outcome : batch.outcomes) {
    std::vector<LifeRecord>& lives = records.emplace_back();
    for (std::string& record : outcome.records) lives.emplace_back(std::move(record));
  }
  return records;
}

void Farm::forget_records() {
  worker_.forget_records();
  tell_all(channel_, message::packed(message::Kind::forget));
  keepers_.clear();
}

std::vector<Verification> Farm::verify(std::span<const Champion> champions,
                                       std::span<const std::uint32_t> provenances) {
  std::vector<message::JobItem> items;
  for (const Champion& champion : champions) items.push_back(item_of(champion.newborn, champion.fitness));
  Batch batch = work({message::Work::verify, std::move(items), {provenances.begin(), provenances.end()}}, silent);
  std::vector<Verification> verifications;
  for (message::Outcome& outcome : batch.outcomes) verifications.push_back(std::move(outcome.verification));
  return verifications;
}

std::size_t Farm::verified_at_once() const {
  std::size_t champions = 0;
  for (const Rank& rank : ranks_)
    if (!rank.lost) champions += rank.hello.verified_at_once;
  return champions;
}

Farm::Batch Farm::work(Batch batch, const Progress& progress) {
  batch.outcomes.resize(batch.items.size());
  batch.found_by.resize(batch.items.size());
  batch.left.resize(batch.needed.empty() ? 1 : provenances_.size());
  for (std::size_t item = batch.items.size(); item-- > 0;) batch.put_back(item);
  if (batch.work == message::Work::records) deal_to_keepers(batch);
  for (; batch.done < batch.items.size(); worker_.wait(between_looks)) {
    bool news = false;
    do {
      deal(batch);
    } while (take_messages(batch) && (news = true));
    news |= beat();
    give_up_silent(batch);
    check_served(batch);
    if (news) progress(robots_done(batch) / static_cast<double>(batch.items.size()));
  }
  return batch;
}

/// Gives jobs to ranks until none is free or nothing is left.
void Farm::deal(Batch& batch) {
  while (const std::optional<int> free = free_rank(batch)) {
    const Rank& rank = ranks_[static_cast<std::size_t>(*free)];
    std::deque<std::size_t>& left = batch.left[batch.line(rank.provenance)];
    const auto count = static_cast<std::ptrdiff_t>(
        job_size(left.size(), jobs_at_once(batch, rank.provenance), share_of_rank(batch), rank.hello));
    std::vector<std::size_t> items(left.begin(), left.begin() + count);
    left.erase(left.begin(), left.begin() + count);
    assign(*free, std::move(items), batch);
  }
}

/// Returns the number of jobs that the ranks that may do the same items as one with this provenance do at once.
std::size_t Farm::jobs_at_once(const Batch& batch, std::uint32_t provenance) const {
  std::size_t jobs = 0;
  for (const Rank& rank : ranks_)
    if (!rank.lost && batch.line(rank.provenance) == batch.line(provenance)) jobs += rank.hello.jobs;
  return jobs;
}

/// Returns the number of items for each rank if all did the same number, rounded up.
std::size_t Farm::share_of_rank(const Batch& batch) const {
  const auto ranks = static_cast<std::size_t>(std::ranges::count(ranks_, false, &Rank::lost));
  return (batch.items.size() + ranks - 1) / ranks;
}

/// Throws if there are items that no rank may do, because those that might are lost.
void Farm::check_served(const Batch& batch) const {
  for (std::uint32_t provenance = 0; provenance < batch.left.size(); ++provenance)
    if (!batch.left[provenance].empty() && jobs_at_once(batch, provenance) == 0)
      throw std::runtime_error("no rank is left with the device (" + provenances_[provenance].device +
                               ") and the builds that evaluated these robots; resume the run: it keeps their results, "
                               "but does not record or verify their lives");
}

/// Returns, of the ranks for which there are items, the one that has the smallest part of the jobs that it does at
/// once; nullopt if all have enough.
std::optional<int> Farm::free_rank(const Batch& batch) const {
  std::optional<int> best;
  double least = 1;
  for (std::size_t i = 0; i < ranks_.size(); ++i) {
    const double part = static_cast<double>(ranks_[i].jobs) / static_cast<double>(ranks_[i].hello.jobs);
    if (ranks_[i].lost || part >= least || batch.left[batch.line(ranks_[i].provenance)].empty()) continue;
    least = part;
    best = static_cast<int>(i);
  }
  return best;
}

/// Asks the ranks that keep records for them. Records that nobody keeps are left.
void Farm::deal_to_keepers(Batch& batch) {
  std::map<int, std::vector<std::size_t>> kept;
  for (std::deque<std::size_t>& line : batch.left)
    std::erase_if(line, [&](std::size_t item) {
      const auto keeper = keepers_.find(batch.items[item].id);
      if (keeper == keepers_.end()) return false;
      kept[keeper->second].push_back(item);
      return true;
    });
  constexpr std::ptrdiff_t most = 100;  // records in a message
  for (const auto& [rank, items] : kept)
    for (auto begin = items.begin(); begin != items.end();) {
      const auto end = begin + std::min(most, items.end() - begin);
      assign(rank, {begin, end}, batch);
      begin = end;
    }
}

void Farm::assign(int rank, std::vector<std::size_t> items, const Batch& batch) {
  message::Job job{next_job_++, batch.work, {}};
  for (const std::size_t item : items) job.items.push_back(batch.items[item]);
  ++ranks_[static_cast<std::size_t>(rank)].jobs;
  jobs_[job.number] = {rank, std::move(items)};
  if (rank == 0)
    worker_.start(std::move(job));
  else
    channel_.send(rank, message::packed(job));
}

/// Takes all answers and messages that are there. Returns whether there was an answer.
bool Farm::take_messages(Batch& batch) {
  bool answered = false;
  while (std::optional<message::Answer> answer = worker_.answer()) {
    take(0, *std::move(answer), batch);
    answered = true;
  }
  while (const std::optional<Received> received = channel_.receive()) {
    Rank& rank = ranks_[static_cast<std::size_t>(received->from)];
    if (rank.lost) continue;
    rank.heard = Clock::now();
    const message::Kind kind = message::kind_of(received->bytes);
    if (kind == message::Kind::failure) fail(received->from, message::unpacked<message::Failure>(received->bytes));
    if (kind == message::Kind::beat) rank.beat = message::unpacked<message::Beat>(received->bytes);
    if (kind != message::Kind::answer) continue;
    take(received->from, message::unpacked<message::Answer>(received->bytes), batch);
    answered = true;
  }
  return answered;
}

void Farm::take(int rank, message::Answer answer, Batch& batch) {
  const auto job = jobs_.extract(answer.job);
  if (job.empty() || answer.outcomes.size() != job.mapped().items.size())
    throw WireError("rank " + std::to_string(channel_.number_in_run(rank)) + " answers a question that was not asked");
  const std::vector<std::size_t>& items = job.mapped().items;
  Rank& from = ranks_[static_cast<std::size_t>(rank)];
  for (std::size_t i = 0; i < items.size(); ++i) {
    batch.outcomes[items[i]] = std::move(answer.outcomes[i]);
    batch.found_by[items[i]] = from.provenance;
    if (batch.work == message::Work::evaluate) keepers_[batch.items[items[i]].id] = rank;
  }
  batch.done += items.size();
  from.beat.busy = answer.busy;
  --from.jobs;
  if (batch.work == message::Work::evaluate) from.robots += items.size();
}

/// Tells the others every second that this rank is alive. Returns whether it was time.
bool Farm::beat() {
  if (Clock::now() < next_beat_) return false;
  ranks_.front().beat = worker_.beat();
  tell_all(channel_, message::packed(ranks_.front().beat));
  next_beat_ = Clock::now() + between_beats;
  return true;
}

/// Takes the jobs of ranks that have fallen silent back. Time in which this rank has not listened does not count.
void Farm::give_up_silent(Batch& batch) {
  const bool has_listened = Clock::now() - listened_ < between_beats;
  listened_ = Clock::now();
  if (!has_listened)
    for (Rank& rank : ranks_) rank.heard = listened_;
  for (std::size_t i = 1; i < ranks_.size(); ++i) {
    Rank& rank = ranks_[i];
    if (rank.lost || Clock::now() - rank.heard <= options_.patience) continue;
    std::cerr << "warning: " + title(static_cast<int>(i), rank.hello.host) + " has said nothing for " +
                     std::to_string(options_.patience.count()) + " s and is given up; the other ranks do its work\n";
    rank.lost = true;
    channel_.give_up(static_cast<int>(i));
    std::erase_if(keepers_, [&](const auto& keeper) { return keeper.second == static_cast<int>(i); });
    std::erase_if(jobs_, [&](const auto& job) {
      if (job.second.rank != static_cast<int>(i)) return false;
      for (const std::size_t item : job.second.items | std::views::reverse) batch.put_back(item);
      return true;
    });
  }
}

double Farm::robots_done(const Batch& batch) const {
  auto done = static_cast<double>(batch.done);
  for (const Rank& rank : ranks_)
    if (!rank.lost && rank.jobs > 0) done += rank.beat.done;
  // a beat may count robots whose answers have come since
  return std::min(done, static_cast<double>(batch.items.size()));
}

std::vector<Share> Farm::shares() const {
  std::vector<Share> shares;
  for (std::size_t i = 0; i < ranks_.size(); ++i) {
    const Rank& rank = ranks_[i];
    shares.push_back({static_cast<int>(i), rank.hello.host, rank.robots, rank.beat.busy, rank.lost});
  }
  return shares;
}

void Farm::fail(int rank, const message::Failure& failure) const {
  const std::string text = title(rank, failure.host) + ": " + failure.reason;
  if (failure.of_input) throw InputError(text);
  throw std::runtime_error(text);
}

}  // namespace evodevo
