// Results as data and as text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "common/bodies.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

using Report = nlohmann::ordered_json;

/// What a study measured and where, without its figures, so that anyone can repeat it.
Report conditions(const Settings& settings, const std::string& study, const std::string& device, const NamedBody& body);

/// A report in Markdown: the study, what was measured where, the command, and `rows`, a list of like objects, as a
/// table.
std::string markdown(const Report& report);

}  // namespace evodevo::tools::bench
