!> Texts from which points are generated: keys, and sections that are parts.
module mpm_generator_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_document, only: document_t, raise_at, value_t, value_to_integer, value_to_real
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: lp, wp
  use mpm_number_parser, only: number_ok, parse_real
  use mpm_number_text, only: append_real, max_number_length
  use mpm_parser, only: parse_file
  use mpm_part_list, only: suggestion
  use mpm_strings, only: excerpt, to_text
  use mpm_text_writer, only: text_writer_t
  implicit none
  private
  public :: generator_text_t, write_points_table

  !> Largest length and density, so that the product of four of them can be stored.
  real(wp), parameter :: largest = 1.0e75_wp

  !> A generator text whose keys are known to exist.
  type :: generator_text_t
    !> The whole text.
    type(document_t) :: document
    !> Where to write the points table; empty when it is not asked for.
    character(:), allocatable :: out_file
  contains
    !> Read a text.
    procedure :: open => generator_text_open
    !> Positive reals of a key.
    procedure :: read_reals => generator_text_read_reals
    !> Positive integers of a key.
    procedure :: read_integers => generator_text_read_integers
    !> Text of a key.
    procedure :: read_text => generator_text_read_text
    !> Line of a key.
    procedure :: line_of => generator_text_line_of
    procedure, private :: find_values => generator_text_find_values
    procedure, private :: read_out_file => generator_text_read_out_file
  end type generator_text_t

