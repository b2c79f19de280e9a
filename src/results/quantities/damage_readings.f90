!> Damage of solids in the results: largest damage with time and place, damaged volume, dissipated
!> energy.
module damage_readings
  use kinds, only: rk
  use material_points, only: created_energy, crushing_energy, fracture_energy
  use shape_hex8, only: corner_of_point
  use inelastic_blocks, only: inelastic_block
  use problem_definition, only: problem
  use analysis_state, only: state
  use dam_faces, only: dam_skin
  use extremes, only: extreme
  use law_fields, only: width_of_field, field_of_block
  implicit none
  private
  public :: damage_record, damage_extreme, open_damage_record, note_damage
  public :: levels, damage_columns, damage_row

  !> Levels of damage in tension for the damaged volumes and elements. The largest damage of a table
  !> is often a round number; round-off just below this number counts as reached.
  real(rk), parameter :: levels(3) = [0.1_rk, 0.5_rk, 0.9_rk]
  real(rk), parameter :: least(3) = levels - 1.0e-9_rk

  !> Names of the columns of `damage_row`.
  character(*), parameter :: damage_columns = 'DAMAGET,DAMAGEC,volume_10,volume_50,volume_90,'// &
                             'inelastic_volume,cracking,crushing,created'
  integer, parameter :: num_columns = 9

  !> The largest damage since the start, and its point.
  type :: damage_extreme
    type(extreme) :: at
    integer :: element = 0, point = 0 !< number in the deck; 1..8
  end type damage_extreme

  !> Points of a block on the faces of the dam.
  type :: block_faces
    logical, allocatable :: is_upstream(:), is_downstream(:) !< (points)
  end type block_faces

  type :: damage_record
    logical :: is_present = .false. !< a law of the model has damage
    type(damage_extreme) :: tension, compression
    type(block_faces), allocatable :: faces(:) !< (inelastic blocks)
    ! Of the last increment:
    real(rk) :: volume(size(levels)) = 0.0_rk !< at or above each level of damage in tension [m3]
    integer :: elements(size(levels)) = 0 !< with a point at or above each level
    real(rk) :: inelastic_volume = 0.0_rk !< of points that have left elasticity [m3]
    integer :: inelastic_elements = 0 !< with a point that has left elasticity
    real(rk) :: cracking = 0.0_rk, crushing = 0.0_rk !< energy dissipated in solids so far [J]
    real(rk) :: created = 0.0_rk !< energy created by laws without potential so far [J]
  end type damage_record

contains

  !> An empty record. A point lies on a face of the dam when the nearest node does; the point of a
  !> one-point element, when any node of the element does.
  subroutine open_damage_record(model, skin, record)
    type(problem), intent(in) :: model
    type(dam_skin), intent(in) :: skin
    type(damage_record), intent(out) :: record
    integer :: i
    record%is_present = max(width_of_field(model, 'DAMAGET'), width_of_field(model, 'DAMAGEC')) > 0
    if (.not. allocated(model%inelastic)) return
    allocate (record%faces(size(model%inelastic)))
    do i = 1, size(model%inelastic)
      associate (nodes => model%mesh%nodes(:, model%inelastic(i)%elements))
        record%faces(i)%is_upstream = points_on(skin%is_upstream, nodes, model%inelastic(i))
        record%faces(i)%is_downstream = points_on(skin%is_downstream, nodes, model%inelastic(i))
      end associate
    end do
  end subroutine open_damage_record

  !> Points of a block at marked nodes.
  pure function points_on(is_marked, nodes, part) result(is_on)
    logical, intent(in) :: is_marked(:) !< (nodes of the mesh)
    integer, intent(in) :: nodes(:, :) !< (8, elements of the block)
    type(inelastic_block), intent(in) :: part
    logical :: is_on(part%points%num_points)
    integer :: e, n
    n = part%points_of_element
    do e = 1, size(nodes, 2)
      if (n == size(corner_of_point)) then
        is_on((e - 1)*n + 1:e*n) = is_marked(nodes(corner_of_point, e))
      else
        is_on((e - 1)*n + 1:e*n) = any(is_marked(nodes(:, e)))
      end if
    end do
  end function points_on

  !> Records one increment. Elastic blocks cost next to nothing.
  subroutine note_damage(model, now, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(damage_record), intent(inout) :: record
    real(rk), allocatable :: tension(:, :), compression(:, :)
    integer :: i
    record%volume = 0.0_rk
    record%elements = 0
    record%inelastic_volume = 0.0_rk
    record%inelastic_elements = 0
    record%cracking = now%energy%left_cracking
    record%crushing = now%energy%left_crushing
    record%created = now%energy%left_created
    do i = 1, size(model%inelastic)
      if (all(now%points(i)%is_elastic)) cycle
      call field_of_block(model, now, i, 'DAMAGET', tension)
      call field_of_block(model, now, i, 'DAMAGEC', compression)
      call note_largest(record%tension, tension, model%inelastic(i), now%total_time)
      call note_largest(record%compression, compression, model%inelastic(i), now%total_time)
      call measure_block(model%inelastic(i), now, i, tension, record)
    end do
  end subroutine note_damage

  !> Updates the largest damage so far.
  subroutine note_largest(largest, damage, part, time)
    type(damage_extreme), intent(inout) :: largest
    real(rk), allocatable, intent(in) :: damage(:, :) !< (1, points); unallocated: none
    type(inelastic_block), intent(in) :: part
    real(rk), intent(in) :: time !< [s]
    integer :: p
    if (.not. allocated(damage)) return
    p = maxloc(damage(1, :), dim=1)
    if (damage(1, p) <= largest%at%value) return
    largest%at = extreme(.true., damage(1, p), time, part%points%x(:, p))
    largest%element = part%points%element(p)
    largest%point = part%points%number(p)
  end subroutine note_largest

  !> Adds volumes, counts and energies of a block.
  subroutine measure_block(part, now, block, tension, record)
    type(inelastic_block), intent(in) :: part
    type(state), intent(in) :: now
    integer, intent(in) :: block !< its position
    real(rk), allocatable, intent(in) :: tension(:, :) !< (1, points); unallocated: none
    type(damage_record), intent(inout) :: record
    integer :: e, n, first, last, level
    n = part%points_of_element
    do e = 1, size(part%elements)
      first = (e - 1)*n + 1
      last = e*n
      associate (points => now%points(block), weight => part%weight(:, e))
        if (all(points%is_elastic(first:last))) cycle
        record%inelastic_elements = record%inelastic_elements + 1
        record%inelastic_volume = record%inelastic_volume + &
                                  sum(weight, mask=.not. points%is_elastic(first:last))
        record%cracking = record%cracking + sum(weight*points%energy(fracture_energy, first:last))
        record%crushing = record%crushing + sum(weight*points%energy(crushing_energy, first:last))
        record%created = record%created + sum(weight*points%energy(created_energy, first:last))
        if (.not. allocated(tension)) cycle
        do level = 1, size(levels)
          if (maxval(tension(1, first:last)) < least(level)) exit
          record%elements(level) = record%elements(level) + 1
          record%volume(level) = record%volume(level) + &
                                 sum(weight, mask=tension(1, first:last) >= least(level))
        end do
      end associate
    end do
  end subroutine measure_block

  !> A row of the record: largest damage so far, volumes now [m3], energies so far [J].
  pure function damage_row(record) result(row)
    type(damage_record), intent(in) :: record
    real(rk) :: row(num_columns)
    row = [record%tension%at%value, record%compression%at%value, record%volume, &
           record%inelastic_volume, record%cracking, record%crushing, record%created]
  end function damage_row
end module damage_readings
