// Films and pictures of pages: headless Chromium draws, ffmpeg encodes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace evodevo {

/// Lets `page` play from beginning to end into `file`: a film, or where its name ends in .png a picture of the moment
/// `at` (s; by default one that the page chooses). Throws std::runtime_error where Node.js, Chromium or ffmpeg is
/// missing or fails; they say why on standard error.
void shoot(const std::string& page, const std::filesystem::path& file, std::optional<double> at);

}  // namespace evodevo
