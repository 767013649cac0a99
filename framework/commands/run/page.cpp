#include "commands/run/page.hpp"

#include <fmt/format.h>

#include <exception>
#include <iostream>

#include "base/output_file.hpp"
#include "base/text.hpp"
#include "commands/shell/output/notices.hpp"
#include "report/page.hpp"
#include "report/report.hpp"

namespace evodevo {
namespace {

constexpr const char* page_of_run = "report.html";

std::string report_command(const std::filesystem::path& folder) {
  return shell_command({"report", folder.string(), "--out", (folder / page_of_run).string()});
}

}  // namespace

std::string link_to(const std::filesystem::path& file) {
  std::string link = "file://";
  for (const char c : std::filesystem::absolute(file).lexically_normal().string()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          std::string_view("-._~/").find(c) != std::string_view::npos;
    link += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return link;
}

void show_runs(const std::filesystem::path& folder, std::span<const ShownRun> runs, Simulator& simulator) {
  if (!has_viewer()) {
    remarks() << "page:  none yet, because the viewer has not been built; make it with `" << report_command(folder)
              << '`' << std::endl;
    return;
  }
  try {
    const std::filesystem::path file = folder / page_of_run;
    remarks() << "page:  " << std::flush;
    std::vector<nlohmann::ordered_json> data;
    for (const auto& [experiment, archive] : runs)
      data.push_back(reported_run(archive, experiment, simulator, Cast(), page_budget / runs.size()));
    const std::string page = filled_page(page_template(), report_data(std::move(data)));
    write_file(file, page);
    remarks() << link_to(file) << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "\nwarning: no page: " << printable(error.what()) << "; " << report_command(folder)
              << " makes it later\n";
  }
}

}  // namespace evodevo
