# cgcontact_unit_tests(PROGRAM PREFIX PROPERTY VALUE...): each suite of a GoogleTest program becomes the test PREFIX.SUITE
# of ctest: one start of the program per suite instead of one per test. The built program is asked for its suites, so that
# none is missed. Exit code 77: a test of the suite was skipped.
function(cgcontact_unit_tests program prefix)
  set(list ${CMAKE_CURRENT_BINARY_DIR}/${program}_suites.cmake)
  list(JOIN ARGN " " properties)
  add_custom_command(TARGET ${program} POST_BUILD VERBATIM BYPRODUCTS ${list}
    COMMAND ${CMAKE_COMMAND} -D program=$<TARGET_FILE:${program}> -D prefix=${prefix} -D "properties=${properties}"
      -D list=${list} -P ${CMAKE_SOURCE_DIR}/cmake/UnitTests.cmake)
  set(include_list ${CMAKE_CURRENT_BINARY_DIR}/${program}_tests.cmake)
  file(WRITE ${include_list} "if(EXISTS \"${list}\")\n  include(\"${list}\")\nelse()\n"
    "  add_test(${prefix}.NOT_BUILT ${program})\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include_list})
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE output RESULT_VARIABLE result TIMEOUT 300)
  string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${output}")  # "Suite." or "Instance/Suite.  # type"
  if(NOT result EQUAL 0 OR NOT suites)
    message(FATAL_ERROR "${program} --gtest_list_tests: ${result}, no suite")
  endif()
  set(text "")
  foreach(suite ${suites})
    string(REGEX REPLACE "[\n.]" "" suite ${suite})
    string(APPEND text "add_test(${prefix}.${suite} \"${program}\" \"--gtest_filter=${suite}.*\")\n"
      "set_tests_properties(${prefix}.${suite} PROPERTIES SKIP_RETURN_CODE 77 ${properties})\n")
  endforeach()
  file(WRITE ${list} "${text}")
endif()
