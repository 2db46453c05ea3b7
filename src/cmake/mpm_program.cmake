# mpm3d_add_program(<target> <ROLE> <file> ... [<ROLE> <file> ...] [SOURCES <file> ...])
#
# For projects that use the installed package: an mpm3d with classes of their own beside its own.
# ROLE is MATERIAL, DRIVER, CONTACT ...; a file <stem>.f90 has the module mpm_<stem> with the type
# <stem>_t. SOURCES are files that these use. One such program a folder.
#
# It works as in verification/: the program has registries of its own, which the linker takes in
# place of those in the library.
include_guard()
include(${CMAKE_CURRENT_LIST_DIR}/mpm_register.cmake)

function(mpm3d_add_program target)
  string(TOUPPER "${mpm3d_roles}" keywords)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;${keywords}")
  if(arg_UNPARSED_ARGUMENTS)
    list(JOIN keywords ", " known)
    message(FATAL_ERROR "mpm3d_add_program: expected one of ${known}, SOURCES, "
      "got: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(sources ${arg_SOURCES})
  foreach(role IN LISTS mpm3d_roles)
    string(TOUPPER ${role} keyword)
    if(NOT arg_${keyword})
      continue()
    endif()
    set(stems ${arg_${keyword}})
    list(TRANSFORM stems REPLACE "^.*/" "")
    list(TRANSFORM stems REPLACE "[.]f90$" "")
    mpm_write_registry(${role} ${mpm3d_${role}_types} ${stems})
    list(APPEND sources ${arg_${keyword}} ${CMAKE_CURRENT_BINARY_DIR}/${role}_registry.f90)
  endforeach()
  add_executable(${target} ${sources}
    ${mpm3d_app_folder}/command_line.f90 ${mpm3d_app_folder}/mpm3d.f90)
  set_target_properties(${target} PROPERTIES
    Fortran_MODULE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/${target}_modules)
  target_link_libraries(${target} PRIVATE mpm3d::mpm3d_core)
endfunction()
