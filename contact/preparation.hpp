/// A scene on its grids, checked: what `cgcontact check` shows, and what a run continues from.
#pragma once

#include <string>
#include <vector>

#include "contact/checks/memory.hpp"
#include "contact/model/contact_pairs.hpp"
#include "contact/motions/free_motion.hpp"

namespace cgcontact {

struct Preparation {
  std::vector<BodyModel> bodies;
  std::vector<ContactPair> pairs;
  std::vector<SupportPoint> supports;
  std::vector<std::string> warnings;
};

/// Throws InputError for a setting out of its range; the scene reader lets none pass, a program may set one.
void check_settings(const Scene& scene);

/// Throws InputError, also if the scene would clearly not fit into memory; refuse_near_limit: or by little, by an
/// estimate of a second or two. The two steps in one:
Preparation prepare(const Scene& scene, bool refuse_near_limit = true);
/// Prepares what can be drawn, whether the scene can be solved or not.
Preparation discretise(const Scene& scene, bool refuse_near_limit = true);
/// Checks that it can be solved; throws InputError; holds motions that no load drives.
void validate(const Scene& scene, Preparation& preparation);

/// Counts the rows of contact.csv: boundary points of the contact faces, in reach of the other body or not.
double count_contact_rows(const Preparation& preparation);

/// Returns, for the expected memory, points of the pairs and rows of the results.
MemoryExtras memory_extras(const Scene& scene, const Preparation& preparation);

/// Returns the memory that a run is expected to take. Throws InputError if it would not fit.
double check_memory(const Scene& scene, const Preparation& preparation);

}  // namespace cgcontact
