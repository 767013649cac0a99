// The simulation core's interface.
//
//   Task: body, state, dt, steps ─► Simulator::run ─► state after the steps, status, records of the springs
//
// A batch is a span of tasks, one per body. Each device has its own simulator.
#pragma once

#include <array>
#include <compare>
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
#include "core/sample.hpp"
#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

enum class Precision { float32, float64 };

/// How a GPU gets the material of a spring: from a table of the body's materials, or by decoding a short code that each
/// spring carries (paper, section V). The codes round materials (analysis/computed_materials.hpp); simulators on all
/// devices use the rounded materials.
enum class Materials { table, computed };

/// How time steps are computed. The length of the step is given by each task.
struct Stepping {
  Method method = Method::paper_euler;
  Precision precision = Precision::float32;
  Materials materials = Materials::table;

  bool operator==(const Stepping&) const = default;
};

/// The quantities that a run records besides the motion. Quantities that are not requested cost no time.
struct Recording {
  bool stress = false;       ///< SpringRecords::stress
  bool work = false;         ///< Task::work
  bool peak_force = false;   ///< SpringRecords::peak_force
  bool muscle_work = false;  ///< SpringRecords::muscle_work
  bool tension = false;      ///< SpringRecords::tension

  bool of_springs() const { return stress || peak_force || muscle_work || tension; }
  auto operator<=>(const Recording&) const = default;
};

/// The recorded quantities of a body's springs, with one number for each spring. Lists that were not requested are
/// empty.
struct SpringRecords {
  std::vector<double> stress;       ///< mean absolute force over the run, N
  std::vector<double> peak_force;   ///< largest absolute force, N
  std::vector<double> muscle_work;  ///< energy that the muscle put into the body, J; energy taken out does not count
  std::vector<double> tension;      ///< mean force, N: positive if the spring pulled, negative if it pushed

  static constexpr std::array lists{&SpringRecords::stress, &SpringRecords::peak_force, &SpringRecords::muscle_work,
                                    &SpringRecords::tension};

  /// Empties each list that `recording` does not request.
  void keep(Recording recording) {
    if (!recording.stress) stress.clear();
    if (!recording.peak_force) peak_force.clear();
    if (!recording.muscle_work) muscle_work.clear();
    if (!recording.tension) tension.clear();
  }

  /// Sets each list that `recording` requests to `springs` zeros, and empties the other lists.
  void clear(Recording recording, std::size_t springs) {
    stress.assign(recording.stress ? springs : 0, 0.0);
    peak_force.assign(recording.peak_force ? springs : 0, 0.0);
    muscle_work.assign(recording.muscle_work ? springs : 0, 0.0);
    tension.assign(recording.tension ? springs : 0, 0.0);
  }
};

class SplitBody;

/// Data on a body's masses and springs that a simulator has computed (on a GPU, their arrangement in memory) and can
/// reuse as long as they do not change.
class Preparation {
 public:
  virtual ~Preparation() = default;
};

/// One body of a batch, to be simulated for `steps` time steps of length `dt`. The caller sets `body`, `state`, `dt`,
/// `steps` and, if needed, `later_steps`, `course`, `preparation`, `split`, `scene` and `sampled_at`; the simulator
/// sets the rest. The records and samples are empty after a divergence. Records and samples change neither the motion
/// nor each other, not even in the last bit.
///
/// A run can be divided into pieces with the same body and dt: each piece except the last gives the number of
/// `later_steps` that follow, and the caller passes its `course` to the next piece. State and status are then
/// bit-identical to those of an undivided run. Records and work cover the piece only; combined over all pieces, they
/// may differ from those of an undivided run by rounding.
struct Task : SpringRecords {
  const Body* body = nullptr;
  State* state = nullptr;  ///< updated in place
  double dt = 0.0005;      ///< time step, s; paper, Table II
  std::uint64_t steps = 0;
  std::uint64_t later_steps = 0;  ///< steps of the same run in later pieces
  std::optional<Course> course;   ///< in: from the run's earlier piece, if any; out: for the next piece, if any
  /// In: the preparation from the body's last run, or null; out: that of this run. A preparation that no longer fits
  /// the body is ignored.
  std::shared_ptr<const Preparation> preparation;
  /// The same for the body's materials, if a simulator has to split them (analysis/split_materials.hpp).
  std::shared_ptr<SplitBody> split;
  const Scene* scene = nullptr;         ///< the scene of the body; null: that of the simulator
  std::vector<SamplePoint> sampled_at;  ///< in ascending order of their steps, from 0 to `steps`

  Status status = Status::ok;            ///< in: tasks that are not ok are skipped; out: ok or diverged
  double ended_at = 0;                   ///< time since birth at which a check found the divergence, s
  std::string reason;                    ///< why the body has diverged
  double work = 0;                       ///< work of the muscles on the body, J; 0 unless recorded
  std::uint64_t spring_evaluations = 0;  ///< springs times steps, whatever the number of passes per step
  std::vector<Sample> samples;           ///< one for each of `sampled_at`
};

/// The scene in which a simulator of `scene` simulates a task.
inline const Scene& scene_of(const Task& task, const Scene& scene) {
  return task.scene != nullptr ? *task.scene : scene;
}

/// Thrown if a device has too little free memory for even one body.
class DeviceOutOfMemory : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The use of one or several devices such as GPUs since their simulator was created.
struct DeviceUse {
  std::size_t devices = 1;
  /// Time during which a device was working, for any simulator of this process, s; the sum over all devices.
  double busy = 0;
  std::size_t portions = 1;  ///< largest number of portions into which a batch was divided to fit the device's memory
  std::size_t bodies = 0;    ///< that all simulators of this process are simulating on the devices at the moment
};

/// Simulates bodies in a scene; tasks may have scenes of their own. Masses of 0 kg are held in place. The result for a
/// body is bit-identical whether the body is alone or in any batch, and for any number of threads.
class Simulator {
 public:
  virtual ~Simulator() = default;

  /// Simulates the steps of every task, and records the quantities that `recording` requests. A body that diverges
  /// stops, and does not affect the others. Several threads may call this function at the same time. Throws
  /// DeviceOutOfMemory, or another std::runtime_error if the device fails.
  virtual void run(std::span<Task> tasks, Recording recording) = 0;

  /// A search for nearest neighbours on the same device.
  virtual NeighbourSearch& neighbours() = 0;

  /// The threads that prepare bodies and read their results. Other work between calls of run() should use them too, so
  /// that no more threads than cores compete and priorities (threads/parallel.hpp) apply to all work.
  virtual Workers& workers() = 0;

  /// The number of simultaneous calls to run() that keep the device busy: while one batch is simulated, others are
  /// prepared.
  virtual int concurrency() const { return 1; }

  /// Tells that `bodies` bodies will be simulated, in any number of runs, as long as the returned object exists. Then
  /// the simulator can divide a device among them, which changes the speed but no result. Announcements add up. The
  /// object must not outlive the simulator.
  virtual std::shared_ptr<const void> announce(std::size_t /*bodies*/) { return nullptr; }

  /// The use of the devices; nothing if the device is the host's own processor.
  virtual std::optional<DeviceUse> device_use() const { return std::nullopt; }

  /// The device and its instruction set, for example "cpu, AVX-512". Equal devices give equal results; results of
  /// different devices may differ by rounding.
  virtual std::string device() const = 0;
};

}  // namespace evodevo
