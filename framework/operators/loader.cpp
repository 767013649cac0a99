#include "operators/loader.hpp"

#define XXH_INLINE_ALL  // uses only the header, so that no library is needed at run time
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <boost/dll/shared_library.hpp>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "base/text.hpp"
#include "operators/declarations.hpp"
#include "operators/isolation.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr const char* entry_symbol = "evodevo_plugin";
constexpr std::string_view suffix = ".evodevo.so";
constexpr unsigned seconds_to_load = 30;
constexpr std::size_t longest_reason = 2000;

/// The libraries in use. They are never closed, because any part of the process may hold their objects and type
/// information.
std::deque<boost::dll::shared_library>& open_libraries() {
  static std::deque<boost::dll::shared_library> libraries;
  return libraries;
}

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

[[noreturn]] void refuse_mismatch(const std::string& what, const std::string& theirs, const std::string& ours) {
  refuse(what + " is " + theirs + ", this evodevo's is " + ours +
         "; rebuild the plugin against this evodevo with the same compiler");
}

/// Returns the dynamic linker's own message. Boost appends the text of an unrelated errno, which would mislead.
std::string loader_sentence(const boost::dll::fs::system_error& error) {
  std::string text = error.what();
  const auto noise = text.rfind(": ");
  const auto first = text.find(": ");
  if (noise != std::string::npos && noise != first) text.erase(noise);
  return text;
}

boost::dll::shared_library open(const fs::path& file) {
  boost::dll::shared_library library;
  try {
    in_operator({lasting_title("library", "", file.string())},
                [&] { library.load(file, boost::dll::load_mode::rtld_now | boost::dll::load_mode::rtld_local); });
  } catch (const boost::dll::fs::system_error& error) {
    const std::string sentence = loader_sentence(error);
    const bool lacks = sentence.find("undefined symbol") != std::string::npos;
    refuse("cannot be loaded: " + sentence +
           (lacks ? "; link it with all libraries that it uses (-Wl,-z,defs shows what is missing)"
                  : "; build it for this system, or remove it"));
  } catch (const std::exception& error) {
    // A static object threw this through the dynamic linker, which does not support exceptions. The check in
    // crash_of_loading() does not catch a logic_error, so that it counts as a crash.
    throw std::logic_error(error.what());
  }
  return library;
}

using EntryFunction = const PluginManifest*();

const PluginManifest* read_manifest(const boost::dll::shared_library& library, const fs::path& file) {
  if (!library.has(entry_symbol)) {
    refuse(std::string("has no function ") + entry_symbol + "; end one of its sources with EVODEVO_PLUGIN(...)");
  }
  EntryFunction& entry = library.get<EntryFunction>(entry_symbol);
  // if a library links a plugin, the linker also finds the plugin's entry function in that library
  const fs::path home = boost::dll::symbol_location_ptr(&entry);
  if (!fs::equivalent(home, file)) {
    refuse(std::string("has no function ") + entry_symbol + " of its own, only that of " + home.string() +
           " which it links; end one of its sources with EVODEVO_PLUGIN(...)");
  }
  return in_operator({lasting_title("library", "", file.string())}, entry);
}

void check_given(const std::string& what, const char* text) {
  if (text == nullptr || *text == '\0') refuse(what + " is missing; give it in EVODEVO_PLUGIN(...)");
}

/// Throws std::runtime_error if a manifest does not fit this host. The order matters: each check makes it safe to read
/// the fields that the next checks need.
void check_manifest(const PluginManifest* manifest) {
  const auto text = [](const char* given) { return given != nullptr ? given : "nothing"; };
  if (manifest == nullptr || manifest->magic != plugin_magic) {
    refuse(std::string("its ") + entry_symbol + " does not return an evodevo manifest; use EVODEVO_PLUGIN(...)");
  }
  if (manifest->epoch != plugin_epoch)
    refuse_mismatch("its ABI epoch", std::to_string(manifest->epoch), std::to_string(plugin_epoch));
  if (manifest->manifest_size != sizeof(PluginManifest))
    refuse_mismatch("its manifest size", std::to_string(manifest->manifest_size),
                    std::to_string(sizeof(PluginManifest)));
  if (manifest->struct_digest != plugin_struct_digest)
    refuse_mismatch("its digest of struct sizes", std::to_string(manifest->struct_digest),
                    std::to_string(plugin_struct_digest));
  if (text(manifest->toolchain) != std::string_view(plugin_toolchain))
    refuse_mismatch("its toolchain", text(manifest->toolchain), plugin_toolchain);
  if (text(manifest->switches) != std::string_view(plugin_switches))
    refuse_mismatch("its list of build switches", text(manifest->switches), plugin_switches);
  check_given("its version", manifest->version);
  check_given("its licence", manifest->license);
  if (manifest->entries == nullptr && manifest->entry_count > 0)
    refuse("it has no list of operators; use EVODEVO_PLUGIN(...)");
}

