# OpenCASCADE, which reads CAD files (STEP, IGES, BREP). CGCONTACT_CAD: ON if it is there; -DCGCONTACT_CAD=ON insists on it,
# -DCGCONTACT_CAD=OFF does without.
include(GNUInstallDirs)
find_package(OpenCASCADE QUIET CONFIG)
if(OpenCASCADE_FOUND AND OpenCASCADE_VERSION VERSION_LESS 7.6)
  set(OpenCASCADE_FOUND FALSE)
endif()
option(CGCONTACT_CAD "Read CAD files with OpenCASCADE" ${OpenCASCADE_FOUND})
if(CGCONTACT_CAD)
  if(NOT OpenCASCADE_FOUND)
    message(FATAL_ERROR "CGCONTACT_CAD is ON, and there is no OpenCASCADE 7.6 or later (Debian: libocct-data-exchange-dev). "
      "Install it (scripts/install_dependencies.sh), or build without CAD files: -DCGCONTACT_CAD=OFF.")
  endif()
  # Those that our files call, which bring the others. As files: the targets name libraries that only programs that draw need.
  set(toolkits TKXDESTEP TKXDEIGES TKXCAF TKLCAF TKCDF TKSTEP TKIGES TKXSBase TKMesh TKBO TKPrim TKShHealing TKTopAlgo TKGeomBase
    TKG3d TKG2d TKBRep TKMath TKernel)
  foreach(toolkit ${toolkits})
    get_target_property(library ${toolkit} LOCATION)
    list(APPEND CGCONTACT_CAD_LIBRARIES ${library})
  endforeach()
endif()
