/// Runs a scene of the repository (path from its root) with overrides, without output.
#pragma once

#include <memory>

#include "contact/simulation.hpp"
#include "core/scene/read_scene.hpp"

namespace cgcontact::test {

struct SolvedScene {
  Scene scene;
  std::unique_ptr<Simulation> simulation;
  const Results& results() const { return simulation->results; }
};

inline std::unique_ptr<SolvedScene> run_scene(const std::string& name, const std::vector<std::string>& overrides = {}) {
  auto solved = std::make_unique<SolvedScene>();
  solved->scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/" + name, overrides);
  solved->simulation = std::make_unique<Simulation>(solved->scene);
  solved->simulation->run({});
  return solved;
}

inline const ZoneError& zone(const Results& results, const std::string& name) {
  for (const ZoneError& z : results.pressure_errors)
    if (z.zone == name) return z;
  throw std::logic_error("no zone " + name);
}

}  // namespace cgcontact::test
