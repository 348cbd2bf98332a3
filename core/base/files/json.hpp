/// JSON whose objects keep the order in which their entries were added.
#pragma once

#include <nlohmann/json.hpp>

namespace cgcontact {

using Json = nlohmann::ordered_json;

}  // namespace cgcontact
