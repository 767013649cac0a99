// Simulates batches of random bodies, and tells as a line of JSON for each what does not hold:
//   - a body ends as ok with finite numbers, or as diverged with a reason and without records;
//   - a body has the same bits among other bodies and when it is sampled, or diverges at the same time for the same
//     reason;
//   - a tame body moves on a GPU as on the CPU, unless rounding decides how it moves.
//
//   hostile_bodies cpu|cuda FIRST_BATCH BATCHES BODIES
#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "batch.hpp"
#include "cpu/simulator.hpp"
#include "support/channels.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/runtime/cuda_simulator.hpp"
#endif

namespace evodevo::test {
namespace {

constexpr std::size_t compared = 8;  // one of so many bodies is simulated again among others, every other one sampled

std::unique_ptr<Simulator> simulator_on(const std::string& device, const Batch& batch) {
  if (device == "cpu") return make_cpu_simulator(batch.scene, batch.stepping, 0);
#ifdef EVODEVO_CUDA
  if (device == "cuda") return make_cuda_simulator(batch.scene, batch.stepping, 0);
#endif
  throw std::invalid_argument("the device " + device + " is not cpu, or cuda in a build with CUDA");
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// What is wrong with an answer in itself; empty if nothing is.
std::string fault_of(const Answer& answer, const Life& life, Recording recording) {
  const Task& task = answer.task;
  for (const auto list : SpringRecords::lists) {
    const std::vector<double>& record = task.*list;
    if (!std::ranges::all_of(record, [](double x) { return std::isfinite(x); })) return "a record is not finite";
    SpringRecords wanted;
    wanted.clear(recording, life.body.springs.size());
    const std::size_t size = task.status == Status::ok ? (wanted.*list).size() : 0;
    if (record.size() != size)
      return "a record has " + std::to_string(record.size()) + " numbers instead of " + std::to_string(size);
  }
  if (task.status == Status::diverged) {
    if (task.reason.empty() || !std::isfinite(task.ended_at)) return "diverged without a reason or a time";
    return "";
  }
  if (task.status != Status::ok) return "neither ok nor diverged";
  if (!std::isfinite(task.work)) return "the work is not finite";
  if (!std::ranges::all_of(answer.state.position, is_finite) || !std::ranges::all_of(answer.state.velocity, is_finite))
    return "ok, but a position or a velocity is not finite";
  return "";
}

/// In what two answers for the same life differ; empty if in nothing. Where a body was when it had diverged may differ.
std::string difference(const Answer& a, const Answer& b) {
  if (a.task.status != b.task.status) return "status";
  if (a.task.reason != b.task.reason) return "reason (" + a.task.reason + ", " + b.task.reason + ")";
  if (a.task.status != Status::ok) return a.task.ended_at == b.task.ended_at ? "" : "time";
  if (!same_bits(a.state, b.state)) return "state";
  if (a.task.work != b.task.work) return "work (" + std::to_string(a.task.work - b.task.work) + " J apart)";
  const bool same_records =
      std::ranges::all_of(SpringRecords::lists, [&](const auto list) { return a.task.*list == b.task.*list; });
  return same_records ? "" : "records";
}

/// Samples of everything at the beginning, twice after a third of a life, and at its end.
std::vector<SamplePoint> points_of(const Life& life) {
  std::vector<SamplePoint> points;
  for (const std::uint64_t step : {std::uint64_t{0}, life.steps / 3, life.steps / 3, life.steps})
    points.push_back({step, all_channels});
  return points;
}

/// Every so many lives, in reversed order.
std::vector<std::size_t> some(std::size_t lives) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < lives; i += compared) chosen.insert(chosen.begin(), i);
  return chosen;
}

class Trial {
 public:
  Trial(const std::string& device, std::uint64_t number, std::size_t bodies)
      : device_(device), batch_(batch_of(number, bodies)), simulator_(simulator_on(device, batch_)) {}

