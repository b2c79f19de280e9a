!> The digest against the examples of FIPS 180-4 and the edges of the padding.
program test_sha256
  use sha256, only: digest_of_text
  use testing, only: test_log, check_text
  implicit none
  type(test_log) :: log
  log%suite = 'sha256'
  call check_text(log, digest_of_text(''), &
                  'e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855', 'empty text')
  call check_text(log, digest_of_text('abc'), &
                  'ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad', 'abc')
  call check_text(log, digest_of_text('abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq'), &
                  '248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1', 'two blocks')
  call check_text(log, digest_of_text(repeat('a', 1000)), &
                  '41edece42d63e8d9bf515a9ba6932e1c'// &
                  '20cbc9f5a5d134645adb5db1b9737ea3', '1000 letters')
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_sha256
