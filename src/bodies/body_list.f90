!> Finding a body among the bodies of a job.
module mpm_body_list
  use mpm_body, only: body_slot_t
  use mpm_errors, only: error_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, nearest_name, string_t, to_text
  implicit none
  private
  public :: find_body, find_partners

contains

  !> The body that a property names, or gives by its number.
  subroutine find_body(bodies, properties, name_key, id_key, position, error)
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Property that holds the name.
    character(*), intent(in) :: name_key
    !> Property that holds the number.
    character(*), intent(in) :: id_key
    !> Position in the list of bodies.
    integer, intent(out) :: position
    !> Neither is given, or there is no such body.
    type(error_t), allocatable, intent(out) :: error
    type(string_t) :: known(size(bodies))
    character(:), allocatable :: name, list, near
    integer :: i

    position = 0
    list = ''
    do i = 1, size(bodies)
      known(i)%text = bodies(i)%body%name
      if (i > 1) list = list//', '
      list = list//'"'//known(i)%text//'"'
    end do
    if (properties%given(name_key)) then
      name = properties%string(name_key)
      do i = 1, size(bodies)
        if (known(i)%text == name) position = i
      end do
      if (position > 0) return
      near = nearest_name(name, known)
      if (len(near) > 0) then
        near = 'did you mean "'//near//'"?'
      else
        near = 'bodies of this config: '//list
      end if
      call properties%reject(name_key, 'there is no body "'//excerpt(name)//'"', error, near)
    else if (properties%given(id_key)) then
      position = properties%integer(id_key)
      if (position < size(bodies)) then
        position = position + 1
        return
      end if
      call properties%reject(id_key, 'there is no body number '//to_text(position), error, &
                             'bodies are numbered from 0 in the order of the config: '//list)
    else
      call properties%reject(name_key, 'the body "'//name_key//'" is not named', error, &
                             'name it in str-properties; bodies of this config: '//list)
    end if
  end subroutine find_body

  !> Find the bodies that materials ask for, when all bodies exist.
  subroutine find_partners(bodies, error)
    !> All bodies of the job.
    type(body_slot_t), intent(inout) :: bodies(:)
    !> There is no such body, or it is the body itself.
    type(error_t), allocatable, intent(out) :: error
    integer :: i, position

    do i = 1, size(bodies)
      if (.not. allocated(bodies(i)%body%material)) cycle
      if (.not. allocated(bodies(i)%body%material%partner%name_key)) cycle
      associate (partner => bodies(i)%body%material%partner)
        call find_body(bodies, partner%properties, partner%name_key, partner%id_key, position, &
                       error)
        if (allocated(error)) return
        if (position == i) then
          call partner%properties%reject(partner%name_key, 'the body "'//bodies(i)%body%name// &
                                         '" names itself', error, 'name the other body')
          return
        end if
        partner%position = position
      end associate
    end do
  end subroutine find_partners

end module mpm_body_list
