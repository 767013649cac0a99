#include "cluster/post.hpp"

#include "base/input_error.hpp"
#include "cluster/worker.hpp"

namespace evodevo {

void Post::Shared::send(int to, std::string bytes) {
  const std::lock_guard lock(mutex_);
  channel_.send(to, std::move(bytes));
}

std::optional<Received> Post::Shared::receive() {
  const std::lock_guard lock(mutex_);
  if (box_.empty()) return std::nullopt;
  Received received = std::move(box_.front());
  box_.pop_front();
  return received;
}

void Post::Shared::give_up(int rank) {
  const std::lock_guard lock(mutex_);
  channel_.give_up(rank);
}

std::vector<int> Post::Shared::given_up() const {
  const std::lock_guard lock(mutex_);
  return channel_.given_up();
}

std::optional<Received> Post::Shared::receive_any() {
  const std::lock_guard lock(mutex_);
  return channel_.receive();
}

void Post::Shared::put_in_box(Received received) {
  const std::lock_guard lock(mutex_);
  box_.push_back(std::move(received));
}

void Post::GroupsExchange::send(const Route& route, std::uint32_t generation, std::vector<Migrant> migrants) {
  const int group = post_.groups_.of_island(route.to);
  if (group == post_.groups_.of_rank(post_.shared_.rank()))
    LocalExchange::send(route, generation, std::move(migrants));
  else
    post_.shared_.send(post_.groups_.first_rank(group),
                       message::packed(message::Migrants{route.from, route.to, generation, std::move(migrants)}));
}

void Post::GroupsExchange::end(std::int64_t island) {
  LocalExchange::end(island);
  post_.tell_first_ranks(message::packed(message::LastMigrants{island}));
}

Post::Post(Channel& channel, const Groups& groups, std::atomic<bool>& stop, OnGeneration on_generation,
           const PostOptions& options)
    : groups_(groups),
      shared_(channel),
      group_(shared_, groups.ranks(groups.of_rank(channel.rank()))),
      exchange_(*this),
      stop_(stop),
      on_generation_(std::move(on_generation)),
      options_(options) {
  for (int group = 0; group < groups_.count(); ++group)
    if (const int rank = groups_.first_rank(group); rank != channel.rank())
      heard_[rank] = Clock::now() + setup_patience * options.patience;
  thread_ = std::jthread([this](const std::stop_token& ending) { work(ending); });
}

void Post::work(const std::stop_token& ending) {
  for (; !ending.stop_requested(); std::this_thread::sleep_for(between_looks)) {
    while (std::optional<Received> received = shared_.receive_any()) sort(*std::move(received));
    if (leads() && stop_ && !told_stop_) {
      tell_first_ranks(message::packed(message::Kind::stop));
      told_stop_ = true;
    }
    beat();
    check_silence();
  }
}

void Post::sort(Received received) {
  const auto first = heard_.find(received.from);
  if (first != heard_.end()) first->second = Clock::now();
  if (received.from == 0) heard_leader_ = Clock::now();
  if (group_.has(received.from)) return shared_.put_in_box(std::move(received));
  try {
    take(received.from, received.bytes);
  } catch (const std::exception& error) {  // of a message that cannot be read, or of on_generation_
    note_failure(error.what());
  }
}

void Post::take(int from, const std::string& bytes) {
  switch (message::kind_of(bytes)) {
    case message::Kind::migrants: {
      auto m = message::unpacked<message::Migrants>(bytes);
      return exchange_.LocalExchange::send({m.from, m.to}, m.generation, std::move(m.migrants));
    }
    case message::Kind::last_migrants:
      return exchange_.LocalExchange::end(message::unpacked<message::LastMigrants>(bytes).island);
    case message::Kind::generation: {
      const auto one = message::unpacked<message::Generation>(bytes);
      return on_generation_(one.island, one.summary);
    }
    case message::Kind::done: {
      for (const int rank : message::unpacked<message::Done>(bytes).lost) shared_.give_up(rank);
      const std::lock_guard lock(mutex_);
      ended_.insert(from);
      return;
    }
    case message::Kind::failure: {
      const auto failure = message::unpacked<message::Failure>(bytes);
      return take_failure(from, "rank " + std::to_string(from) + " on " + failure.host + ": " + failure.reason);
    }
    case message::Kind::end:
      for (const int rank : message::unpacked<message::End>(bytes).lost) shared_.give_up(rank);
      stop_ = true;
      is_over_ = true;
      return;
    case message::Kind::stop:
      stop_ = true;
      return;
    default:
      return;  // a beat
  }
}

/// Says that this rank is alive: to the ranks of its group, which else hear nothing while it waits for migrants, and to
/// the first ranks of the others.
void Post::beat() {
  if (Clock::now() < next_beat_) return;
  next_beat_ = Clock::now() + between_beats;
  const std::string bytes = message::packed(message::Beat{});
  for (int rank = 1; rank < group_.size(); ++rank) group_.send(rank, bytes);
  if (leads())
    tell_first_ranks(bytes);
  else
    shared_.send(0, bytes);
}

void Post::check_silence() {
  if (!leads()) {
    if (Clock::now() - heard_leader_ > options_.patience_with_leader) stop_ = is_over_ = true;
    return;
  }
  for (auto& [rank, heard] : heard_) {
    if (Clock::now() - heard <= options_.patience) continue;
    heard = Clock::time_point::max();
    shared_.give_up(rank);
    take_failure(rank, "rank " + std::to_string(rank) + ", the first one of island " +
                           std::to_string(groups_.islands(groups_.of_rank(rank)).front()) + ", has said nothing for " +
                           std::to_string(options_.patience.count()) + " s; look whether its host works");
  }
}

void Post::note_failure(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = reason;
  stop_ = true;
}

void Post::take_failure(int rank, const std::string& reason) {
  note_failure(reason);
  const std::lock_guard lock(mutex_);
  ended_.insert(rank);
}

void Post::tell_first_ranks(const std::string& bytes) {
  for (const auto& [rank, heard] : heard_) shared_.send(rank, bytes);
}

void Post::tell_generation(std::int64_t island, const Summary& summary) {
  shared_.send(0, message::packed(message::Generation{island, summary}));
}

void Post::done() {
  std::vector<int> lost = shared_.given_up();
  shared_.send(0, message::packed(message::Done{std::move(lost)}));
  wait_for_end();
}

void Post::fail(const std::exception& error) {
  const bool of_input = dynamic_cast<const InputError*>(&error) != nullptr;
  shared_.send(0, message::packed(message::Failure{host_name(), error.what(), of_input}));
  wait_for_end();
}

void Post::wait_for_end() {
  while (!is_over_) std::this_thread::sleep_for(between_looks);
}

std::optional<std::string> Post::others_done() {
  for (;; std::this_thread::sleep_for(between_looks)) {
    const std::lock_guard lock(mutex_);
    if (ended_.size() >= heard_.size()) return failure_;
  }
}

}  // namespace evodevo
