# cgcontact_end_to_end_tests(FOLDER): every test_*.sh and test_*.py in FOLDER becomes the test end_to_end.<name>. It runs in
# an empty directory of its own, with the built program and the source directory as arguments, and passes when it exits
# with 0. A line "# timeout: SECONDS" near its top replaces the 120 seconds that it may take on an idle machine; the
# limit is five times that, for machines that others use too (ten times as long with sanitizers, where
# CGCONTACT_SANITIZED is set). "# alone" keeps ctest from running other tests beside it, "# threads" on backends with
# threads only: most of its time is solved on all of them. "# backend: NAME" is for tests of that backend only. Exit code
# 77: skipped.
find_program(CGCONTACT_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)  # Debian's own: the one that has VTK
find_program(CGCONTACT_PYTHON python3)

function(cgcontact_end_to_end_tests folder)
  file(GLOB scripts CONFIGURE_DEPENDS ${folder}/test_*.sh ${folder}/test_*.py)
  foreach(script ${scripts})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${script})
    file(STRINGS ${script} backend REGEX "^# backend: " LIMIT_COUNT 1)
    if(backend AND NOT backend STREQUAL "# backend: ${CGCONTACT_BACKEND}")
      continue()
    endif()
    get_filename_component(name ${script} NAME_WE)
    string(REPLACE "test_" "" name ${name})
    if(script MATCHES "\\.py$")
      set(interpreter ${CGCONTACT_PYTHON})
    else()
      set(interpreter bash)
    endif()
    set(work_dir ${CMAKE_CURRENT_BINARY_DIR}/end_to_end/${name})
    add_test(NAME end_to_end.${name} WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
      COMMAND bash -c "rm -rf \"$1\" && mkdir -p \"$1\" && cd \"$1\" && shift && exec \"$@\"" _
        ${work_dir} ${interpreter} ${script} $<TARGET_FILE:cgcontact> ${CMAKE_SOURCE_DIR})
    file(STRINGS ${script} timeout REGEX "^# timeout: [0-9]+$" LIMIT_COUNT 1)
    string(REGEX MATCH "[0-9]+" timeout "${timeout};120")
    math(EXPR timeout "5 * ${timeout}")
    file(STRINGS ${script} alone REGEX "^# alone$" LIMIT_COUNT 1)
    set_tests_properties(end_to_end.${name} PROPERTIES LABELS end_to_end SKIP_RETURN_CODE 77)
    if(CGCONTACT_SANITIZE OR CGCONTACT_THREAD_SANITIZER)
      math(EXPR timeout "10 * ${timeout}")
      set(sanitizer address)
      if(CGCONTACT_THREAD_SANITIZER)
        set(sanitizer thread)
      endif()
      set_tests_properties(end_to_end.${name} PROPERTIES ENVIRONMENT CGCONTACT_SANITIZED=${sanitizer})
    endif()
    set_tests_properties(end_to_end.${name} PROPERTIES TIMEOUT ${timeout})
    file(STRINGS ${script} threads REGEX "^# threads$" LIMIT_COUNT 1)
    if(threads)
      set_tests_properties(end_to_end.${name} PROPERTIES PROCESSORS ${CGCONTACT_TEST_THREADS})
    endif()
    if(alone)
      set_tests_properties(end_to_end.${name} PROPERTIES RUN_SERIAL ON)
    endif()
  endforeach()
endfunction()
