# Every package the project stands on, in one place, but for those that a single test asks for (tests/*/CMakeLists.txt). All are Debian's; scripts/install-packages.sh installs them.
# Events to frames (libeventide-core).
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)
find_package(nlohmann_json REQUIRED)  # headers alone, as is Eigen

# Recordings, cameras and simulations (libeventide).
find_package(ZLIB QUIET)
find_package(BZip2 QUIET)
find_package(Eigen3 QUIET NO_MODULE)
find_package(OpenCV QUIET COMPONENTS core imgproc imgcodecs highgui)
pkg_check_modules(lz4 IMPORTED_TARGET liblz4)
pkg_check_modules(zstd IMPORTED_TARGET libzstd)
# Header-only, without a CMake package in Debian 12.
find_path(CONCURRENTQUEUE_DIR concurrentqueue.h PATH_SUFFIXES concurrentqueue moodycamel)
eventide_feature(EVENTIDE_IO "recordings, cameras and simulations: libeventide" DEFAULT ON
  CHECK ZLIB_FOUND Eigen3_FOUND OpenCV_FOUND CONCURRENTQUEUE_DIR)
eventide_feature(EVENTIDE_COMPRESSION "recordings compressed by LZ4, ZSTD and bzip2"
  CHECK lz4_FOUND zstd_FOUND BZIP2_FOUND EVENTIDE_IO_ENABLED)

# The programs.
pkg_check_modules(spdlog IMPORTED_TARGET spdlog)
pkg_check_modules(libav libavformat libavcodec libavutil)
find_package(CLI11 QUIET)
set(program ON)
if(NOT EVENTIDE_IO_ENABLED AND NOT EVENTIDE_PROGRAM STREQUAL "ON")
  set(program AUTO)  # the library of frames alone has none
endif()
eventide_feature(EVENTIDE_PROGRAM "the program eventide, which its tests need" DEFAULT ${program}
  CHECK spdlog_FOUND CLI11_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_VIDEO "video files (--out x.mp4)" CHECK libav_FOUND EVENTIDE_PROGRAM_ENABLED)
foreach(other EVENTIDE_TESTS EVENTIDE_BENCH EVENTIDE_FUZZ)
  foreach(part PROGRAM VIDEO COMPRESSION)
    if(${other} AND NOT EVENTIDE_${part}_ENABLED)
      message(FATAL_ERROR "${other}=ON: expected a build with EVENTIDE_${part}, found one without; choose -D${other}=OFF")
    endif()
  endforeach()
endforeach()

