!> The classes that configs of mpm_3d v3 can name, and what became of each of them here.
!!
!! The one place that says so: `--list`, the class reference and the message about a class that is
!! not available take it from here. What differs for all classes alike, such as times of frames
!! and messages, is no difference of a class.
module mpm_original_classes
  implicit none
  private
  public :: original_class_t
  public :: is_new, kept, improved, missing
  public :: class_state, describe_original, missing_reason

  !> Same name and behaviour as in mpm_3d.
  character(*), parameter :: kept = 'as mpm_3d'
  !> Same name, better behaviour.
  character(*), parameter :: improved = 'improved'
  !> Not here.
  character(*), parameter :: missing = 'not available'
  !> No class of mpm_3d.
  character(*), parameter :: is_new = 'new'
  !> Why the classes of the finite volume method are not here.
  character(*), parameter :: finite_volumes = 'finite volumes: mpm3d has material points only'

  !> A class of mpm_3d.
  type :: original_class_t
    !> Its name.
    character(:), allocatable :: name
    !> `kept`, `improved` or `missing`.
    character(:), allocatable :: state
    !> What is better, or why it is not here; empty for a class that was kept.
    character(:), allocatable :: why
  end type original_class_t

contains

  !> The classes of mpm_3d of a role.
  pure subroutine describe_original(role, classes)
    !> Name of the role in the singular.
    character(*), intent(in) :: role
    !> Its classes; none for a role that mpm_3d does not have.
    type(original_class_t), allocatable, intent(out) :: classes(:)

    allocate (classes(0))
    select case (role)
    case ('serializer')
      call add_serializers(classes)
    case ('driver')
      call add_drivers(classes)
    case ('solver')
      call add_solvers(classes)
    case ('grid')
      call add_grids(classes)
    case ('body')
      call add_bodies(classes)
    case ('points')
      call add_points(classes)
    case ('part')
      call add_kept(classes, [character(9) :: 'Ball', 'Box', 'SineWave', 'SandPile'])
    case ('nodes')
      call add_kept(classes, ['DefaultNodes'])
    case ('material')
      call add_materials(classes)
    case ('boundary')
      call add_boundaries(classes)
    case ('contact')
      call add_contacts(classes)
    case default
      continue
    end select
  end subroutine describe_original

  !> What became of a class.
  pure subroutine class_state(role, name, state, why)
    !> Name of the role in the singular.
    character(*), intent(in) :: role
    !> Name of the class.
    character(*), intent(in) :: name
    !> `kept`, `improved` or `missing`; `is_new` for one that mpm_3d does not have.
    character(:), allocatable, intent(out) :: state
    !> What is better, or why it is not here; may be empty.
    character(:), allocatable, intent(out) :: why
    type(original_class_t), allocatable :: classes(:)
    integer :: i

    state = is_new
    why = ''
    call describe_original(role, classes)
    do i = 1, size(classes)
      if (classes(i)%name /= name) cycle
      state = classes(i)%state
      why = classes(i)%why
      return
    end do
  end subroutine class_state

  !> Why a class of mpm_3d is not available.
  pure function missing_reason(role, name) result(why)
    !> Name of the role in the singular.
    character(*), intent(in) :: role
    !> Name of the class.
    character(*), intent(in) :: name
    !> The reason; empty for all other names.
    character(:), allocatable :: why
    character(:), allocatable :: state

    call class_state(role, name, state, why)
    if (state /= missing) why = ''
  end function missing_reason

  !> Serializers.
  pure subroutine add_serializers(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)

    call add(classes, 'DefaultVTK', improved, 'checkpoints, histories, binary files; NaN and &
             &inactive points are not written as 0')
    call add(classes, 'MinimalVTK', improved, 'as DefaultVTK')
    call add(classes, 'SlicePointsVTK', improved, 'as DefaultVTK; each point is asked whether it &
             &is active')
    call add(classes, 'DebugVTK', improved, 'as DefaultVTK; frames of the window do not delay &
             &the others')
    call add(classes, 'FVMDefaultVTK', missing, finite_volumes)
  end subroutine add_serializers

  !> Drivers.
  pure subroutine add_drivers(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    character(*), parameter :: finite(5) = &
      [character(25) :: 'FiniteVolumeDriver', 'FVMVariableStepDriver', &
       'FVMNumericalDampingDriver', 'FVMBolideImpactDriver', 'FVMBolideRestartDriver']

    call add_kept(classes, [character(24) :: 'DefaultDriver', 'UserDefinedGravityDriver', &
                            'CavityFlowDriver', 'BallisticDriver'])
    call add(classes, 'ColumnCollapseDriver', improved, 'pressures in TYPE 4 and 5, gravity in &
             &TYPE 5')
    call add(classes, 'ChuteFlowDriver', improved, 'no NaN where a node lies just above the &
             &surface; a table that does not depend on the order of nodes')
    call add(classes, 'FishRandomSampleDriver', improved, 'samples by a seed; contacts begin anew &
             &in each run')
    call add(classes, 'FishMixtureModelRandomSampleDriver', improved, 'samples by a seed, from &
             &all distributions (mpm_3d: always the last one)')
    call add_missing(classes, finite, finite_volumes)
  end subroutine add_drivers

  !> Solvers.
  pure subroutine add_solvers(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    character(*), parameter :: finite(7) = &
      [character(25) :: 'FVMDefaultSolver', 'FVMRungeKuttaSolver', 'FVMSteadyStateSolver', &
       'FVMMixtureSolver', 'FVMMixtureSolverRK4', 'FVMStaticMixtureSolverRK4', &
       'ParallelMixtureSolverRK4']

    call add(classes, 'ExplicitUSL', improved, 'inertia of spin in TYPE 4, nodes of little mass, &
             &a check of dt, a choice of transfers')
    call add(classes, 'ParallelExplicitUSL', improved, 'the same bits for any number of threads, &
             &no crash in TYPE 4')
    call add(classes, 'ThreadPoolExplicitUSL', improved, 'the same bits for any number of threads')
    call add(classes, 'ExplicitUSLwithVolumetricStrainSmoothing', improved, 'sums begin anew for &
             &each body, cells have their sides, rate laws do not lock; names for all numbers')
    call add(classes, 'ExplicitMixtureSolver', improved, 'any material of grains, of constant &
             &density, in a barotropic fluid; other bodies move as ever, pressures that are given &
             &stay')
    call add(classes, 'TGVErrorSolver', missing, 'a case of the verification, taylor_green: &
             &docs/verification/fluid.md')
    call add(classes, 'ShiftedTGVErrorSolver', missing, 'a case of the verification, taylor_green &
             &with vortices between walls: docs/verification/fluid.md')
    call add(classes, 'GeneralizedVortexErrorSolver', missing, 'a case of the verification, &
             &vortex: docs/verification/manufactured_solutions.md')
    call add_missing(classes, finite, finite_volumes)
  end subroutine add_solvers

  !> Grids.
  pure subroutine add_grids(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    character(*), parameter :: lines = 'points on node lines and on the upper faces', &
                               walls = lines//', a check of the cells between walls'

    call add(classes, 'CartesianLinear', improved, lines)
    call add(classes, 'CartesianPeriodic', improved, lines//'; forces of the last cell are not &
             &lost')
    call add(classes, 'CartesianCustom', improved, lines//'; no dummy entries in TYPE 4 and 5')
    call add(classes, 'CartesianQuadratic', improved, walls//', node volumes that fill the box')
    call add(classes, 'CartesianQuadraticCustom', improved, 'as CartesianQuadratic; right with 3 &
             &cells between walls')
    call add(classes, 'CartesianCubic', improved, walls)
    call add(classes, 'CartesianCubicCustom', improved, 'as CartesianCubic; right with 3 cells &
             &between walls')
    call add(classes, 'CartesianCubic_Offset', improved, walls//', grid_velocity at the outer &
             &wall')
    call add(classes, 'CartesianUGIMP', improved, walls//', a check of the width')
    call add(classes, 'CartesianUGIMPCustom', improved, 'as CartesianUGIMP; right with 3 cells &
             &between walls')
    call add(classes, 'Linear1DNonUniform', improved, 'nodes by a seed or given; points on nodes')
    call add(classes, 'TriangularGridLinear', improved, 'negative coordinates, points on edges, &
             &any file of Gmsh 2.2 or 4.1, physical groups')
    call add(classes, 'TetrahedralGridLinear', improved, 'as TriangularGridLinear; either &
             &orientation of the cells')
    call add_missing(classes, [character(21) :: 'FVMCartesian', 'FVMGmsh2D', 'FVMGmsh3D', &
                               'FVMLinear1DNonUniform'], finite_volumes)
  end subroutine add_grids

  !> Bodies.
  pure subroutine add_bodies(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)

    call add_kept(classes, ['DefaultBody'])
    call add(classes, 'HydrostaticBody', improved, 'a choice of the free surface')
    call add_kept(classes, ['PrestressedBody'])
    call add(classes, 'LaunchedBody', improved, 'speed in TYPE 1')
    call add(classes, 'WheelBody', improved, 'inertia about the axle in 3D; no NaN')
    call add_missing(classes, [character(14) :: 'FVMDefaultBody', 'FVMRocketBody'], finite_volumes)
  end subroutine add_bodies

  !> Points.
  pure subroutine add_points(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)

    call add(classes, 'DefaultPoints', improved, 'a bad table is an error with its line')
    call add(classes, 'ThreadPoolPoints', improved, 'the same bits for any number of threads')
    call add(classes, 'CartesianPoints', improved, 'tables of TYPE 4 that can be read again')
    call add(classes, 'GmshPoints', improved, 'as CartesianPoints; files with cells of other &
             &dimensions')
    call add(classes, 'ImprovedQuadraturePoints', improved, 'CPDI2 in every dimension, volumes in &
             &TYPE 4, periodic grids, a seed; history of points that are merged and inserted')
  end subroutine add_points

  !> Materials.
  pure subroutine add_materials(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    character(*), parameter :: fluids(5) = &
      [character(25) :: 'FVMBarotropicViscousFluid', 'FVMSlurryFluidPhase', &
       'FVMCarmanKozenyFluid', 'FVMIdealGas', 'FVMSlurryGasPhase']

    call add_kept(classes, ['IsotropicLinearElasticity'])
    call add(classes, 'Sand_SachithLocal', improved, 'exact rotations; no flow where grains part; &
             &pressures that are assigned')
    call add(classes, 'BarotropicViscousFluid', improved, 'a choice of no tension; no shift of &
             &points, for which ImprovedQuadraturePoints is')
    call add(classes, 'CompressibleNeohookeanElasticity', improved, 'a volume ratio that is that &
             &of the point; stresses that are assigned')
    call add(classes, 'SlurryGranularPhase', improved, 'one equation to round-off; pressures at &
             &rest; exact rotations')
    call add(classes, 'SlurryFluidPhase', improved, 'also without grains; shear alone shifts &
             &points')
    call add(classes, 'SlurryGranularPhase_wUnderCompaction', improved, 'as SlurryGranularPhase')
    call add(classes, 'Cornstarch', improved, 'as SlurryGranularPhase')
    call add(classes, 'TillotsonEOSFluid', improved, 'viscosity, energy of cavities, cold curve, &
             &work of shocks')
    call add(classes, 'BreakageMechanicsSand', improved, 'plastic flow in pieces to the yield &
             &surface; pressures that are assigned')
    call add(classes, 'Fish', improved, 'a stress that follows from an energy')
    call add(classes, 'CompressibleBreakageMechanicsSand', missing, 'impact at shock pressures is &
             &left to later; BreakageMechanicsSand is for grains of constant density')
    call add(classes, 'CompressibleBreakageMechanicsRestart', missing, 'checkpoints restart every &
             &class: mpm3d -r FILE')
    call add(classes, 'CompressibleDamageMechanicsSandstone', missing, 'cemented rock is left to &
             &later; BreakageMechanicsSand is its sand without cement')
    call add_missing(classes, fluids, finite_volumes)
  end subroutine add_materials

  !> Boundaries.
  pure subroutine add_boundaries(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)

    call add(classes, 'CartesianBox', improved, 'faces of the grid, wherever they are')
    call add(classes, 'CartesianSmoothBox', improved, 'faces of the grid; no swirl on the axis')
    call add(classes, 'CartesianFrictionalBox', improved, 'hoop stress, a smooth axis, walls that &
             &only push if asked')
    call add(classes, 'CartesianBoxCustom', improved, 'each face has its own friction and bound; &
             &codes 2, 5 and 6 act as documented')
    call add(classes, 'AssignedVelocity', improved, 'motion out of the plane in TYPE 5')
    call add(classes, 'GeneralCustomBoundary', improved, 'slip keeps the forces along the wall; &
             &codes are checked')
  end subroutine add_boundaries

  !> Contacts.
  pure subroutine add_contacts(classes)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)

    call add(classes, 'ContactHuang', improved, 'symmetric normals (normals = 0: as mpm_3d), no &
             &NaN')
    call add(classes, 'ContactHuang_ReflectedBoundary', improved, 'faces of the grid; none where &
             &it is periodic')
    call add(classes, 'ContactRigid_ReflectedBoundary', improved, 'faces of the grid; none where &
             &it is periodic')
    call add(classes, 'ContactLinked', improved, 'symmetric normals (normals = 0: as mpm_3d), no &
             &NaN')
    call add(classes, 'SlurryMixture', improved, 'drag and buoyancy in TYPE 4; nodes of little &
             &mass')
    call add(classes, 'SlurryContact', improved, 'grains stick; nothing pulls; no NaN')
    call add(classes, 'SlurryContact_ReflectedBoundary', improved, 'as SlurryContact')
  end subroutine add_contacts

  !> Add classes that were kept as they are.
  pure subroutine add_kept(classes, names)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    !> Their names.
    character(*), intent(in) :: names(:)
    integer :: i

    do i = 1, size(names)
      call add(classes, trim(names(i)), kept, '')
    end do
  end subroutine add_kept

  !> Add classes that are not here for the same reason.
  pure subroutine add_missing(classes, names, why)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    !> Their names.
    character(*), intent(in) :: names(:)
    !> The reason.
    character(*), intent(in) :: why
    integer :: i

    do i = 1, size(names)
      call add(classes, trim(names(i)), missing, why)
    end do
  end subroutine add_missing

  !> Add a class.
  pure subroutine add(classes, name, state, why)
    !> The list.
    type(original_class_t), allocatable, intent(inout) :: classes(:)
    !> Its name.
    character(*), intent(in) :: name
    !> One of the states.
    character(*), intent(in) :: state
    !> What is better, or why it is not here.
    character(*), intent(in) :: why
    type(original_class_t), allocatable :: longer(:)

    allocate (longer(size(classes) + 1))
    longer(:size(classes)) = classes
    longer(size(longer))%name = name
    longer(size(longer))%state = state
    longer(size(longer))%why = why
    call move_alloc(longer, classes)
  end subroutine add

end module mpm_original_classes
