# `cmake --install`: the program, the library, its modules, and a package for find_package(mpm3d).
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/mpm3d)

install(TARGETS mpm3d mpm3d_core EXPORT mpm3dTargets)
get_target_property(module_folder mpm3d_core Fortran_MODULE_DIRECTORY)
install(DIRECTORY ${module_folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mpm3d
  FILES_MATCHING PATTERN "*.mod")
install(EXPORT mpm3dTargets NAMESPACE mpm3d:: DESTINATION ${package_folder})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/mpm3dConfig.cmake.in
  ${PROJECT_BINARY_DIR}/mpm3dConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mpm3dConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mpm3dConfig.cmake ${PROJECT_BINARY_DIR}/mpm3dConfigVersion.cmake
  DESTINATION ${package_folder})

install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/src/app/mpm3d.bash RENAME mpm3d
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
