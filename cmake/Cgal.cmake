# CGAL, which repairs triangle surfaces and cuts them with other bodies. CGCONTACT_CGAL: ON if it is there; -DCGCONTACT_CGAL=ON
# insists on it, -DCGCONTACT_CGAL=OFF does without (its mesh processing is under the GPL: docs/licences.md).
find_package(CGAL QUIET)
option(CGCONTACT_CGAL "Repair and cut triangle surfaces with CGAL" ${CGAL_FOUND})
if(CGCONTACT_CGAL AND NOT CGAL_FOUND)
  message(FATAL_ERROR "CGCONTACT_CGAL is ON, and there is no CGAL (Debian: libcgal-dev). "
    "Install it (scripts/install_dependencies.sh), or do without repairs and booleans of triangle surfaces: -DCGCONTACT_CGAL=OFF.")
endif()
