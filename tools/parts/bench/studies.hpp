// The studies of the benchmark.
#pragma once

#include "report.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

/// Measures our simulator's rate and, relative to it, the rates while recording stress or work.
Report speed(const Settings& settings);

/// Measures the rate, and that while recording stress, for bodies of 64 to 50,000 masses. Each batch has about
/// settings.bodies times settings.masses masses in all.
Report sizes(const Settings& settings);

/// Measures the rate for 1 to settings.bodies bodies, each number twice the one before. On a GPU, few bodies get
/// several multiprocessors each.
Report numbers(const Settings& settings);

/// Measures the cost of each force, of actuation and of each recording: the ratio of the rates with and without it, all
/// else equal.
Report feature_costs(const Settings& settings);

/// Measures the cost of samples of several kinds: the ratio of the rates of whole runs with and without them.
Report sample_costs(const Settings& settings);

#ifdef EVODEVO_CUDA
/// Compares the paper's baseline, the paper's method and our simulator.
Report baselines(const Settings& settings);

/// Measures the ratio of the rate with materials computed from codes to the rate with a table of materials, for bodies
/// of few and of many materials.
Report material_costs(const Settings& settings);

/// Measures the cost of recording stress: with the paper's method, for each of the ways of recording that the paper
/// tried, and with our simulator, for exact sums (paper, Figures 2 and 4).
Report stress_costs(const Settings& settings);

/// Measures what share of the 125 truly least and the 125 truly most stressed springs each of the paper's ways of
/// recording finds (paper, Figure 3).
Report tally_agreement(const Settings& settings);

/// Measures, without a GPU, how long the host takes for each stage of the lives of random robots that a GPU simulates.
Report host_work(const Settings& settings);

/// Measures how long the search for nearest neighbours in a population of random balls takes on CPU and GPU. Throws
/// std::runtime_error if their results differ.
Report neighbours(const Settings& settings);
#endif

}  // namespace evodevo::tools::bench