contains

  !> Read a text.
  subroutine generator_text_open(self, path, known_keys, error)
    !> The text.
    class(generator_text_t), intent(inout) :: self
    !> Its file.
    character(*), intent(in) :: path
    !> The keys that it may have, `out_file` among them.
    character(*), intent(in) :: known_keys(:)
    !> A syntax error, an unknown key, or a bad `out_file`.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    call parse_file(path, self%document, error)
    if (allocated(error)) return
    do i = 1, size(self%document%entries)
      associate (entry => self%document%entries(i))
        if (any(known_keys == entry%key)) cycle
        call raise(error, err_input, 'unknown key "'//excerpt(entry%key)// &
                   '" in a generator text', file=path, line=entry%line, &
                   hint=suggestion(entry%key, known_keys))
        return
      end associate
    end do
    call self%read_out_file(error)
  end subroutine generator_text_open

  !> Positive reals of a key.
  subroutine generator_text_read_reals(self, key, numbers, error)
    !> The text.
    class(generator_text_t), intent(in) :: self
    !> The key.
    character(*), intent(in) :: key
    !> As many numbers as the key must have values.
    real(wp), intent(out) :: numbers(:)
    !> A missing key, or numbers that are not positive.
    type(error_t), allocatable, intent(out) :: error
    type(value_t), allocatable :: values(:)
    logical :: is_good
    integer :: i

    numbers = 0.0_wp
    call self%find_values(key, size(numbers), values, error)
    if (allocated(error)) return
    do i = 1, size(numbers)
      call value_to_real(values(i), numbers(i), error)
      if (allocated(error)) return
      is_good = ieee_is_finite(numbers(i))
      if (is_good) is_good = numbers(i) > 0.0_wp .and. numbers(i) <= largest
      if (is_good) cycle
      call raise_at(error, values(i), key//' = '//excerpt(values(i)%text)//' is out of bounds: '// &
                    'above 0, at most '//to_text(largest), hint=meaning(key))
      return
    end do
  end subroutine generator_text_read_reals

  !> Positive integers of a key.
  subroutine generator_text_read_integers(self, key, numbers, error)
    !> The text.
    class(generator_text_t), intent(in) :: self
    !> The key.
    character(*), intent(in) :: key
    !> As many numbers as the key must have values.
    integer, intent(out) :: numbers(:)
    !> A missing key, or numbers that are not positive.
    type(error_t), allocatable, intent(out) :: error
    type(value_t), allocatable :: values(:)
    integer :: i

    numbers = 0
    call self%find_values(key, size(numbers), values, error)
    if (allocated(error)) return
    do i = 1, size(numbers)
      call value_to_integer(values(i), numbers(i), error)
      if (allocated(error)) return
      if (numbers(i) > 0) cycle
      call raise_at(error, values(i), key//' = '//excerpt(values(i)%text)// &
                    ' is out of bounds: at least 1', hint=meaning(key))
      return
    end do
  end subroutine generator_text_read_integers

  !> Text of a key.
  subroutine generator_text_read_text(self, key, text, error)
    !> The text.
    class(generator_text_t), intent(in) :: self
    !> The key.
    character(*), intent(in) :: key
    !> What it says.
    character(:), allocatable, intent(out) :: text
    !> A missing key.
    type(error_t), allocatable, intent(out) :: error
    type(value_t), allocatable :: values(:)

    call self%find_values(key, 1, values, error)
    text = ''
    if (.not. allocated(error)) text = trim(values(1)%text)
  end subroutine generator_text_read_text

  !> Line of a key.
  pure function generator_text_line_of(self, key) result(line)
    !> The text.
    class(generator_text_t), intent(in) :: self
    !> The key.
    character(*), intent(in) :: key
    !> From 1; 0 when the text does not have the key.
    integer :: line
    integer :: i

    i = self%document%find(key)
    line = 0
    if (i > 0) line = self%document%entries(i)%line
  end function generator_text_line_of

  !> The values of a key.
  subroutine generator_text_find_values(self, key, n, values, error)
    !> The text.
    class(generator_text_t), intent(in) :: self
    !> The key.
    character(*), intent(in) :: key
    !> How many values it must have.
    integer, intent(in) :: n
    !> The values. (n)
    type(value_t), allocatable, intent(out) :: values(:)
    !> A missing key, too few or too many values, or values with names.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    i = self%document%find(key)
    if (i == 0) then
      call raise(error, err_input, 'the generator text has no "'//key//'", '//meaning(key), &
                 file=self%document%path, hint='add a line such as   '//example(key, n))
      return
    end if
    values = self%document%entries(i)%values
    if (size(values) /= n) then
      call raise(error, err_input, key//' needs '//to_text(n)//' value'// &
                 trim(merge('s', ' ', n > 1))//', found '//to_text(size(values)), &
                 file=self%document%path, line=self%line_of(key), &
                 hint=meaning(key)//':   '//example(key, n))
      return
    end if
    do i = 1, n
      if (len(values(i)%name) == 0) cycle
      call raise_at(error, values(i), 'the values of '//key//' have no names, found "'// &
                    excerpt(values(i)%name)//'"', hint='write for example   '//example(key, n))
      return
    end do
  end subroutine generator_text_find_values

  !> Read the key `out_file`.
  subroutine generator_text_read_out_file(self, error)
    !> The text.
    class(generator_text_t), intent(inout) :: self
    !> An empty path, or that of the text itself.
    type(error_t), allocatable, intent(out) :: error
    type(value_t), allocatable :: values(:)

    self%out_file = ''
    if (self%document%find('out_file') == 0) return
    call self%find_values('out_file', 1, values, error)
    if (allocated(error)) return
    if (len_trim(values(1)%text) == 0) then
      call raise_at(error, values(1), 'the name of the file to write is empty', &
                    hint='write for example   '//example('out_file', 1)//'   or remove the line')
    else if (values(1)%text == self%document%path) then
      call raise_at(error, values(1), 'the points table would replace the generator text itself', &
                    hint='choose another name')
    end if
    self%out_file = trim(values(1)%text)
  end subroutine generator_text_read_out_file

  !> What a key means.
  pure function meaning(key) result(text)
    !> The key.
    character(*), intent(in) :: key
    !> A few words.
    character(:), allocatable :: text

    select case (key)
    case ('Lx')
      text = 'the length of the lattice in each direction of the grid, in m'
    case ('Nx')
      text = 'the cells of the lattice in each direction of the grid'
    case ('lmpp')
      text = 'the number of points in each cell and direction'
    case ('msh_file')
      text = 'the Gmsh file whose cells get points'
    case ('rho')
      text = 'the density of the points, in kg/m3'
    case default
      text = 'the points table to write'
    end select
  end function meaning

  !> An example of a key with its values.
  pure function example(key, n) result(text)
    !> The key.
    character(*), intent(in) :: key
    !> Number of values.
    integer, intent(in) :: n
    !> One line.
    character(:), allocatable :: text

    select case (key)
    case ('Lx')
      text = 'Lx = {1.0'//repeat(', 1.0', n - 1)//'}'
    case ('Nx')
      text = 'Nx = {20'//repeat(', 20', n - 1)//'}'
    case ('lmpp')
      text = 'lmpp = 2'
    case ('rho')
      text = 'rho = 1000'
    case ('msh_file')
      text = 'msh_file = "box.msh"'
    case default
      text = key//' = "block.points"'
    end select
  end function example

  !> Write a points table; its numbers are as short as gives back every bit.
  subroutine write_points_table(path, table, error)
    !> The file, which is replaced.
    character(*), intent(in) :: path
    !> Mass, volume, position, velocity, active. (columns, n)
    real(wp), intent(in) :: table(:, :)
    !> `err_io`; then there is no new file.
    type(error_t), allocatable, intent(out) :: error
    type(text_writer_t) :: writer
    character((max_number_length + 1)*size(table, 1)) :: line
    integer :: p, i, length

    call writer%open(path, error)
    if (allocated(error)) return
    call writer%put_integer(size(table, 2))
    call writer%put_line()
    do p = 1, size(table, 2)
      length = 0
      do i = 1, size(table, 1)
        call append_exactly(line, length, table(i, p))
        length = length + 1
        line(length:length) = ' '
      end do
      call writer%put_line(line(:length - 1))
    end do
    call writer%commit(error)
  end subroutine write_points_table

  !> Write a number with 15 digits if they give back the number, as decimals of a user do, or 17.
  subroutine append_exactly(line, length, number)
    !> The text.
    character(*), intent(inout) :: line
    !> Characters in use.
    integer, intent(inout) :: length
    !> The number.
    real(wp), intent(in) :: number
    real(wp) :: read_back
    integer :: start, status

    start = length
    call append_real(line, length, number, 15)
    call parse_real(line, start + 1_lp, int(length, lp), read_back, status)
    if (status == number_ok .and. .not. abs(read_back - number) > 0.0_wp) return
    length = start
    call append_real(line, length, number, 17)
  end subroutine append_exactly

end module mpm_generator_text
