#include "cluster/ranks.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <boost/dll/shared_library.hpp>
#include <charconv>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "cluster/farm.hpp"
#include "experiment/device.hpp"
#include "operators/loader.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

constexpr const char* library_name = "libevodevo-mpi.so";

std::filesystem::path mpi_library() { return builtin_plugin_folder().parent_path() / library_name; }

/// The library stays loaded as long as the channel exists.
std::shared_ptr<Channel> opened_channel(int processes) {
  const std::filesystem::path file = mpi_library();
  const std::string started = "started as " + std::to_string(processes) + " processes";
  if (!std::filesystem::exists(file))
    throw std::runtime_error(started + ", but this evodevo cannot use MPI, because " + file.string() +
                             " is missing; install MPI (on Debian: libopenmpi-dev) and build evodevo again");
  // global: MPI loads further libraries, which need its symbols
  const auto library = std::make_shared<boost::dll::shared_library>(
      file, boost::dll::load_mode::rtld_global | boost::dll::load_mode::rtld_now);
  std::shared_ptr<Channel> channel(library->get<Channel*()>("evodevo_open_mpi_channel")(),
                                   [library](Channel* opened) { delete opened; });
  if (channel->size() == 1) {
    channel->leave();
    throw std::runtime_error(started +
                             " that do not know of each other, so each would make the same run; with Slurm, "
                             "use srun --mpi=pmix; otherwise, use the mpirun of the MPI with which evodevo was built");
  }
  return channel;
}

int number_in(const char* variable) {
  const char* const text = std::getenv(variable);
  if (!text) return 1;
  const std::string_view digits = text;
  int number = 1;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

/// The number of cores on which this process may run, and whether they are all cores of the host.
std::pair<int, bool> usable_cores() {
  const int cores = thread_count(0);
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return {cores, true};
  const int usable = CPU_COUNT(&set);
  return {usable, usable >= static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN))};
}

}  // namespace

bool has_mpi() { return std::filesystem::exists(mpi_library()); }

int started_processes() {
  // Open MPI; MPICH, Intel MPI and Slurm's own PMI; Slurm's srun
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const int number = number_in(variable); number > 1) return number;
  return 1;
}

Ranks Ranks::joined() {
  const int processes = started_processes();
  return Ranks(processes > 1 ? opened_channel(processes) : nullptr);
}

Ranks::~Ranks() {
  if (!channel_) return;
  if (channel_->rank() == 0) end_run(*channel_);
  channel_->leave();
}

std::vector<int> share_of(int count, int sharer, int sharers) {
  if (count == 0) return {};
  if (count < sharers) return {sharer % count};
  std::vector<int> share;
  for (int number = sharer; number < count; number += sharers) share.push_back(number);
  share.resize(static_cast<std::size_t>(count / sharers));
  return share;
}

void share_host(Experiment& experiment, const Channel& channel, bool mixed) {
  const int rank = channel.rank_on_host(), ranks = channel.ranks_on_host();
  if (experiment.threads == 0) {
    const auto [cores, all] = usable_cores();
    experiment.threads = all ? std::max(1, cores / ranks) : cores;  // a launcher may have divided the cores already
  }
  if (experiment.device == Device::cpu || (mixed && !experiment.gpus.empty())) return;
  std::vector<int> numbers;
  const std::vector<int> all = experiment.gpus.empty() ? usable_gpus() : experiment.gpus;
  for (const int place : share_of(static_cast<int>(all.size()), rank, ranks))
    numbers.push_back(all[static_cast<std::size_t>(place)]);
  experiment.gpus = numbers;
}

}  // namespace evodevo
