// Makes films and pictures of the viewer's pages: headless Chromium draws them, ffmpeg encodes them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/output_file.hpp"

namespace evodevo {

/// The part of a life that a picture or film shows. Times are since birth, s.
struct Shooting {
  std::optional<double> at = {};             ///< time of a picture; by default, the page chooses it
  std::optional<double> from = {}, to = {};  ///< beginning and end of a film; by default, those of the life
  bool quiet = false;                        ///< whether to print only errors
};

/// Renders what `page` plays, and writes it to `output`, whose name is `file`. The ending of the name selects a film
/// (.mp4, .gif or .webp) or a picture (.png). Throws std::runtime_error if the file cannot be written, or if Node.js,
/// Chromium or ffmpeg is missing or fails; these programs write the reason to standard error.
void shoot(const std::string& page, OutputFile& output, const std::filesystem::path& file, const Shooting& shooting);

}  // namespace evodevo
