#include "core/output/view/view_page.hpp"

#include <fmt/format.h>

#include "core/base/files/text.hpp"
#include "core/output/view/packed_values.hpp"
#include "core/output/view/view_assets.hpp"

namespace cgcontact {

namespace {

/// The licence of three.js and OrbitControls goes with every copy.
constexpr const char* licence = R"(/*
three.js r111 and its OrbitControls. The MIT License. Copyright (c) 2010-2019 three.js authors

Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit
persons to whom the Software is furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all copies or substantial portions of the
Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
*/
)";

/// Writes a script that is XML as well.
std::string script(const std::string& text) { return "<script>//<![CDATA[\n" + text + "\n//]]></script>\n"; }

}  // namespace

bool has_view_library() { return three_library[0] != '\0'; }

std::string view_content(const ViewData& data) {
  if (!data.wanted) return "";
  if (!has_view_library())
    return "<p class=\"note\">This program was built without the library that draws a view to turn (three.js); the "
           "pictures below show the result.</p>\n";
  if (data.json.empty()) return "";
  std::string text = view_controls;
  text += fmt::format(
      "<p class=\"note\">{}Values and places are rounded to 1/{} of their range in a body; a colour or value between "
      "points is linear. Contact pressures are fitted to those of contact.csv around a point, the largest one is "
      "exact. "
      "The file works without a network.</p>\n",
      html_text(data.left_out), packed_steps);
  text += "<script type=\"application/json\" id=\"view-data\">" + data.json + "</script>\n";
  return text + script(licence + std::string(three_library)) + script(orbit_controls) +
         script("(function () {\n\"use strict\";\n" + std::string(view_script) + "})();");
}

std::string view_style(const ViewData& data) {
  return data.json.empty() || !has_view_library() ? "" : std::string(view_css);
}

}  // namespace cgcontact
