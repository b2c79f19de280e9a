!> The gaps of *CLEARANCE, after all contact pairs are read.
module finish_contact
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  implicit none
  private
  public :: complete_clearances

contains

  !> Sets the gaps of *CLEARANCE. All pairs must be read.
  subroutine complete_clearances(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: given(size(model%joints)), i, j
    given = 0
    do i = 1, size(model%clearances)
      associate (this => model%cards(model%clearances(i)%card))
        j = pair_between(model, this%word('SLAVE'), this%word('MASTER'))
        if (j == 0) then
          call this%fault(faults, "no contact pair has the slave surface '"// &
                          this%text('SLAVE')//"' and the master surface '"// &
                          this%text('MASTER')//"'", 'surfaces of a *CONTACT PAIR')
        else if (given(j) > 0) then
          call this%fault(faults, 'the pair already has a *CLEARANCE', 'one for each pair', &
                          first=model%cards(given(j))%place())
        else if (model%joints(j)%is_adjusted) then
          call this%fault(faults, 'the pair has ADJUST', 'ADJUST or *CLEARANCE, not both', &
                          first=model%cards(model%joints(j)%spot%card)%place())
        else
          given(j) = model%clearances(i)%card
          model%joints(j)%is_measured = .false.
          model%laws(model%joints(j)%contact_law)%law%gap = this%real('VALUE')
        end if
      end associate
    end do
  end subroutine complete_clearances

  !> The contact pair between two surfaces in either order, 0 for none.
  pure integer function pair_between(model, slave, master) result(found)
    type(draft), intent(in) :: model
    character(*), intent(in) :: slave, master !< upper case
    integer :: j
    found = 0
    do j = 1, size(model%joints)
      associate (joint => model%joints(j))
        if (joint%contact_law == 0) cycle
        associate (own => model%problem%surfaces(joint%slave)%name, &
                   other => model%problem%surfaces(joint%master)%name)
          if (own == slave .and. other == master .or. own == master .and. other == slave) found = j
        end associate
      end associate
    end do
  end function pair_between
end module finish_contact
