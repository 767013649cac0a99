// Results as JSON and as Markdown.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "common/bodies.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

using Report = nlohmann::ordered_json;

/// Returns a report without rows: the study, the device, the body and the settings, which suffice to repeat it.
Report conditions(const Settings& settings, const std::string& study, const std::string& device, const NamedBody& body);

/// Formats a report in Markdown: the study, its conditions, the command, and a table of `rows`, which is a list of
/// objects with the same keys.
std::string markdown(const Report& report);

/// Whether JSON is a report that markdown() can read.
bool is_report(const Report& report);

}  // namespace evodevo::tools::bench
