/// Runs scenes without output; how far their fields are from known ones.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "contact/simulation.hpp"
#include "core/scene_file/read_scene.hpp"

namespace cgcontact::test {

struct SolvedScene {
  Scene scene;
  std::unique_ptr<Simulation> simulation;
  const Results& results() const { return simulation->results; }
};

inline std::unique_ptr<SolvedScene> run(Scene scene) {
  auto solved = std::make_unique<SolvedScene>();
  solved->scene = std::move(scene);
  solved->simulation = std::make_unique<Simulation>(solved->scene);
  solved->simulation->run({});
  return solved;
}

/// Solves a scene of the repository; path from its root.
inline std::unique_ptr<SolvedScene> run_scene(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return run(read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/" + name, overrides));
}

/// Solvers converged far below the bounds of tests with exact answers.
inline const std::vector<std::string> tight{"solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"};

/// The same where supports and contact carry nothing: rounding is then all that the outer iteration has to converge to.
inline const std::vector<std::string> tight_without_forces{"solver.tolerance=1e-8", "solver.linear_tolerance=1e-15"};

/// Solves a scene given as text.
inline std::unique_ptr<SolvedScene> run_text(const std::string& text,
                                             const std::vector<std::string>& overrides = tight) {
  return run(parse_scene(text, "scene.toml", overrides));
}

/// The largest ones from known fields, at the centre and near a corner of every cell of the first body.
struct Differences {
  double raw = 0, recovered = 0, displacement = 0;  ///< Pa, Pa, m
};

template <class Stress, class Displacement>
Differences differences(const Results& results, const Stress& stress, const Displacement& displacement) {
  Differences largest;
  const BodyFields& body = results.bodies[0];
  for (int c = 0; c < static_cast<int>(body.cut_cells->cells.size()); ++c)
    for (const Vec3& xi : {Vec3(0, 0, 0), Vec3(-0.9, 0.8, 0.7)}) {
      const Vec3 x = global_position(*body.cut_cells, c, xi);
      largest.raw = std::max(largest.raw, (body.stress_raw(c, xi) - stress(x)).norm());
      largest.recovered = std::max(largest.recovered, (body.stress_recovered(c, xi) - stress(x)).norm());
      largest.displacement = std::max(largest.displacement, (body.displacement(c, xi) - displacement(x)).norm());
    }
  return largest;
}

inline const ZoneError& zone(const Results& results, const std::string& name) {
  for (const ZoneError& z : results.pressure_errors)
    if (z.zone == name) return z;
  throw std::logic_error("no zone " + name);
}

}  // namespace cgcontact::test