std::string title(const OperatorEntry& entry) {
  return std::string("its ") + entry.kind + " operator \"" + entry.name + "\"";
}

/// Throws std::runtime_error if `text` could not be printed, recorded and put on pages unchanged.
void check_text(const std::string& title, std::string_view text) {
  if (const std::string fault = text_fault(text); !fault.empty()) refuse(title + " " + fault + "; correct it");
}

/// Whether `op` is an object of the class that belongs to `kind`.
bool is_of_kind(const Operator* op, std::string_view kind) {
  const auto is_a = [&]<class T>(const T*) { return kind == T::kind && dynamic_cast<const T*>(op) != nullptr; };
  return is_a(static_cast<Encoding*>(nullptr)) || is_a(static_cast<Mutation*>(nullptr)) ||
         is_a(static_cast<Crossover*>(nullptr)) || is_a(static_cast<Devo*>(nullptr)) ||
         is_a(static_cast<Fitness*>(nullptr)) || is_a(static_cast<Selection*>(nullptr));
}

void check_texts(const OperatorEntry& entry, std::size_t index) {
  const std::string which = "its operator " + std::to_string(index) + ": ";
  check_given(which + "the kind", entry.kind);
  check_given(which + "the name", entry.name);
  check_given(which + "the summary", entry.summary);
  if (entry.create == nullptr)
    refuse(which + "it has no function that creates an operator; use operator_entry<Class>(...)");
}

void check_entry(const OperatorEntry& entry, const OperatorTitle* named) {
  check_text(std::string("the name of its ") + entry.kind + " operator", entry.name);
  check_text("the summary of " + title(entry), entry.summary);
  if (std::find(operator_kinds.begin(), operator_kinds.end(), entry.kind) == operator_kinds.end())
    refuse(std::string("its operator \"") + entry.name + "\" is of the unknown kind \"" + entry.kind +
           "\"; rebuild the plugin against this evodevo");
  std::string fault, taken;
  bool is_right = false;
  try {
    in_operator({named}, [&] {
      const std::unique_ptr<Operator> op(entry.create());
      is_right = is_of_kind(op.get(), entry.kind);
      if (!is_right) return;
      fault = wrong_default(*op);
      taken = taken_name(*op);
    });
  } catch (const std::exception& error) {
    refuse(title(entry) + " cannot be created: \"" + error.what() +
           "\"; its constructor and parameters() must not throw");
  }
  if (!is_right)
    refuse(title(entry) +
           " is not an object of the class of its kind; use operator_entry<Class>(...) with a class of this kind");
  if (!fault.empty()) refuse(title(entry) + " has a default that it does not allow: " + fault);
  if (!taken.empty())
    refuse(title(entry) + " calls a parameter \"" + taken +
           "\", but evodevo itself has a key of this name in the table of an operator; rename the parameter");
}

/// Returns the operators of an opened library. Throws std::runtime_error if the library or one of them is faulty.
std::span<const OperatorEntry> checked_entries(const boost::dll::shared_library& library, const fs::path& file) {
  const PluginManifest* manifest = read_manifest(library, file);
  check_manifest(manifest);
  check_text("its version", manifest->version);
  check_text("its licence", manifest->license);
  const std::span<const OperatorEntry> entries(manifest->entries, manifest->entry_count);
  for (std::size_t i = 0; i < entries.size(); ++i) check_texts(entries[i], i);
  for (const OperatorEntry& entry : entries) check_entry(entry, lasting_title(entry.kind, entry.name, file.string()));
  return entries;
}

/// Loads the files in a child process. Returns what crashed the child, or an empty text if nothing did.
std::string crash_of_loading(std::span<const fs::path> files) {
  const auto load_and_forget = [&] {
    for (const fs::path& file : files) {
      try {
        const boost::dll::shared_library library = open(file);
        checked_entries(library, file);
      } catch (const std::runtime_error&) {
        // Registry::load() gets the same error in this process and reports it
      }
    }
    return std::string();
  };
  return in_child(load_and_forget, seconds_to_load).crash;
}

auto sort_key(const AvailableOperator& available) {
  return std::pair<std::string_view, std::string_view>(available.entry->kind, available.entry->name);
}

}  // namespace

Registry::Registry(const std::vector<fs::path>& path) {
  static std::mutex mutex;  // runs of one process may begin at the same time
  const std::lock_guard lock(mutex);
  for (const fs::path& item : path) load_all(libraries_at(item));
  std::sort(operators_.begin(), operators_.end(),
            [](const auto& a, const auto& b) { return sort_key(a) < sort_key(b); });
}

