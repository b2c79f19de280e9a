!> Totals of all loads on a small wall.
program test_loads
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use load_gravity, only: gravity_load
  use load_point, only: point_load
  use load_pressure, only: face_of_word, faces_of_elements, pressure_load
  use load_reservoir, only: reservoir_load, wetted_area
  use testing, only: check, check_close, test_log
  use wetted_facet, only: water_body
  implicit none

  integer, parameter :: face_west = 6 !< S6: 4-8-5-1
  type(test_log) :: log

  log%suite = 'loads'
  call weight_of_a_wall(log)
  call pressures(log)
  call westergaard_totals(log)
  call added_mass_follows_the_normal(log)
  call motion_and_points(log)
  call labels_name_faces(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A wall 2 m thick along x, 1 m wide along y, of `layers` elements over the height.
  subroutine wall(height, layers, mesh)
    real(rk), intent(in) :: height
    integer, intent(in) :: layers
    type(fe_mesh), intent(out) :: mesh
    integer :: k, i
    mesh%num_nodes = 4*(layers + 1)
    mesh%num_elements = layers
    allocate (mesh%x(3, mesh%num_nodes), mesh%nodes(8, layers))
    do k = 0, layers
      mesh%x(1:2, 4*k + 1:4*k + 4) = reshape(real([0, 0, 2, 0, 2, 1, 0, 1], rk), [2, 4])
      mesh%x(3, 4*k + 1:4*k + 4) = height*k/layers
    end do
    do k = 1, layers
      mesh%nodes(:, k) = [(4*k - 4 + i, i=1, 8)]
    end do
  end subroutine wall

  subroutine weight_of_a_wall(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(gravity_load) :: item
    real(rk), allocatable :: force(:, :)
    call wall(10.0_rk, 5, mesh)
    allocate (force(3, mesh%num_nodes), source=0.0_rk)
    item%elements = [1, 2, 3, 4, 5]
    item%acceleration = [0.0_rk, 0.0_rk, -9.81_rk]
    call item%add_force(mesh, [0.0_rk, 2400.0_rk, 2400.0_rk, 2400.0_rk, 2400.0_rk], force)
    call check_close(log, sum(force(3, :)), -2400.0_rk*16.0_rk*9.81_rk, 1.0e-6_rk, 'weight')
    call check_close(log, maxval(abs(force(:2, :))), 0.0_rk, 0.0_rk, 'only downwards')
    call check_close(log, sum(abs(force(3, 1:4))), 0.0_rk, 0.0_rk, 'the massless part has none')
  end subroutine weight_of_a_wall

  subroutine pressures(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(pressure_load) :: item
    real(rk), allocatable :: force(:, :)
    call wall(10.0_rk, 4, mesh)
    allocate (force(3, mesh%num_nodes), source=0.0_rk)
    item%faces = faces_of_elements([1, 2, 3, 4], face_west)
    item%pressure = 1000.0_rk
    call item%add_force(mesh, [0.0_rk], force)
    call check_close(log, sum(force(1, :)), 10.0e3_rk, 1.0e-9_rk, 'uniform pressure pushes east')
    force = 0.0_rk
    item%is_hydrostatic = .true.
    item%top = 9.0_rk
    item%reference = -1.0_rk
    call item%add_force(mesh, [0.0_rk], force)
    call check_close(log, sum(force(1, :)), 100.0_rk*81.0_rk/2.0_rk, 1.0e-9_rk, 'hydrostatic force')
    call check_close(log, sum(force(1, :)*mesh%x(3, :)), 100.0_rk*729.0_rk/6.0_rk, 1.0e-9_rk, &
                     'hydrostatic moment')
  end subroutine pressures

  !> VALIDATION: Koyna's face, water at 91.75 m of 103 m: 7/12 rho H**2 a metre on any mesh, and
  !> 7/8 rho H per area at the base.
  subroutine westergaard_totals(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(reservoir_load) :: item
    real(rk), allocatable :: blocks(:, :, :), force(:, :)
    integer, parameter :: meshes(3) = [1, 7, 200]
    integer :: i, e
    do i = 1, 3
      call wall(103.0_rk, meshes(i), mesh)
      allocate (blocks(3, 3, mesh%num_nodes), force(3, mesh%num_nodes), source=0.0_rk)
      item%faces = faces_of_elements([(e, e=1, meshes(i))], face_west)
      item%water = water_body(level=91.75_rk, bed=0.0_rk)
      item%has_added_mass = .true.
      call item%add_added_mass(mesh, blocks)
      call item%add_force(mesh, [0.0_rk], force)
      call check_close(log, sum(blocks(1, 1, :)), 7.0_rk/12.0_rk*1.0e3_rk*91.75_rk**2, 1.0e-6_rk, &
                       'added mass of the face')
      call check_close(log, sum(blocks(1, 1, :)), 4.9105e6_rk, 50.0_rk, 'as in the literature')
      call check_close(log, sum(blocks(2:, :, :)) + sum(blocks(1, 2:, :)), 0.0_rk, 0.0_rk, &
                       'only along the normal')
      call check_close(log, sum(force(1, :)), 0.5_rk*9810.0_rk*91.75_rk**2, 1.0e-6_rk, &
                       'water force')
      call check_close(log, wetted_area(item, mesh), 91.75_rk, 1.0e-12_rk, 'wetted area')
      if (i == 3) call check_close(log, blocks(1, 1, 1)/(0.25_rk*103.0_rk/200.0_rk), 8.028e4_rk, &
                                   1.0e-3_rk*8.028e4_rk, 'added mass per area at the base')
      deallocate (blocks, force)
    end do
  end subroutine westergaard_totals

  !> A sloping face: the normal block has the mass as its trace, so has its diagonal.
  subroutine added_mass_follows_the_normal(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(reservoir_load) :: item
    real(rk), allocatable :: blocks(:, :, :), diagonal(:, :, :)
    integer :: e
    call wall(10.0_rk, 5, mesh)
    where (mesh%x(1, :) < 1.0_rk) mesh%x(1, :) = -0.75_rk*(10.0_rk - mesh%x(3, :))
    allocate (blocks(3, 3, mesh%num_nodes), diagonal(3, 3, mesh%num_nodes), source=0.0_rk)
    item%faces = faces_of_elements([(e, e=1, 5)], face_west)
    item%water = water_body(level=10.0_rk, bed=0.0_rk)
    item%has_added_mass = .true.
    call item%add_added_mass(mesh, diagonal)
    item%is_diagonal = .false.
    call item%add_added_mass(mesh, blocks)
    call check_close(log, sum(blocks(1, 1, :)), 0.64_rk*1.25_rk*7.0_rk/12.0_rk*1.0e5_rk, &
                     1.0e-8_rk, 'n1**2 of the mass')
    call check_close(log, sum(blocks(1, 3, :)), -0.48_rk*1.25_rk*7.0_rk/12.0_rk*1.0e5_rk, &
                     1.0e-8_rk, 'n1 n3 of the mass')
    call check_close(log, sum(diagonal(3, 3, :)), sum(blocks(3, 3, :)), 1.0e-9_rk, 'same diagonal')
    call check_close(log, sum(abs(diagonal(1, 3, :))), 0.0_rk, 0.0_rk, 'nothing beside it')
  end subroutine added_mass_follows_the_normal

  subroutine motion_and_points(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(base_motion) :: motion
    type(point_load) :: point
    real(rk) :: acceleration(3), force(3, 8)
    call wall(1.0_rk, 1, mesh)
    motion%dof = 2
    acceleration = 1.0_rk
    call motion%add_base_acceleration(acceleration)
    call check_close(log, acceleration(2), 2.0_rk, 1.0e-14_rk, 'base motion')
    point%nodes = [3, 4]
    point%force = reshape([0.0_rk, 0.0_rk, -5.0_rk, 0.0_rk, 0.0_rk, -5.0_rk], [3, 2])
    force = 0.0_rk
    call point%add_force(mesh, [0.0_rk], force)
    call check_close(log, sum(force), -10.0_rk, 0.0_rk, 'point loads')
  end subroutine motion_and_points

  subroutine labels_name_faces(log)
    type(test_log), intent(inout) :: log
    call check(log, face_of_word('P3') == 3 .and. face_of_word('HP6') == 6, 'faces')
    call check(log, face_of_word('P7') + face_of_word('GRAV') + face_of_word('P') == 0, 'no faces')
  end subroutine labels_name_faces
end program test_loads
