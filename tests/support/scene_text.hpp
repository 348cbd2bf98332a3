/// Sections of scene files, for tests.
#pragma once

#include <string>
#include <vector>

namespace cgcontact::test {

/// Makes the section of a box of steel; `more`: further keys of the body.
inline std::string box_text(const std::string& name, const std::string& min, const std::string& max, double cell_size,
                            const std::string& more = "") {
  return "[[body]]\nname = \"" + name + "\"\nshape = {box = {min = " + min + ", max = " + max +
         "}}\nmaterial = {E = 200e9, nu = 0.3}\ncell_size = " + std::to_string(cell_size) + "\n" + more;
}

/// Grid that fits no box.
inline const std::string turned_grid = "grid = {offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}\n";

inline std::string support_text(const std::string& face, const std::string& held) {
  return "[[support]]\nface = \"" + face + "\"\n" + held + "\n";
}

inline std::string symmetry_text(const std::vector<std::string>& faces) {
  std::string text;
  for (const std::string& face : faces) text += support_text(face, "symmetry = true");
  return text;
}

inline std::string contact_text(const std::string& first, const std::string& second) {
  return "[[contact]]\nfaces = [\"" + first + "\", \"" + second + "\"]\n";
}

/// Makes the sections of a bar of 0.5 x 0.4 x 1 m, which is pulled along z to a strain of 0.1 %.
inline std::string pulled_bar_text() {
  return box_text("bar", "[0, 0, 0]", "[0.5, 0.4, 1]", 0.13, turned_grid) +
         "[[load]]\nface = \"bar.z+\"\npressure = -200e6\n" + symmetry_text({"bar.x-", "bar.y-", "bar.z-"});
}

}  // namespace cgcontact::test
