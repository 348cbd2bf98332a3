# Included by the build of Trilinos (scripts/build_trilinos_openmp.sh), at its project(): MueLu's and Ifpack2's explicit
# instantiations are compiled several at a time, in less than half of the CPU time; Tpetra's graphs and its matrices of integers,
# which set things up, with -O1 (the graph 21 instead of 47 s). g++'s garbage collection is put off as for our own code
# (some of MueLu's and Tpetra's instantiations in turns: 162 -> 147 s of user time, 0.4 GB more for each compiler).
add_compile_options($<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:--param=ggc-min-heapsize=524288>)  # KiB
function(cgcontact_trilinos_unity)
  foreach(macro MUELU_ETI_3ARGUMENT_HPP MUELU_ETI_4ARGUMENT_HPP MUELU_ETI_5ARGUMENT_HPP MUELU_ETI_GROUP)
    string(APPEND begin_muelu "#undef ${macro}\n")  # headers that are meant to be read once per instantiation
  endforeach()
  set(begin_ifpack2 "#undef LCLINST\n")
  foreach(target muelu ifpack2)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources EXCLUDE REGEX "/ExplicitInstantiation/MueLu_[^/]*\\.cpp$|/Ifpack2_[^/]*_OpenMP\\.cpp$")
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    set_source_files_properties(${sources} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8
      UNITY_BUILD_CODE_BEFORE_INCLUDE "${begin_${target}}")
  endforeach()
  get_target_property(sources tpetra SOURCES)  # relative to where they are made
  get_target_property(folder tpetra BINARY_DIR)
  list(FILTER sources INCLUDE REGEX "^Tpetra_.*_OPENMP\\.cpp$")
  list(FILTER sources INCLUDE REGEX "^Tpetra_((FE)?CrsGraph|Block)|_(INT|LONG_LONG)_INT_LONG_LONG_OPENMP")
  list(TRANSFORM sources PREPEND "${folder}/")
  set_source_files_properties(${sources} TARGET_DIRECTORY tpetra PROPERTIES COMPILE_OPTIONS -O1)
endfunction()
cmake_language(DEFER CALL cgcontact_trilinos_unity)
