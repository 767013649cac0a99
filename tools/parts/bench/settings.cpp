#include "settings.hpp"

#include <stdexcept>
#include <vector>

namespace evodevo::tools::bench {
namespace {

constexpr std::uint32_t most_bodies = 65535;  // CUDA's limit for the second dimension of a grid of blocks

void check(const Settings& s) {
  check_choice("study", s.study,
               {"speed", "sizes", "numbers", "features", "samples", "host", "baselines", "stress", "tallies",
                "neighbours", "materials"});
  check_device(s.device);
  check_choice("method", s.method, {method_names.begin(), method_names.end()});
  check_choice("precision", s.precision, {"float32", "float64"});
  check_choice("instructions", s.instructions, {"best", "avx2", "sse4", "none"});
  if (s.study == "materials" && (s.device != "cuda" || s.precision != "float32" || !is_explicit(s.stepping().method)))
    throw std::invalid_argument(
        "--study materials measures a GPU in single precision with explicit methods; add --device cuda, leave "
        "--precision out, and choose another --method");
#ifndef EVODEVO_CUDA
  if (s.study == "host")
    throw std::invalid_argument("--study host needs evodevo to be built with CUDA; configure with -DEVODEVO_CUDA=ON");
#endif
  const bool beside_cuda =
      s.study == "baselines" || s.study == "stress" || s.study == "tallies" || s.study == "neighbours";
  if (beside_cuda && s.device != "cuda")
    throw std::invalid_argument("--study " + s.study + " compares methods on a GPU; add --device cuda");
  if (beside_cuda && s.method != name(Method::paper_euler))
    throw std::invalid_argument("--study " + s.study +
                                " always uses the paper's time-stepping method; leave --method out");
  if (beside_cuda && s.precision != "float32")
    throw std::invalid_argument("--study " + s.study + " always uses single precision; leave --precision out");
  const bool needs_robots = s.study == "tallies" || s.study == "host";
  if (needs_robots && s.robots.empty())
    throw std::invalid_argument("--study " + s.study + " needs random robots; give their experiment with --robots");
  if (s.study == "sizes" && s.body != "knn1000")
    throw std::invalid_argument("--study sizes measures bodies of knn1000's kind; leave --body out");
  if (!needs_robots && s.study != "speed" && !s.robots.empty())
    throw std::invalid_argument("--robots can be given only with --study speed, tallies and host");
  if (s.bodies < 1 || s.bodies > most_bodies || s.steps < 1 || s.runs < 1 || s.masses < 2)
    throw std::invalid_argument("steps and runs must be at least 1, masses at least 2, bodies from 1 to " +
                                std::to_string(most_bodies));
}

}  // namespace

Stepping Settings::stepping() const {
  return {method_of(method), precision == "float32" ? Precision::float32 : Precision::float64};
}

boost::program_options::options_description options(Settings& s) {
  namespace po = boost::program_options;
  po::options_description all;
  all.add_options()("study", po::value(&s.study)->default_value("speed"));
  all.add_options()("body", po::value(&s.body)->default_value("knn1000"));
  all.add_options()("masses", po::value(&s.masses)->default_value(1000));
  all.add_options()("materials", po::value(&s.materials)->default_value(0));
  all.add_options()("robots", po::value(&s.robots));
  all.add_options()("bodies", po::value(&s.bodies)->default_value(8));
  all.add_options()("steps", po::value(&s.steps)->default_value(2000));
  all.add_options()("runs", po::value(&s.runs)->default_value(5));
  all.add_options()("device", po::value(&s.device)->default_value("cpu"));
  all.add_options()("threads", po::value(&s.threads)->default_value(0));
  all.add_options()("method", po::value(&s.method)->default_value(std::string(name(Method::paper_euler))));
  all.add_options()("precision", po::value(&s.precision)->default_value("float32"));
  all.add_options()("instructions", po::value(&s.instructions)->default_value("best"));
  all.add_options()("json", po::bool_switch(&s.json));
  all.add_options()("tables", po::value(&s.tables));
  return all;
}

Settings parse(const CommandLine& line) {
  Settings s;
  read_options(line, options(s));
  check(s);
  s.command = command_of(program, line, {"--json"});
  return s;
}

}  // namespace evodevo::tools::bench
