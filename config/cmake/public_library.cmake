# eventide_public_library(name SOURCES a.cpp... OF eventide::x... ON_TOP_OF other PACKAGES z...): one library of the
# public face, made of its own sources and of whatever they use of our static libraries.
#   eventide_NAME_shared   libNAME.so, with the symbols of exported_NAME.map
#   eventide_NAME_static   libNAME.a, one object that shows the same symbols; PACKAGES are what it wants of the linker
# ON_TOP_OF: another public library, which it uses and its users get with it.

# Every static library of ours that `ARGN` need, by target.
function(eventide_archives into)
  set(todo ${ARGN})
  set(found)
  while(todo)
    list(POP_FRONT todo item)
    string(REGEX REPLACE "^\\$<(LINK_ONLY|BUILD_INTERFACE):(.*)>$" "\\2" item "${item}")
    if(NOT TARGET "${item}")
      continue()
    endif()
    get_target_property(aliased ${item} ALIASED_TARGET)
    if(aliased)
      set(item ${aliased})
    endif()
    get_target_property(imported ${item} IMPORTED)
    get_target_property(type ${item} TYPE)
    if(imported OR item IN_LIST seen)
      continue()
    endif()
    list(APPEND seen ${item})
    if(type STREQUAL "STATIC_LIBRARY")
      list(APPEND found ${item})
    endif()
    get_target_property(uses ${item} INTERFACE_LINK_LIBRARIES)
    if(uses)
      list(APPEND todo ${uses})
    endif()
  endwhile()
  set(${into} ${found} PARENT_SCOPE)
endfunction()

function(eventide_public_library name)
  cmake_parse_arguments(arg "" "ON_TOP_OF;OUTPUT;EXPORT" "SOURCES;OF;PACKAGES" ${ARGN})
  set(objects eventide_${name}_objects)
  add_library(${objects} OBJECT ${arg_SOURCES})
  eventide_compile(${objects})
  eventide_hide_symbols(${objects})
  target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(${objects} PRIVATE ${arg_OF})

  set(map ${CMAKE_CURRENT_SOURCE_DIR}/exported_${name}.map)
  add_library(eventide_${name}_shared SHARED $<TARGET_OBJECTS:${objects}>)
  list(TRANSFORM arg_OF REPLACE "(.+)" "$<BUILD_INTERFACE:\\1>" OUTPUT_VARIABLE privately)
  # As needed: our archives bring the packages of all they hold.
  target_link_libraries(eventide_${name}_shared PRIVATE ${privately})
  target_link_options(eventide_${name}_shared PRIVATE LINKER:--as-needed LINKER:--version-script=${map})
  set_target_properties(eventide_${name}_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}
    LINK_DEPENDS ${map} INSTALL_RPATH "$ORIGIN")
  if(EVENTIDE_SANITIZE)
    eventide_compile(eventide_${name}_shared)
  else()  # a sanitizer's runtime may come with the program alone
    target_link_options(eventide_${name}_shared PRIVATE LINKER:--no-undefined)
  endif()

  # GNU's linker, also beside clang, for which CMake finds lld: that cannot dissolve groups.
  # Where another machine's programs are made, that of its own.
  get_filename_component(tools "${CMAKE_OBJCOPY}" NAME)
  string(REPLACE "objcopy" "ld" linker "${tools}")
  find_program(EVENTIDE_GNU_LINKER NAMES ${linker}.bfd ld.bfd ld DOC "GNU linker, for static libraries" REQUIRED)
  mark_as_advanced(EVENTIDE_GNU_LINKER)

  # One object, in which every name is local but those that the shared library shows. Groups are dissolved, as a
  # consumer's own copy of an inline function would drop a whole one; what gcc made unique in one is weak first, as
  # objcopy makes nothing unique local.
  eventide_archives(archives ${arg_OF})
  list(TRANSFORM archives REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE files)
  set(object ${CMAKE_CURRENT_BINARY_DIR}/${name}.o)
  set(names ${CMAKE_CURRENT_BINARY_DIR}/${name}.names)
  set(list_names "${CMAKE_NM} --dynamic --defined-only --format=posix --without-symbol-versions $<TARGET_FILE:eventide_${name}_shared>")
  add_custom_command(OUTPUT ${object} DEPENDS ${objects} $<TARGET_OBJECTS:${objects}> ${archives} eventide_${name}_shared
    VERBATIM COMMAND_EXPAND_LISTS
    COMMAND ${EVENTIDE_GNU_LINKER} -r --force-group-allocation -o ${object} $<TARGET_OBJECTS:${objects}> --start-group ${files} --end-group
    COMMAND sh -c "${CMAKE_NM} --format=posix ${object} | sed -n 's/ u .*//p' > ${names}"
    COMMAND ${CMAKE_OBJCOPY} --weaken-symbols=${names} ${object}
    COMMAND sh -c "${list_names} | cut -d ' ' -f 1 > ${names}"
    COMMAND ${CMAKE_OBJCOPY} --keep-global-symbols=${names} ${object})
  add_library(eventide_${name}_static STATIC ${object})
  set_target_properties(eventide_${name}_static PROPERTIES LINKER_LANGUAGE CXX EVENTIDE_PACKAGES "${arg_PACKAGES}")
  # A program in C does not bring C++'s library.
  target_link_libraries(eventide_${name}_static INTERFACE ${arg_PACKAGES} $<$<LINK_LANGUAGE:C>:stdc++> m)

  foreach(kind shared static)
    set(target eventide_${name}_${kind})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} INTERFACE
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${arg_OUTPUT} EXPORT_NAME ${arg_EXPORT})
    if(arg_ON_TOP_OF)
      target_link_libraries(${target} PUBLIC eventide_${arg_ON_TOP_OF}_${kind})
    endif()
  endforeach()
endfunction()
