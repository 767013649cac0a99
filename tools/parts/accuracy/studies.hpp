// What can be studied. Each study gives the tables that its charts are drawn from.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "common/table.hpp"
#include "settings.hpp"

namespace evodevo::tools::accuracy {

/// The error of each method, precision and dt over its cost, in scenes whose outcome is known.
std::vector<Table> work_precision(const Settings& settings);

/// A beam's deflection and first frequency against those of Euler and Bernoulli.
std::vector<Table> beam(const Settings& settings);

/// How well each setting, and each coarser body, ranks random robots.
std::vector<Table> ranking(const Settings& settings);

/// The error of each method over dt, and the order that it shows.
std::vector<Table> orders(const Settings& settings);

/// What each method does to the energy of a body that nothing slows down.
std::vector<Table> energies(const Settings& settings);

/// The largest dt of each method against theory, what contact does to energy, and how many random bodies diverge.
std::vector<Table> stability(const Settings& settings);

/// What each part of a scene costs.
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
