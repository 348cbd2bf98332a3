/// The view's section of report.html: its controls, its style sheet, its script and the library that draws.
#pragma once

#include <cstddef>
#include <string>

namespace cgcontact {

struct ViewData {
  bool wanted = false;      ///< by the scene
  std::string json;         ///< empty: no view
  std::string left_out;     ///< what it has not, in words for the page; empty: nothing
  std::string alternative;  ///< the result in words
};

/// Bytes of the pictures on a page beside a view, so that it stays below 5 MB.
constexpr std::size_t pictures_beside_view = 1400000;

/// Tells whether the program was built with the library three.js (Debian's libjs-three).
bool has_view_library();

/// Writes the section's content, well-formed XML; the scripts come with it.
std::string view_content(const ViewData& data);
/// Style sheet of the view; empty where there is none.
std::string view_style(const ViewData& data);

}  // namespace cgcontact
