// The simulation core's interface.
//
//   Task: body, state, dt, steps ─► Simulator::run ─► state after the steps, status, records of the springs
//
// A batch is a span of tasks, one per body. Each device has its own simulator.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/course.hpp"
#include "core/method.hpp"
#include "core/neighbour_search.hpp"
#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

enum class Precision { float32, float64 };

/// How a GPU gets the material of a spring: from a table of the body's materials, or by decoding a short code that each
/// spring carries (paper, section V). The codes round materials (analysis/computed_materials.hpp); a simulator on any
/// device uses the rounded materials.
enum class Materials { table, computed };

/// How steps are made. Each task has a step length of its own.
struct Stepping {
  Method method = Method::paper_euler;
  Precision precision = Precision::float32;
  Materials materials = Materials::table;

  bool operator==(const Stepping&) const = default;
};

/// What a run records beside the motion. What is not asked for costs no time.
struct Recording {
  bool stress = false;       ///< SpringRecords::stress
  bool work = false;         ///< Task::work
  bool peak_force = false;   ///< SpringRecords::peak_force
  bool muscle_work = false;  ///< SpringRecords::muscle_work
  bool tension = false;      ///< SpringRecords::tension

  bool of_springs() const { return stress || peak_force || muscle_work || tension; }
};

/// What a run has recorded of a body's springs: one number for each spring. A list that was not asked for is empty.
struct SpringRecords {
  std::vector<double> stress;       ///< mean absolute force over the run, N
  std::vector<double> peak_force;   ///< largest absolute force, N
  std::vector<double> muscle_work;  ///< energy that the spring's muscle put into the body, J; losses not subtracted
  std::vector<double> tension;      ///< mean force, N: positive if the spring pulled, negative if it pushed

  static constexpr std::array lists{&SpringRecords::stress, &SpringRecords::peak_force, &SpringRecords::muscle_work,
                                    &SpringRecords::tension};

  /// Sets the lists that `recording` asks for to zeros for `springs` springs, and empties the others.
  void clear(Recording recording, std::size_t springs) {
    stress.assign(recording.stress ? springs : 0, 0.0);
    peak_force.assign(recording.peak_force ? springs : 0, 0.0);
    muscle_work.assign(recording.muscle_work ? springs : 0, 0.0);
    tension.assign(recording.tension ? springs : 0, 0.0);
  }
};

/// What a simulator has computed about a body's masses and springs (on a GPU, their arrangement in memory) and can use
/// again while they stay the same.
class Preparation {
 public:
  virtual ~Preparation() = default;
};

/// One body of a batch and what to do with it: `steps` time steps of length `dt`. The caller sets `body`, `state`,
/// `dt`, `steps` and, where they apply, `later_steps`, `course` and `preparation`; the simulator sets the rest. The
/// records are empty after a divergence.
///
/// A run can be made in pieces with the same body and dt: each piece except the last says how many `later_steps`
/// follow, and the caller hands its `course` to the next piece. State and status are then those of one run, to the bit.
/// Records and work are those of the piece alone; their sums over the pieces may differ from those of one run by
/// rounding.
struct Task : SpringRecords {
  const Body* body = nullptr;
  State* state = nullptr;  ///< moved in place
  double dt = 0.0005;      ///< time step, s; paper, Table II
  std::uint64_t steps = 0;
  std::uint64_t later_steps = 0;  ///< steps of the same run in pieces still to come
  std::optional<Course> course;   ///< before: from the run's earlier piece, if any; after: for the next piece, if any
  /// Before: from the body's last run, or null; after: of this run. One that does not fit the body any more is ignored.
  std::shared_ptr<const Preparation> preparation;

  Status status = Status::ok;            ///< afterwards ok or diverged; a task that is not ok before the run is skipped
  double ended_at = 0;                   ///< time of the divergence since birth, s; detected up to 100 steps late
  std::string reason;                    ///< why the body has diverged
  double work = 0;                       ///< work of the muscles on the body, J; 0 unless recorded
  std::uint64_t spring_evaluations = 0;  ///< springs times steps, whatever the number of passes per step
};

/// Thrown if a device has too little free memory for even one body.
class DeviceOutOfMemory : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How a device such as a GPU was used since its simulator was made.
struct DeviceUse {
  double busy = 0;           ///< time in which the device was working, s
  std::size_t portions = 1;  ///< largest number of portions into which a batch was divided to fit the device's memory
};

/// Moves bodies through a scene. A mass of 0 kg stays where it is. The answer for a body is the same, to the bit,
/// whether the body is alone or in any batch, and for any number of threads.
class Simulator {
 public:
  virtual ~Simulator() = default;

  /// Moves every task's body through its steps and records what `recording` asks for. A body that diverges stops, and
  /// does not affect the others. Several threads may call this at once. Throws DeviceOutOfMemory, or another
  /// std::runtime_error if the device fails.
  virtual void run(std::span<Task> tasks, Recording recording) = 0;

  /// A search for nearest neighbours on the same device.
  virtual NeighbourSearch& neighbours() = 0;

  /// The threads that prepare bodies and read their answers. Other work between calls of run() should use them too, so
  /// that no more threads than cores compete and priorities (threads/parallel.hpp) apply to all work.
  virtual Workers& workers() = 0;

  /// How many simultaneous calls of run() keep the device busy: while one batch moves, others are prepared.
  virtual int concurrency() const { return 1; }

  /// How the device was used; none if the device is the host's own processor.
  virtual std::optional<DeviceUse> device_use() const { return std::nullopt; }

  /// The device and its instruction set, for example "cpu, AVX-512". Results on equal devices are equal; between
  /// different ones they may differ in the last bit.
  virtual std::string device() const = 0;
};

}  // namespace evodevo
