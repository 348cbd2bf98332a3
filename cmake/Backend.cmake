# Which Trilinos: Debian's (Kokkos Serial), or one built with Kokkos OpenMP: in CGCONTACT_TRILINOS_PREFIX, or where
# `make trilinos-openmp` puts it.
set(CGCONTACT_BACKEND serial CACHE STRING "serial or openmp")
set_property(CACHE CGCONTACT_BACKEND PROPERTY STRINGS serial openmp)
set(CGCONTACT_TRILINOS_PREFIX "" CACHE PATH "openmp only: where a Trilinos with OpenMP is installed (or in the environment)")

if(CGCONTACT_BACKEND STREQUAL openmp)
  set(trilinos_prefix "${CGCONTACT_TRILINOS_PREFIX}")
  if(NOT trilinos_prefix)
    set(trilinos_prefix "$ENV{CGCONTACT_TRILINOS_PREFIX}")
  endif()
  if(NOT trilinos_prefix)
    execute_process(COMMAND ${CMAKE_SOURCE_DIR}/scripts/build_trilinos_openmp.sh --prefix
      OUTPUT_VARIABLE trilinos_prefix OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE not_built)
    if(not_built)
      message(FATAL_ERROR "The openmp backend needs a Trilinos that was built with OpenMP; Debian's was not. "
        "\"make trilinos-openmp\" builds one (once, about 45 minutes of CPU time) in ${trilinos_prefix}; "
        "or say where you have one with the environment or CMake variable CGCONTACT_TRILINOS_PREFIX (docs/setup.md).")
    endif()
  endif()
  file(GLOB trilinos_config "${trilinos_prefix}/lib*/cmake/Trilinos/TrilinosConfig.cmake"
    "${trilinos_prefix}/lib/*/cmake/Trilinos/TrilinosConfig.cmake")
  if(NOT trilinos_config)
    message(FATAL_ERROR "CGCONTACT_TRILINOS_PREFIX is \"${trilinos_prefix}\": "
      "there is no lib/cmake/Trilinos/TrilinosConfig.cmake in it. The openmp backend needs a Trilinos that was built "
      "with OpenMP (\"make trilinos-openmp\", docs/setup.md).")
  endif()
  list(GET trilinos_config 0 trilinos_config)
  get_filename_component(trilinos_config "${trilinos_config}" DIRECTORY)
  set(Trilinos_DIR "${trilinos_config}" CACHE PATH "" FORCE)
elseif(NOT CGCONTACT_BACKEND STREQUAL serial)
  message(FATAL_ERROR "CGCONTACT_BACKEND is \"${CGCONTACT_BACKEND}\": expected serial or openmp.")
endif()

# Once Trilinos has been found: does it have the execution space asked for? Adds what its users need to TARGET.
function(cgcontact_use_backend target)
  if(CGCONTACT_BACKEND STREQUAL openmp)
    find_file(config KokkosCore_config.h PATHS ${Trilinos_INCLUDE_DIRS} ${trilinos_prefix}/include NO_DEFAULT_PATH NO_CACHE)
    if(config)
      file(STRINGS ${config} enabled REGEX "^#define KOKKOS_ENABLE_OPENMP$")
    endif()
    if(NOT enabled)
      message(FATAL_ERROR "The Trilinos in ${trilinos_prefix} was built without OpenMP (Trilinos_ENABLE_OpenMP).")
    endif()
    find_package(OpenMP REQUIRED COMPONENTS CXX)
    target_link_libraries(${target} INTERFACE OpenMP::OpenMP_CXX)
  endif()
endfunction()
