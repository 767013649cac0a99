#include "commands/run/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "base/text.hpp"
#include "commands/run/islands_progress.hpp"
#include "commands/shell/output/notices.hpp"
#include "commands/shell/output/output_of_thread.hpp"

namespace evodevo {
namespace {

constexpr std::size_t indent = 7;  ///< of what follows a heading such as "time:"

std::string optional_text(const std::optional<double>& value) { return value ? short_number(*value) : "none"; }

/// The part of a time of `whole` seconds in which a rank had nothing to do, percent.
double idle_percent(const Share& share, double whole) {
  return whole > 0 ? 100 * std::max(0.0, 1 - share.busy / whole) : 0;
}

/// Returns a text such as "16 ranks idle 3 to 8 %".
std::string ranks_text(const std::vector<Share>& shares, double whole) {
  double least = 100, most = 0;
  std::size_t present = 0;
  for (const Share& share : shares) {
    if (share.lost) continue;
    ++present;
    least = std::min(least, idle_percent(share, whole));
    most = std::max(most, idle_percent(share, whole));
  }
  return fmt::format("{} ranks idle {:.0f} to {:.0f} %", present, least, most);
}

}  // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

double ProgressDisplay::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::unique_ptr<ProgressDisplay> progress_of(const Run& run, const std::atomic<bool>& stop, bool has_ranks) {
  const bool is_live = !has_ranks && prints_on_terminal() && verbosity() != Verbosity::quiet;
  if (run.has_islands()) return std::make_unique<IslandsProgress>(run, stop, is_live);
  return std::make_unique<PopulationProgress>(run, stop, is_live);
}

PopulationProgress::PopulationProgress(const Run& run, const std::atomic<bool>& stop, bool is_live)
    : run_(run), experiment_(run.experiments().front()), stop_(stop), live_(is_live) {
  const std::vector<Summary> past = run.archives().front().generations();
  if (past.empty()) return;
  last_ = past.back();
  evaluations_before_ = last_.evaluations;
  evaluations_ = static_cast<double>(last_.evaluations);
  for (const Summary& summary : past) {
    diverged_ += summary.diverged;
    refused_ += summary.refused();
    spring_evaluations_before_ += static_cast<double>(summary.spring_evaluations);
    seconds_before_ += summary.wall_time;
  }
}

double PopulationProgress::seconds_left(double evaluations) const {
  const double done = evaluations - static_cast<double>(evaluations_before_);
  double left = seconds() / done * (static_cast<double>(experiment_.evaluations) - evaluations);
  if (experiment_.hours > 0)
    left = std::min(left, std::max(0.0, experiment_.hours * 3600 - seconds_before_ - seconds()));
  if (experiment_.spring_evaluations == 0 || spring_evaluations_ == 0) return left;
  const auto springs = static_cast<double>(spring_evaluations_);
  const double springs_left = experiment_.spring_evaluations - spring_evaluations_before_ - springs;
  return std::min(left, seconds() / springs * std::max(0.0, springs_left));
}

std::vector<LinePart> PopulationProgress::parts(double evaluations) const {
  const double rate = (evaluations - static_cast<double>(evaluations_before_)) / seconds();
  const auto percent = [&](std::int64_t count) {
    return last_.evaluations > 0 ? 100.0 * static_cast<double>(count) / static_cast<double>(last_.evaluations) : 0.0;
  };
  const std::string of = experiment_.objectives.size() > 1 ? " of " + experiment_.objectives.front().name : "";
  std::vector<LinePart> parts;
  const auto add = [&](int rank, std::string text) { parts.push_back({std::move(text), rank}); };
  add(1, fmt::format("generation {}", last_.generation));
  add(0, fmt::format("evaluations {:.0f}/{}", evaluations, experiment_.evaluations));
  add(0, "best " + optional_text(last_.best));
  add(3, "median " + optional_text(last_.median) + of);
  add(5, fmt::format("diverged {:.1f} %", percent(diverged_)));
  if (experiment_.verify_front != VerifyFront::off) add(5, fmt::format("refused {:.1f} %", percent(refused_)));
  if (const std::vector<Share> shares = run_.shares(); !shares.empty()) add(5, ranks_text(shares, seconds()));
  if (rate > 0) add(4, fmt::format("{:.3g} evaluations/s", rate));
  if (rate > 0) add(2, duration_text(seconds_left(evaluations)) + " left");
  if (stop_) add(0, "(stopping; Ctrl-C again: at once)");
  return parts;
}

std::string PopulationProgress::line(std::size_t columns) const {
  std::string line;
  for (const std::string& part : fitting_parts(parts(evaluations_), columns))
    line += (line.empty() ? "" : "  ") + (live_ && part.starts_with("best ") ? bold(part) : part);
  return line;
}

void PopulationProgress::show_live() {
  live_line_.show([this](std::size_t columns) { return line(columns); });
}

void PopulationProgress::generation_done(std::int64_t, const Summary& summary) {
  last_ = summary;
  diverged_ += summary.diverged;
  refused_ += summary.refused();
  spring_evaluations_ += summary.spring_evaluations;
  evaluations_ = static_cast<double>(summary.evaluations);
  if (live_)
    show_live();
  else
    remarks() << line(std::string::npos) << std::endl;
}

void PopulationProgress::generation_progress(double done) {
  if (!live_) return;
  const std::uint32_t generation = last_.evaluations > 0 ? last_.generation + 1 : 0;
  const auto batch = std::min(experiment_.births(generation), experiment_.evaluations - last_.evaluations);
  evaluations_ = static_cast<double>(last_.evaluations) + done * static_cast<double>(batch);
  show_live();
}

void PopulationProgress::finish() {
  if (!live_) return;
  live_line_.finish([this](std::size_t columns) { return line(columns); });
}

bool print_best(const Experiment& experiment, const Archive& archive) {
  const auto best = archive.best(1);
  const std::string folder = archive.folder().string();
  if (best.empty()) {
    std::cout << "no individual has a fitness";
    if (const std::vector<Individual> population = archive.population(); !population.empty())
      std::cout << "; the first that is left is " << name(population.front().result.status) << ": "
                << population.front().result.reason;
    std::cout << "; to see more: " << shell_command({"show", folder}) << '\n';
    return false;
  }
  const ArchivedIndividual individual = *archive.individual(best.front());
  std::cout << "best: individual " << individual.id << " of generation " << individual.born << " in " << folder;
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i)
    std::cout << ", " << experiment.objectives[i].name << ' '
              << short_quantity(individual.result.objectives[i], experiment.objectives[i].unit);
  std::cout << std::endl;
  remarks() << "      look at the run: " << shell_command({"show", folder}) << "\n      its body:        "
            << shell_command({"body", folder, "--individual", std::to_string(individual.id)})
            << "\n      a film of it:    " << shell_command({"film", folder, "--out", "film.mp4"})
            << "\n      test others:     " << shell_command({"verify", folder, "--best", "10"})
            << "\n      its next lives:  " << shell_command({"signal", folder}) << '\n';
  return true;
}

