# Which Trilinos: Debian's (Kokkos Serial), or one built with Kokkos OpenMP in CGCONTACT_TRILINOS_PREFIX.
set(CGCONTACT_BACKEND serial CACHE STRING "serial or openmp")
set_property(CACHE CGCONTACT_BACKEND PROPERTY STRINGS serial openmp)
set(CGCONTACT_TRILINOS_PREFIX "" CACHE PATH "openmp only: where a Trilinos with OpenMP is installed (or in the environment)")

if(CGCONTACT_BACKEND STREQUAL openmp)
  set(trilinos_prefix "${CGCONTACT_TRILINOS_PREFIX}")
  if(NOT trilinos_prefix)
    set(trilinos_prefix "$ENV{CGCONTACT_TRILINOS_PREFIX}")
  endif()
  if(NOT trilinos_prefix)
    message(FATAL_ERROR "The openmp backend needs a Trilinos 13.2 that was built with OpenMP; Debian's was not. "
      "Say where it is installed with the environment or CMake variable CGCONTACT_TRILINOS_PREFIX (docs/setup.md).")
  endif()
  if(NOT EXISTS "${trilinos_prefix}/lib/cmake/Trilinos/TrilinosConfig.cmake")
    message(FATAL_ERROR "CGCONTACT_TRILINOS_PREFIX is \"${trilinos_prefix}\": "
      "there is no lib/cmake/Trilinos/TrilinosConfig.cmake in it. The openmp backend needs a Trilinos 13.2 that was built "
      "with OpenMP (docs/setup.md).")
  endif()
  set(Trilinos_DIR "${trilinos_prefix}/lib/cmake/Trilinos" CACHE PATH "" FORCE)
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
