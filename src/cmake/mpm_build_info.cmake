# Writes build_info.f90, the module mpm_build_info, and adds it to mpm3d_core.
set(revision unknown)
if(EXISTS ${PROJECT_SOURCE_DIR}/.git)
  find_package(Git QUIET)
endif()
if(Git_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --short=12 HEAD
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} RESULT_VARIABLE failed
    OUTPUT_VARIABLE output ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed)
    set(revision ${output})
  endif()
  # A new commit makes the next build configure again, so that the revision stays true.
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --git-path logs/HEAD
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE log
    ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  cmake_path(ABSOLUTE_PATH log BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
  if(EXISTS ${log})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${log})
  endif()
endif()

# One flag a line: the source line stays short however many there are.
list(JOIN mpm_build_flags " '// &\n    '" flags)
configure_file(${PROJECT_SOURCE_DIR}/src/core/build_info.f90.in build_info.f90 @ONLY)
target_sources(mpm3d_core PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/build_info.f90)
