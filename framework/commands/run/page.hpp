// The page on which a run shows itself when it ends.
#pragma once

#include "archive/archive.hpp"

namespace evodevo {

/// A run that a page shows: that of a whole folder, or of an island.
struct ShownRun {
  const Experiment& experiment;
  const Archive& archive;
};

/// Writes report.html into the folder of a run, with the robots that `report` shows, and prints a link to it. If the
/// viewer has not been built, only prints the command that makes the page; `tools/evodevo` then builds the viewer
/// first. If the page cannot be written, prints a warning; a run never fails for want of a page.
void show_runs(const std::filesystem::path& folder, std::span<const ShownRun> runs, Simulator& simulator);

/// The link to a file, for a browser: "file://" and its absolute path, in which a byte other than an unreserved
/// character or a slash becomes % and two digits (RFC 3986).
std::string link_to(const std::filesystem::path& file);

}  // namespace evodevo
