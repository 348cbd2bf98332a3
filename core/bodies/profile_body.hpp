/// Bodies from a plane profile of lines and arcs: extruded across its plane, or turned about an axis in it.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/profile.hpp"
#include "core/geometry/solid.hpp"

namespace cgcontact {

/// From the plane of the frame on, by `height` along first x second; faces of the edges, and two ends. Throws
/// InputError for profiles that are not closed, cross themselves or have no area.
Solid extruded(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame, double height,
               const std::string& bottom, const std::string& top);

/// A whole turn about the second axis; first coordinates are >= 0. Arcs have their centres on the axis (others:
/// CadModel::revolved). Edges on the axis have no face. Throws InputError as above.
Solid revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame);

}  // namespace cgcontact
