# What goes where when eventide is installed. Models are found from the folder of the library or the
# program upwards (src/model/model_folders.cpp).
include(CMakePackageConfigHelpers)

set(data ${CMAKE_INSTALL_DATADIR}/eventide)
install(TARGETS eventide COMPONENT program)
install(DIRECTORY config/models/ DESTINATION ${data}/models COMPONENT library
  FILES_MATCHING PATTERN "*.safetensors" PATTERN checkpoints EXCLUDE)
install(DIRECTORY config/cameras DESTINATION ${data} COMPONENT library FILES_MATCHING PATTERN "*.toml")
install(FILES config/default.toml DESTINATION ${data} COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/manual/page DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 RENAME eventide.1 COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/manual/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME eventide COMPONENT program)
install(FILES config/udev/65-eventide.rules DESTINATION lib/udev/rules.d COMPONENT program)
configure_file(config/systemd/eventide@.service.in ${PROJECT_BINARY_DIR}/eventide@.service @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/eventide@.service DESTINATION lib/systemd/system COMPONENT program)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT library)

install(TARGETS eventide_shared EXPORT eventideTargets
  LIBRARY COMPONENT library NAMELINK_COMPONENT development)
install(DIRECTORY include/eventide DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/eventide)
install(EXPORT eventideTargets NAMESPACE eventide:: DESTINATION ${package} COMPONENT development)
configure_package_config_file(config/cmake/eventideConfig.cmake.in ${PROJECT_BINARY_DIR}/eventideConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/eventideConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/eventideConfig.cmake ${PROJECT_BINARY_DIR}/eventideConfigVersion.cmake
  DESTINATION ${package} COMPONENT development)

file(RELATIVE_PATH EVENTIDE_PC_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" EVENTIDE_PC_UP "${EVENTIDE_PC_UP}")
configure_file(config/cmake/eventide.pc.in ${PROJECT_BINARY_DIR}/eventide.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/eventide.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
