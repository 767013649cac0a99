// Films and pictures of pages: headless Chromium draws, ffmpeg encodes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/output_file.hpp"

namespace evodevo {

/// What of a life is shot; times are in s since birth.
struct Shooting {
  std::optional<double> at = {};             ///< of a picture; by default one that the page chooses
  std::optional<double> from = {}, to = {};  ///< of a film; by default the whole life
  bool quiet = false;                        ///< whether nothing but errors is said
};

/// Lets `page` play into `output`, whose name is `file`: a film (.mp4, .gif or .webp), or where that ends in .png a
/// picture. Throws std::runtime_error where the file cannot be written, or where Node.js, Chromium or ffmpeg is missing
/// or fails; they say why on standard error.
void shoot(const std::string& page, OutputFile& output, const std::filesystem::path& file, const Shooting& shooting);

}  // namespace evodevo
