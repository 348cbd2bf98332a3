/// `cgcontact study`: runs a scene over sizes and variants, each run in a process of its own.
#pragma once

#include "core/program/cli.hpp"

namespace cgcontact {

/// Returns the exit code: 0 all runs solved, 2 some did not (the table says which), 128 + signal when the user stopped
/// it (what has finished is written). Throws InputError before anything is run.
int run_study(const CommandLine& line);

}  // namespace cgcontact
