# Debian packages: `cpack --config build/release/CPackConfig.cmake` in any folder.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME eventide)
set(CPACK_PACKAGE_CONTACT "the eventide developers <eventide@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL library development program)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
# What each binary needs is read from it; our own library lies in the build folder.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/library)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)

set(library libeventide${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${library})
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "${PROJECT_DESCRIPTION}: shared library and models")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libeventide-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "${PROJECT_DESCRIPTION}: headers for C++ and C")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME eventide)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION})")  # for its models
if(EVENTIDE_ROS2_ENABLED)  # loaded when a ROS 2 topic is named, so that dpkg-shlibdeps does not see it
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS libddsc0debian)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_SUGGESTS libddsc0debian)
endif()
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${PROJECT_DESCRIPTION}: the program")
if(EVENTIDE_PYTHON_ENABLED)
  list(APPEND CPACK_COMPONENTS_ALL python)
  math(EXPR python_minor_after "${Python3_VERSION_MINOR} + 1")  # a compiled module is for one version
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-eventide)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION}), python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3 (<< ${Python3_VERSION_MAJOR}.${python_minor_after}), python3-numpy")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "${PROJECT_DESCRIPTION}: Python module")
endif()
include(CPack)
