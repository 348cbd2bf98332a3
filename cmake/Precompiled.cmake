# cgcontact_precompile(TARGET HEADER...): these headers of others and those of the standard library that most files see are
# compiled once for all files of TARGET; cgcontact_precompiled_as(TARGET OTHER) takes those of OTHER, which has the same flags.
# A file includes what it needs all the same: without precompiled headers (-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON) everything
# compiles as well. ccache: cmake/Ccache.cmake.
function(cgcontact_precompile target)
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <filesystem> <functional> <limits> <map> <memory>
    <numeric> <optional> <string> <tuple> <utility> <vector> ${ARGN})
endfunction()

function(cgcontact_precompiled_as target other)
  target_precompile_headers(${target} REUSE_FROM ${other})
  get_target_property(type ${target} TYPE)
  if(CMAKE_POSITION_INDEPENDENT_CODE AND type STREQUAL EXECUTABLE)  # as the library that has them, not -fPIE
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIC)
  endif()
endfunction()
