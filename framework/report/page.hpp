// The viewer's page: one HTML file with the viewer's program and its data.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace evodevo {

/// Returns the folder of the built viewer. If the viewer is not there, throws std::runtime_error that says how to build
/// it.
std::filesystem::path viewer_folder();

/// Whether the viewer has been built.
bool has_viewer();

/// Returns the built page without data. Throws like viewer_folder().
std::string page_template();

/// Inserts `data` into the page. Data are escaped so that a browser does not interpret any of them as markup.
std::string filled_page(const std::string& page, const nlohmann::ordered_json& data);

/// Lets a filled page that a server serves reload itself as soon as the server's document `path` differs from `shown`.
/// The page asks for it every few seconds, and its policy then allows connections to its server.
std::string self_reloading(const std::string& page, const std::string& path, const std::string& shown);

/// If a page is larger than 30 MB, returns a line that says how large it is and names the option that reduces the
/// number of robots on it; else returns an empty text.
std::string size_note(const std::string& file, std::size_t bytes, const std::string& option);

}  // namespace evodevo
