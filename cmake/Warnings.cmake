# Language standard and warnings of every Fortran and C source.
option(KEYWAY_WERROR "Treat warnings as errors" OFF)

# A procedure that overrides one of a parent type takes all arguments of it, needed or not. Files that
# define a type of a family may therefore have unused dummies; all other files may not.
function(allow_unused_dummies_of_families target)
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  list(FILTER sources INCLUDE REGEX "[.]f90$")
  foreach(source IN LISTS sources)
    get_filename_component(path "${source}" ABSOLUTE BASE_DIR "${folder}")
    if(EXISTS "${path}")
      file(STRINGS "${path}" family REGEX "^ *type, *(abstract|extends)" LIMIT_COUNT 1)
      if(family)
        set_property(SOURCE "${path}" TARGET_DIRECTORY ${target}
                     APPEND PROPERTY COMPILE_OPTIONS "-Wno-unused-dummy-argument")
      endif()
    endif()
  endforeach()
endfunction()

function(set_warnings target)
  # gfortran calls its own temporaries of array results uninitialised; the check build finds true
  # cases by filling reals with signalling NaN.
  set(fortran -std=f2008 -fimplicit-none -Wall -Wextra -Wimplicit-interface
              -Wno-uninitialized -Wno-maybe-uninitialized)
  set(c -Wall -Wextra)
  # Each release of GCC warns of something new; errors only where the project is kept free of them.
  if(KEYWAY_WERROR AND CMAKE_Fortran_COMPILER_VERSION MATCHES "^12\\.")
    list(APPEND fortran -Werror)
    list(APPEND c -Werror)
  endif()
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:Fortran>:${fortran}>
                                           $<$<COMPILE_LANGUAGE:C>:${c}>)
  allow_unused_dummies_of_families(${target})
endfunction()
