# How libraries, programs, tests and optional parts are made here: one function each.

set(EVENTIDE_SANITIZE "" CACHE STRING "Sanitizers, joined by '+': address+undefined, thread")
set(EVENTIDE_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # With -O3, GCC 12 takes "a" + text for a copy onto itself (GCC bug 105651).
  list(APPEND EVENTIDE_WARNINGS $<$<CONFIG:Release>:-Wno-restrict> $<$<CONFIG:Release>:-Wno-stringop-overflow>)
endif()

# GoogleTest and libtorch are compiled once for all files that read them. ccache takes part when it is told not to mind
# the macros of such a header.
option(EVENTIDE_PRECOMPILED_HEADERS "Compile GoogleTest's and libtorch's headers once" ON)
if(EVENTIDE_CCACHE AND EVENTIDE_PRECOMPILED_HEADERS)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${EVENTIDE_CCACHE})
endif()

# eventide_precompile(target owner <a.h> <b.h>): target reads what owner, a target with the same options, has compiled.
function(eventide_precompile target owner)
  if(NOT EVENTIDE_PRECOMPILED_HEADERS OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  if(target STREQUAL owner)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

function(eventide_compile target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${EVENTIDE_WARNINGS})
  if(EVENTIDE_SANITIZE)
    string(REPLACE "+" "," sanitizers ${EVENTIDE_SANITIZE})
    # -O1 takes half of the time to compile that -O2 takes; fuzzing wants speed more.
    target_compile_options(${target} PRIVATE -fsanitize=${sanitizers} -fno-omit-frame-pointer $<IF:$<BOOL:${EVENTIDE_FUZZ}>,-O2,-O1>)
    target_link_options(${target} PUBLIC -fsanitize=${sanitizers})
  endif()
  if(EVENTIDE_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
    # What numbers are compared with leads to new inputs where bytes are read; of the network and of
    # command lines, whose words memcmp() shows already, it is a fifth to a third of all time.
    if(target MATCHES "^eventide_(kernels|nn|model|binning|app|eventide.*)$")
      target_compile_options(${target} PRIVATE -fno-sanitize-coverage=trace-cmp)
    endif()
  endif()
endfunction()

# All of it may end in the shared library, which shows what is marked EVENTIDE_API and nothing else.
function(eventide_hide_symbols target)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# eventide_library(name SOURCES a.cpp b.cpp USES lib... PRIVATELY lib...): made as eventide::name.
# PRIVATELY is for libraries that must not show in our headers, HEADERS for large ones that most of its files read.
function(eventide_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES;PRIVATELY;HEADERS" ${ARGN})
  add_library(eventide_${name} STATIC ${arg_SOURCES})
  add_library(eventide::${name} ALIAS eventide_${name})
  eventide_compile(eventide_${name})
  eventide_hide_symbols(eventide_${name})
  if(arg_HEADERS)
    eventide_precompile(eventide_${name} eventide_${name} ${arg_HEADERS})
  endif()
  target_include_directories(eventide_${name} PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(eventide_${name} PUBLIC ${arg_USES} PRIVATE ${arg_PRIVATELY})
endfunction()

# Every test process has a temporary folder of its own.
set(eventide_test_sources ${CMAKE_CURRENT_LIST_DIR}/../../tests/support/own_temporary_folder.cpp)

# What a sanitizer has to be told in every program.
if(EVENTIDE_SANITIZE STREQUAL "thread")
  set(eventide_sanitizer_sources ${CMAKE_CURRENT_LIST_DIR}/../../tests/support/tsan_suppressions.cpp)
endif()

function(eventide_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${arg_SOURCES} ${eventide_sanitizer_sources})
  eventide_compile(${name})
  target_link_libraries(${name} PRIVATE ${arg_USES})
endfunction()

# Owns the headers that every test reads.
if(EVENTIDE_TESTS)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/test_headers.cpp CONTENT "int main() {}\n")
  add_executable(eventide_test_headers EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/test_headers.cpp)
  eventide_compile(eventide_test_headers)
  target_link_libraries(eventide_test_headers PRIVATE GTest::gtest GTest::gmock)
  eventide_precompile(eventide_test_headers eventide_test_headers <gtest/gtest.h> <gmock/gmock.h>)
endif()

# eventide_test(name SOURCES test_a.cpp USES eventide::x LABELS unit): one GoogleTest program, run by ctest
# test by test (with a sanitizer in one go). Labels: unit kernels threads realtime system slow. THREADED: which of its tests
# start threads, where the others would take the thread sanitizer hours.
function(eventide_test name)
  cmake_parse_arguments(arg "" "TIMEOUT;THREADED" "SOURCES;USES;LABELS;HEADERS" ${ARGN})
  if(NOT EVENTIDE_TESTS)
    return()
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  add_executable(test_${name} ${arg_SOURCES} ${eventide_test_sources} ${eventide_sanitizer_sources})
  eventide_compile(test_${name})
  if(arg_HEADERS)
    eventide_precompile(test_${name} test_${name} ${arg_HEADERS} <gtest/gtest.h> <gmock/gmock.h>)
  else()
    eventide_precompile(test_${name} eventide_test_headers)
  endif()
  target_link_libraries(test_${name} PRIVATE ${arg_USES} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE EVENTIDE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # One label that `ctest -L` finds each of them in: a list would come apart on its way into the discovered tests'
  # properties ("LABELS a b c" labels with a alone, and sets a property b to c).
  list(JOIN arg_LABELS "," labels)
  if(EVENTIDE_SANITIZE)
    # A sanitizer's start takes a second, which is more than most tests take: one process runs all of them. test_model
    # takes 20 minutes with the address sanitizer.
    math(EXPR seconds "8 * ${arg_TIMEOUT}")
    set(chosen)
    if(arg_THREADED AND EVENTIDE_SANITIZE MATCHES "thread")
      set(chosen --gtest_filter=${arg_THREADED})
    endif()
    add_test(NAME test_${name} COMMAND test_${name} --gtest_brief=1 ${chosen})
    set_tests_properties(test_${name} PROPERTIES LABELS "${labels}" TIMEOUT ${seconds})
  else()
    gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 60
      PROPERTIES LABELS "${labels}" TIMEOUT ${arg_TIMEOUT})
  endif()
endfunction()

# eventide_bench(name SOURCES bench_a.cpp USES ...): one Google Benchmark program.
function(eventide_bench name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES" ${ARGN})
  if(NOT EVENTIDE_BENCH)
    return()
  endif()
  add_executable(bench_${name} ${arg_SOURCES})
  eventide_compile(bench_${name})
  target_compile_definitions(bench_${name} PRIVATE EVENTIDE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(bench_${name} PRIVATE ${arg_USES} benchmark::benchmark benchmark::benchmark_main)
endfunction()

# eventide_fuzz(name SOURCES fuzz_a.cpp USES ... LABELS parsers RUNS 2000): a target that is given any bytes. With EVENTIDE_FUZZ
# a libFuzzer program (clang only); in tests with the address sanitizer so many changes of its corpus, the same in every run.
function(eventide_fuzz name)
  cmake_parse_arguments(arg "" "RUNS" "SOURCES;USES;LABELS" ${ARGN})
  if(EVENTIDE_FUZZ)
    add_executable(fuzz_${name} ${arg_SOURCES})
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  elseif(EVENTIDE_TESTS AND EVENTIDE_SANITIZE MATCHES "address")
    add_executable(fuzz_${name} ${arg_SOURCES} ${PROJECT_SOURCE_DIR}/tests/fuzz/mutate_corpus.cpp)
    if(NOT arg_RUNS)
      set(arg_RUNS 2000)
    endif()
    add_test(NAME fuzz_${name} COMMAND fuzz_${name} ${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/${name} ${arg_RUNS})
    set_tests_properties(fuzz_${name} PROPERTIES LABELS "${arg_LABELS}" TIMEOUT 600)
    # For the build preset "parsers".
    if("parsers" IN_LIST arg_LABELS)
      if(NOT TARGET fuzz_parsers)
        add_custom_target(fuzz_parsers)
      endif()
      add_dependencies(fuzz_parsers fuzz_${name})
    endif()
  else()
    return()
  endif()
  eventide_compile(fuzz_${name})
  target_link_libraries(fuzz_${name} PRIVATE ${arg_USES})
  target_compile_definitions(fuzz_${name} PRIVATE
    EVENTIDE_FUZZ_MODEL="${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/model/tiny")
endfunction()

# eventide_feature(EVENTIDE_X "what it gives" CHECK found [DEFAULT ON]): AUTO becomes ON or OFF; ON without the package
# stops the build. Sets EVENTIDE_X_ENABLED.
function(eventide_feature option what)
  cmake_parse_arguments(arg "" "DEFAULT" "CHECK" ${ARGN})
  if(NOT arg_DEFAULT)
    set(arg_DEFAULT AUTO)
  endif()
  set(${option} ${arg_DEFAULT} CACHE STRING "${what}: AUTO, ON or OFF")
  set_property(CACHE ${option} PROPERTY STRINGS AUTO ON OFF)
  set(enabled OFF)
  if(NOT ${option} STREQUAL "OFF")
    set(enabled ON)
    foreach(found IN LISTS arg_CHECK)
      if(NOT ${found})
        set(enabled OFF)
        if(${option} STREQUAL "ON")
          message(FATAL_ERROR "${option}=ON, but ${found} is false: a package is missing (scripts/install-packages.sh installs it)")
        endif()
      endif()
    endforeach()
  endif()
  message(STATUS "eventide: ${option}=${enabled} (${what})")
  set(${option}_ENABLED ${enabled} PARENT_SCOPE)
endfunction()
