# `cmake --install`: the program, the library, its modules, and a package for find_package(mpm3d),
# with the function mpm3d_add_program; completion, mpm_pygen, manual and scenes.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/mpm3d)

install(TARGETS mpm3d mpm3d_core EXPORT mpm3dTargets)
get_target_property(module_folder mpm3d_core Fortran_MODULE_DIRECTORY)
install(DIRECTORY ${module_folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mpm3d
  FILES_MATCHING PATTERN "*.mod")
install(EXPORT mpm3dTargets NAMESPACE mpm3d:: DESTINATION ${package_folder})

# What mpm3d_add_program needs: the classes of each role, the program, and the template of a registry.
get_property(mpm_roles GLOBAL PROPERTY mpm_roles)
set(mpm_types "set(mpm3d_roles ${mpm_roles})\n")
foreach(role IN LISTS mpm_roles)
  get_property(types GLOBAL PROPERTY mpm_${role}_types)
  string(APPEND mpm_types "set(mpm3d_${role}_types ${types})\n")
endforeach()
install(FILES ${CMAKE_CURRENT_LIST_DIR}/mpm_program.cmake ${CMAKE_CURRENT_LIST_DIR}/mpm_register.cmake
  ${CMAKE_CURRENT_LIST_DIR}/registry.f90.in DESTINATION ${package_folder})
install(FILES ${PROJECT_SOURCE_DIR}/src/app/command_line.f90 ${PROJECT_SOURCE_DIR}/src/app/mpm3d.f90
  DESTINATION ${package_folder}/app)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/mpm3dConfig.cmake.in
  ${PROJECT_BINARY_DIR}/mpm3dConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mpm3dConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mpm3dConfig.cmake ${PROJECT_BINARY_DIR}/mpm3dConfigVersion.cmake
  DESTINATION ${package_folder})

install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/src/app/mpm3d.bash RENAME mpm3d
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)

# mpm_pygen stands where Debian's Python looks for packages when the prefix is /usr.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/mpm_pygen/src/mpm_pygen DESTINATION lib/python3/dist-packages
  FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/src/app/mpm-pygen DESTINATION ${CMAKE_INSTALL_BINDIR})

# The folders of the project that people read keep their places, so that links between them lead on.
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  ${PROJECT_SOURCE_DIR}/CITATION.cff ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm3d)
install(FILES ${PROJECT_SOURCE_DIR}/mpm_pygen/README.md
  DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm3d/mpm_pygen)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm3d
  FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg"
  PATTERN "manual" EXCLUDE PATTERN "notes" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/configs DESTINATION ${CMAKE_INSTALL_DATADIR}/mpm3d
  USE_SOURCE_PERMISSIONS
  FILES_MATCHING PATTERN "*.md" PATTERN "*.cfg" PATTERN "*.parts" PATTERN "*.sh")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
