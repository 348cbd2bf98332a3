# The view of report.html in three dimensions: three.js of Debian's libjs-three and our own script become text of the program
# (core/output/view/view_assets.hpp). Without the package the pages have pictures only, and say so.
find_file(CGCONTACT_THREE three.min.js PATHS /usr/share/javascript/three NO_DEFAULT_PATH)
find_file(CGCONTACT_ORBIT_CONTROLS OrbitControls.js PATHS /usr/share/javascript/three/examples/js/controls NO_DEFAULT_PATH)
if(NOT CGCONTACT_THREE OR NOT CGCONTACT_ORBIT_CONTROLS)
  message(STATUS "three.js was not found (Debian package libjs-three): report.html will have pictures, but no view to turn")
endif()

# cgcontact_view_assets(TARGET): adds the generated source.
function(cgcontact_view_assets target)
  set(folder ${CMAKE_SOURCE_DIR}/core/output/view)
  set(scripts sweep data drawing camera reading controls)  # one after the other
  list(TRANSFORM scripts REPLACE "(.+)" "${folder}/view_\\1.js")
  string(REPLACE ";" "," joined "${scripts}")
  set(texts view_script=${joined} view_controls=${folder}/view.html view_css=${folder}/view.css)
  if(CGCONTACT_THREE AND CGCONTACT_ORBIT_CONTROLS)
    list(APPEND texts three_library=${CGCONTACT_THREE} orbit_controls=${CGCONTACT_ORBIT_CONTROLS})
  else()
    list(APPEND texts three_library= orbit_controls=)
  endif()
  string(REGEX REPLACE "[^;]*=" "" files "${texts}")
  string(REPLACE "," ";" files "${files}")
  list(REMOVE_ITEM files "")
  set(source ${CMAKE_BINARY_DIR}/view_assets.cpp)
  add_custom_command(OUTPUT ${source} VERBATIM
    COMMAND ${CMAKE_COMMAND} "-DTEXTS=${texts}" -DOUTPUT=${source} -P ${CMAKE_SOURCE_DIR}/cmake/EmbedTexts.cmake
    DEPENDS ${files} ${CMAKE_SOURCE_DIR}/cmake/EmbedTexts.cmake
    COMMENT "Embedding the view of report.html")
  target_sources(${target} PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
endfunction()
