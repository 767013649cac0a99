#include "commands/shell/topics.hpp"

namespace evodevo {
namespace {

Topic experiment() {
  return {
      .name = "experiment",
      .summary = "How an experiment is written",
      .text = {"An experiment is one TOML file. A force that has no table is not computed. A key that is left out has "
               "its default. A key that does not exist is an error that names the file, the line, the column and the "
               "most similar key that exists.",
               "Every key can also be set on the command line: --set experiment.population=100. The items of lists "
               "have numbers from 0: --set fitness.0.window=5. The number after the last one adds an item.",
               "`evodevo check FILE` says whether an experiment can be run, `evodevo operators` lists the operators "
               "that it can name, and `evodevo describe OPERATOR` explains the keys of one operator. `evodevo describe "
               "experiment` prints the keys of all tables with their ranges."},
      .definitions = {},
      .example = R"([experiment]
evaluations = 600
population = 30
[encoding]
name = "neural"
[[mutation]]
name = "reset-weight"
[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]
[development]
cycles = 4
cycle_time = 1.0
[[development.operator]]
name = "spring-turnover"
springs = 8
[[fitness]]
name = "distance"
settle = 10.0
window = 10.0
[selection]
name = "age-fitness-pareto"
)"};
}

Topic plugins() {
  return {
      .name = "plugins",
      .summary = "How to write, check and use operators of your own",
      .text = {"Every encoding, mutation, crossover, devo operator, fitness and selection is a plugin: a shared "
               "library NAME.evodevo.so with one operator or more. To use another operator, change a name in the "
               "experiment; evodevo need not be built again.",
               "evodevo looks for operators in the folders that [plugins] paths in the experiment names, then in "
               "those of --plugin-path, then in those of EVODEVO_PLUGIN_PATH, and then in its own folder. A run "
               "records the folders, and `run` remembers them for `resume` and the other commands.",
               "evodevo checks a library before it uses it, and says why it refuses one: see "
               "`evodevo operators --failed`. It names an operator that crashes, throws or takes too long.",
               "share/doc/evodevo/plugins.md, which is framework/sdk/README.md in the sources, teaches how to write "
               "an operator. Beside it are a page for each kind of operator, and those on experiments, commands, "
               "archives, the simulation and Python."},
      .definitions = {},
      .example = R"(evodevo new devo my-lab.growth && cd my-lab.growth
cmake -B build && cmake --build build
evodevo conform build/lib/evodevo/*.evodevo.so
evodevo run experiment.toml
)"};
}

Topic archive() {
  return {
      .name = "archive",
      .summary = "What a run writes, and how to read it",
      .text = {"The folder of a run holds one SQLite file, run.sqlite, with every individual of every generation and "
               "the experiment with all defaults written out. While the run goes on, its newest generations can "
               "lie in run.sqlite-wal beside it: copy and move these files together.",
               "A generation is one transaction. Ctrl-C ends a run after the current generation, a second Ctrl-C "
               "ends it at once; `evodevo resume` goes on in both cases, and ends with the same genes and scores as "
               "a run that was never interrupted. Only one process at a time can write a run; any number can read it."},
      .definitions =
          {{"record", "Texts about the whole run, each under a key, such as experiment, name and seed."},
           {"individuals",
            "Id, generation of birth and of death, parents, operators that made it, genes, "
            "status and reason."},
           {"scores", "The value of each objective of each individual with a fitness."},
           {"objectives", "Name, unit and direction of each objective."},
           {"measures, measured", "Name, unit and role of each score that is not an objective, and its values."},
           {"scenarios, tests", "Names of the scenarios, and the scores in each of them and its repeats."},
           {"generations", "Best, median and counts of each generation."},
           {"members", "The individuals in the population after each generation, and the ages of their genes."},
           {"lives", "The edits that development made in each life of individuals that reached the Pareto front."},
           {"life_scores", "The scores in each life of individuals that have had several."},
           {"verifications", "The trials of verified individuals (see `evodevo help verification`)."}},
      .example = "sqlite3 runs/quickstart-1/run.sqlite \"SELECT generation, best FROM generations\"\n"};
}

Topic verification() {
  return {
      .name = "verification",
      .summary = "How the best individuals of a run are verified",
      .text =
          {"Fitness can come from an error of the simulation, such as energy that too long a time step adds. At its "
           "end, a run therefore simulates its best individuals again ([experiment] verify, 1 by default), and "
           "`evodevo verify` does so for more of them. The body develops as in the run; then its final evaluation "
           "is repeated in eight trials. A robot that develops also lives again in eight lives to come.",
           "A trial has held if the first objective is as good as in the run, better, or worse by at most half of its "
           "absolute value. An individual is an artefact if quarter-step or other-method did not hold. It is passive "
           "if it keeps more than half of its fitness without muscles, or has lost more than half of it after ten more "
           "seconds. Otherwise it is verified. The verdict also says in how many lives to come it kept its fitness.",
           "With [experiment] verify_front = \"trials\", individuals are also verified before they enter the front of "
           "a "
           "generation, in four of the trials: no-muscles and settled, then quarter-step and other-method. With "
           "\"lives\", they must also keep half of their fitness in new lives, and are lucky otherwise. The first "
           "trial "
           "that shows an artefact, a lucky or a passive individual decides its status; it loses its fitness, and is "
           "not tried further. All these trials run on the device of the run, while quarter-step and other-method at "
           "the "
           "end "
           "of a run always use the CPU."},
      .definitions =
          {{"again", "The final evaluation as it was in the run."},
           {"quarter-step", "A quarter of the time step, in double precision."},
           {"other-method",
            "Another integration method, in double precision, with a quarter of the "
            "longest stable step of the body."},
           {"perturbed-1, perturbed-2, perturbed-3",
            "A perturbation: each mass is moved at random by up "
            "to 1e-4 of the longest side of the body."},
           {"no-muscles", "No muscle changes its length."},
           {"settled", "The measurement begins ten seconds later."},
           {"reborn-1 to reborn-4",
            "If there is development or noise at birth: a new life from birth on, with other noise or such a "
            "perturbation. Operators draw the same random numbers as in the run."},
           {"redrawn-1 to redrawn-4", "If there is development: the same, and operators draw other random numbers."}},
      .example = "evodevo verify runs/quickstart-1 --best 10\n"};
}

Topic heredity() {
  return {
      .name = "heredity",
      .summary = "What repeats in scores, and what children inherit",
      .text =
          {"Selection can use only what of a score comes again, and evolution only what children get of it. `evodevo "
           "signal` lets robots live again in lives that selection never sees, and measures both in the first "
           "objective. "
           "If the experiment has no birth noise, masses are moved by up to 1e-4 of the longest side at birth.",
           "It measures random robots and, of a run, as many of the last population, drawn at random, each in at least "
           "four lives and two combinations of lives. Each gets four children by the experiment's own mutation and "
           "crossover, with a mate drawn at random, which live in other such lives. Nobody is selected, since selected "
           "parents are lucky ones, and their children always look worse. Intervals hold 95 % of 2,000 samples of "
           "robots, "
           "or families, drawn with replacement. By rank, a life that fails is worse than all others; by value, robots "
           "with such a life are left out. Robots that fail in all of these lives are left out of both. Luck that is "
           "the "
           "same for all robots in lives of one number counts as luck.",
           "With a repeatability r of one life, the mean of n lives has n r/(1 + (n - 1) r); 4 (1 - r)/r lives reach "
           "0.8. Another measure may need fewer, such as distance with direction = \"any\". A low heritability alone "
           "is not bad, since few small changes suffice to climb; none at all is random "
           "search. What counts is progress in lives to come, beside random search at the same cost, as `tools/compare "
           "--random --signal 60` measures it."},
      .definitions =
          {{"repeatability",
            "The share of the variance of scores that lies between robots, not between lives of one: the one-way "
            "intraclass correlation. Of one life; of all lives, as the experiment combines them; and of one life if "
            "development draws other random numbers in each (new draws)."},
           {"heritability",
            "The slope of the regression of the children's mean score on their parent's, or on the mean of both "
            "parents: how much of a difference between parents is found between their children. Of all children, and "
            "of "
            "those of each operator."},
           {"heritability / repeatability",
            "What it would be if each parent's score were the mean of endless lives: what mutation and crossover leave "
            "of it. With draws = \"individual\" it is left out, since robots repeat draws that no child inherits."},
           {"equal bodies", "The share of the children whose body at birth is that of their parent."},
           {"score",
            "The medians of parents and children. Of the best robot: its record, its median in lives to come, ten "
            "times as "
            "many as it was selected by and combined in the same way, with the draws of the run and with new ones, and "
            "that of twenty children. It has no median if half of them fail (failures)."}},
      .example = "evodevo signal runs/quickstart-1 --svg children.svg\n"};
}

Topic environment() {
  return {.name = "environment",
          .summary = "The environment variables and files that evodevo reads",
          .text = {},
          .definitions = {{"EVODEVO_PLUGIN_PATH", "Folders with operators, separated by colons."},
                          {"EVODEVO_PATIENCE",
                           "Number of seconds after which a call of an operator is reported as slow; 10 by default."},
                          {"EVODEVO_CHROMIUM",
                           "The browser that draws films and pictures; by default chromium, chromium-browser or "
                           "google-chrome, as found in PATH."},
                          {"EVODEVO_COMMAND", "The name by which messages call the program; tools/evodevo sets it."},
                          {"EVODEVO_PRESET",
                           "What tools/evodevo builds: cpu or cuda; by default cuda where a CUDA toolkit is "
                           "found. tools/test also takes asan and tsan."},
                          {"XDG_CACHE_HOME",
                           "The folder in which compiled kernels are kept, in evodevo/kernels; ~/.cache by default."},
                          {"XDG_STATE_HOME",
                           "The folder of the list evodevo/plugin-folders, which names the folders whose operators you "
                           "have run, one on each line; ~/.local/state by default."}},
          .example = ""};
}

Topic exit_codes() {
  return {.name = "exit-codes",
          .summary = "What the exit codes mean",
          .text = {"Messages go to standard error, so that results can be piped. A reader that ends early, as in "
                   "`evodevo operators | head -1`, ends the command without a message."},
          .definitions = {{"0", "The command succeeded."},
                          {"1",
                           "The command failed: a simulation or a run failed, output could not be written, or plugins "
                           "do not conform."},
                          {"2", "The command line, an experiment, a body or a run is not valid. Nothing was written."},
                          {"3", "The run is complete, but no individual has a fitness."},
                          {"130",
                           "The run ended early, because of Ctrl-C, SIGTERM or SIGUSR1, and `evodevo resume` can "
                           "continue it."}},
          .example = ""};
}

}  // namespace

const std::vector<Topic>& topics() {
  static const std::vector<Topic> all = {experiment(), plugins(),     archive(),   verification(),
                                         heredity(),   environment(), exit_codes()};
  return all;
}

}  // namespace evodevo
