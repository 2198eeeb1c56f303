// An event sensor in software and the camera that reads it.
#pragma once

#include "drivers/v4l2/v4l2_camera.h"
#include "src/core/error.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <linux/videodev2.h>

#include <functional>
#include <string>
#include <utility>

namespace eventide::testing_support::v4l2 {

constexpr std::uint32_t kEvt3 = v4l2_fourcc('P', 'S', 'E', '3');

inline V4l2NodeSettings sensor(std::uint32_t fourcc = kEvt3) {
    V4l2NodeSettings settings;
    settings.fourcc = fourcc;
    settings.width = 320;
    settings.height = 320;
    return settings;
}

inline V4l2Camera open(V4l2Settings settings = {}, bool reconnect = false,
                       std::function<void(const std::string&)> warn = {}) {
    return V4l2Camera{"/dev/video0", std::move(settings), reconnect, std::move(warn)};
}

inline std::string failure_of(const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace eventide::testing_support::v4l2
