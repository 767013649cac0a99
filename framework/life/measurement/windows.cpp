#include "life/measurement/windows.hpp"

#include <algorithm>
#include <cmath>

#include "life/measurement/scenario_start.hpp"

namespace evodevo {
namespace {

constexpr double rounding = 1e-9;  // s

/// A moment of a life: a cycle of development (from 1; 0: after maturing), and a time since its beginning. Times are
/// whole nanoseconds, so that equal moments of two windows are equal in all bits.
struct Moment {
  std::int64_t cycle = 0, nanoseconds = 0;

  static Moment at(std::int64_t cycle, double seconds) { return {cycle, std::llround(seconds * 1e9)}; }
  double seconds() const { return static_cast<double>(nanoseconds) * 1e-9; }

  friend auto operator<=>(const Moment&, const Moment&) = default;
};

/// A sample that a window needs.
struct Need {
  Moment moment;
  Channels channels;
};

/// Returns the needs of a window: those of its samples, the first of which is at its opening, then that of its closing.
/// `moment_after(time)` is the moment `time` s after the opening.
template <class MomentAfter>
std::vector<Need> needs_of(const Request& request, const Moment& opening, const MomentAfter& moment_after) {
  std::vector<Need> needs{{opening, Channels{.centre = true, .box = true, .work = request.work} | request.channels}};
  if (request.rate > 0)
    for (std::int64_t i = 1; i <= last_sample(request); ++i)
      needs.push_back({moment_after(static_cast<double>(i) / request.rate), request.channels});
  needs.push_back({moment_after(request.window), {.centre = true, .work = request.work}});
  return needs;
}

std::vector<Need> needs_after_maturing(const Request& request, double later) {
  const double opens = request.settle + later;
  return needs_of(request, Moment::at(0, opens), [&](double time) { return Moment::at(0, opens + time); });
}

/// A window that opens between two cycles opens after the change of the body. Every other sample between two cycles is
/// taken before it.
std::vector<Need> needs_within_life(const Request& request, double cycle_time) {
  const double opens = static_cast<double>(*request.cycle) * cycle_time + request.settle;
  const auto first = static_cast<std::int64_t>(std::floor((opens + rounding) / cycle_time));
  const auto moment_after = [&](double time) {
    const auto cycle = std::max<std::int64_t>(1, std::llround(std::ceil((opens + time - rounding) / cycle_time)));
    return Moment::at(cycle, opens + time - static_cast<double>(cycle - 1) * cycle_time);
  };
  const double since = std::max(0.0, opens - static_cast<double>(first) * cycle_time);
  return needs_of(request, Moment::at(first + 1, since), moment_after);
}

/// Merges needs at the same moment, in the order of time.
std::vector<Need> merged(std::vector<Need> needs) {
  std::stable_sort(needs.begin(), needs.end(), [](const Need& a, const Need& b) { return a.moment < b.moment; });
  std::vector<Need> merged;
  for (const Need& need : needs) {
    if (merged.empty() || merged.back().moment != need.moment) merged.push_back({need.moment, {}});
    merged.back().channels = merged.back().channels | need.channels;
  }
  return merged;
}

/// The index among `merged` of the sample at a moment.
std::size_t index_of(const Moment& moment, const std::vector<Need>& merged) {
  const auto found = std::lower_bound(merged.begin(), merged.end(), moment,
                                      [](const Need& need, const Moment& wanted) { return need.moment < wanted; });
  return static_cast<std::size_t>(found - merged.begin());
}

Channels counted_in(const std::vector<Need>& needs) {
  Channels all;
  for (const Need& need : needs) all = all | need.channels;
  return {.contact = all.contact, .work = all.work, .contacts = all.contacts};
}

double bytes_of(std::span<const SampleTime> samples, std::size_t masses, std::size_t springs) {
  double bytes = 0;
  for (const auto& [time, channels] : samples) {
    bytes += sizeof(StoredSample);
    bytes += static_cast<double>(masses) * 3 * sizeof(float) * (channels.positions + channels.velocities);
    bytes += static_cast<double>(masses) * (sizeof(double) + sizeof(std::uint32_t)) * channels.contacts;
    bytes += static_cast<double>(springs) * sizeof(float) * channels.forces;
  }
  return bytes;
}

template <class BytesOf>
std::size_t fitting(std::span<const Life> lives, const BytesOf& bytes_of_body) {
  double bytes = 0;
  std::size_t count = 0;
  for (; count < lives.size(); ++count) {
    const Body& body = lives[count].living.body;
    bytes += bytes_of_body(body.masses.size(), body.springs.size());
    if (bytes > most_sample_bytes) break;
  }
  return std::max<std::size_t>(count, 1);
}

}  // namespace

Windows::Windows(const Experiment& experiment, double later)
    : cycle_time_(experiment.development.cycle_time),
      in_cycles_(static_cast<std::size_t>(experiment.development.cycles)),
      scenes_of_life_(static_cast<double>(1 + scenarios_that_develop(experiment).size())) {
  std::vector<std::vector<Need>> needs;
  std::vector<Need> in_life, after;
  for (std::size_t i = 0; i < experiment.fitness.size(); ++i) {
    Window& window = windows_.emplace_back(Window{fitness_request(experiment, i)});
    const Request& request = window.request;
    if (!window.within_life()) duration_ = std::max(duration_, request.settle + later + request.window);
    needs.push_back(window.within_life() ? needs_within_life(request, cycle_time_)
                                         : needs_after_maturing(request, later));
    std::vector<Need>& all = window.within_life() ? in_life : after;
    all.insert(all.end(), needs.back().begin(), needs.back().end());
  }
  in_life = merged(std::move(in_life));
  after = merged(std::move(after));
  counted_in_life_ = counted_in(in_life);
  for (const Need& need : in_life)
    in_cycles_.at(static_cast<std::size_t>(need.moment.cycle - 1)).push_back({need.moment.seconds(), need.channels});
  for (const Need& need : after) after_maturing_.push_back({need.moment.seconds(), need.channels});
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    std::vector<std::size_t> at;
    for (const Need& need : needs[i]) at.push_back(index_of(need.moment, windows_[i].within_life() ? in_life : after));
    windows_[i].opens = at.front();
    windows_[i].closes = at.back();
    at.pop_back();
    if (windows_[i].request.rate > 0) windows_[i].samples = std::move(at);
  }
}

std::int64_t last_sample(const Request& request) {
  return static_cast<std::int64_t>(std::floor(request.window * request.rate + rounding));
}

double Windows::bytes_after_maturing(std::size_t masses, std::size_t springs) const {
  return bytes_of(after_maturing_, masses, springs);
}

double Windows::bytes_within_life(std::size_t masses, std::size_t springs) const {
  double bytes = 0;
  for (const std::vector<SampleTime>& samples : in_cycles_) bytes += bytes_of(samples, masses, springs);
  return bytes;
}

std::size_t Windows::fitting_after_maturing(std::span<const Life> lives) const {
  return fitting(lives, [&](auto masses, auto springs) { return bytes_after_maturing(masses, springs); });
}

std::size_t Windows::fitting_within_life(std::span<const Life> born) const {
  return fitting(born, [&](auto masses, auto springs) { return scenes_of_life_ * bytes_within_life(masses, springs); });
}

Stretch Windows::in_cycle(std::int64_t cycle) const {
  return {
      .duration = cycle_time_, .samples = in_cycles_[static_cast<std::size_t>(cycle - 1)], .counted = counted_in_life_};
}

Stretch Windows::after_maturing() const {
  return {.duration = duration_, .samples = after_maturing_, .counted = {}};
}

}  // namespace evodevo
