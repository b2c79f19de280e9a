!> The single list of loads: the keyword that brings each in, its word on the data line, its maker.
module load_catalogue
  use applied_load, only: load
  use dam_mesh, only: surface
  use load_base_motion, only: base_motion
  use load_gravity, only: gravity_load
  use load_point, only: point_load
  use load_pressure, only: pressure_load
  use load_reservoir, only: reservoir_load
  use load_uplift, only: uplift_load
  implicit none
  private
  public :: load_kind, load_kinds, make_load, face_of_word, faces_of_elements

  !> One row of the list.
  type :: load_kind
    character(16) :: keyword !< without the star
    character(8) :: word !< second field of the data line; '' where there is none, N is a face 1..6
    character(16) :: kind !< for the log and the list of effects
    character(64) :: meaning
  end type load_kind

  type(load_kind), parameter :: load_kinds(8) = [ &
                                load_kind('CLOAD', '', 'point load', 'forces on nodes'), &
                                load_kind('DLOAD', 'GRAV', 'gravity', 'weight of elements'), &
                                load_kind('DLOAD', 'PN', 'pressure', 'uniform on a face'), &
                                load_kind('DLOAD', 'HPN', 'pressure', 'hydrostatic on a face'), &
                                load_kind('DSLOAD', 'P', 'pressure', 'uniform on a surface'), &
                                load_kind('RESERVOIR', '', 'reservoir', &
                                          'hydrostatic head and added mass of water'), &
                                load_kind('BASE MOTION', '', 'base motion', &
                                          'uniform acceleration of the base'), &
                                load_kind('JOINT LAW', '', 'uplift', &
                                          'water of a reservoir in a joint')]

contains

  !> Makes an empty load of a kind; stays unallocated when it is not in the list.
  subroutine make_load(kind, item)
    character(*), intent(in) :: kind !< as in the list
    class(load), allocatable, intent(out) :: item
    select case (kind)
    case ('point load')
      allocate (point_load :: item)
    case ('gravity')
      allocate (gravity_load :: item)
    case ('pressure')
      allocate (pressure_load :: item)
    case ('reservoir')
      allocate (reservoir_load :: item)
    case ('base motion')
      allocate (base_motion :: item)
    case ('uplift')
      allocate (uplift_load :: item)
    case default
      return
    end select
    item%kind = kind
  end subroutine make_load

  !> Face 1..6 that P1..P6 or HP1..HP6 names, 0 for any other word.
  pure integer function face_of_word(word) result(face)
    character(*), intent(in) :: word !< upper case
    integer :: length
    length = len_trim(word)
    face = 0
    if (length < 2) return
    if (word(:length - 1) /= 'P' .and. word(:length - 1) /= 'HP') return
    face = index('123456', word(length:length))
  end function face_of_word

  !> One face of each element as a surface without a name.
  pure function faces_of_elements(elements, face) result(faces)
    integer, intent(in) :: elements(:) !< positions
    integer, intent(in) :: face !< 1..6
    type(surface) :: faces
    allocate (faces%element(size(elements)), source=elements)
    allocate (faces%face(size(elements)), source=face)
  end function faces_of_elements
end module load_catalogue
