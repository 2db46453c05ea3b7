# `cpack`: a package for Debian and an archive, of what `cmake --install` installs.
#
# For other machines than the own one, build the preset `portable`: cpack --preset portable.
set(CPACK_PACKAGE_NAME mpm3d)
set(CPACK_PACKAGE_VENDOR "the mpm3d contributors")
set(CPACK_PACKAGE_CONTACT "the mpm3d contributors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION "mpm3d simulates solids, grains and fluids with the material point method.
It comes with the Python package mpm_pygen, which makes points and configs and draws results, with
scenes and the manual in /usr/share/mpm3d, and with a library for programs with classes of their own.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR DEB TGZ)

# dpkg-shlibdeps, of the package dpkg-dev, finds the packages of the shared libraries, with `file`.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3 (>= 3.11), python3-numpy, python3-matplotlib")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gfortran, cmake, ninja-build, libhdf5-dev, python3-h5py, python3-pil")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/src/cmake/prerm)
include(CPack)
