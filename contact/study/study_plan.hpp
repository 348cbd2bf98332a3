/// Plan of a study's runs.
#pragma once

#include <vector>

#include "core/output/study/study_table.hpp"
#include "core/program/cli.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

struct StudyPlan {
  Study study;
  std::vector<Scene> scenes;  ///< one per row of the study
};

/// Reads the scene of every run, so that mistakes show before anything is run. Throws InputError.
StudyPlan plan_study(const CommandLine& line);

}  // namespace cgcontact
