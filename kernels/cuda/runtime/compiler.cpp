#include "cuda/runtime/compiler.hpp"

#include <nvrtc.h>

#include <algorithm>
#include <stdexcept>

#include "core/slow_step.hpp"
#include "cuda/runtime/cache.hpp"

namespace evodevo::cuda {
namespace {

void check(nvrtcResult result, const char* what) {
  if (result != NVRTC_SUCCESS)
    throw std::runtime_error(std::string("CUDA's run-time compiler: ") + what +
                             " failed: " + nvrtcGetErrorString(result));
}

// the parts of the standard library that the sources use; the run-time compiler has no standard library
constexpr EmbeddedSource standard_headers[] = {
    {"cmath", "namespace std { using ::floor; using ::fma; using ::sqrt; }\n"},
    {"cstdint",
     "#pragma once\n"
     "namespace std { using int32_t = int; using uint32_t = unsigned int; using uint64_t = unsigned long long; }\n"}};

/// The compiler's target: machine code if the compiler knows the GPU, otherwise PTX code, which the driver compiles.
struct Target {
  std::string option;
  bool machine_code;
};

Target target_for(const std::string& architecture) {
  int count = 0;
  check(nvrtcGetNumSupportedArchs(&count), "asking for its architectures");
  std::vector<int> known(static_cast<std::size_t>(count));
  check(nvrtcGetSupportedArchs(known.data()), "asking for its architectures");
  const int wanted = std::stoi(architecture.substr(architecture.find('_') + 1));
  if (std::find(known.begin(), known.end(), wanted) != known.end()) return {"-arch=" + architecture, true};
  const auto [oldest, newest] = std::minmax_element(known.begin(), known.end());
  if (wanted < *oldest)
    throw std::runtime_error("CUDA: the GPU is too old: it is " + architecture + ", and this program needs sm_" +
                             std::to_string(*oldest) + " or newer");
  return {"-arch=compute_" + std::to_string(*newest), false};
}

std::string compiler_version() {
  int major = 0, minor = 0;
  check(nvrtcVersion(&major, &minor), "asking for its version");
  return std::to_string(major) + "." + std::to_string(minor);
}

/// The compiler's options. -fmad=false: contraction to fused multiply-adds would make results depend on which features
/// are compiled in.
std::vector<std::string> options_for(const Target& target, const std::vector<std::string>& definitions) {
  std::vector<std::string> options{target.option, "-std=c++20", "-fmad=false", "-ftz=true"};
  for (const std::string& definition : definitions) options.push_back("-D" + definition);
  return options;
}

/// The embedded sources and `more`.
std::vector<EmbeddedSource> embedded_with(std::span<const EmbeddedSource> more) {
  std::vector<EmbeddedSource> sources = embedded_sources();
  sources.insert(sources.end(), more.begin(), more.end());
  return sources;
}

/// The cache's key: a digest of everything that the machine code depends on.
std::string key_of(std::string_view name, const std::vector<std::string>& options,
                   const std::vector<EmbeddedSource>& sources) {
  std::string text = compiler_version() + '\n' + std::string(name) + '\n';
  for (const std::string& option : options) text += option + '\n';
  for (const EmbeddedSource& source : sources) text.append(source.text);
  for (const EmbeddedSource& source : standard_headers) text.append(source.text);
  return digest(text);
}

/// A program of the run-time compiler.
class Program {
 public:
  Program(const std::vector<EmbeddedSource>& sources, std::string_view name) {
    std::vector<std::string> names, texts;
    const char* main = nullptr;
    for (const EmbeddedSource& source : sources) names.emplace_back(source.name), texts.emplace_back(source.text);
    for (const EmbeddedSource& source : standard_headers)
      names.emplace_back(source.name), texts.emplace_back(source.text);
    std::vector<const char*> name_pointers, text_pointers;
    for (std::size_t i = 0; i < names.size(); ++i) {
      name_pointers.push_back(names[i].c_str());
      text_pointers.push_back(texts[i].c_str());
      if (names[i] == name) main = texts[i].c_str();
    }
    if (main == nullptr) throw std::logic_error("no embedded source " + std::string(name));
    check(nvrtcCreateProgram(&program_, main, std::string(name).c_str(), static_cast<int>(names.size()),
                             text_pointers.data(), name_pointers.data()),
          "reading a kernel");
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() { nvrtcDestroyProgram(&program_); }

  void compile(const std::vector<std::string>& options) {
    std::vector<const char*> pointers;
    for (const std::string& option : options) pointers.push_back(option.c_str());
    const nvrtcResult result = nvrtcCompileProgram(program_, static_cast<int>(pointers.size()), pointers.data());
    if (result == NVRTC_ERROR_COMPILATION) throw std::logic_error("a kernel does not compile:\n" + log());
    check(result, "compiling a kernel");
  }

  std::vector<char> code(bool machine_code) const {
    std::size_t size = 0;
    check(machine_code ? nvrtcGetCUBINSize(program_, &size) : nvrtcGetPTXSize(program_, &size), "reading the code");
    std::vector<char> result(size);
    check(machine_code ? nvrtcGetCUBIN(program_, result.data()) : nvrtcGetPTX(program_, result.data()),
          "reading the code");
    return result;
  }

 private:
  std::string log() const {
    std::size_t size = 0;
    check(nvrtcGetProgramLogSize(program_, &size), "reading its messages");
    std::string text(size, '\0');
    check(nvrtcGetProgramLog(program_, text.data()), "reading its messages");
    return text;
  }

  nvrtcProgram program_ = nullptr;
};

}  // namespace

std::vector<char> compile(std::string_view name, const std::vector<std::string>& definitions,
                          const std::string& architecture, std::span<const EmbeddedSource> more) {
  const Target target = target_for(architecture);
  const std::vector<EmbeddedSource> sources = embedded_with(more);
  const std::string key = key_of(name, options_for(target, definitions), sources);
  if (std::optional<std::vector<char>> code = load(key)) return *std::move(code);
  const SlowStep step("compiling the kernel " + std::string(name) + " for " + architecture);
  std::vector<char> code = compile(sources, name, definitions, architecture);
  store(key, code);
  return code;
}

std::vector<char> compile(const std::vector<EmbeddedSource>& sources, std::string_view name,
                          const std::vector<std::string>& definitions, const std::string& architecture) {
  const Target target = target_for(architecture);
  Program program(sources, name);
  program.compile(options_for(target, definitions));
  return program.code(target.machine_code);
}

}  // namespace evodevo::cuda
