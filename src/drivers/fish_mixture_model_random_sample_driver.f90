!> Many runs of a swimming body, with muscles of a mixture of normal distributions.
module mpm_fish_mixture_model_random_sample_driver
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_fish_random_sample_driver, only: add_sample_notes, add_sample_properties, &
                                           fish_random_sample_driver_t
  use mpm_gaussian_mixture, only: gaussian_mixture_t
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: fish_mixture_model_random_sample_driver_t

  !> Runs from the same start, one behind the other, with muscles of a mixture.
  type, extends(fish_random_sample_driver_t) :: fish_mixture_model_random_sample_driver_t
    !> Where the muscles come from.
    type(gaussian_mixture_t) :: mixture
    !> Its file.
    character(:), allocatable :: input_file
  contains
    procedure, nopass :: describe => fish_mixture_model_random_sample_driver_describe
    procedure :: init => fish_mixture_model_random_sample_driver_init
    procedure :: prepare => fish_mixture_model_random_sample_driver_prepare
    procedure :: draw => fish_mixture_model_random_sample_driver_draw
  end type fish_mixture_model_random_sample_driver_t

contains

  !> Purpose and properties of the class.
  subroutine fish_mixture_model_random_sample_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'FishMixtureModelRandomSampleDriver', &
                          'As FishRandomSampleDriver, with muscles drawn from a mixture of normal &
                          &distributions that a file gives.', &
                          'Random numbers: Box and Muller, Ann. Math. Stat. 29 (1958) 610-611', &
                          'driver'//nl//'{'//nl// &
                          '    class = "FishMixtureModelRandomSampleDriver"'//nl// &
                          '    # t_stop, ranges of alpha, beta, gamma, which are not used'//nl// &
                          '    properties = {1, 0, 0, 0, 0, 0, 0}'//nl// &
                          '    int-properties = {2, seed = 7}   # samples'//nl// &
                          '    str-properties = {"samples.csv", "mixture.txt", "block_0"}'//nl//'}')
    call add_sample_properties(description)
    call description%add_string('output_file', 'file for the table, relative to the working &
                                &directory')
    call description%add_string('input_file', 'file of the mixture, relative to the working &
                                &directory')
    call description%add_string('body', 'name of the fish', default='')
    call add_sample_notes(description)
    call description%add_note('The ranges are checked and not used, as in mpm_3d.')
    call description%add_note('The input file: a line k, d with d = 9; a line that is not used; &
                              &for each of the k distributions a line with the sum of the &
                              &probabilities up to its own, the mean of alpha, beta and gamma of &
                              &head, abdomen and tail, and the covariance row by row.')
    call description%add_note('A distribution is taken when a uniform number is below its sum and &
                              &not below those before (mpm_3d always takes the last one).')
  end subroutine fish_mixture_model_random_sample_driver_describe

  !> Set up from the properties.
  subroutine fish_mixture_model_random_sample_driver_init(self, properties, error)
    !> The driver.
    class(fish_mixture_model_random_sample_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> As of its parent.
    type(error_t), allocatable, intent(out) :: error

    self%input_file = properties%string('input_file')
    call self%fish_random_sample_driver_t%init(properties, error)
  end subroutine fish_mixture_model_random_sample_driver_init

  !> Read the mixture and find the fish.
  subroutine fish_mixture_model_random_sample_driver_prepare(self, model, error)
    !> The driver.
    class(fish_mixture_model_random_sample_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> No mixture of nine components, or no fish.
    type(error_t), allocatable, intent(out) :: error

    call self%mixture%read(self%input_file, error)
    if (allocated(error)) return
    if (self%mixture%dim /= 9) then
      call raise(error, err_input, 'd = '//to_text(self%mixture%dim)//' in place of 9', &
                 self%input_file, 1, 'alpha, beta and gamma of head, abdomen and tail')
      return
    end if
    call self%fish_random_sample_driver_t%prepare(model, error)
  end subroutine fish_mixture_model_random_sample_driver_prepare

  !> Draw the muscles of a run: alpha, beta and gamma of head, abdomen, tail.
  pure function fish_mixture_model_random_sample_driver_draw(self, sample) result(values)
    !> The driver.
    class(fish_mixture_model_random_sample_driver_t), intent(in) :: self
    !> Number of the run.
    integer, intent(in) :: sample
    !> The numbers.
    real(wp) :: values(9)

    values = self%mixture%draw(self%seed, sample)
  end function fish_mixture_model_random_sample_driver_draw

end module mpm_fish_mixture_model_random_sample_driver
