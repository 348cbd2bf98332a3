# Compile through ccache where there is one. With -march=native the meaning of the same command line depends on the
# machine, so what the compiler makes of it here is part of the key. Files that use precompiled headers are cached only if
# ccache may take it that they do not ask for the time and that the macros of the command line are those of the headers.
# Where the sources and the build lie does not matter: what a build of the other backend, or one in another clone, has
# compiled with the same command is taken from it.
find_program(CGCONTACT_CCACHE ccache)
mark_as_advanced(CGCONTACT_CCACHE)
if(CGCONTACT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -v ERROR_VARIABLE version OUTPUT_QUIET)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=native -Q --help=target OUTPUT_VARIABLE target ERROR_QUIET)
  string(MD5 key "${version}${target}")
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_COMPILERCHECK=string:${key}
    CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CGCONTACT_CCACHE})
endif()
