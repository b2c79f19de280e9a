!> The SHA-256 digest of a file, so that a result can be traced to the very deck that made it.
!>
!> Source: FIPS 180-4. Words are kept in 64-bit integers and masked, for Fortran has no unsigned.
module sha256
  use kinds, only: long
  implicit none
  private
  public :: digest_of_file, digest_of_text

  integer(long), parameter :: mask = int(z'FFFFFFFF', long)
  integer, parameter :: block_size = 64 !< bytes

  !> Fractional parts of the cube roots of the first 64 primes.
  integer(long), parameter :: round_constant(64) = [ &
    int(z'428a2f98', long), int(z'71374491', long), int(z'b5c0fbcf', long), int(z'e9b5dba5', long), &
    int(z'3956c25b', long), int(z'59f111f1', long), int(z'923f82a4', long), int(z'ab1c5ed5', long), &
    int(z'd807aa98', long), int(z'12835b01', long), int(z'243185be', long), int(z'550c7dc3', long), &
    int(z'72be5d74', long), int(z'80deb1fe', long), int(z'9bdc06a7', long), int(z'c19bf174', long), &
    int(z'e49b69c1', long), int(z'efbe4786', long), int(z'0fc19dc6', long), int(z'240ca1cc', long), &
    int(z'2de92c6f', long), int(z'4a7484aa', long), int(z'5cb0a9dc', long), int(z'76f988da', long), &
    int(z'983e5152', long), int(z'a831c66d', long), int(z'b00327c8', long), int(z'bf597fc7', long), &
    int(z'c6e00bf3', long), int(z'd5a79147', long), int(z'06ca6351', long), int(z'14292967', long), &
    int(z'27b70a85', long), int(z'2e1b2138', long), int(z'4d2c6dfc', long), int(z'53380d13', long), &
    int(z'650a7354', long), int(z'766a0abb', long), int(z'81c2c92e', long), int(z'92722c85', long), &
    int(z'a2bfe8a1', long), int(z'a81a664b', long), int(z'c24b8b70', long), int(z'c76c51a3', long), &
    int(z'd192e819', long), int(z'd6990624', long), int(z'f40e3585', long), int(z'106aa070', long), &
    int(z'19a4c116', long), int(z'1e376c08', long), int(z'2748774c', long), int(z'34b0bcb5', long), &
    int(z'391c0cb3', long), int(z'4ed8aa4a', long), int(z'5b9cca4f', long), int(z'682e6ff3', long), &
    int(z'748f82ee', long), int(z'78a5636f', long), int(z'84c87814', long), int(z'8cc70208', long), &
    int(z'90befffa', long), int(z'a4506ceb', long), int(z'bef9a3f7', long), int(z'c67178f2', long)]

  !> Fractional parts of the square roots of the first 8 primes.
  integer(long), parameter :: start_value(8) = [ &
    int(z'6a09e667', long), int(z'bb67ae85', long), int(z'3c6ef372', long), int(z'a54ff53a', long), &
    int(z'510e527f', long), int(z'9b05688c', long), int(z'1f83d9ab', long), int(z'5be0cd19', long)]

contains

  !> Digest of the bytes of a file, 64 hexadecimal digits; empty when it cannot be read.
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
    integer(long) :: sum(8)
    integer :: i, whole, num_tail
    sum = start_value
    whole = len(bytes)/block_size
    do i = 1, whole
      call add_block(sum, bytes((i - 1)*block_size + 1:i*block_size))
    end do
    call pad(bytes(whole*block_size + 1:), int(len(bytes), long), tail, num_tail)
    do i = 1, num_tail
      call add_block(sum, tail((i - 1)*block_size + 1:i*block_size))
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
    character(*), intent(out) :: tail
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
  pure subroutine add_block(sum, text)
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
