// Lives simulated again with a camera: where every mass was, and how hard every spring worked.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

/// A place that is only looked at, m.
using SeenPlace = std::array<float, 3>;

inline SeenPlace seen(Vec3 p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }

/// All masses of a body at one moment.
struct Frame {
  double time = 0;  ///< since birth, s
  std::vector<SeenPlace> positions;
};

/// A stretch of a life in which the body stays the same.
struct Shot {
  Body body;
  std::vector<Frame> frames;                ///< from the beginning of the stretch to its end; one or more
  std::vector<double> stress;               ///< of each spring, N; empty after a divergence
  std::vector<std::uint32_t> numbers = {};  ///< of the masses, which they keep through the film, ascending
};

using Film = std::vector<Shot>;

/// What was filmed of a body so far.
struct Reel {
  Film film;
  std::uint64_t steps = 0;  ///< on the last shot; 0: what comes is on a new one
};

/// A simulator that films what another one simulates: it simulates from frame to frame. Apart from that a body moves
/// as it would in one go.
class FilmingSimulator final : public Simulator {
 public:
  /// `rate` is in frames per simulated second.
  FilmingSimulator(Simulator& simulator, double rate) : simulator_(simulator), rate_(rate) {}

  void run(std::span<Task> tasks, Recording recording) override;
  NeighbourSearch& neighbours() override { return simulator_.neighbours(); }
  Workers& workers() override { return simulator_.workers(); }
  std::string device() const override { return simulator_.device(); }

  /// Ends all shots: of the same body, runs up to here are one shot, and what comes is on a new one.
  void cut();

  /// What was filmed of a body. Its masses have no numbers yet.
  Film take(const Body& body) { return std::move(reels_[&body].film); }

 private:
  Simulator& simulator_;
  double rate_;
  std::map<const Body*, Reel> reels_;
};

/// A life, and what it looked like.
struct FilmedLife {
  Result result;
  Film film;  ///< the development cycles, then the stretches of the final evaluation; empty where there was no body
  std::size_t cycles = 0;  ///< how many of the shots are development cycles
};

inline constexpr double filmed_frames_per_second = 60;

/// Simulates newborns again as in their run. A diverged life ends early.
std::vector<FilmedLife> film_lives(const Experiment& experiment, Simulator& simulator,
                                   std::span<const Newborn> newborns);

}  // namespace evodevo
