!> The SHA-256 digest of a file, so that a result can be traced to its deck.
!>
!> Source: FIPS 180-4. Words are 64-bit integers with a mask, since Fortran has no unsigned ones.
module sha256
  use kinds, only: long
  implicit none
  private
  public :: digest_of_file, digest_of_text

  integer(long), parameter :: mask = int(z'FFFFFFFF', long)
  integer, parameter :: block_size = 64 !< bytes

  !> Fractional parts of the cube roots of the first 64 primes, 8 hexadecimal digits each.
  character(*), parameter :: round_digits = &
                             '428a2f9871374491b5c0fbcfe9b5dba53956c25b59f111f1923f82a4ab1c5ed5'// &
                             'd807aa9812835b01243185be550c7dc372be5d7480deb1fe9bdc06a7c19bf174'// &
                             'e49b69c1efbe47860fc19dc6240ca1cc2de92c6f4a7484aa5cb0a9dc76f988da'// &
                             '983e5152a831c66db00327c8bf597fc7c6e00bf3d5a7914706ca635114292967'// &
                             '27b70a852e1b21384d2c6dfc53380d13650a7354766a0abb81c2c92e92722c85'// &
                             'a2bfe8a1a81a664bc24b8b70c76c51a3d192e819d6990624f40e3585106aa070'// &
                             '19a4c1161e376c082748774c34b0bcb5391c0cb34ed8aa4a5b9cca4f682e6ff3'// &
                             '748f82ee78a5636f84c878148cc7020890befffaa4506cebbef9a3f7c67178f2'

  !> Fractional parts of the square roots of the first 8 primes.
  character(*), parameter :: start_digits = &
                             '6a09e667bb67ae853c6ef372a54ff53a510e527f9b05688c1f83d9ab5be0cd19'

contains

  !> Digest of the bytes of a file, 64 hexadecimal digits; empty if the file cannot be read.
  function digest_of_file(path) result(digest)
    character(*), intent(in) :: path
    character(:), allocatable :: digest, bytes
    integer :: unit, size_of_file, status
    digest = ''
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status /= 0) return
    inquire (unit=unit, size=size_of_file)
    allocate (character(max(0, size_of_file)) :: bytes)
    read (unit, iostat=status) bytes
    close (unit)
    if (status == 0) digest = digest_of_text(bytes)
  end function digest_of_file

  !> Digest of the bytes of a text.
  pure function digest_of_text(bytes) result(digest)
    character(*), intent(in) :: bytes
    character(64) :: digest
    character(2*block_size) :: tail
    character(8*(8 + 64)) :: digits
    integer(long) :: sum(8), round_constant(64)
    integer :: i, whole, num_tail
    digits = start_digits//round_digits
    read (digits, '(72z8)') sum, round_constant
    whole = len(bytes)/block_size
    do i = 1, whole
      call add_block(round_constant, sum, bytes((i - 1)*block_size + 1:i*block_size))
    end do
    call pad(bytes(whole*block_size + 1:), int(len(bytes), long), tail, num_tail)
    do i = 1, num_tail
      call add_block(round_constant, sum, tail((i - 1)*block_size + 1:i*block_size))
    end do
    write (digest, '(8z8.8)') sum
    do i = 1, len(digest)
      if (digest(i:i) >= 'A' .and. digest(i:i) <= 'F') digest(i:i) = achar(iachar(digest(i:i)) + 32)
    end do
  end function digest_of_text

  !> The last one or two blocks: the rest of the text, a one bit, zeros and the length in bits.
  pure subroutine pad(rest, num_bytes, tail, num_blocks)
    character(*), intent(in) :: rest !< shorter than a block
    integer(long), intent(in) :: num_bytes !< of the whole text
    character(2*block_size), intent(out) :: tail
    integer, intent(out) :: num_blocks
    integer :: i, last
    tail = repeat(achar(0), len(tail))
    tail(:len(rest)) = rest
    tail(len(rest) + 1:len(rest) + 1) = char(128)
    num_blocks = merge(1, 2, len(rest) + 9 <= block_size)
    last = num_blocks*block_size
    do i = 0, 7
      tail(last - i:last - i) = char(int(iand(ishft(8*num_bytes, -8*i), 255_long)))
    end do
  end subroutine pad

  !> The compression of one block.
  pure subroutine add_block(round_constant, sum, text)
    integer(long), intent(in) :: round_constant(64)
    integer(long), intent(inout) :: sum(8)
    character(block_size), intent(in) :: text
    integer(long) :: w(64), h(8), first, second
    integer :: i
    call expand(text, w)
    h = sum
    do i = 1, 64
      first = h(8) + rotations(h(5), 6, 11, 25) + &
              ieor(iand(h(5), h(6)), iand(iand(not(h(5)), mask), h(7))) + round_constant(i) + w(i)
      second = rotations(h(1), 2, 13, 22) + &
               ieor(ieor(iand(h(1), h(2)), iand(h(1), h(3))), iand(h(2), h(3)))
      h(2:8) = h(1:7)
      h(5) = iand(h(5) + first, mask)
      h(1) = iand(first + second, mask)
    end do
    sum = iand(sum + h, mask)
  end subroutine add_block

  !> The message schedule.
  pure subroutine expand(text, w)
    character(block_size), intent(in) :: text
    integer(long), intent(out) :: w(64)
    integer(long) :: small_0, small_1
    integer :: i, b
    do i = 1, 16
      w(i) = 0
      do b = 4*i - 3, 4*i
        w(i) = ior(ishft(w(i), 8), iand(int(ichar(text(b:b)), long), 255_long))
      end do
    end do
    do i = 17, 64
      small_0 = ieor(ieor(rotate(w(i - 15), 7), rotate(w(i - 15), 18)), ishft(w(i - 15), -3))
      small_1 = ieor(ieor(rotate(w(i - 2), 17), rotate(w(i - 2), 19)), ishft(w(i - 2), -10))
      w(i) = iand(w(i - 16) + small_0 + w(i - 7) + small_1, mask)
    end do
  end subroutine expand

  !> Exclusive or of three rotations.
  pure integer(long) function rotations(word, first, second, third) result(mixed)
    integer(long), intent(in) :: word
    integer, intent(in) :: first, second, third
    mixed = ieor(ieor(rotate(word, first), rotate(word, second)), rotate(word, third))
  end function rotations

  !> Rotation of a 32-bit word to the right.
  pure integer(long) function rotate(word, places) result(turned)
    integer(long), intent(in) :: word
    integer, intent(in) :: places
    turned = iand(ior(ishft(word, -places), ishft(word, 32 - places)), mask)
  end function rotate
end module sha256
