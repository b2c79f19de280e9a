!> The balance of several ranks in job.json.
module rank_json
  use json_writer, only: json_text
  use rank_balance, only: balance_of_ranks, spread
  implicit none
  private
  public :: put_balance

contains

  !> An object 'ranks'; none for one rank.
  subroutine put_balance(json, balance)
    type(json_text), intent(inout) :: json
    type(balance_of_ranks), intent(in) :: balance
    integer :: i
    if (balance%num_ranks == 0) return
    call json%open_object('ranks')
    call json%put_integer(balance%num_ranks, 'number')
    call json%put_real(balance%share, 'exchange_share')
    call put_spread(json, balance%elements, 'elements')
    call put_spread(json, balance%memory, 'peak_memory_mb')
    call put_spread(json, balance%exchange, 'exchange_s')
    call json%open_array('parts')
    do i = 1, size(balance%parts)
      call put_spread(json, balance%parts(i))
    end do
    call json%close_array()
    call json%close_object()
  end subroutine put_balance

  !> Least, mean and most of a rank.
  subroutine put_spread(json, over, name)
    type(json_text), intent(inout) :: json
    type(spread), intent(in) :: over
    character(*), intent(in), optional :: name !< of the object; else its name is a member
    call json%open_object(name)
    if (.not. present(name)) call json%put_text(over%name, 'name')
    call json%put_real(over%least, 'least')
    call json%put_real(over%mean, 'mean')
    call json%put_real(over%most, 'most')
    call json%close_object()
  end subroutine put_spread
end module rank_json
