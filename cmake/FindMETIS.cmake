# Imported target METIS::METIS.
include(FindPackageHandleStandardArgs)
find_path(METIS_INCLUDE_DIR metis.h)
find_library(METIS_LIBRARY metis)

if(METIS_INCLUDE_DIR)
  file(STRINGS "${METIS_INCLUDE_DIR}/metis.h" lines
       REGEX "^#define METIS_VER_(MAJOR|MINOR|SUBMINOR)[ \t]+[0-9]+")
  string(REGEX MATCHALL "R[ \t]+[0-9]+" numbers "${lines}")
  string(REGEX REPLACE "R[ \t]+" "" numbers "${numbers}")
  string(REPLACE ";" "." METIS_VERSION "${numbers}")
endif()

find_package_handle_standard_args(METIS REQUIRED_VARS METIS_LIBRARY METIS_INCLUDE_DIR
                                  VERSION_VAR METIS_VERSION)
if(METIS_FOUND AND NOT TARGET METIS::METIS)
  add_library(METIS::METIS UNKNOWN IMPORTED)
  set_target_properties(METIS::METIS PROPERTIES
    IMPORTED_LOCATION "${METIS_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${METIS_INCLUDE_DIR}")
endif()
mark_as_advanced(METIS_LIBRARY METIS_INCLUDE_DIR)
