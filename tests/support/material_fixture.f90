!> A single point with a material, moved by given velocity gradients.
module mpm_material_fixture
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_stress, kinematics_t, make_kinematics
  use mpm_material, only: material_t
  use mpm_material_registry, only: create_material
  use mpm_properties, only: make_properties, properties_t
  implicit none
  private
  public :: component, example_properties, material_point_t, stored_gradient

  !> A point.
  type :: material_point_t
    !> Its material.
    class(material_t), allocatable :: material
    !> Component counts.
    type(kinematics_t) :: kin
    !> Mass. [kg]
    real(wp) :: mass(1) = 1.0_wp
    !> Volume. [m3]
    real(wp) :: volume(1) = 1.0_wp
    !> Stress. [Pa] (nstress, 1)
    real(wp), allocatable :: stress(:, :)
    !> Memory of the material. (n_history, 1)
    real(wp), allocatable :: history(:, :)
    !> What the last step said of the point.
    integer :: first_bad = 0
    !> Message of an error of its making; empty when there is none.
    character(:), allocatable :: failure
  contains
    !> Make the material and the point, of 1 m3 at rest.
    procedure :: make => material_point_make
    !> Make steps of one velocity gradient.
    procedure :: move => material_point_move
    !> Give it a stress.
    procedure :: assign => material_point_assign
    !> The stress as a tensor.
    procedure :: tensor => material_point_tensor
    !> The pressure.
    procedure :: pressure => material_point_pressure
    !> sqrt(s:s/2).
    procedure :: tau => material_point_tau
    !> Largest wave speed.
    procedure :: speed => material_point_speed
    !> Recoverable energy.
    procedure :: energy => material_point_energy
  end type material_point_t

