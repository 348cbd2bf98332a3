# cmake --install BUILD --prefix PREFIX: program, library, headers, scenes, documents, manual page, completion, and the CMake
# package that makes find_package(cgcontact) and the target cgcontact::cgcontact work.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cgcontact)

# Headers refer to each other as "cgcontact/core/scene/scene.hpp", so that a user's own core/ cannot come between. Those that read
# scenes, TOML and the command line are ours alone.
set(header_dir ${CMAKE_INSTALL_INCLUDEDIR}/cgcontact)
set(staged ${CMAKE_BINARY_DIR}/installed_headers)
foreach(folder core kernels recovery contact)
  file(GLOB_RECURSE headers RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS ${folder}/*.hpp)
  list(FILTER headers EXCLUDE REGEX "toml_cursor|scene_(copies|overrides|reader|shapes|profiles|materials|mesh|cad)|cad_shape|cli\\.hpp|contact/study")
  list(APPEND public_headers ${headers})
endforeach()
install(CODE "set(source_dir \"${CMAKE_SOURCE_DIR}\")\nset(headers \"${public_headers}\")\nset(staged \"${staged}\")")
install(SCRIPT ${CMAKE_SOURCE_DIR}/cmake/StageHeaders.cmake)
install(DIRECTORY ${staged}/ DESTINATION ${header_dir})

# How Eigen aligns its fixed-size types depends on the vector units that a file is compiled for (-march=native: 32 or 64 bytes,
# else 16). A program compiled otherwise would disagree with the library about the layout of structs and about what may
# be read with aligned instructions. -march=native itself must not reach other people's programs; so the exported
# target pins the one macro that decides the layout, to the library's value, and cgcontact.hpp refuses any other.
set(probe ${CMAKE_BINARY_DIR}/eigen_alignment.cpp)
file(WRITE ${probe} "#include <Eigen/Core>\ncgcontact_alignment EIGEN_MAX_STATIC_ALIGN_BYTES\n")
get_target_property(eigen_include Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
separate_arguments(flags NATIVE_COMMAND "${CMAKE_CXX_FLAGS}")
if(CGCONTACT_NATIVE)
  list(APPEND flags -march=native)
endif()
execute_process(COMMAND ${CMAKE_CXX_COMPILER} -std=c++17 ${flags} -I${eigen_include} -E -P ${probe}
  OUTPUT_VARIABLE preprocessed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "cgcontact_alignment ([0-9]+)" ignored "${preprocessed}")
set(CGCONTACT_EIGEN_ALIGNMENT "${CMAKE_MATCH_1}")
if(NOT CGCONTACT_EIGEN_ALIGNMENT)
  message(FATAL_ERROR "The alignment of Eigen's types could not be found out.")
endif()
target_compile_definitions(cgcontact_core
  INTERFACE $<INSTALL_INTERFACE:EIGEN_MAX_STATIC_ALIGN_BYTES=${CGCONTACT_EIGEN_ALIGNMENT}>)
configure_file(cmake/cgcontact.hpp.in ${CMAKE_BINARY_DIR}/cgcontact.hpp @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/cgcontact.hpp DESTINATION ${header_dir})

# Libraries: a program links cgcontact::cgcontact, which brings the others.
set(libraries cgcontact_core cgcontact_kernels cgcontact_recovery cgcontact_contact)
foreach(library ${libraries})
  string(REPLACE cgcontact_ "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${library} INTERFACE $<INSTALL_INTERFACE:cxx_std_17>)
  target_include_directories(${library} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endforeach()
set_target_properties(cgcontact_contact PROPERTIES EXPORT_NAME cgcontact)
set_target_properties(cgcontact PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)  # a Trilinos of one's own
install(TARGETS cgcontact)
if(CGCONTACT_CAD)  # a program looks beside itself, one of somebody else where it is told to
  install(TARGETS cgcontact_cad LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cgcontact)
  target_link_options(cgcontact_core INTERFACE
    $<INSTALL_INTERFACE:-Wl,-rpath,$<INSTALL_PREFIX>/${CMAKE_INSTALL_LIBDIR}/cgcontact>)
endif()
install(TARGETS ${libraries} EXPORT cgcontactTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT cgcontactTargets NAMESPACE cgcontact:: DESTINATION ${package_dir})
configure_package_config_file(cmake/cgcontactConfig.cmake.in ${CMAKE_BINARY_DIR}/cgcontactConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/cgcontactConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/cgcontactConfig.cmake ${CMAKE_BINARY_DIR}/cgcontactConfigVersion.cmake
  cmake/TrilinosTarget.cmake DESTINATION ${package_dir})

# What a user reads.
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/cgcontact)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png"
  PATTERN man EXCLUDE)
install(FILES docs/man/cgcontact.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES scripts/completion/cgcontact.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME cgcontact)
