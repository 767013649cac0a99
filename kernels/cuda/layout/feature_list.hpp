// The features of a scene and of a run that are compiled into a kernel. The host's structure, the definitions for the
// compiler, the kernels' constants and the tests are made from this list.
#pragma once

/// Calls FEATURE(name, whole) for each feature. A feature that is part of another one, `whole`, is on only if that one
/// is; the others have `always` in its place.
#define EVODEVO_FEATURES(FEATURE)                                            \
  FEATURE(gravity, always)                                                   \
  FEATURE(slope, gravity)                                                    \
  FEATURE(has_floor, always)                                                 \
  FEATURE(elastic_floor, has_floor) /* no scene has both kinds of floor */   \
  FEATURE(rigid_floor, has_floor)                                            \
  FEATURE(rough, has_floor)                                                  \
  FEATURE(friction, has_floor)                                               \
  FEATURE(static_friction, friction) /* it is higher than that of sliding */ \
  FEATURE(damping, always)                                                   \
  FEATURE(drag, always)                                                      \
  FEATURE(actuation, always)                                                 \
  FEATURE(dashpots, always)                                                  \
  FEATURE(stress, always)                                                    \
  FEATURE(work, always)                                                      \
  FEATURE(peak_force, always)                                                \
  FEATURE(muscle_work, work)                                                 \
  FEATURE(mean_tension, always)                                              \
  FEATURE(sampled, always)                                                   \
  FEATURE(contacts, sampled)
