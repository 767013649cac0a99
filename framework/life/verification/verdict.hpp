// What the trials of verification say of an individual.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evodevo/body.hpp"
#include "evodevo/fitness.hpp"

namespace evodevo {

/// The result of repeating lives, or their final evaluations, with one thing changed.
struct Trial {
  std::string name;  ///< name of one of the trials listed at verify() and verify_marks()
  Status status = Status::ok;
  std::string reason;           ///< reason for a status other than ok
  std::optional<double> value;  ///< the first objective; none unless ok
};

/// An individual's trials, and the fitness that its original evaluation found.
struct Verification {
  std::uint32_t individual = 0;
  double fitness = 0;  ///< the first objective, as the run recorded it
  std::vector<Trial> trials;
};

inline constexpr const char *reborn_trial = "reborn-", *redrawn_trial = "redrawn-", *new_lives_trial = "new-lives";
/// Of the trials of each kind of life to come, so many choose the best of several individuals; the others tell what it
/// is worth.
inline constexpr std::size_t choosing_births = 2, births = 4;

/// Whether an individual keeps its fitness in a trial: the trial's value is as good as the fitness, better, or worse by
/// at most half of the fitness's absolute value. False if the trial has no value.
bool held(const Verification& verification, const Trial& trial, bool maximise);

/// Returns the marks of an individual, which are found from its trials:
///   artefact  its fitness depends on the time step or the method: it is lost in quarter-step or other-method;
///   lucky     its fitness is lost in new-lives;
///   passive   it keeps over half its fitness in no-muscles, or loses over half in settled; only if the objective is
///             maximised and the fitness is above 0.
/// The names are in alphabetical order.
std::vector<std::string> marks(const Verification& verification, bool maximise);
/// A mark of an individual, as a status, and the trial from which it was found.
struct Mark {
  Status status = Status::artefact;  ///< artefact, lucky or passive
  Trial trial;
};
/// Returns the first mark that an individual gets in the order of the trials in verify_marks(); nullopt if it has none.
std::optional<Mark> first_mark(const Verification& verification, bool maximise);
/// Returns the marks as a text, such as "artefact, passive"; "verified" if there are none.
std::string marks_text(const Verification& verification, bool maximise);
/// Returns what the trials say of the individual as one sentence: its marks and, if it has lived again, how often it
/// kept its fitness then, such as "verified, kept in 3 of 4 lives to come with the same draws and in 1 of 4 with new
/// ones".
std::string verdict_text(const Verification& verification, bool maximise);
/// Returns which of several individuals is best in lives to come, chosen by the first of them and told by the others,
/// as one sentence; an empty text if fewer than two have lived again.
std::string choice_text(std::span<const Verification> verifications, const Objective& objective);

}  // namespace evodevo
