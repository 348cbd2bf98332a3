/// What a run tells its caller while it works.
#pragma once

#include <functional>
#include <string>

#include "contact/solve/outer_loop.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Called when a phase starts, before the solve with the memory (bytes) that the run is expected to take, after every
/// outer iteration, and after each step of [steps] but the last one, with its number from 0, its fields, contact rows
/// and pairs, valid until the next step begins.
struct ProgressCallbacks {
  std::function<void(const std::string& phase)> phase = [](const std::string&) {};
  std::function<void(double expected)> memory = [](double) {};
  std::function<void(const OuterStep&)> step = [](const OuterStep&) {};
  std::function<void(std::size_t number, const Results&)> load_step = [](std::size_t, const Results&) {};
};

}  // namespace cgcontact
