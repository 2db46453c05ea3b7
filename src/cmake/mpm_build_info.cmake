# Adds the module mpm_build_info to mpm3d_core; each build writes it anew where it has changed.
set(build_info ${CMAKE_CURRENT_BINARY_DIR}/build_info.f90)

# One flag a line: the source line stays short however many there are.
list(JOIN mpm_build_flags " '// &\n    '" flags)
# All but the revision, which belongs to the time of the build.
set(revision @revision@)
configure_file(${PROJECT_SOURCE_DIR}/src/core/build_info.f90.in build_info.f90.in @ONLY)
add_custom_target(mpm_build_info
  COMMAND ${CMAKE_COMMAND} -D source=${PROJECT_SOURCE_DIR} -D output=${build_info}
    -D template=${CMAKE_CURRENT_BINARY_DIR}/build_info.f90.in
    -P ${PROJECT_SOURCE_DIR}/src/cmake/mpm_write_build_info.cmake
  BYPRODUCTS ${build_info} COMMENT "" VERBATIM)
target_sources(mpm3d_core PRIVATE ${build_info})
add_dependencies(mpm3d_core mpm_build_info)
