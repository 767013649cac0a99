// The simulation core's interface: batches of bodies in, moved bodies out.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/course.hpp"
#include "core/method.hpp"
#include "core/neighbour_search.hpp"
#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

enum class Precision { float32, float64 };

/// How a GPU knows the materials of springs: from a table of the body's, or computed from a short code of each spring
/// (paper, section V). Codes round materials (computed_materials.hpp), on every device.
enum class Materials { table, computed };

/// How steps are made. How long they are is each task's own.
struct Stepping {
  Method method = Method::paper_euler;
  Precision precision = Precision::float32;
  Materials materials = Materials::table;
};

/// What is recorded beside the motion; what is not asked for costs nothing.
struct Recording {
  bool stress = false;       ///< SpringRecords::stress
  bool work = false;         ///< Task::work
  bool peak_force = false;   ///< SpringRecords::peak_force
  bool muscle_work = false;  ///< SpringRecords::muscle_work
  bool tension = false;      ///< SpringRecords::tension

  bool of_springs() const { return stress || peak_force || muscle_work || tension; }
};

/// What was recorded of every spring of a body over a run; a list is empty where it was not asked for.
struct SpringRecords {
  std::vector<double> stress;       ///< mean absolute force, N
  std::vector<double> peak_force;   ///< largest absolute force, N
  std::vector<double> muscle_work;  ///< positive work of the spring's muscle on the body, J
  std::vector<double> tension;      ///< mean force, N: positive where the spring pulled, negative where it pushed

  static constexpr std::array lists{&SpringRecords::stress, &SpringRecords::peak_force, &SpringRecords::muscle_work,
                                    &SpringRecords::tension};

  /// Zeros for `springs` springs in what `recording` asks for.
  void clear(Recording recording, std::size_t springs) {
    stress.assign(recording.stress ? springs : 0, 0.0);
    peak_force.assign(recording.peak_force ? springs : 0, 0.0);
    muscle_work.assign(recording.muscle_work ? springs : 0, 0.0);
    tension.assign(recording.tension ? springs : 0, 0.0);
  }
};

/// What a simulator has worked out about a body's masses and springs and need not work out again while they stay.
class Preparation {
 public:
  virtual ~Preparation() = default;
};

/// One body's share of a batch: `steps` time steps of `dt`, the i-th of them at State::time + i dt. `body` to
/// `later_steps` are given; the rest, and what was recorded of the springs, is the answer. The records are empty after
/// a divergence.
///
/// A run can be made in pieces: each piece but the last says how many `later_steps` are to follow, and hands its
/// `course` to the next, with the same body and dt. State and verdict are then those of one run, to the bit; what was
/// recorded is of the piece alone, and sums of pieces may differ from the whole's by rounding.
struct Task : SpringRecords {
  const Body* body = nullptr;
  State* state = nullptr;  ///< moved in place
  double dt = 0.0005;      ///< time step, s; paper, Table II
  std::uint64_t steps = 0;
  std::uint64_t later_steps = 0;  ///< of the same run, in pieces still to come
  std::optional<Course> course;   ///< of the same run's pieces so far; afterwards for the next, where one is to come
  /// Of the body's last run, or none; afterwards of this one. One that no longer fits the body is not used.
  std::shared_ptr<const Preparation> preparation;

  Status status = Status::ok;            ///< ok or diverged; a task that does not come in as ok is left alone
  double ended_at = 0;                   ///< time of a divergence since birth, s; found to within 100 steps
  std::string reason;                    ///< of a divergence
  double work = 0;                       ///< positive work of the muscles on the body, J; 0 unless recorded
  std::uint64_t spring_evaluations = 0;  ///< springs times steps, however often a method's step looks at a spring
};

/// How a device of its own, such as a GPU, was used since its simulator was made.
struct DeviceUse {
  double busy = 0;           ///< time in which it had something to do, s
  std::size_t portions = 1;  ///< that a batch had to be divided into, at most, for the device's memory
};

/// Moves bodies through a scene; a mass of 0 kg stays where it is. A body's answer is the same bits alone, in any
/// batch, and for any number of threads.
class Simulator {
 public:
  virtual ~Simulator() = default;

  /// Moves every task's body. A body that diverges stops there and disturbs no other. May be called from several
  /// threads at once.
  virtual void run(std::span<Task> tasks, Recording recording) = 0;

  /// A search for neighbours on the same device.
  virtual NeighbourSearch& neighbours() = 0;

  /// The threads that prepare and read out bodies. What else is done between calls of run() belongs on them too, so
  /// that no more threads than cores compete and turns hold for all work.
  virtual Workers& workers() = 0;

  /// How many calls of run() at once keep the device busy: while the bodies of one move, those of others are prepared.
  virtual int concurrency() const { return 1; }

  /// Nothing where the device is the host's own processor.
  virtual std::optional<DeviceUse> device_use() const { return std::nullopt; }

  /// The device and the instruction set in words, for example "cpu, AVX-512". Results may differ in the last bit
  /// between devices, never on one.
  virtual std::string device() const = 0;
};

/// A simulator on `threads` cores (0: all of them) with the best instruction set that this processor has.
std::unique_ptr<Simulator> make_cpu_simulator(const Scene& scene, const Stepping& stepping, int threads);

}  // namespace evodevo
