# Imported target ARPACK::ARPACK. ARPACK has no header; its version stands in its pkg-config file.
include(FindPackageHandleStandardArgs)
find_library(ARPACK_LIBRARY arpack)

if(ARPACK_LIBRARY)
  get_filename_component(folder "${ARPACK_LIBRARY}" DIRECTORY)
  if(EXISTS "${folder}/pkgconfig/arpack.pc")
    file(STRINGS "${folder}/pkgconfig/arpack.pc" line REGEX "^Version:")
    string(REGEX REPLACE "^Version:[ ]*" "" ARPACK_VERSION "${line}")
  endif()
endif()

find_package_handle_standard_args(ARPACK REQUIRED_VARS ARPACK_LIBRARY
                                  VERSION_VAR ARPACK_VERSION)
if(ARPACK_FOUND AND NOT TARGET ARPACK::ARPACK)
  add_library(ARPACK::ARPACK UNKNOWN IMPORTED)
  set_target_properties(ARPACK::ARPACK PROPERTIES IMPORTED_LOCATION "${ARPACK_LIBRARY}")
endif()
mark_as_advanced(ARPACK_LIBRARY)
