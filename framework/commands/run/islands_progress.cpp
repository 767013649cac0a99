#include "commands/run/islands_progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "base/text.hpp"
#include "commands/run/progress.hpp"
#include "commands/shell/output/notices.hpp"

namespace evodevo {

IslandsProgress::IslandsProgress(const Run& run, const std::atomic<bool>& stop, bool is_live)
    : island_(run.experiments().front()), stop_(stop), is_live_(is_live), last_(run.archives().size()) {
  for (const Experiment& island : run.experiments()) evaluations_ += island.evaluations;
  for (std::size_t i = 0; i < last_.size(); ++i)
    if (const std::vector<Summary> past = run.archives()[i].generations(); !past.empty()) last_[i] = past.back();
  before_ = evaluations_done();
}

void IslandsProgress::generation_done(std::int64_t island, const Summary& summary) {
  last_[static_cast<std::size_t>(island - 1)] = summary;
  spring_evaluations_ += summary.spring_evaluations;
  ++generations_;
  if (is_live_)
    show();
  else if (generations_ % last_.size() == 0)
    remarks() << line(std::string::npos) << std::endl;
}

void IslandsProgress::finish() {
  if (!is_live_) return;
  live_line_.finish([this](std::size_t columns) { return line(columns); });
}

std::int64_t IslandsProgress::evaluations_done() const {
  std::int64_t done = 0;
  for (const std::optional<Summary>& summary : last_) done += summary ? summary->evaluations : 0;
  return done;
}

std::string IslandsProgress::line(std::size_t columns) const {
  std::uint32_t least = ~0u, most = 0;
  std::optional<double> best;
  std::size_t where = 0, begun = 0;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    if (!last_[i]) continue;
    ++begun;
    least = std::min(least, last_[i]->generation);
    most = std::max(most, last_[i]->generation);
    const std::optional<double>& own = last_[i]->best;
    if (!own || (best && !(island_.objectives.front().maximise ? *own > *best : *own < *best))) continue;
    best = own;
    where = i + 1;
  }
  const std::int64_t done = evaluations_done();
  const double rate = static_cast<double>(done - before_) / seconds();
  std::vector<LinePart> parts;
  if (begun < last_.size())
    parts.push_back({fmt::format("{} of {} islands begun", begun, last_.size()), 1});
  else if (least == most)
    parts.push_back({fmt::format("generation {} on {} islands", least, last_.size()), 1});
  else
    parts.push_back({fmt::format("generations {} to {} on {} islands", least, most, last_.size()), 1});
  parts.push_back({fmt::format("evaluations {}/{}", done, evaluations_), 0});
  if (best) parts.push_back({fmt::format("best {} on island {}", short_number(*best), where), 0});
  if (rate > 0) {
    parts.push_back({fmt::format("{:.3g} evaluations/s", rate), 3});
    parts.push_back({duration_text(static_cast<double>(evaluations_ - done) / rate) + " left", 2});
  }
  if (stop_) parts.push_back({"(stopping; Ctrl-C again: at once)", 0});
  return joined(fitting_parts(parts, columns), "  ");
}

void IslandsProgress::show() {
  live_line_.show([this](std::size_t columns) { return line(columns); });
}

}  // namespace evodevo
