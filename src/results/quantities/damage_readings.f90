!> Damage of solids in the results: largest damage with time and place, damaged volume, dissipated
!> energy.
module damage_readings
  use kinds, only: rk
  use material_points, only: created_energy, crushing_energy, fracture_energy
  use shape_hex8, only: corner_of_point
  use inelastic_blocks, only: fewest_blocks, inelastic_block
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

  !> What a block adds to the record of an increment; components as there.
  type :: block_damage
    real(rk) :: volume(size(levels)) = 0.0_rk
    integer :: elements(size(levels)) = 0, inelastic_elements = 0
    real(rk) :: inelastic_volume = 0.0_rk, cracking = 0.0_rk, crushing = 0.0_rk, created = 0.0_rk
    integer :: first_t = 0, first_c = 0 !< points of the largest damages; 0: none
    real(rk) :: damage_t = 0.0_rk, damage_c = 0.0_rk !< the largest damages
  end type block_damage

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

  !> Records one increment. Elastic blocks cost next to nothing. Sums are those of blocks, in their
  !> order: the same for any number of threads.
  subroutine note_damage(model, now, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(damage_record), intent(inout) :: record
    type(block_damage) :: found(size(model%inelastic))
    integer :: i
    !$omp parallel do default(none) shared(model, now, found) schedule(dynamic, 8) &
    !$omp if (size(found) > fewest_blocks)
    do i = 1, size(found)
      if (.not. all(now%points(i)%is_elastic)) call read_block(model, now, i, found(i))
    end do
    !$omp end parallel do
    record%volume = 0.0_rk
    record%elements = 0
    record%inelastic_volume = sum(found%inelastic_volume)
    record%inelastic_elements = sum(found%inelastic_elements)
    record%cracking = now%energy%left_cracking + sum(found%cracking)
    record%crushing = now%energy%left_crushing + sum(found%crushing)
    record%created = now%energy%left_created + sum(found%created)
    do i = 1, size(found)
      record%volume = record%volume + found(i)%volume
      record%elements = record%elements + found(i)%elements
      call note_largest(record%tension, found(i)%first_t, found(i)%damage_t, model%inelastic(i), &
                        now%total_time)
      call note_largest(record%compression, found(i)%first_c, found(i)%damage_c, &
                        model%inelastic(i), now%total_time)
    end do
  end subroutine note_damage

  !> Updates the largest damage so far.
  subroutine note_largest(largest, point, damage, part, time)
    type(damage_extreme), intent(inout) :: largest
    integer, intent(in) :: point !< of the block; 0: none
    real(rk), intent(in) :: damage !< there
    type(inelastic_block), intent(in) :: part
    real(rk), intent(in) :: time !< [s]
    if (point == 0 .or. damage <= largest%at%value) return
    largest%at = extreme(.true., damage, time, part%points%x(:, point))
    largest%element = part%points%element(point)
    largest%point = part%points%number(point)
  end subroutine note_largest

  !> Largest damages, volumes, counts and energies of a block.
  subroutine read_block(model, now, block, found)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block !< its position
    type(block_damage), intent(inout) :: found
    real(rk), allocatable :: tension(:, :), compression(:, :)
    call field_of_block(model, now, block, 'DAMAGET', tension)
    call field_of_block(model, now, block, 'DAMAGEC', compression)
    call find_largest(tension, found%first_t, found%damage_t)
    call find_largest(compression, found%first_c, found%damage_c)
    call measure_block(model%inelastic(block), now, block, tension, found)
  end subroutine read_block

  !> The largest damage of a block and its point.
  subroutine find_largest(damage, point, largest)
    real(rk), allocatable, intent(in) :: damage(:, :) !< (1, points); unallocated: none
    integer, intent(inout) :: point
    real(rk), intent(inout) :: largest
    if (.not. allocated(damage)) return
    point = maxloc(damage(1, :), dim=1)
    largest = damage(1, point)
  end subroutine find_largest

  !> Volumes, counts and energies of a block.
  subroutine measure_block(part, now, block, tension, found)
    type(inelastic_block), intent(in) :: part
    type(state), intent(in) :: now
    integer, intent(in) :: block !< its position
    real(rk), allocatable, intent(in) :: tension(:, :) !< (1, points); unallocated: none
    type(block_damage), intent(inout) :: found
    integer :: e, n, first, last, level
    n = part%points_of_element
    do e = 1, size(part%elements)
      first = (e - 1)*n + 1
      last = e*n
      associate (points => now%points(block), weight => part%weight(:, e))
        if (all(points%is_elastic(first:last))) cycle
        found%inelastic_elements = found%inelastic_elements + 1
        found%inelastic_volume = found%inelastic_volume + &
                                 sum(weight, mask=.not. points%is_elastic(first:last))
        found%cracking = found%cracking + sum(weight*points%energy(fracture_energy, first:last))
        found%crushing = found%crushing + sum(weight*points%energy(crushing_energy, first:last))
        found%created = found%created + sum(weight*points%energy(created_energy, first:last))
        if (.not. allocated(tension)) cycle
        do level = 1, size(levels)
          if (maxval(tension(1, first:last)) < least(level)) exit
          found%elements(level) = found%elements(level) + 1
          found%volume(level) = found%volume(level) + &
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
