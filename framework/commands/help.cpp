// evodevo help, completion and man: present the declarations of the commands in several forms.
#include "commands/shell/help.hpp"

#include <iostream>

#include "base/text.hpp"
#include "cluster/ranks.hpp"
#include "commands/commands.hpp"
#include "commands/shell/completion.hpp"
#include "commands/shell/manual.hpp"
#include "cpu/simulator.hpp"
#include "report/page.hpp"
#include "threads/parallel.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/runtime/cuda_simulator.hpp"
#endif

namespace evodevo {
namespace {

int help(const Given& given) {
  if (!given.contains("TOPIC")) {
    print_overview(std::cout, commands());
    return 0;
  }
  const auto wanted = given["TOPIC"].as<std::string>();
  std::vector<std::string> names;
  for (const Topic& topic : topics()) {
    if (topic.name == wanted) return print_topic(std::cout, topic), 0;
    names.push_back(topic.name);
  }
  for (const Command& command : commands()) {
    if (command.name == wanted) return print_help(std::cout, command), 0;
    names.push_back(command.name);
  }
  throw UsageError("help " + printable(wanted) + ": is neither a topic nor a command" + suggestion(wanted, names));
}

int complete(const Given& given) {
  std::cout << completion_script(given[shells].as<std::string>(), commands());
  return 0;
}

int man(const Given&) {
  std::cout << manual_page(commands());
  return 0;
}

/// Returns a text such as "cuda, NVIDIA H200, sm_90 (2 GPUs)", or why there is none.
std::string gpu_text() {
#ifdef EVODEVO_CUDA
  if (const std::string obstacle = why_cuda_is_unusable(); !obstacle.empty()) return "no GPU: " + obstacle;
  const std::size_t count = equal_gpus().size();
  return make_cuda_group({}, {}, 1)->device() + (count > 1 ? " (" + std::to_string(count) + " GPUs)" : "");
#else
  return "no GPU: this program was built without CUDA";
#endif
}

}  // namespace

void print_version(std::ostream& stream) {
  const auto whether = [](bool is_there) { return is_there ? "yes" : "no"; };
#ifdef EVODEVO_CUDA
  constexpr bool cuda = true;
#else
  constexpr bool cuda = false;
#endif
#ifdef __clang__
  constexpr const char* compiler = __VERSION__;
#else
  constexpr const char* compiler = "GCC " __VERSION__;
#endif
  const int cores = thread_count(0);
  stream << "evodevo " EVODEVO_VERSION "\nbuild: " EVODEVO_BUILD_TYPE ", " << compiler << "\nfeatures: CUDA "
         << whether(cuda) << ", MPI " << whether(has_mpi()) << ", viewer " << whether(has_viewer())
         << "\ndevices: " << make_cpu_simulator({}, {}, 1)->device() << " (" << cores
         << (cores == 1 ? " core" : " cores") << "); " << gpu_text() << '\n';
}

Command help_command() {
  return {.name = "help",
          .arguments = {{"TOPIC", Count::optional}},
          .summary = "Explain a topic or a command",
          .text = {"Without a name, it lists all commands and topics."},
          .examples = {"help experiment", "help run"},
          .options = {},
          .function = help};
}

Command completion_command() {
  return {.name = "completion",
          .arguments = {{shells}},
          .summary = "Print a completion script for a shell",
          .text = {"The script completes commands, options, their values, names of operators, and files. "
                   "`cmake --install` puts it where each shell looks for it. Elsewhere, load it when the shell starts, "
                   "as in the examples below; the first one is for ~/.bashrc."},
          .examples = {"completion bash >> ~/.bashrc", "completion zsh > ~/.zfunc/_evodevo",
                       "completion fish > ~/.config/fish/completions/evodevo.fish"},
          .options = {},
          .function = complete};
}

Command man_command() {
  return {.name = "man",
          .arguments = {},
          .summary = "Print the manual page",
          .text = {"The page is in roff, the format that `man` reads. `cmake --install` puts it in share/man/man1."},
          .examples = {"man | man -l -"},
          .options = {},
          .function = man};
}

}  // namespace evodevo
