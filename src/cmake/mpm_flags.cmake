# Compiler flags, carried by the interface target `mpm_flags`. No global flag is set.
# mpm_build_flags: those that change what the compiler makes, for mpm_build_info.
set(release_flags -O3)
if(MPM3D_NATIVE)
  list(APPEND release_flags -march=native)
endif()
set(debug_flags -O1 -g -fcheck=all -ffpe-trap=invalid,zero,overflow -finit-real=snan)
# Errors that the run-time checks of Fortran do not see; the first one ends the program.
if(MPM3D_SANITIZE)
  list(APPEND debug_flags -fsanitize=address,undefined -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
endif()

add_library(mpm_flags INTERFACE)
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  target_compile_options(mpm_flags INTERFACE
    -std=f2008 -Wall -Wextra -Wimplicit-interface
    "$<$<CONFIG:Release>:${release_flags}>"
    "$<$<CONFIG:Debug>:${debug_flags}>"
    $<$<BOOL:${MPM3D_WERROR}>:-Werror>)
  if(MPM3D_SANITIZE)
    target_link_options(mpm_flags INTERFACE -fsanitize=address,undefined)
  endif()
else()
  if(NOT CMAKE_Fortran_COMPILER_ID STREQUAL "LLVMFlang")
    message(WARNING "mpm3d is tested with gfortran, and its unit tests with LLVM's flang; "
      "with ${CMAKE_Fortran_COMPILER_ID} CMake's default flags are used")
  endif()
  set(release_flags "")
  set(debug_flags "")
endif()

separate_arguments(mpm_build_flags NATIVE_COMMAND "${CMAKE_Fortran_FLAGS}")
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  list(APPEND mpm_build_flags ${debug_flags})
elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
  list(APPEND mpm_build_flags ${release_flags})
endif()
