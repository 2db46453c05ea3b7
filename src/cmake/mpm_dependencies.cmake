# OpenMP is required. HDF5 and LAPACK are looked for and reported; a target that uses one links
# hdf5::hdf5_fortran or LAPACK::LAPACK itself when MPM3D_HAVE_<library> is true.
find_package(OpenMP REQUIRED COMPONENTS Fortran)

function(mpm_find library)
  set(found FALSE)
  if(MPM3D_${library} STREQUAL "AUTO")
    find_package(${library} QUIET ${ARGN})
    set(found ${${library}_FOUND})
  elseif(MPM3D_${library})
    find_package(${library} REQUIRED ${ARGN})
    set(found TRUE)
  endif()
  if(found)
    message(STATUS "${library}: found ${${library}_VERSION}")
  else()
    message(STATUS "${library}: not used (MPM3D_${library}=${MPM3D_${library}})")
  endif()
  set(MPM3D_HAVE_${library} ${found} PARENT_SCOPE)
endfunction()

mpm_find(HDF5 COMPONENTS Fortran)
mpm_find(LAPACK)
