!> What the processor offers beyond the least one of its kind.
module processor_features
  use, intrinsic :: iso_c_binding, only: c_int
  implicit none
  private
  public :: has_wide_registers

  interface
    pure integer(c_int) function keyway_has_wide_registers() bind(c)
      import :: c_int
      implicit none
    end function keyway_has_wide_registers
  end interface

contains

  !> Whether modules compiled for registers of four double-precision numbers can be called
  !> (cmake/WideCopies.cmake).
  pure logical function has_wide_registers()
    has_wide_registers = keyway_has_wide_registers() /= 0
  end function has_wide_registers
end module processor_features
