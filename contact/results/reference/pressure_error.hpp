/// Error of the pressure on the contact faces against a reference.
#pragma once

#include <functional>
#include <vector>

#include "core/results/results.hpp"

namespace cgcontact {

/// Errors over the whole face (first entry, "whole") and each zone, all relative to the L2 norm of the reference over
/// the whole face. `reference`: Pa, at a row. Zones without a row are left out; empty if the reference is zero in all.
std::vector<ZoneError> pressure_errors(const std::vector<ContactRow>& rows,
                                       const std::function<double(const ContactRow&)>& reference,
                                       const std::vector<std::pair<std::string, Expression>>& zones);

}  // namespace cgcontact
