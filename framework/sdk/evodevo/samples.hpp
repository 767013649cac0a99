// Samples: what a body did at regular times in the window of a fitness operator.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "evodevo/body.hpp"
#include "evodevo/channels.hpp"

namespace evodevo {

/// A body between two changes by development. A mass keeps its number throughout its life, while its index changes when
/// other masses are removed.
struct BodyVersion {
  Body body;
  std::vector<std::uint32_t> numbers;  ///< number of each mass, ascending
};

/// A sample as the host stores it. Operators read it through Samples. Times of contact and work are counted from birth.
struct StoredSample {
  double time = 0;                             ///< since birth, s
  Vec3 centre;                                 ///< m
  Vec3 velocity;                               ///< m/s
  Box box;                                     ///< m
  double contact_time = 0;                     ///< mean of all masses, s
  double work = 0;                             ///< J
  std::vector<float> positions;                ///< [masses][3] m
  std::vector<float> velocities;               ///< [masses][3] m/s
  std::vector<double> contact_times;           ///< [masses] s
  std::vector<float> forces;                   ///< [springs] N
  std::shared_ptr<const BodyVersion> version;  ///< if a quantity by mass or by spring was requested
};

/// The samples of a window. Sample 0 is taken when the window opens; sample i at the time step that is nearest to
/// i/rate seconds after that. Development may change the body between two samples of a window within the life.
///
/// Reading a quantity whose channel Request::channels does not ask for, or an index out of range, throws a
/// std::logic_error that names it.
class Samples {
 public:
  Samples() = default;
  /// `samples` must outlive this object. For the host.
  Samples(std::vector<const StoredSample*> samples, const Channels& channels)
      : samples_(std::move(samples)), channels_(channels) {}

  std::size_t size() const { return samples_.size(); }

  /// Time since the window opened, s.
  double time(std::size_t i) const { return at(i).time - at(0).time; }
  /// Centre of mass, m.
  Vec3 centre(std::size_t i) const { return asked(channels_.centre, "centre").at(i).centre; }
  /// Velocity of the centre of mass, m/s.
  Vec3 velocity(std::size_t i) const { return asked(channels_.centre, "centre").at(i).velocity; }
  /// Bounding box, m.
  Box box(std::size_t i) const { return asked(channels_.box, "box").at(i).box; }
  /// Share of the masses that touched the ground, on average from the previous sample to this one, 0 to 1; 0 for the
  /// first sample.
  double contact(std::size_t i) const {
    const double now = asked(channels_.contact, "contact").at(i).contact_time;
    return i == 0 ? 0 : share(now - at(i - 1).contact_time, i);
  }
  /// Positive work of the muscles on the body since the window opened, J.
  double work(std::size_t i) const { return asked(channels_.work, "work").at(i).work - at(0).work; }

  /// The body at a sample. Indices of masses and springs refer to it. Requires a channel by mass or by spring.
  const Body& body(std::size_t i) const { return version(i).body; }
  /// The numbers of the masses, which stay the same throughout the life, by their indices; ascending.
  std::span<const std::uint32_t> numbers(std::size_t i) const { return version(i).numbers; }
  /// Whether development changed the body since the previous sample.
  bool edited(std::size_t i) const { return i > 0 && &version(i) != &version(i - 1); }

  /// Position of a mass, m.
  Vec3 position(std::size_t i, std::size_t mass) const {
    return triple(asked(channels_.positions, "positions").at(i).positions, mass);
  }
  /// Velocity of a mass, m/s.
  Vec3 velocity(std::size_t i, std::size_t mass) const {
    return triple(asked(channels_.velocities, "velocities").at(i).velocities, mass);
  }
  /// Share of the time from the previous sample to this one in which a mass touched the ground, 0 to 1; 0 for the first
  /// sample. A mass that came in between did not touch it before.
  double contact(std::size_t i, std::size_t mass) const {
    const double now = element(asked(channels_.contacts, "contacts").at(i).contact_times, mass, "mass");
    return i == 0 ? 0 : share(now - earlier_contact_time(i, mass), i);
  }
  /// Force of a spring at the time of the sample, N: positive if it pulls, negative if it pushes.
  double force(std::size_t i, std::size_t spring) const {
    return static_cast<double>(element(asked(channels_.forces, "forces").at(i).forces, spring, "spring"));
  }

 private:
  const Samples& asked(bool requested, const char* channel) const {
    if (!requested)
      throw std::logic_error(std::string("reads the channel \"") + channel +
                             "\" of samples, which observes() does not ask for; set Request::channels." + channel +
                             " and Request::rate");
    return *this;
  }

  const StoredSample& at(std::size_t i) const { return *element(samples_, i, "sample"); }

  const BodyVersion& version(std::size_t i) const {
    const StoredSample& sample = at(i);
    if (!channels_.positions && !channels_.velocities && !channels_.contacts && !channels_.forces)
      throw std::logic_error(
          "reads the body of a sample, but observes() asks for no channel by mass or by spring; set one in "
          "Request::channels");
    return *sample.version;
  }

  template <class T>
  static const T& element(const std::vector<T>& list, std::size_t i, const char* what) {
    if (i >= list.size()) refuse(what, i, list.size());
    return list[i];
  }

  [[noreturn]] static void refuse(const char* what, std::size_t i, std::size_t count) {
    throw std::logic_error(std::string("reads ") + what + " " + std::to_string(i) + ", but there are only " +
                           std::to_string(count) + ", numbered from 0");
  }

  static Vec3 triple(const std::vector<float>& list, std::size_t mass) {
    if (mass >= list.size() / 3) refuse("mass", mass, list.size() / 3);
    const float* v = list.data() + 3 * mass;
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  }

  /// A time (s) relative to the time from the previous sample to sample i.
  double share(double time, std::size_t i) const {
    const double interval = at(i).time - at(i - 1).time;
    return interval > 0 ? time / interval : 0;
  }

  /// The contact time of the mass with index `mass` at sample i, as it was at the previous sample.
  double earlier_contact_time(std::size_t i, std::size_t mass) const {
    const StoredSample& before = at(i - 1);
    if (!edited(i)) return before.contact_times[mass];
    const std::vector<std::uint32_t>& numbers = before.version->numbers;
    const std::uint32_t number = at(i).version->numbers[mass];
    const auto found = std::lower_bound(numbers.begin(), numbers.end(), number);
    return found != numbers.end() && *found == number
               ? before.contact_times[static_cast<std::size_t>(found - numbers.begin())]
               : 0;
  }

  std::vector<const StoredSample*> samples_;
  Channels channels_;
};

}  // namespace evodevo