std::vector<fs::path> Registry::libraries_at(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return {fs::absolute(path)};
  std::vector<fs::path> files;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      if (!entry.path().filename().string().ends_with(suffix)) continue;
      if (entry.is_regular_file(error))
        files.push_back(fs::absolute(entry.path()));
      else
        failed_.push_back({entry.path(), "is not a file; remove it"});
    }
  } catch (const fs::filesystem_error& failure) {
    failed_.push_back({path, "cannot be read: " + failure.code().message() +
                                 "; make it readable, or leave it out of the plugin path"});
  }
  std::sort(files.begin(), files.end());
  return files;
}

void Registry::load_all(const std::vector<fs::path>& files) {
  // libraries that a child has loaded without a crash; they need not be tried again
  static std::set<fs::path> survived;
  std::vector<fs::path> unknown;
  for (const fs::path& file : files)
    if (!survived.contains(file)) unknown.push_back(file);
  const bool all_survive = unknown.empty() || crash_of_loading(unknown).empty();
  for (const fs::path& file : files) {
    try {
      if (!all_survive && !survived.contains(file))
        if (const std::string crash = crash_of_loading({&file, 1}); !crash.empty())
          refuse("crashes while it is loaded: " + crash +
                 "; look at its static objects, constructors and parameters() in a debugger, or remove it");
      survived.insert(file);
      load(file);
    } catch (const std::exception& error) {
      failed_.push_back({file, printable(error.what(), longest_reason)});
    }
  }
}

void Registry::load(const fs::path& file) {
  std::error_code error;
  const auto here = [&](const AvailableOperator& known) { return fs::equivalent(known.file, file, error); };
  if (std::any_of(operators_.begin(), operators_.end(), here)) return;  // loaded already by another path
  boost::dll::shared_library library = open(file);
  const auto entries = checked_entries(library, file);
  const PluginManifest* manifest = read_manifest(library, file);
  std::vector<AvailableOperator> brought;
  for (const OperatorEntry& entry : entries) {
    if (const AvailableOperator* twin = find(entry.kind, entry.name))
      refuse(title(entry) + " is already provided by " + twin->file.string() +
             ", which comes first; rename one of them, or take one off the plugin path");
    const AvailableOperator candidate{&entry, manifest, file, lasting_title(entry.kind, entry.name, file.string())};
    const auto same = [&](const AvailableOperator& other) { return sort_key(other) == sort_key(candidate); };
    if (std::any_of(brought.begin(), brought.end(), same)) refuse(title(entry) + " is in it twice; rename one of them");
    brought.push_back(candidate);
  }
  operators_.insert(operators_.end(), brought.begin(), brought.end());
  open_libraries().push_back(std::move(library));
}

const AvailableOperator* Registry::find(std::string_view kind, std::string_view name) const {
  const auto found = std::find_if(operators_.begin(), operators_.end(),
                                  [&](const auto& available) { return sort_key(available) == std::pair(kind, name); });
  return found == operators_.end() ? nullptr : &*found;
}

std::vector<std::string> Registry::names(std::string_view kind) const {
  std::vector<std::string> names;
  for (const AvailableOperator& available : operators_)
    if (available.entry->kind == kind) names.emplace_back(available.entry->name);
  return names;
}

namespace {

fs::path& set_plugin_folder() {
  static fs::path folder;
  return folder;
}

}  // namespace

fs::path builtin_plugin_folder() {
  if (!set_plugin_folder().empty()) return set_plugin_folder();
  const fs::path program = boost::dll::program_location();
  return program.parent_path().parent_path() / EVODEVO_PLUGIN_DIR;
}

void set_builtin_plugin_folder(fs::path folder) { set_plugin_folder() = std::move(folder); }

std::vector<fs::path> environment_plugin_folders() {
  const char* variable = std::getenv("EVODEVO_PLUGIN_PATH");
  std::istringstream list(variable != nullptr ? variable : "");
  std::vector<fs::path> folders;
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) folders.push_back(fs::absolute(folder));
  return folders;
}

std::vector<fs::path> plugin_search_path(const std::vector<fs::path>& own) {
  std::vector<fs::path> path = own;
  const auto environment = environment_plugin_folders();
  path.insert(path.end(), environment.begin(), environment.end());
  path.push_back(builtin_plugin_folder());
  return path;
}

bool is_plugin_path(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) || (fs::is_regular_file(path, error) && path.string().ends_with(suffix));
}

std::string file_hash(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(stream), {}};
  return fmt::format("{:016x}", XXH3_64bits(content.data(), content.size()));
}

}  // namespace evodevo
