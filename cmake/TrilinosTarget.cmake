# cgcontact::trilinos: Trilinos with what it needs, for this build and for programs that use the installed library. An imported
# target: its headers, which warn under C++17, are system headers. Debian's configuration does not bring MPI.
add_library(cgcontact::trilinos INTERFACE IMPORTED GLOBAL)
target_include_directories(cgcontact::trilinos SYSTEM INTERFACE ${Trilinos_INCLUDE_DIRS} ${Trilinos_TPL_INCLUDE_DIRS})
target_link_options(cgcontact::trilinos INTERFACE -Wl,--as-needed)  # Trilinos names every package it has
target_link_libraries(cgcontact::trilinos INTERFACE ${Trilinos_LIBRARIES} ${Trilinos_TPL_LIBRARIES} MPI::MPI_CXX)
