# Imported targets SuiteSparse::CHOLMOD and SuiteSparse::UMFPACK (versions 5 to 7).
include(FindPackageHandleStandardArgs)
find_path(SuiteSparse_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
set(SuiteSparse_REQUIRED SuiteSparse_INCLUDE_DIR)
foreach(part CHOLMOD UMFPACK)
  string(TOLOWER ${part} name)
  find_library(SuiteSparse_${part}_LIBRARY ${name})
  list(APPEND SuiteSparse_REQUIRED SuiteSparse_${part}_LIBRARY)
endforeach()

if(SuiteSparse_INCLUDE_DIR)
  file(STRINGS "${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h" lines
       REGEX "^#define SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION +[0-9]+")
  string(REGEX MATCHALL "VERSION +[0-9]+" numbers "${lines}")
  string(REGEX REPLACE "VERSION +" "" numbers "${numbers}")
  string(REPLACE ";" "." SuiteSparse_VERSION "${numbers}")
endif()

find_package_handle_standard_args(SuiteSparse REQUIRED_VARS ${SuiteSparse_REQUIRED}
                                  VERSION_VAR SuiteSparse_VERSION)
foreach(part CHOLMOD UMFPACK)
  if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::${part})
    add_library(SuiteSparse::${part} UNKNOWN IMPORTED)
    set_target_properties(SuiteSparse::${part} PROPERTIES
      IMPORTED_LOCATION "${SuiteSparse_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${SuiteSparse_INCLUDE_DIR}")
  endif()
endforeach()
mark_as_advanced(${SuiteSparse_REQUIRED})
