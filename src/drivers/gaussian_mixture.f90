!> Random vectors of a mixture of normal distributions.
module mpm_gaussian_mixture
  use mpm_errors, only: err_input, error_t, raise
  use mpm_hashed_random, only: random_number_of
  use mpm_kinds, only: lp, wp
  use mpm_number_parser, only: parse_real
  use mpm_strings, only: excerpt, to_text
  use mpm_text_file, only: read_whole_file
  implicit none
  private
  public :: gaussian_mixture_t

  !> A covariance may lack this part of its largest diagonal entry to be one.
  real(wp), parameter :: rounding = 1.0e-10_wp

  !> A mixture of normal distributions.
  type :: gaussian_mixture_t
    !> Components of a vector.
    integer :: dim = 0
    !> Sums of the probabilities up to each distribution. (k)
    real(wp), allocatable :: cumulative(:)
    !> Means. (dim, k)
    real(wp), allocatable :: mean(:, :)
    !> Lower triangular roots of the covariances. (dim, dim, k)
    real(wp), allocatable :: root(:, :, :)
  contains
    !> Read a mixture from a file.
    procedure :: read => gaussian_mixture_read
    !> Draw a vector.
    procedure :: draw => gaussian_mixture_draw
  end type gaussian_mixture_t

contains

  !> Read a mixture: a line `k, d`, a line that is not used, and k lines with the sum of the
  !! probabilities so far, the mean and the covariance row by row.
  subroutine gaussian_mixture_read(self, path, error)
    !> The mixture.
    class(gaussian_mixture_t), intent(inout) :: self
    !> The file.
    character(*), intent(in) :: path
    !> It can't be read, or is no mixture.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text
    real(wp), allocatable :: numbers(:)
    integer :: first, line, i, k, d

    call read_whole_file(path, text, error)
    if (allocated(error)) return
    first = 1
    call next_line(text, first, path, 1, numbers, error)
    if (allocated(error)) return
    k = 0
    d = 0
    if (size(numbers) == 2) then
      ! Numbers that no integer can hold are no counts either.
      if (all(numbers >= 1.0_wp .and. numbers <= 1.0e4_wp)) then
        k = nint(numbers(1))
        d = nint(numbers(2))
      end if
    end if
    if (k == 0) then
      call raise(error, err_input, 'the first line is not "k, d"', path, 1, &
                 'the numbers of distributions and of components of a vector')
      return
    end if
    self%dim = d
    if (allocated(self%mean)) deallocate (self%cumulative, self%mean, self%root)
    allocate (self%cumulative(k), self%mean(d, k), self%root(d, d, k))
    first = first + index(text(first:)//new_line('a'), new_line('a'))
    do i = 1, k
      line = i + 2
      call next_line(text, first, path, line, numbers, error)
      if (allocated(error)) return
      if (size(numbers) /= 1 + d + d*d) then
        call raise(error, err_input, to_text(size(numbers))//' numbers in place of '// &
                   to_text(1 + d + d*d), path, line, 'a probability, '//to_text(d)// &
                   ' means and a covariance of '//to_text(d*d)//' numbers')
        return
      end if
      self%cumulative(i) = numbers(1)
      self%mean(:, i) = numbers(2:d + 1)
      call take_root(reshape(numbers(d + 2:), [d, d]), self%root(:, :, i), path, line, error)
      if (allocated(error)) return
    end do
    call check_probabilities(self%cumulative, path, error)
  end subroutine gaussian_mixture_read

  !> Sums of probabilities grow, and end at 1.
  subroutine check_probabilities(cumulative, path, error)
    !> The sums. (k)
    real(wp), intent(in) :: cumulative(:)
    !> The file.
    character(*), intent(in) :: path
    !> They do not.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: before
    integer :: i

    before = 0.0_wp
    do i = 1, size(cumulative)
      if (cumulative(i) < before .or. cumulative(i) > 1.0_wp + rounding) then
        call raise(error, err_input, 'the probabilities are not sums of those before', path, &
                   i + 2, 'each line has the sum of the probabilities up to its own; the last is 1')
        return
      end if
      before = cumulative(i)
    end do
  end subroutine check_probabilities

  !> The numbers of the next line, parted by commas or blanks.
  subroutine next_line(text, first, path, line, numbers, error)
    !> The text of the file.
    character(*), intent(in) :: text
    !> Position of the line; that of the next one on return.
    integer, intent(inout) :: first
    !> The file.
    character(*), intent(in) :: path
    !> Number of the line.
    integer, intent(in) :: line
    !> Its numbers.
    real(wp), allocatable, intent(out) :: numbers(:)
    !> Something that is no number.
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: separators = ' ,'//achar(9)//achar(13)
    integer :: last, start, length, status
    real(wp) :: number

    allocate (numbers(0))
    last = len(text)
    if (first <= last) then
      length = index(text(first:), new_line('a'))
      if (length > 0) last = first + length - 2
    end if
    do
      if (first > last) exit
      start = verify(text(first:last), separators)
      if (start == 0) exit
      first = first + start - 1
      length = scan(text(first:last), separators) - 1
      if (length < 0) length = last - first + 1
      call parse_real(text, int(first, lp), int(first + length - 1, lp), number, status)
      if (status /= 0) then
        call raise(error, err_input, '"'//excerpt(text(first:first + length - 1))// &
                   '" is not a number', path, line)
        return
      end if
      numbers = [numbers, number]
      first = first + length
    end do
    first = last + 2
  end subroutine next_line

  !> Lower triangular root of a covariance; a direction without variance has a column of 0.
  subroutine take_root(covariance, root, path, line, error)
    !> The covariance. (dim, dim)
    real(wp), intent(in) :: covariance(:, :)
    !> The root. (dim, dim)
    real(wp), intent(out) :: root(:, :)
    !> The file.
    character(*), intent(in) :: path
    !> Number of the line.
    integer, intent(in) :: line
    !> It is no covariance.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: scale, rest
    integer :: i, j

    scale = maxval(abs(covariance))
    root = 0.0_wp
    do j = 1, size(covariance, 1)
      do i = j, size(covariance, 1)
        rest = covariance(i, j) - dot_product(root(i, :j - 1), root(j, :j - 1))
        if (i == j .and. rest > rounding*scale) then
          root(j, j) = sqrt(rest)
        else if (i > j .and. root(j, j) > 0.0_wp) then
          root(i, j) = rest/root(j, j)
        end if
      end do
    end do
    if (maxval(abs(matmul(root, transpose(root)) - covariance)) <= 1.0e3_wp*rounding*scale) return
    call raise(error, err_input, 'the covariance is not symmetric, or a variance is negative', &
               path, line, 'a covariance is a symmetric matrix without negative eigenvalues')
  end subroutine take_root

  !> Draw a vector; the same one for the same seed and number.
  pure function gaussian_mixture_draw(self, seed, number) result(vector)
    !> The mixture.
    class(gaussian_mixture_t), intent(in) :: self
    !> Seed.
    integer, intent(in) :: seed
    !> Number of the vector.
    integer, intent(in) :: number
    !> The vector.
    real(wp) :: vector(self%dim)
    real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)
    real(wp) :: normal(self%dim), radius
    integer :: j, i

    associate (u => random_number_of(seed, int(number, lp), 0_lp, 0_lp))
      do j = 1, size(self%cumulative) - 1
        if (u < self%cumulative(j)) exit
      end do
    end associate
    do i = 1, self%dim
      radius = sqrt(-2.0_wp*log(random_number_of(seed, int(number, lp), int(i, lp), 1_lp)))
      normal(i) = radius*cos(turn*random_number_of(seed, int(number, lp), int(i, lp), 2_lp))
    end do
    vector = self%mean(:, j) + matmul(self%root(:, :, j), normal)
  end function gaussian_mixture_draw

end module mpm_gaussian_mixture
