!> What a mortar projection hands on over curved faces.
program test_mortar_balance
  use face_pairs, only: field_error, lay_bent, join, two_faces
  use gauss_rules, only: line5_point, line5_weight
  use kinds, only: rk
  use shape_quad4, only: facet_derivative, facet_shape
  use small_matrix, only: cross_product
  use surface_segments, only: facet_set
  use testing, only: check_close, test_log
  implicit none

  !> Round-off of sums of some hundred products.
  real(rk), parameter :: round_off = 1.0e-12_rk
  type(test_log) :: log

  log%suite = 'mortar_balance'
  call curved_faces_pass_a_stress(log)
  call rounded_nodes_keep_their_weights(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A constant stress passes from face to face, whichever is the slave: on a hyperbolic paraboloid,
  !> on one that is almost plane, and through the kinks of a cylinder of four chords.
  subroutine curved_faces_pass_a_stress(log)
    type(test_log), intent(inout) :: log
    call passes(log, 'hypar', 4, 6, 0.1_rk)
    call passes(log, 'hypar', 7, 3, 0.1_rk)
    call passes(log, 'shallow', 4, 6, 0.1_rk)
    call passes(log, 'shallow', 6, 4, 1.0e-6_rk)
    call passes(log, 'chords', 8, 12, 0.1_rk)
    call passes(log, 'chords', 12, 8, 0.1_rk)
  end subroutine curved_faces_pass_a_stress

  !> sum_a w_am int N_a n dA = - int N_m n dA (normals out of each face's solid); to 1e-11, the
  !> residual of the search over the turn of the normals.
  subroutine passes(log, geometry, n, m, most_change)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: geometry
    integer, intent(in) :: n, m !< facets a side of slave and master
    real(rk), intent(in) :: most_change !< of a weight, where it is checked; measured 0.071, 8e-11
    type(two_faces) :: pair, plane
    real(rk), allocatable :: force(:, :), f(:, :)
    integer :: a, k
    character(40) :: name
    write (name, '(a,2(a,i0))') geometry, ' ', n, ':', m
    call lay_bent(geometry, n, m, pair)
    call lay_bent('flat', n, m, plane)
    force = -nodal_vectors(pair%x, pair%master)
    do a = 1, pair%rows%num_rows()
      do k = pair%rows%first(a), pair%rows%first(a + 1) - 1
        force(:, pair%rows%item(k)) = force(:, pair%rows%item(k)) &
                                      - pair%rows%weight(k)*pair%rows%pressed(:, a)
      end do
    end do
    call check_close(log, maxval(abs(force))/maxval(norm2(pair%rows%pressed, dim=1)), 0.0_rk, &
                     1.0e-11_rk, trim(name)//': forces of a constant stress')
    allocate (f(4, size(pair%x, 2)))
    f(:3, :) = pair%x
    f(4, :) = 1.0_rk
    call check_close(log, field_error(pair%rows, f), 0.0_rk, round_off, trim(name)//': linear')
    if (geometry /= 'shallow') return
    call check_close(log, maxval(abs(matrix(pair) - matrix(plane))), 0.0_rk, most_change, &
                     trim(name)//': a small change of the weights')
  end subroutine passes

  !> The weights of a pair by slave and master node.
  pure function matrix(pair)
    type(two_faces), intent(in) :: pair
    real(rk) :: matrix(size(pair%x, 2), size(pair%x, 2))
    integer :: a, k
    matrix = 0.0_rk
    do a = 1, pair%rows%num_rows()
      do k = pair%rows%first(a), pair%rows%first(a + 1) - 1
        matrix(pair%rows%node(a), pair%rows%item(k)) = pair%rows%weight(k)
      end do
    end do
  end function matrix

  !> int N_m n dA of the nodes of a face; exact by 2 x 2 points, taken by 5 x 5.
  pure function nodal_vectors(x, facets) result(force)
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: facets
    real(rk) :: force(3, size(x, 2))
    real(rk) :: along(3, 2), xi(2), n(4)
    integer :: f, i, j, c
    force = 0.0_rk
    do f = 1, size(facets%node, 2)
      do i = 1, 5
        do j = 1, 5
          xi = 2.0_rk*[line5_point(i), line5_point(j)] - 1.0_rk
          along = matmul(x(:, facets%node(:, f)), facet_derivative(xi))
          n = 4.0_rk*line5_weight(i)*line5_weight(j)*facet_shape(xi)
          do c = 1, 4
            force(:, facets%node(c, f)) = force(:, facets%node(c, f)) &
                                          + n(c)*cross_product(along(:, 1), along(:, 2))
          end do
        end do
      end do
    end do
  end function nodal_vectors

  !> A plane face whose nodes are rounded to 1e-8 is no curved face: the weights are those of the
  !> plane, but for the size of the digits.
  subroutine rounded_nodes_keep_their_weights(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair, plane
    integer :: i
    call lay_bent('flat', 4, 6, plane)
    call lay_bent('flat', 4, 6, pair)
    do i = 1, size(pair%x, 2)
      pair%x(3, i) = 1.0e-8_rk*modulo(7*i*i, 5)
    end do
    call join(pair)
    call check_close(log, maxval(abs(matrix(pair) - matrix(plane))), 0.0_rk, 1.0e-6_rk, &
                     'weights of the plane')
  end subroutine rounded_nodes_keep_their_weights
end program test_mortar_balance
