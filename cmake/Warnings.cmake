# Language standard and warnings of every Fortran and C source.
option(KEYWAY_WERROR "Treat warnings as errors" OFF)

function(set_warnings target)
  # A procedure that overrides another has the arguments of its contract, used or not.
  # gfortran calls its own temporaries of array results uninitialised; the check build finds true
  # cases by filling reals with signalling NaN.
  set(fortran -std=f2008 -fimplicit-none -Wall -Wextra -Wimplicit-interface
              -Wno-unused-dummy-argument -Wno-uninitialized -Wno-maybe-uninitialized)
  set(c -Wall -Wextra)
  # Each release of GCC warns of something new; errors only where the project is kept free of them.
  if(KEYWAY_WERROR AND CMAKE_Fortran_COMPILER_VERSION MATCHES "^12\\.")
    list(APPEND fortran -Werror)
    list(APPEND c -Werror)
  endif()
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:Fortran>:${fortran}>
                                           $<$<COMPILE_LANGUAGE:C>:${c}>)
endfunction()
