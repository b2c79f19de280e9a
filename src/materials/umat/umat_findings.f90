!> Findings about a UMAT during a run: unsymmetric tangents, and the largest error in a check of the
!> tangents.
module umat_findings
  use kinds, only: long, rk
  use write_text, only: as_text
  implicit none
  private
  public :: findings, tangent_check, call_place, place_text, text_of_check

  !> Place of a call of a UMAT.
  type :: call_place
    character(:), allocatable :: material
    integer :: element = 0, point = 0, step = 0, increment = 0
  end type call_place

  !> DDSDDE compared with differences of STRESS: the entry with the largest error.
  type :: tangent_check
    integer(long) :: num_tangents = 0 !< compared so far
    real(rk) :: error = -1.0_rk !< |given - found| over the largest entry of DDSDDE
    integer :: row = 0, column = 0
    real(rk) :: given = 0.0_rk, found = 0.0_rk !< DDSDDE and the difference quotient [Pa]
    type(call_place) :: place
  end type tangent_check

  type :: findings
    type(tangent_check) :: check
    character(:), allocatable :: asymmetry !< of the first DDSDDE that was symmetrised
    logical :: is_asymmetry_reported = .false.
    character(:), allocatable :: bad_start !< why SDVINI failed
  contains
    procedure :: add_check
    procedure :: add_asymmetry
  end type findings

contains

  !> 'material X, element 12, point 3, step 1, increment 7'
  pure function place_text(place) result(text)
    type(call_place), intent(in) :: place
    character(:), allocatable :: text
    text = 'material '//place%material//', element '//as_text(place%element)//', point '// &
           as_text(place%point)//', step '//as_text(place%step)//', increment '// &
           as_text(place%increment)
  end function place_text

  !> Text of a check.
  pure function text_of_check(check) result(text)
    type(tangent_check), intent(in) :: check
    character(:), allocatable :: text
    text = 'UMAT: DDSDDE compared with differences of STRESS in '//as_text(check%num_tangents)// &
           ' calls'
    if (check%error < 0.0_rk) return
    text = text//'; largest error '//as_text(check%error)//' of its largest entry, at '// &
           place_text(check%place)//': DDSDDE('//as_text(check%row)//','// &
           as_text(check%column)//') = '//as_text(check%given)//', difference quotient '// &
           as_text(check%found)
  end function text_of_check

  !> Counts a comparison and keeps the largest error; thread-safe.
  subroutine add_check(self, new)
    class(findings), intent(inout) :: self
    type(tangent_check), intent(in) :: new
    integer(long) :: num_tangents
    !$omp critical (umat_findings)
    num_tangents = self%check%num_tangents + 1
    if (new%error > self%check%error) self%check = new
    self%check%num_tangents = num_tangents
    !$omp end critical (umat_findings)
  end subroutine add_check

  !> Keeps the first unsymmetric tangent.
  subroutine add_asymmetry(self, place, share)
    class(findings), intent(inout) :: self
    type(call_place), intent(in) :: place
    real(rk), intent(in) :: share !< of the difference to the transpose in the largest entry
    !$omp critical (umat_findings)
    if (.not. allocated(self%asymmetry)) then
      self%asymmetry = 'DDSDDE of the UMAT is not symmetric ('//place_text(place)//': by '// &
                       as_text(share)//' of its largest entry) and is symmetrised; '// &
                       '*USER MATERIAL, UNSYMM keeps it unsymmetric'
    end if
    !$omp end critical (umat_findings)
  end subroutine add_asymmetry
end module umat_findings