# The name that whoever links a library would load it by.
function(eventide_soname into name folders)
  unset(soname_file)
  find_library(soname_file ${name} HINTS ${folders} NO_CACHE REQUIRED)
  execute_process(COMMAND ${CMAKE_OBJDUMP} -p ${soname_file} OUTPUT_VARIABLE headers)
  if(NOT headers MATCHES "SONAME +([^ \n]+)")
    message(FATAL_ERROR "${soname_file}: expected a library with a name (SONAME), found none")
  endif()
  set(${into} ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()

if(EVENTIDE_VIDEO_ENABLED)
  foreach(part AVCODEC AVFORMAT AVUTIL)
    string(TOLOWER ${part} name)
    eventide_soname(EVENTIDE_${part} ${name} "${libav_LIBRARY_DIRS}")
  endforeach()
endif()

# What can be left out of either.
pkg_check_modules(libusb IMPORTED_TARGET libusb-1.0)
pkg_check_modules(httplib IMPORTED_TARGET cpp-httplib)
if(httplib_FOUND)
  # Headers alone: the library is loaded when a page is opened (late_httplib.cpp).
  add_library(eventide_httplib INTERFACE)
  target_include_directories(eventide_httplib SYSTEM INTERFACE ${httplib_INCLUDE_DIRS})
  target_compile_options(eventide_httplib INTERFACE ${httplib_CFLAGS})
  eventide_soname(EVENTIDE_HTTPLIB_LIBRARY cpp-httplib "${httplib_LIBRARY_DIRS}")
endif()
pkg_check_modules(umockdev IMPORTED_TARGET umockdev-1.0)
find_package(CycloneDDS QUIET)
find_program(EVENTIDE_IDLC idlc)
pkg_check_modules(yaml IMPORTED_TARGET yaml-0.1)
# Debian's dnnl-config.cmake insists on OpenCL headers that the CPU engine does not need.
find_library(DNNL_LIBRARY dnnl)
find_path(DNNL_INCLUDE_DIR oneapi/dnnl/dnnl.hpp)
if(DNNL_LIBRARY AND DNNL_INCLUDE_DIR)
  set(dnnl_FOUND TRUE)
  add_library(eventide_dnnl INTERFACE)
  target_include_directories(eventide_dnnl SYSTEM INTERFACE ${DNNL_INCLUDE_DIR})
  target_link_libraries(eventide_dnnl INTERFACE ${DNNL_LIBRARY})
endif()
find_package(Torch QUIET)
find_package(SQLite3 QUIET)
pkg_check_modules(hdf5 IMPORTED_TARGET hdf5)
if(hdf5_FOUND)
  # What makes files for tests; the program loads the library when it is first used.
  add_library(eventide_linked_hdf5 INTERFACE)
  target_include_directories(eventide_linked_hdf5 SYSTEM INTERFACE ${hdf5_INCLUDE_DIRS})
  target_link_libraries(eventide_linked_hdf5 INTERFACE PkgConfig::hdf5)
  eventide_soname(EVENTIDE_HDF5_LIBRARY hdf5 "${hdf5_LIBRARY_DIRS}")
endif()

# Debian's Python, for which its NumPy is; pybind11 is headers alone.
set(Python3_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python that the module is made for")
find_package(Python3 COMPONENTS Interpreter Development.Module NumPy QUIET)
find_path(PYBIND11_HEADERS pybind11/pybind11.h)

if(EVENTIDE_IO_ENABLED)
  add_library(eventide_concurrentqueue INTERFACE)
  target_include_directories(eventide_concurrentqueue SYSTEM INTERFACE ${CONCURRENTQUEUE_DIR})

  # OpenCV 4.6 headers warn under C++20; they are system headers to us.
  add_library(eventide_opencv INTERFACE)
  target_include_directories(eventide_opencv SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
  target_link_libraries(eventide_opencv INTERFACE opencv_core opencv_imgproc)
  # Those that bring a hundred others are loaded when they are first used, by the name that whoever links them would load them by.
  foreach(part IMGCODECS HIGHGUI)
    string(TOLOWER opencv_${part} target)
    get_target_property(configuration ${target} IMPORTED_CONFIGURATIONS)
    list(GET configuration 0 configuration)
    get_target_property(EVENTIDE_OPENCV_${part} ${target} IMPORTED_SONAME_${configuration})
    if(NOT EVENTIDE_OPENCV_${part})
      message(FATAL_ERROR "OpenCV: expected ${target} as a shared library, found none")
    endif()
  endforeach()
  # What looks at image files in tests.
  add_library(eventide_opencv_files INTERFACE)
  target_link_libraries(eventide_opencv_files INTERFACE eventide_opencv opencv_imgcodecs)
endif()

if(EVENTIDE_TESTS)
  find_package(GTest REQUIRED)
endif()
if(EVENTIDE_BENCH)
  find_package(benchmark REQUIRED)
endif()

eventide_feature(EVENTIDE_ONEDNN "fast convolutions" CHECK dnnl_FOUND)
find_path(V4L2_HEADERS linux/videodev2.h)
eventide_feature(EVENTIDE_V4L2 "V4L2 event sensors" CHECK V4L2_HEADERS EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_HTTP "the live page in the browser (--out http:)" CHECK httplib_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_USB "USB event cameras" CHECK libusb_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_EMULATOR "software DAVIS for tests" CHECK umockdev_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_SQLITE "ROS 2 bags in SQLite files" CHECK SQLite3_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_HDF5 "HDF5 recordings" CHECK hdf5_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_CALIBRATION "calibrations of cameras, in YAML" CHECK yaml_FOUND EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_ROS2 "ROS 2 topics through Cyclone DDS" CHECK CycloneDDS_FOUND EVENTIDE_IDLC EVENTIDE_CALIBRATION_ENABLED EVENTIDE_IO_ENABLED)
eventide_feature(EVENTIDE_TRAIN "training with libtorch" CHECK Torch_FOUND EVENTIDE_PROGRAM_ENABLED)
eventide_feature(EVENTIDE_PYTHON "the Python module" CHECK Python3_Development.Module_FOUND Python3_NumPy_FOUND PYBIND11_HEADERS EVENTIDE_IO_ENABLED)
