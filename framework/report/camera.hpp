// Films and pictures of pages: headless Chromium draws, ffmpeg encodes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/output_file.hpp"

namespace evodevo {

/// Lets `page` play from beginning to end into `output`, whose name is `file`: a film, or where that ends in .png a
/// picture of the moment `at` (s; by default one that the page chooses). Throws std::runtime_error where the file
/// cannot be written, or where Node.js, Chromium or ffmpeg is missing or fails; they say why on standard error.
void shoot(const std::string& page, OutputFile& output, const std::filesystem::path& file, std::optional<double> at);

}  // namespace evodevo