void print_speed(double spring_evaluations, double seconds, double verifying) {
  const double evaluating = seconds - verifying;
  remarks() << "speed: "
            << wrapped(short_number(spring_evaluations / evaluating) + " spring evaluations/s (" +
                           short_number(spring_evaluations) + " in " + duration_text(evaluating) +
                           (verifying > 0 ? ", without " + duration_text(verifying) + " of verification" : "") + ")",
                       indent)
            << std::endl;
}

void print_shares(const std::vector<Share>& shares, double whole) {
  double robots = 0;
  for (const Share& share : shares) robots += static_cast<double>(share.robots);
  for (const Share& share : shares) {
    remarks() << fmt::format("rank {} on {}: {} robots ({:.0f} %)", share.rank, share.host, share.robots,
                             100 * static_cast<double>(share.robots) / std::max(robots, 1.0));
    remarks() << fmt::format(", idle {:.0f} %", idle_percent(share, whole))
              << (share.lost ? "; lost on the way\n" : "\n");
  }
}

void print_time_spent(const TimeSpent& time, const Simulator& simulator) {
  if (!(time.whole > 0)) return;
  // no line breaks within a part: ~ stands for its spaces
  const auto part = [&](const char* name, double seconds) {
    return std::string(name) + fmt::format("~{:.0f}~%", 100 * seconds / time.whole);
  };
  std::string text = part("simulate", time.evaluation.simulate) + ", " + part("develop", time.evaluation.develop) +
                     ", " + part("decode", time.evaluation.decode) + ", " + part("breed", time.breed) + ", " +
                     part("select", time.select) + ", " + part("archive", time.archive);
  if (time.verify > 0) text += ", " + part("verify", time.verify);
  // verification also uses the device through simulators of its own, whose use is not counted
  if (const std::optional<DeviceUse> device = simulator.device_use(); device && !(time.verify > 0)) {
    const auto devices = static_cast<double>(device->devices);
    text += std::string("; device") + (device->devices > 1 ? "s " : " ") +
            part("idle", time.whole - device->busy / devices);
    if (device->portions > 1)
      text +=
          ", each batch split into up to " + std::to_string(device->portions) + " portions to fit into device memory";
  }
  text = wrapped(text, indent);
  replace_all(text, "~", " ");
  remarks() << "time:  " << text << std::endl;
}

}  // namespace evodevo
