/// What a study is going to run.
#pragma once

#include <vector>

#include "core/cli.hpp"
#include "core/scene.hpp"
#include "core/study_table.hpp"

namespace cgcontact {

struct StudyPlan {
  Study study;
  std::vector<Scene> scenes;  ///< one per row of the study
};

/// Reads the scene of every run, so that mistakes show before anything is run. Throws InputError.
StudyPlan plan_study(const CommandLine& line);

}  // namespace cgcontact
