#include "core/piecewise.hpp"

#include <algorithm>
#include <vector>

#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// A task that is simulated in pieces, and its progress.
class Piecewise {
 public:
  explicit Piecewise(Task& whole) : whole_(whole) {
    whole_.spring_evaluations = 0;
    whole_.samples.clear();
    for (const SamplePoint& point : whole_.sampled_at) counted_ = counted_ | counted_of(point.channels);
  }

  /// Whether the task has ended. A task without steps takes one piece if it is sampled.
  bool is_over() const {
    const bool is_sampled = whole_.samples.size() == whole_.sampled_at.size();
    return whole_.status != Status::ok || (done_ == whole_.steps && is_sampled);
  }

  Task piece(std::uint64_t steps) {
    Task piece{.body = whole_.body, .state = whole_.state, .dt = whole_.dt};
    piece.scene = whole_.scene;
    piece.steps = std::min(steps, whole_.steps - done_);
    piece.later_steps = whole_.later_steps + whole_.steps - done_ - piece.steps;
    piece.course = whole_.course;
    piece.preparation = std::move(whole_.preparation);
    piece.split = std::move(whole_.split);
    for (std::size_t next = whole_.samples.size(); next < whole_.sampled_at.size(); ++next) {
      const auto& [step, channels] = whole_.sampled_at[next];
      if (step > done_ + piece.steps) break;
      piece.sampled_at.push_back({step - done_, channels});
    }
    if (counted_.any()) piece.sampled_at.push_back({piece.steps, counted_});
    return piece;
  }

  void take(Task& piece) {
    whole_.status = piece.status;
    whole_.ended_at = piece.ended_at;
    whole_.reason = piece.reason;
    whole_.course = piece.course;
    whole_.preparation = std::move(piece.preparation);
    whole_.split = std::move(piece.split);
    whole_.spring_evaluations += piece.spring_evaluations;
    done_ += piece.steps;
    if (piece.status != Status::ok) return whole_.samples.clear();
    Sample end;
    if (counted_.any()) {
      end = std::move(piece.samples.back());
      piece.samples.pop_back();
    }
    for (std::size_t i = 0; i < piece.samples.size(); ++i) {
      const Channels& channels = whole_.sampled_at[whole_.samples.size()].channels;
      Sample& sample = whole_.samples.emplace_back(std::move(piece.samples[i]));
      if (channels.contact) sample.contact_steps += before_.contact_steps;
      if (channels.work) sample.work += before_.work;
      for (std::size_t m = 0; m < sample.contacts.size() && m < before_.contacts.size(); ++m)
        sample.contacts[m] += before_.contacts[m];
    }
    before_.contact_steps += end.contact_steps;
    before_.work += end.work;
    before_.contacts.resize(end.contacts.size());
    for (std::size_t m = 0; m < end.contacts.size(); ++m) before_.contacts[m] += end.contacts[m];
  }

 private:
  /// The channels that are counted from the beginning of a task.
  static Channels counted_of(const Channels& channels) {
    return {.contact = channels.contact, .work = channels.work, .contacts = channels.contacts};
  }

  Task& whole_;
  Channels counted_;  ///< by any sample; each piece is sampled at its end, so that the next one can go on counting
  Sample before_;     ///< what was counted in earlier pieces
  std::uint64_t done_ = 0;
};

}  // namespace

void run_in_pieces(Simulator& simulator, std::span<Task> tasks, Recording recording,
                   const std::function<std::uint64_t(std::size_t)>& next_steps,
                   const std::function<void(std::size_t, const Task&)>& look) {
  std::vector<Piecewise> on_way;
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    on_way.emplace_back(tasks[i]);
    moving.push_back(i);
  }
  for (;;) {
    std::erase_if(moving, [&](std::size_t i) { return on_way[i].is_over(); });
    if (moving.empty()) return;
    std::vector<Task> pieces;
    for (const std::size_t i : moving) pieces.push_back(on_way[i].piece(next_steps(i)));
    simulator.run(pieces, recording);
    simulator.workers().for_each(moving.size(), [&](std::size_t k) {
      on_way[moving[k]].take(pieces[k]);
      look(moving[k], pieces[k]);
    });
  }
}

}  // namespace evodevo
