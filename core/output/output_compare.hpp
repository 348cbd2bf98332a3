/// Two results side by side: what `cgcontact compare` prints and writes.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

struct Comparison {
  std::string text;                   ///< for the terminal
  std::vector<std::string> files;     ///< written
  std::vector<std::string> warnings;  ///< pictures that could not be drawn
};

/// Compares the figures that both results have, and, if `out` is not empty, writes them there as compare.csv and the
/// pressure along common paths as compare_PAIR.svg. Throws InputError if a directory holds no result, or if the two
/// have neither a contact pair nor a body in common.
Comparison compare_results(const std::string& first, const std::string& second, const std::string& out);

}  // namespace cgcontact
