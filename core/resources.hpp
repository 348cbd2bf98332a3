/// What this process has used so far.
#pragma once

namespace cgcontact {

/// Largest resident set, bytes.
long long peak_memory_bytes();

}  // namespace cgcontact
