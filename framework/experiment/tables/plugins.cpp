#include "experiment/tables/plugins.hpp"

#include <algorithm>
#include <climits>

#include "base/text.hpp"
#include "operators/loader.hpp"
#include "operators/plugin_folders.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// Checks a path that an experiment's file names. It is relative to the folder of the file.
NamedPath path_in_experiment(const fs::path& named, const ExperimentSource& source) {
  const fs::path path = fs::absolute(source.file).parent_path() / named;
  if (is_plugin_path(path)) return {path, ""};
  return {path, path.lexically_normal().string() + " is neither a folder nor a library of operators"};
}

/// Checks a path that the record of a run names. It must be absolute, and the user must have named it, because the
/// maker of a record must not decide which code runs here.
NamedPath path_in_record(const fs::path& named, const ExperimentSource& source) {
  if (!named.is_absolute())
    return {named, named.string() +
                       " is a relative path, and runs record only absolute ones; if you trust the operators that "
                       "the path means, give their folder with --plugin-path"};
  if (!is_plugin_path(named))
    return {named,
            named.string() + " is no longer a folder or a library of operators; give its new place with --plugin-path"};
  if (!is_named_by_user(named, source.plugin_path))
    return {named,
            named.string() +
                " is named only by the record of the run; if you trust the operators in it, give --plugin-path " +
                named.string()};
  return {named, ""};
}

}  // namespace

PluginsTable::PluginsTable(const toml::table& root, const ExperimentSource& source) : source_(source) {
  if (const toml::array* paths = root["plugins"]["paths"].as_array())
    for (const toml::node& path : *paths)
      if (const auto text = path.value<std::string>())
        named_.push_back(source.is_record ? path_in_record(*text, source) : path_in_experiment(*text, source));
  std::vector<fs::path> own;
  for (const NamedPath& named : named_)
    if (named.fault.empty()) own.push_back(named.path);
  for (const fs::path& path : source.plugin_path) own.push_back(fs::absolute(path));
  search_path_ = plugin_search_path(own);
}

void PluginsTable::check(TomlReader& top, Warnings& warnings) const {
  read_table(top, "plugins", false, [&](TomlReader& t) {
    t.texts("paths");
    for (const NamedPath& named : named_) {
      if (named.fault.empty()) continue;
      if (source_.is_record)
        warnings.push_back(named.fault);
      else
        t.report("paths", named.fault);
    }
  });
}

std::vector<fs::path> PluginsTable::recorded_path(const TomlReader& top) const {
  std::vector<fs::path> recorded;
  for (const fs::path& path : search_path_) {
    if (path == builtin_plugin_folder() || !is_plugin_path(path)) continue;
    const fs::path normal = path.lexically_normal();  // a record's own path may be given again, so that it is trusted
    if (std::ranges::find(recorded, normal) != recorded.end()) continue;
    recorded.push_back(normal);
    if (const std::string fault = text_fault(recorded.back().string(), PATH_MAX); !fault.empty())
      throw ConfigError(top.location("plugins") + ": plugins: the path " + fault + "; rename the folder");
  }
  return recorded;
}

}  // namespace evodevo
