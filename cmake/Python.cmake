# The Python module (python/), with pybind11 and the headers of the Python that end-to-end tests use. CGCONTACT_PYTHON_MODULE: ON
# if both are there; -DCGCONTACT_PYTHON_MODULE=ON insists on them, OFF does without.
set(Python_EXECUTABLE ${CGCONTACT_PYTHON})
find_package(Python QUIET COMPONENTS Interpreter Development)
set(found FALSE)
if(Python_FOUND)
  set(PYBIND11_FINDPYTHON ON)
  find_package(pybind11 QUIET CONFIG)
  set(found ${pybind11_FOUND})
endif()
if(CGCONTACT_SANITIZE OR CGCONTACT_THREAD_SANITIZER)  # Python itself would have to be built with them
  set(found FALSE)
endif()
option(CGCONTACT_PYTHON_MODULE "The Python module, with pybind11" ${found})
if(CGCONTACT_PYTHON_MODULE AND NOT found)
  message(FATAL_ERROR "CGCONTACT_PYTHON_MODULE is ON, and there is no pybind11 for ${CGCONTACT_PYTHON} (Debian: pybind11-dev, "
    "python3-dev), or sanitizers are asked for. Install them (scripts/install_dependencies.sh), or build without it: "
    "-DCGCONTACT_PYTHON_MODULE=OFF.")
endif()
set(CMAKE_POSITION_INDEPENDENT_CODE ${CGCONTACT_PYTHON_MODULE})  # the module is a shared library