  nlohmann::json result() {
    const std::vector<Answer> answers = simulate(*simulator_, batch_.lives, batch_.recording);
    for (std::size_t i = 0; i < answers.size(); ++i) tell(i, fault_of(answers[i], batch_.lives[i], batch_.recording));
    compare_among_others(answers);
    if (device_ != "cpu" && batch_.is_tame) compare_with_cpu(answers);
    const auto diverged =
        std::ranges::count_if(answers, [](const Answer& answer) { return answer.task.status == Status::diverged; });
    return {{"what", std::string(name(batch_.stepping.method)) + ", " + name_of(batch_.stepping.precision) +
                         (batch_.stepping.materials == Materials::computed ? ", materials from codes" : "") +
                         (batch_.is_tame ? "" : ", hostile")},
            {"tried", answers.size()},
            {"diverged", diverged},
            {"found", found_}};
  }

 private:
  void tell(std::size_t life, const std::string& fault) {
    if (!fault.empty()) found_.push_back("body " + std::to_string(life) + ": " + fault);
  }

  void compare_among_others(const std::vector<Answer>& answers) {
    std::vector<Life> lives;
    for (const std::size_t i : some(answers.size())) {
      lives.push_back(batch_.lives[i]);
      if (lives.size() % 2 == 1) lives.back().sampled_at = points_of(lives.back());
    }
    const std::vector<Answer> again = simulate(*simulator_, lives, batch_.recording);
    for (std::size_t k = 0; const std::size_t i : some(answers.size())) {
      const Answer& other = again[k++];
      const std::size_t samples = other.task.sampled_at.size();
      if (const std::string what = difference(answers[i], other); !what.empty())
        tell(i, std::string("among other bodies") + (samples > 0 ? " and sampled" : "") + ", another " + what);
      else if (other.task.status == Status::ok && other.task.samples.size() != samples)
        tell(i, "not sampled as often as requested");
    }
  }

  void compare_with_cpu(const std::vector<Answer>& answers) {
    const std::vector<Answer> cpu = simulate(*simulator_on("cpu", batch_), batch_.lives, batch_.recording);
    const bool single = batch_.stepping.precision == Precision::float32;
    const double rounding = single ? 1e-2 : 1e-9;  // m; about ten times the deviations of most bodies
    const double moved = single ? 1e-5 : 1e-14;    // m; a hundred times the rounding of a position of one metre
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (answers[i].task.status != cpu[i].task.status)
        tell(i, "not the status that it has on the CPU");
      else if (const double apart = largest_difference(answers[i].state, cpu[i].state);
               apart > rounding && apart > 2 * sensitivity(batch_.lives[i], batch_.scene, batch_.stepping, moved))
        tell(i, std::to_string(apart) + " m from where it is on the CPU");
    }
  }

  std::string device_;
  Batch batch_;
  std::unique_ptr<Simulator> simulator_;
  std::vector<std::string> found_;
};

/// Returns the number that a word is. Throws std::invalid_argument if it is none.
std::uint64_t number_in(const std::string& word) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size())
    throw std::invalid_argument(word + ": expected a whole number of at least 0");
  return number;
}

}  // namespace
}  // namespace evodevo::test

int main(int argc, char** argv) try {
  using evodevo::test::number_in;
  if (argc != 5) throw std::invalid_argument("usage: hostile_bodies cpu|cuda FIRST_BATCH BATCHES BODIES");
  const std::uint64_t first = number_in(argv[2]), batches = number_in(argv[3]), bodies = number_in(argv[4]);
  if (batches == 0 || bodies == 0) throw std::invalid_argument("BATCHES and BODIES: expected at least 1");
  for (std::uint64_t number = first; number < first + batches; ++number) {
    nlohmann::json result = evodevo::test::Trial(argv[1], number, bodies).result();
    result["batch"] = number;
    std::cout << result.dump() << std::endl;
  }
  return 0;
} catch (const std::exception& failure) {
  std::cerr << "hostile_bodies: " << failure.what() << '\n';
  return 2;
}
