/// Texts of the view that the build makes constants of the program (cmake/View.cmake).
#pragma once

namespace cgcontact {

extern const char* const three_library;   ///< three.js; empty: not there when the program was built
extern const char* const orbit_controls;  ///< turning by mouse and fingers, of its examples
extern const char* const view_script;     ///< view_sweep.js and those that follow it
extern const char* const view_controls;   ///< view.html
extern const char* const view_css;        ///< view.css

}  // namespace cgcontact
