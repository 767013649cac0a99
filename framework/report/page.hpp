// The page of the viewer: one HTML file that holds its program and its data.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace evodevo {

/// The folder of the built viewer. Throws std::runtime_error, saying how to build it, where it is not there.
std::filesystem::path viewer_folder();

/// The built page without data. Throws like viewer_folder().
std::string page_template();

/// The page with `data` in it. Nothing in the data is read as markup.
std::string filled_page(const std::string& page, const nlohmann::ordered_json& data);

/// Writes `page` to `file`, all of it or nothing. Throws std::runtime_error where it cannot be written.
void write_page(const std::filesystem::path& file, const std::string& page);

}  // namespace evodevo