contains

  !> Make the material and the point, of 1 m3 at rest; `failure` tells what went wrong.
  subroutine material_point_make(self, class_name, sim_type, text, density)
    !> The point.
    class(material_point_t), intent(out) :: self
    !> Class of the material.
    character(*), intent(in) :: class_name
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Its properties as in a config: any of `properties`, `int-properties`, `str-properties`.
    character(*), intent(in) :: text
    !> Density. [kg/m3]
    real(wp), intent(in) :: density
    type(description_t) :: description
    type(properties_t) :: properties
    type(error_t), allocatable :: error
    real(wp), allocatable :: x(:, :)

    self%failure = ''
    self%kin = make_kinematics(sim_type)
    self%mass = density
    call create_material(class_name, self%material, error)
    if (.not. allocated(error)) then
      call self%material%describe(description)
      call make_properties(description, sim_type, text, properties, error)
    end if
    if (.not. allocated(error)) call self%material%init(self%kin, properties, error)
    if (allocated(error)) then
      self%failure = error%message
      return
    end if
    allocate (self%stress(self%kin%nstress, 1), source=0.0_wp)
    allocate (self%history(self%material%n_history, 1))
    allocate (x(self%kin%dim, 1), source=0.0_wp)
    call self%material%start(1, x, self%mass, self%volume, self%history)
  end subroutine material_point_make

  !> Make steps of one velocity gradient, until one says that the point is bad.
  subroutine material_point_move(self, l, dt, steps)
    !> The point.
    class(material_point_t), intent(inout) :: self
    !> Velocity gradient. [1/s]
    real(wp), intent(in) :: l(3, 3)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Number of steps.
    integer, intent(in) :: steps
    real(wp) :: g(self%kin%ngrad, 1)
    integer :: i

    g(:, 1) = stored_gradient(self%kin, l)
    do i = 1, steps
      self%volume = self%volume*exp(dt*(l(1, 1) + l(2, 2) + l(3, 3)))
      call self%material%update_stress(1, dt, g, self%mass, self%volume, self%stress, &
                                       self%history, self%first_bad)
      if (self%first_bad > 0) return
    end do
  end subroutine material_point_move

  !> Give it a stress.
  subroutine material_point_assign(self, tensor)
    !> The point.
    class(material_point_t), intent(inout) :: self
    !> The stress. [Pa]
    real(wp), intent(in) :: tensor(3, 3)
    real(wp) :: s(6), target(self%kin%nstress, 1)

    s = [tensor(1, 1), tensor(2, 2), tensor(3, 3), tensor(1, 2), tensor(2, 3), tensor(3, 1)]
    target(:, 1) = s(:self%kin%nstress)
    call self%material%assign_stress(1, target, self%mass, self%volume, self%stress, &
                                     self%history, self%first_bad)
  end subroutine material_point_assign

  !> The stress as a tensor.
  function material_point_tensor(self) result(tensor)
    !> The point.
    class(material_point_t), intent(in) :: self
    !> The stress. [Pa]
    real(wp) :: tensor(3, 3)

    tensor = expand_stress(self%stress(:, 1))
  end function material_point_tensor

  !> The pressure.
  function material_point_pressure(self) result(pressure)
    !> The point.
    class(material_point_t), intent(in) :: self
    !> -tr T/3. [Pa]
    real(wp) :: pressure

    pressure = -sum(self%stress(1:3, 1))/3.0_wp
  end function material_point_pressure

  !> sqrt(s:s/2).
  function material_point_tau(self) result(tau)
    !> The point.
    class(material_point_t), intent(in) :: self
    !> Shear stress. [Pa]
    real(wp) :: tau
    real(wp) :: t(3, 3)
    integer :: i

    t = self%tensor()
    do i = 1, 3
      t(i, i) = t(i, i) + self%pressure()
    end do
    tau = sqrt(0.5_wp*sum(t**2))
  end function material_point_tau

  !> Largest wave speed.
  function material_point_speed(self) result(speed)
    !> The point.
    class(material_point_t), intent(in) :: self
    !> The speed. [m/s]
    real(wp) :: speed

    speed = self%material%wave_speed(1, self%mass, self%volume, self%stress, self%history)
  end function material_point_speed

  !> Recoverable energy.
  function material_point_energy(self) result(energy)
    !> The point.
    class(material_point_t), intent(in) :: self
    !> The energy. [J]
    real(wp) :: energy

    energy = self%material%strain_energy(1, self%mass, self%volume, self%stress, self%history)
  end function material_point_energy

  !> Components of a velocity gradient that a TYPE stores: inverse of `expand_gradient`.
  function stored_gradient(kin, l) result(gradient)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Velocity gradient.
    real(wp), intent(in) :: l(3, 3)
    !> Stored components.
    real(wp) :: gradient(kin%ngrad)
    integer :: a

    do a = 1, kin%nvel
      gradient((a - 1)*kin%dim + 1:a*kin%dim) = l(a, :kin%dim)
    end do
    if (kin%sim_type == 4) gradient(7:8) = [l(1, 3), l(3, 3)]
  end function stored_gradient

  !> A tensor with one component.
  pure function component(a, b, value) result(l)
    !> Row.
    integer, intent(in) :: a
    !> Column.
    integer, intent(in) :: b
    !> Value.
    real(wp), intent(in) :: value
    !> The tensor.
    real(wp) :: l(3, 3)

    l = 0.0_wp
    l(a, b) = value
  end function component

  !> The properties in the example of a class of material, as `make_properties` takes them.
  function example_properties(class_name) result(text)
    !> Class of the material.
    character(*), intent(in) :: class_name
    !> Lines of properties.
    character(:), allocatable :: text
    character(*), parameter :: keys(3) = [character(18) :: 'material-props', 'material-int-props', &
                                          'material-str-props']
    character(*), parameter :: lists(3) = [character(14) :: 'properties', 'int-properties', &
                                           'str-properties']
    class(material_t), allocatable :: material
    type(description_t) :: description
    type(error_t), allocatable :: error
    character(:), allocatable :: rest, line
    integer :: cut, equals, k

    text = ''
    call create_material(class_name, material, error)
    if (allocated(error)) return
    call material%describe(description)
    rest = description%example//new_line('a')
    do while (len(rest) > 0)
      cut = index(rest, new_line('a'))
      line = adjustl(rest(:cut - 1))
      rest = rest(cut + 1:)
      if (index(line, 'material-class') > 0) cycle
      equals = index(line, '=')
      do k = 1, 3
        if (line(:max(0, equals - 2)) == trim(keys(k))) line = trim(lists(k))//' '//line(equals:)
      end do
      text = text//line//new_line('a')
    end do
  end function example_properties

end module mpm_material_fixture
