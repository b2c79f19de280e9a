# keyway_add_umat(name SOURCES file.. [FLAGS flag..]): a shared library of a UMAT, made by Keyway itself
# as `keyway --umat file..` would make it, for `keyway --umat <name>.so job.inp`. The path of the
# library is the property KEYWAY_LIBRARY of the target. Outside of Keyway's own build the program is
# that of find_package(keyway), else the one in the PATH, or KEYWAY_PROGRAM.
function(keyway_add_umat name)
  cmake_parse_arguments(PARSE_ARGV 1 umat "" "" "SOURCES;FLAGS")
  if(NOT umat_SOURCES)
    message(FATAL_ERROR "keyway_add_umat(${name}): no SOURCES")
  endif()
  if(TARGET keyway)
    set(program $<TARGET_FILE:keyway>)
  elseif(TARGET keyway::keyway)
    set(program $<TARGET_FILE:keyway::keyway>)
  else()
    find_program(KEYWAY_PROGRAM keyway REQUIRED)
    set(program "${KEYWAY_PROGRAM}")
  endif()
  set(sources "")
  foreach(source IN LISTS umat_SOURCES)
    get_filename_component(source "${source}" ABSOLUTE)
    list(APPEND sources "${source}")
  endforeach()
  list(JOIN umat_FLAGS " " flags)
  set(library "${CMAKE_CURRENT_BINARY_DIR}/${name}.so")
  add_custom_command(OUTPUT "${library}"
                     COMMAND ${program} --umat ${sources} --umat-flags "${flags}"
                             --umat-library "${library}"
                     DEPENDS ${sources} $<TARGET_NAME_IF_EXISTS:keyway>
                     COMMENT "Building the UMAT ${name}" VERBATIM)
  add_custom_target(${name} ALL DEPENDS "${library}")
  set_target_properties(${name} PROPERTIES KEYWAY_LIBRARY "${library}")
endfunction()
