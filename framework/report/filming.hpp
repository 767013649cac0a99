// Films of lives: lives are simulated again, and the positions of all masses and the stress of all springs are
// recorded.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

/// A position that is only displayed, m; single precision suffices.
using SeenPlace = std::array<float, 3>;

inline SeenPlace seen(Vec3 p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }

/// The positions of all masses of a body at one moment.
struct Frame {
  double time = 0;                   ///< simulated time since birth, s
  std::vector<SeenPlace> positions;  ///< one for each mass
};

/// A part of a life during which the body does not change.
struct Shot {
  Body body;
  std::vector<Frame> frames;                ///< from the beginning of the shot to its end; at least one
  std::vector<double> stress;               ///< stress of each spring during the shot, N; empty after a divergence
  std::vector<std::uint32_t> numbers = {};  ///< numbers of the masses, which stay the same in all shots; ascending
};

using Film = std::vector<Shot>;

/// The film of a body so far.
struct Reel {
  Film film;
  std::uint64_t steps = 0;  ///< number of time steps in the last shot; 0: the next frame begins a new shot
};

/// A simulator that films what another simulator computes. It interrupts the simulation at every frame to record the
/// positions; bodies move as they would without interruptions. Sums over many steps would differ by rounding; a run
/// that asks for some is therefore simulated twice, once for the film and once in one go.
class FilmingSimulator final : public Simulator {
 public:
  /// `rate` is in frames per simulated second.
  FilmingSimulator(Simulator& simulator, double rate) : simulator_(simulator), rate_(rate) {}

  void run(std::span<Task> tasks, Recording recording) override;
  NeighbourSearch& neighbours() override { return simulator_.neighbours(); }
  Workers& workers() override { return simulator_.workers(); }
  std::string device() const override { return simulator_.device(); }

  /// Ends the present shot of every body; later runs of a body are in a new shot.
  void cut();
  /// From now on, ends a shot at the frame nearest to each of these times (s since birth).
  void cut_at(std::vector<double> times) { cuts_ = std::move(times); }

  /// Returns the film of a body and removes it from the simulator. Shot::numbers are not set yet.
  Film take(const Body& body) { return std::move(reels_[&body].film); }

 private:
  void film(std::span<Task> tasks);

  Simulator& simulator_;
  double rate_;
  std::vector<double> cuts_;
  std::map<const Body*, Reel> reels_;
};

/// A life and its film.
struct FilmedLife {
  std::uint32_t number = 1;  ///< of the life
  Result result;
  Film film;               ///< one shot for each cycle, then those of the final evaluation; empty if there was no body
  std::size_t cycles = 0;  ///< number of shots that are development cycles
};

inline constexpr double filmed_frames_per_second = 60;  ///< frames per simulated second

/// Simulates one life of each newborn again as in its run, and films it. If the experiment has scenarios, their final
/// evaluation is that of one test alone. The film of a life that diverges ends early.
std::vector<FilmedLife> film_lives(const Experiment& experiment, Simulator& simulator,
                                   std::span<const Newborn> newborns, const Test& test = {});

}  // namespace evodevo
