// The page of the viewer: one HTML file that holds its program and its data.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace evodevo {

/// The folder of the built viewer. Throws std::runtime_error, saying how to build it, where it is not there.
std::filesystem::path viewer_folder();

/// The built page without data. Throws like viewer_folder().
std::string page_template();

/// The page with `data` in it. Nothing in the data is read as markup.
std::string filled_page(const std::string& page, const nlohmann::ordered_json& data);

/// A line that says how large a page of more than 30 MB is, and the option with which it would show fewer robots; of a
/// smaller one, nothing.
std::string size_note(const std::string& file, std::size_t bytes, const std::string& option);

}  // namespace evodevo
