# What goes where when eventide is installed. Models are found from the folder of the library or the
# program upwards (src/model/model_folders.cpp).
include(CMakePackageConfigHelpers)

set(data ${CMAKE_INSTALL_DATADIR}/eventide)
install(DIRECTORY config/models/ DESTINATION ${data}/models COMPONENT core
  FILES_MATCHING PATTERN "*.safetensors" PATTERN checkpoints EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT core)
if(EVENTIDE_IO_ENABLED)
  install(DIRECTORY config/cameras DESTINATION ${data} COMPONENT library FILES_MATCHING PATTERN "*.toml")
  install(FILES config/udev/65-eventide.rules DESTINATION lib/udev/rules.d COMPONENT library)
endif()
if(EVENTIDE_PROGRAM_ENABLED)
  install(TARGETS eventide COMPONENT program)
  install(FILES config/default.toml DESTINATION ${data} COMPONENT program)
  # The pages with all that they link to.
  install(FILES README.md CHANGELOG.md CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
    FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.webp" PATTERN "*.png")
  install(DIRECTORY research DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
    FILES_MATCHING PATTERN "*.md" PATTERN "*.csv")
  install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
    FILES_MATCHING PATTERN "*.c" PATTERN "*.cpp" PATTERN "*.py" PATTERN "CMakeLists.txt")
  install(FILES ${PROJECT_BINARY_DIR}/manual/page DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 RENAME eventide.1 COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/manual/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME eventide COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/manual/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
    RENAME _eventide COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/manual/fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    RENAME eventide.fish COMPONENT program)
  install(FILES config/systemd/eventide@.service DESTINATION lib/systemd/system COMPONENT program)
endif()

# The public libraries, and how CMake and pkg-config find them. Two files of targets with the same names: the shared
# libraries and the static ones.
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/eventide)
file(RELATIVE_PATH EVENTIDE_PC_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" EVENTIDE_PC_UP "${EVENTIDE_PC_UP}")
set(EVENTIDE_COMPONENTS core)
set(public eventide-core:frames:core)
if(EVENTIDE_IO_ENABLED)
  list(APPEND EVENTIDE_COMPONENTS io cameras pipeline)
  list(APPEND public eventide:whole:library)
endif()
foreach(one IN LISTS public)
  string(REPLACE ":" ";" one ${one})
  list(GET one 0 pc)
  list(GET one 1 name)
  list(GET one 2 component)
  install(TARGETS eventide_${name}_static EXPORT eventideStatic ARCHIVE COMPONENT development)
  if(BUILD_SHARED_LIBS)
    install(TARGETS eventide_${name}_shared EXPORT eventideShared LIBRARY COMPONENT ${component} NAMELINK_COMPONENT development)
  endif()
  get_target_property(packages eventide_${name}_static EVENTIDE_PACKAGES)
  list(TRANSFORM packages REPLACE "^Threads::Threads$" "pthread")
  list(TRANSFORM packages PREPEND "-l")
  list(JOIN packages " " EVENTIDE_PC_PRIVATE)
  configure_file(config/cmake/${pc}.pc.in ${PROJECT_BINARY_DIR}/${pc}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${pc}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endforeach()
install(EXPORT eventideStatic NAMESPACE eventide:: DESTINATION ${package} COMPONENT development)
if(BUILD_SHARED_LIBS)
  install(EXPORT eventideShared NAMESPACE eventide:: DESTINATION ${package} COMPONENT development)
endif()
install(DIRECTORY include/eventide DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
configure_package_config_file(config/cmake/eventideConfig.cmake.in ${PROJECT_BINARY_DIR}/eventideConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/eventideConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/eventideConfig.cmake ${PROJECT_BINARY_DIR}/eventideConfigVersion.cmake
  DESTINATION ${package} COMPONENT development)
