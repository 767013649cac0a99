// Checks of the results that the studies claim.
#include "studies.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"

namespace evodevo::tools::accuracy::EVODEVO_FILE {
namespace {

Settings quick() {
  Settings settings;
  settings.quick = true;
  return settings;
}

TEST(Orders, AreThoseOfTheoryWithoutContactAndUpToTheSecondOnARigidFloor) {
  const Table found = orders(quick()).at(1);
  int smooth = 0, rigid = 0;
  for (std::size_t row = 0; row < found.rows().size(); ++row) {
    const std::string scene = found.text(row, "scene"), method = found.text(row, "method");
    const double theory = found.number(row, "order in theory");
    const bool is_smooth = found.text(row, "contact") != "yes";
    if (!is_smooth && (scene != "lattice dropped, rigid floor" || theory > 2 || !is_explicit(method_of(method))))
      continue;
    ++(is_smooth ? smooth : rigid);
    EXPECT_NEAR(found.number(row, "observed order"), theory, is_smooth ? 0.1 : 0.2) << scene << ", " << method;
  }
  EXPECT_EQ(smooth, 12);
  EXPECT_EQ(rigid, 3);
}

TEST(Beam, BendsAndSwingsAsEulerAndBernoulliSay) {
  const Table table = beam(quick()).front();
  double last_sum = 1;
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    const auto off = [&](const std::string& quantity) {
      return std::abs(table.number(row, quantity) / table.number(row, "Euler-Bernoulli " + quantity) - 1);
    };
    const double deflection = off("deflection (m)"), frequency = off("first frequency (Hz)");
    // theory neglects shear and the fixed width of the clamped end; both matter less for longer beams
    EXPECT_LT(deflection, 0.02) << row;
    EXPECT_LT(frequency, row == 0 ? 0.04 : 0.005) << row;
    EXPECT_LT(deflection + frequency, last_sum) << row;
    last_sum = deflection + frequency;
  }
}

TEST(Trials, HaveATruthThatTheSimulatorFinds) {
  struct Expected {
    Trial trial;
    double error;
  };
  for (const auto& [trial, error] :
       {Expected{spring_trial(), 1e-4}, Expected{beam_trial(), 1e-5}, Expected{lattice_trial(), 1e-3},
        Expected{swimmer_trial(), 1e-2}, Expected{drop_trial(), 1e-2}, Expected{slide_trial(), 1e-6},
        Expected{rigid_drop_trial(1e-5), 1e-3}, Expected{rigid_slide_trial(), 1e-6}}) {
    const Setting setting{Method::velocity_verlet, Precision::float64, 0.0005};
    const Traveller end = simulate(trial.body, trial.start, trial.scene, setting, trial.duration);
    ASSERT_TRUE(end.alive()) << trial.name;
    EXPECT_LT(trial.error(end.state), error) << trial.name;
    EXPECT_DOUBLE_EQ(trial.error(trial.start), 1) << trial.name;
  }
}

TEST(Energies, AreKeptByTheSymplecticMethodsAlone) {
  const Table table = energies(quick()).front();
  std::size_t row = 0;
  for (const Method method : all_methods())
    for (int precision = 0; precision < 2; ++precision) {
      double last = 0;
      for (;
           row < table.rows().size() && table.text(row, "method") == name(method) && table.number(row, "steps") > last;
           ++row)
        last = table.number(row, "steps");
      const double kept = table.number(row - 1, "energy (of the first)");
      EXPECT_EQ(last, 3e4);
      if (method == Method::rk4)
        EXPECT_TRUE(kept > 0.3 && kept < 0.9) << kept;
      else if (is_explicit(method))
        EXPECT_NEAR(kept, 1, 0.1) << name(method);
      else
        EXPECT_LT(kept, 0.1) << name(method);
    }
  EXPECT_EQ(row, table.rows().size());
}

}  // namespace
}  // namespace evodevo::tools::accuracy::EVODEVO_FILE
