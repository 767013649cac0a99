// How signals end a run early.
#pragma once

#include <atomic>
#include <chrono>

namespace evodevo {

/// The exit code of a run that ended early and can be continued.
inline constexpr int ended_early = 130;
/// The exit code of a run that is complete, but in which no individual has a fitness.
inline constexpr int no_fitness = 3;

/// Set once a signal has asked this process to end its run, or a part of the run has failed, so that the rest has to
/// end.
std::atomic<bool>& stop_requested();

/// From now on, the first SIGINT, SIGTERM or SIGUSR1 sets stop_requested(), and a second one ends the process at once,
/// with the exit code `ended_early`. SIGUSR1 within a second of the one before does not count, because a launcher may
/// forward one that the scheduler has also sent to each process.
void stop_on_signals();

/// From now on, the first of these signals ends the process at once, with the exit code `ended_early`, because nothing
/// that is under way has to be finished.
void end_on_signals();

/// From now on, end_on_signals() changes nothing, because other runs of this process may have to finish something.
void never_end_on_signals();

/// From now on, the process ends at this time, with the exit code `ended_early`; a second from now if it is past.
void end_at(std::chrono::steady_clock::time_point time);

}  // namespace evodevo
