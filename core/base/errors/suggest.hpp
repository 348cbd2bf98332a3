/// "Did you mean ...?" for misspelt names.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

/// Counts the insertions, deletions, replacements and swaps of neighbours that turn one word into the other.
int edit_distance(const std::string& a, const std::string& b);

/// Returns the candidate closest to the word, or "" if none is similar.
std::string closest_name(const std::string& word, const std::vector<std::string>& candidates);

/// " (did you mean "name"?)" or "" if no candidate is similar.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

/// Joins words: "a, b, c".
std::string join(const std::vector<std::string>& words, const std::string& separator = ", ");

}  // namespace cgcontact
