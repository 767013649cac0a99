#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace evodevo::tools::bench {
namespace {

/// Formats a cell of the table: floats with three significant digits from 1e6 on and with four below, other values
/// unchanged.
std::string text_of(const Report& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float()) return value.dump();
  std::ostringstream text;
  text << std::setprecision(std::abs(value.get<double>()) >= 1e6 ? 3 : 4) << value.get<double>();
  return text.str();
}

std::string words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string table(const Report& rows) {
  std::string header = "|", line = "|", body;
  for (const auto& [key, value] : rows.front().items()) {
    header += " " + words(key) + " |";
    line += "---|";
  }
  for (const Report& row : rows) {
    body += "|";
    for (const auto& [key, value] : row.items()) body += " " + text_of(value) + " |";
    body += "\n";
  }
  return header + "\n" + line + "\n" + body;
}

}  // namespace

bool is_report(const Report& report) {
  const auto is_text = [&](const char* key) { return report.contains(key) && report[key].is_string(); };
  if (!report.is_object() || !is_text("study") || !is_text("command") || !report.contains("rows")) return false;
  const Report& rows = report["rows"];
  return rows.is_array() && !rows.empty() &&
         std::all_of(rows.begin(), rows.end(), [](const Report& row) { return row.is_object() && !row.empty(); });
}

Report conditions(const Settings& settings, const std::string& study, const std::string& device,
                  const NamedBody& body) {
  return {{"study", study},
          {"command", settings.command},
          {"device", device},
          {"body", body.name},
          {"masses", body.body.masses.size()},
          {"springs", body.body.springs.size()},
          {"materials", body.body.materials.size()},
          {"bodies", settings.bodies},
          {"steps", settings.steps},
          {"runs", settings.runs},
          {"scene", description(walking_scene())},
          {"method", settings.method},
          {"precision", settings.precision},
          {"dt", time_step}};
}

std::string markdown(const Report& report) {
  std::string text = "## " + text_of(report.at("study")) + "\n\n";
  std::string facts;
  for (const auto& [key, value] : report.items()) {
    if (key == "study" || key == "command" || key == "rows" || key == "note") continue;
    facts += (facts.empty() ? "" : "; ") + words(key) + ": " + text_of(value);
  }
  text += facts + ".\n\n";
  if (report.contains("note")) text += text_of(report["note"]) + "\n\n";
  text += "```sh\n" + text_of(report.at("command")) + "\n```\n";
  if (report.contains("rows")) text += "\n" + table(report["rows"]);
  return text;
}

}  // namespace evodevo::tools::bench
