# Modules with loops over points a second time, for processors with registers of four numbers (AVX2):
# module and file NAME become NAME_wide. processor_features says which copy to call. Without fused
# multiplication and addition, a number does not depend on its place in a register.
#
#   add_wide_copies(TARGET FOLDER NAME...)
set(wide_instructions "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(wide_instructions -mavx2)
endif()

function(add_wide_copies target folder)
  list(JOIN ARGN "|" names)
  foreach(name ${ARGN})
    set(source "${folder}/${name}.f90")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}")
    file(READ "${source}" text)
    string(REGEX REPLACE "(module|use) (${names})([,\n])" "\\1 \\2_wide\\3" text "${text}")
    set(copy "${CMAKE_CURRENT_BINARY_DIR}/wide/${name}_wide.f90")
    file(CONFIGURE OUTPUT "${copy}" CONTENT "${text}" @ONLY)
    target_sources(${target} PRIVATE "${copy}")
    get_source_file_property(options "${source}" TARGET_DIRECTORY ${target} COMPILE_OPTIONS)
    if(NOT options)
      set(options "")
    endif()
    set_source_files_properties("${copy}" TARGET_DIRECTORY ${target}
      PROPERTIES COMPILE_OPTIONS "${options};${wide_instructions}")
  endforeach()
endfunction()
