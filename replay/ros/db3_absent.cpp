// Where eventide was built without SQLite (EVENTIDE_SQLITE).
#include "replay/ros/bag_recording.h"
#include "src/core/error.h"

namespace eventide {

std::unique_ptr<DataReader> open_db3(const std::string& path, const OpenOptions&) {
    throw Error(ErrorKind::failed, path +
                                       ": a ROS 2 bag in an SQLite file; eventide was built "
                                       "without SQLite (EVENTIDE_SQLITE; Debian's libsqlite3-dev)");
}

}  // namespace eventide
