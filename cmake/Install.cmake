# `cmake --install` and `cpack`: program, library, modules, package files, what UMATs need, help.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(KEYWAY_MODULES_DIR "${CMAKE_INSTALL_INCLUDEDIR}/keyway")
set(KEYWAY_CMAKE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/keyway")
set(KEYWAY_SHARE_DIR "${CMAKE_INSTALL_DATADIR}/keyway")

# Files of the modules of a target; the folder of modules holds those of tests, too.
function(module_files variable target)
  get_target_property(sources ${target} SOURCES)
  set(files "")
  foreach(source IN LISTS sources)
    if(source MATCHES "[.]f90$")
      file(STRINGS "${source}" lines REGEX "^module +[a-z0-9_]+ *$")
      foreach(line IN LISTS lines)
        string(REGEX REPLACE "^module +([a-z0-9_]+) *$" "\\1" name "${line}")
        list(APPEND files "${CMAKE_Fortran_MODULE_DIRECTORY}/${name}.mod")
      endforeach()
    endif()
  endforeach()
  set(${variable} "${files}" PARENT_SCOPE)
endfunction()

set_target_properties(keyway_core PROPERTIES EXPORT_NAME core)
# Libraries in folders that the linker does not search by itself (HDF5 of Debian).
set_target_properties(keyway PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)
install(TARGETS keyway keyway_core EXPORT keywayTargets)
module_files(modules keyway_core)
install(FILES ${modules} DESTINATION "${KEYWAY_MODULES_DIR}")
install(EXPORT keywayTargets NAMESPACE keyway:: DESTINATION "${KEYWAY_CMAKE_DIR}")

string(REGEX MATCH "^[0-9]+" major "${CMAKE_Fortran_COMPILER_VERSION}")
set(KEYWAY_COMPILER "${CMAKE_Fortran_COMPILER_ID} ${major}")
configure_package_config_file(packaging/keywayConfig.cmake.in
  "${CMAKE_BINARY_DIR}/keywayConfig.cmake" INSTALL_DESTINATION "${KEYWAY_CMAKE_DIR}")
write_basic_package_version_file("${CMAKE_BINARY_DIR}/keywayConfigVersion.cmake"
                                 COMPATIBILITY SameMajorVersion)
install(FILES "${CMAKE_BINARY_DIR}/keywayConfig.cmake"
              "${CMAKE_BINARY_DIR}/keywayConfigVersion.cmake"
              cmake/FindARPACK.cmake cmake/FindMETIS.cmake cmake/FindSuiteSparse.cmake
              cmake/KeywayUmat.cmake
        DESTINATION "${KEYWAY_CMAKE_DIR}")

install(FILES packaging/keyway.bash DESTINATION
        "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" RENAME keyway)
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(FILES packaging/ABA_PARAM.INC DESTINATION "${KEYWAY_MODULES_DIR}")
install(FILES tools/keyway/job-1.schema.json DESTINATION "${KEYWAY_SHARE_DIR}")
install(DIRECTORY input/ DESTINATION "${KEYWAY_SHARE_DIR}/examples"
        PATTERN "xingbiling*" EXCLUDE PATTERN "jinping*" EXCLUDE)
install(DIRECTORY input/umat DESTINATION "${KEYWAY_SHARE_DIR}")

# What is made of the sources and of the program itself.
find_package(Python3 COMPONENTS Interpreter)
install(CODE "
  set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  execute_process(COMMAND \"${CMAKE_SOURCE_DIR}/tools/make_umat\" \"\${share}/keyway/umat/umat_concrete.f90\"
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  message(STATUS \"Installing: \${share}/keyway/umat/umat_concrete.f90\")")
if(Python3_FOUND)
  install(CODE "
    execute_process(COMMAND \"${Python3_EXECUTABLE}\" \"${CMAKE_SOURCE_DIR}/tools/make_syntax.py\"
                    --program \"$<TARGET_FILE:keyway>\" --vim \"\${share}/keyway/vim\"
                    --vscode \"\${share}/keyway/vscode\"
                    COMMAND_ERROR_IS_FATAL ANY)
    set(manual \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1/keyway.1\")
    execute_process(COMMAND \"${Python3_EXECUTABLE}\" \"${CMAKE_SOURCE_DIR}/tools/make_manual.py\"
                    --program \"$<TARGET_FILE:keyway>\" -o \"\${manual}\"
                    COMMAND_ERROR_IS_FATAL ANY)")
else()
  message(STATUS "No Python: manual page and syntax of editors will not be installed")
endif()

# cpack in the build folder writes a package of Debian.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Keyway developers")
set(CPACK_PACKAGE_VENDOR "The Keyway developers")
set(CPACK_RESOURCE_FILE_LICENSE "${CMAKE_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gfortran) # for UMATs
include(CPack)
