!> How far the points of a body overfill the nodes, as lines of a text file.
module mpm_volume_metrics
  use mpm_errors, only: err_io, error_t, raise
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_volume_overshoot, only: measure_overshoot, overshoot_t
  implicit none
  private
  public :: volume_metrics, write_volume_metrics

contains

  !> Metrics of the first body of a model at the end of a step.
  !!
  !! With H_i = max(0, sum_p S_ip V_p - V_i), V_i the volume of the grid that belongs to node i:
  !! sum H_i**2, max H_i/V_i, sum m_p v_p**2/2, the mean of the second coordinate (TYPE 1: the
  !! first), weighted by mass, and sqrt(sum v_i**2 V_i).
  subroutine volume_metrics(model, metrics)
    !> The model, its points advanced.
    type(model_t), intent(in) :: model
    !> The five numbers.
    real(wp), intent(out) :: metrics(5)
    type(overshoot_t) :: overshoot
    real(wp) :: own
    integer :: i, n

    metrics = 0.0_wp
    associate (points => model%bodies(1)%body%points, nodes => model%bodies(1)%body%nodes)
      n = points%n_inside
      if (n == 0 .or. points%hi(1) < 0) return
      call measure_overshoot(points, model%grid, overshoot)
      metrics(1) = sum(overshoot%excess**2)
      metrics(2) = maxval(overshoot%relative)
      do i = 1, n
        metrics(3) = metrics(3) + 0.5_wp*points%mass(i)*sum(points%velocity(:, i)**2)
      end do
 metrics(4) = dot_product(points%mass(:n), points%x(min(2, model%kin%dim), :n))/sum(points%mass(:n))
      do i = 1, nodes%window%size()
        if (.not. nodes%mass(i) > 0.0_wp) cycle
        own = model%grid%node_volume(nodes%window%node(i))
        metrics(5) = metrics(5) + own*sum(nodes%velocity(:, i)**2)
      end do
      metrics(5) = sqrt(metrics(5))
    end associate
  end subroutine volume_metrics

  !> Write a line: the time and the metrics.
  subroutine write_volume_metrics(model, time, path, is_first, error)
    !> The model, its points advanced.
    type(model_t), intent(in) :: model
    !> Time at the end of the step. [s]
    real(wp), intent(in) :: time
    !> The file.
    character(*), intent(in) :: path
    !> Begin the file anew, with a line that names the columns.
    logical, intent(in) :: is_first
    !> The file can't be written.
    type(error_t), allocatable, intent(out) :: error
    character(200) :: reason
    real(wp) :: metrics(5)
    integer :: unit, status

    call volume_metrics(model, metrics)
    if (is_first) then
      open (newunit=unit, file=path, action='write', status='replace', iostat=status, iomsg=reason)
    else
      open (newunit=unit, file=path, action='write', status='old', position='append', &
            iostat=status, iomsg=reason)
    end if
    if (status == 0 .and. is_first) then
      write (unit, '(a)', iostat=status, iomsg=reason) &
        '# t, sum H^2, max H/V, kinetic energy, mean y, sqrt(sum v^2 V)'
    end if
    if (status == 0) then
      write (unit, '(*(es24.16e3, :, 1x))', iostat=status, iomsg=reason) time, metrics
    end if
    if (status == 0) close (unit, iostat=status, iomsg=reason)
    if (status == 0) return
    call raise(error, err_io, 'the file cannot be written: '//trim(reason), file=path, &
               hint='the first string of ExplicitUSLwithVolumetricStrainSmoothing names the file')
  end subroutine write_volume_metrics

end module mpm_volume_metrics
