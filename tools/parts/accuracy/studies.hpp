// The available studies. Each study returns the tables from which its charts are drawn.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "common/table.hpp"
#include "settings.hpp"

namespace evodevo::tools::accuracy {

/// The error and the cost of each method, precision and dt, in scenes with a reference solution.
std::vector<Table> work_precision(const Settings& settings);

/// The deflection and the first frequency of a beam, compared with those of Euler-Bernoulli theory.
std::vector<Table> beam(const Settings& settings);

/// How well the fitness ranking of random robots agrees with that of the reference, for each setting and for coarser
/// bodies.
std::vector<Table> ranking(const Settings& settings);

/// The error of each method against dt, and the observed order of convergence.
std::vector<Table> orders(const Settings& settings);

/// How the energy of a body without damping or drag changes with each method.
std::vector<Table> energies(const Settings& settings);

/// The largest stable dt of each method compared with theory, the change of energy by contact, and the share of random
/// bodies that diverge.
std::vector<Table> stability(const Settings& settings);

/// The computing time that each part of a scene adds.
std::vector<Table> features(const Settings& settings);

struct Study {
  std::string_view name;
  std::vector<Table> (*run)(const Settings&);
};

inline constexpr std::array<Study, 7> studies = {{{"work-precision", work_precision},
                                                  {"beam", beam},
                                                  {"ranking", ranking},
                                                  {"orders", orders},
                                                  {"energy", energies},
                                                  {"stability", stability},
                                                  {"features", features}}};

}  // namespace evodevo::tools::accuracy
