#include "settings.hpp"

#include <algorithm>
#include <boost/program_options.hpp>
#include <iostream>
#include <stdexcept>
#include <vector>

namespace evodevo::benchmark {
namespace {

constexpr std::uint32_t most_bodies = 65535;  // blocks of a grid in its second dimension

/// Throws where `value` is none of `known`.
void check_choice(const char* option, const std::string& value, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), value) != known.end()) return;
  std::string names;
  for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
  throw std::invalid_argument("--" + std::string(option) + " \"" + value + "\" is none of " + names);
}

void check(const Settings& s) {
  check_choice("study", s.study, {"speed", "features", "baselines", "stress", "tallies", "neighbours", "materials"});
  check_choice("device", s.device, {"cpu", "cuda"});
  check_choice("method", s.method, {method_names.begin(), method_names.end()});
  check_choice("precision", s.precision, {"float32", "float64"});
  check_choice("instructions", s.instructions, {"best", "avx2", "sse4", "none"});
#ifndef EVODEVO_CUDA
  if (s.device == "cuda")
    throw std::invalid_argument("this program was built without CUDA; configure with -DEVODEVO_CUDA=ON");
#endif
  if (s.study == "materials" && (s.device != "cuda" || s.precision != "float32" || !is_explicit(s.stepping().method)))
    throw std::invalid_argument(
        "--study materials is of what a GPU computes in single precision and with explicit methods; add --device "
        "cuda, leave --precision out, and take another --method");
  const bool beside_cuda = s.study != "speed" && s.study != "features" && s.study != "materials";
  if (beside_cuda && s.device != "cuda")
    throw std::invalid_argument("--study " + s.study + " compares methods on a GPU; add --device cuda");
  if (beside_cuda && s.method != name(Method::paper_euler))
    throw std::invalid_argument("--study " + s.study + " has the paper's method of time stepping; leave --method out");
  if (beside_cuda && s.precision != "float32")
    throw std::invalid_argument("--study " + s.study + " has one precision; leave --precision out");
  if (s.study == "tallies" && s.robots.empty())
    throw std::invalid_argument("--study tallies takes random robots; name their experiment with --robots");
  if (s.study != "tallies" && s.study != "speed" && !s.robots.empty())
    throw std::invalid_argument("--robots goes with --study speed and tallies alone");
  if (s.bodies < 1 || s.bodies > most_bodies || s.steps < 1 || s.runs < 1 || s.masses < 2)
    throw std::invalid_argument("steps and runs must be at least 1, masses at least 2, bodies from 1 to " +
                                std::to_string(most_bodies));
}

}  // namespace

Stepping Settings::stepping() const {
  return {method_of(method), precision == "float32" ? Precision::float32 : Precision::float64};
}

std::optional<Settings> parse(int argc, const char* const* argv) {
  namespace po = boost::program_options;
  Settings s;
  po::options_description options("Spring evaluations per second; one is one spring in one step. Options");
  options.add_options()("help", "this text");
  options.add_options()(
      "study", po::value(&s.study)->default_value("speed"),
      "speed: how fast | features: what each force and recording costs | baselines: the paper's "
      "methods beside ours | stress: what recording stress costs with each method | tallies: how "
      "many of the true least and most stressed springs the paper's tallies find in 1 s and in 10 s | "
      "neighbours: the search for nearest neighbours on both devices | materials: few and many "
      "materials, from a table and computed from codes");
  options.add_options()("device", po::value(&s.device)->default_value("cpu"), "cpu | cuda");
  options.add_options()("body", po::value(&s.body)->default_value("knn1000"),
                        "cube10 | knn1000 | a JSON file of `evodevo body`");
  options.add_options()("masses", po::value(&s.masses)->default_value(1000), "masses of knn1000");
  options.add_options()("materials", po::value(&s.materials)->default_value(0),
                        "materials of the springs, in turn; 0: the body's own");
  options.add_options()("robots", po::value(&s.robots)->default_value(""),
                        "an experiment whose scene and random robots --study speed and tallies take instead of --body");
  options.add_options()("bodies", po::value(&s.bodies)->default_value(8), "bodies in the batch");
  options.add_options()("steps", po::value(&s.steps)->default_value(2000), "time steps of 0.5 ms");
  options.add_options()("threads", po::value(&s.threads)->default_value(0), "threads; 0: all cores");
  options.add_options()("method", po::value(&s.method)->default_value(std::string(name(Method::paper_euler))),
                        "of time stepping, as [simulation] method names it");
  options.add_options()("precision", po::value(&s.precision)->default_value("float32"), "float32 | float64");
  options.add_options()("instructions", po::value(&s.instructions)->default_value("best"),
                        "at most these: best | avx2 | sse4 | none");
  options.add_options()("runs", po::value(&s.runs)->default_value(5), "runs, of which the median counts");
  options.add_options()("json", po::bool_switch(&s.json), "print JSON");
  options.add_options()("tables", po::value(&s.tables)->default_value(""),
                        "measure nothing; print the tables of a file of such JSON, one result or a list");
  po::variables_map values;
  po::store(po::parse_command_line(argc, argv, options), values);
  po::notify(values);
  if (values.count("help")) {
    std::cout << options;
    return std::nullopt;
  }
  check(s);
  s.command = "tools/bench";
  for (int i = 1; i < argc; ++i)
    if (argv[i] != std::string("--json")) s.command += std::string(" ") + argv[i];
  return s;
}

}  // namespace evodevo::benchmark
