# Writes build_info.f90 from a template: cmake -D source= -D template= -D output= -P this file.
#
# The revision is the commit, with `+` when sources of the program differ from it.
set(revision unknown)
find_package(Git QUIET)
if(Git_FOUND AND EXISTS ${source}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --short=12 HEAD
    WORKING_DIRECTORY ${source} RESULT_VARIABLE failed
    OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed)
    set(revision ${commit})
    execute_process(
      COMMAND ${GIT_EXECUTABLE} status --porcelain -- src verification/drivers CMakeLists.txt
      WORKING_DIRECTORY ${source} OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      string(APPEND revision "+")
    endif()
  endif()
endif()
configure_file(${template} ${output} @ONLY)
