!> Kinds of numbers used everywhere.
module kinds
  use, intrinsic :: iso_fortran_env, only: int64, real64
  implicit none
  private
  public :: rk, long

  integer, parameter :: rk = real64 !< every real
  integer, parameter :: long = int64 !< counts that outgrow a default integer
end module kinds
