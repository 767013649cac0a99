// The channels of samples: the quantities that a sample of a body's motion can have.
#pragma once

namespace evodevo {

/// The quantities to be sampled. A quantity that is not requested costs no time.
struct Channels {
  bool centre = false;      ///< centre of mass and its velocity
  bool box = false;         ///< bounding box
  bool contact = false;     ///< share of the masses that touch the ground
  bool work = false;        ///< positive work of the muscles so far
  bool positions = false;   ///< position of each mass
  bool velocities = false;  ///< velocity of each mass
  bool contacts = false;    ///< share of the time in which each mass touches the ground
  bool forces = false;      ///< force of each spring

  bool any() const { return *this != Channels{}; }

  friend Channels operator|(const Channels& a, const Channels& b) {
    return {a.centre || b.centre,       a.box || b.box,
            a.contact || b.contact,     a.work || b.work,
            a.positions || b.positions, a.velocities || b.velocities,
            a.contacts || b.contacts,   a.forces || b.forces};
  }
  friend bool operator==(const Channels&, const Channels&) = default;
};

}  // namespace evodevo
