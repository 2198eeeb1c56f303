#include "tests/support/v4l2/v4l2_testbed.h"

#include "tests/support/preload.h"
#include "tests/support/v4l2/v4l2_testbed_parts.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

namespace eventide::testing_support {
namespace {

constexpr const char* kNode = "/dev/video0";
// "=00" makes the node a regular file: what the client maps is then really shared with this
// process.
constexpr const char* kRecord =
    "P: /devices/platform/eventide/video4linux/video0\nN: video0=00\n"
    "E: DEVNAME=/dev/video0\nE: SUBSYSTEM=video4linux\nE: MAJOR=81\nE: MINOR=0\nA: "
    "name=eventide\\n\n";
constexpr const char* kSubdevice = "/dev/v4l-subdev0";
constexpr const char* kSubdeviceRecord =
    "P: /devices/platform/eventide/video4linux/v4l-subdev0\nN: v4l-subdev0=00\n"
    "E: DEVNAME=/dev/v4l-subdev0\nE: SUBSYSTEM=video4linux\nE: MAJOR=81\nE: MINOR=1\nA: "
    "name=sensor\\n\n";
}  // namespace

V4l2Testbed::V4l2Testbed(V4l2NodeSettings settings) : parts_(std::make_unique<Parts>()) {
    if (!runs_in_testbed())
        throw std::runtime_error("the V4L2 testbed needs umockdev's preload library");
    parts_->settings = std::move(settings);
    parts_->testbed.reset(umockdev_testbed_new());
    parts_->handler.reset(umockdev_ioctl_base_new());
    g_signal_connect(parts_->handler.get(), "handle-ioctl", G_CALLBACK(&Parts::on_ioctl),
                     parts_.get());
    g_signal_connect(parts_->handler.get(), "handle-write", G_CALLBACK(&Parts::on_write),
                     parts_.get());
    parts_->make_node(kNode, kRecord);
    parts_->make_node(kSubdevice, kSubdeviceRecord);
    gchar* root = umockdev_testbed_get_root_dir(parts_->testbed.get());
    parts_->file = std::string{root} + kNode;
    g_free(root);
    parts_->backing = ::open(parts_->file.c_str(), O_RDWR);
    if (parts_->backing < 0) throw std::runtime_error("umockdev: no file behind /dev/video0");
}

void V4l2Testbed::Parts::make_node(const char* node, const char* record) {
    GError* failure = nullptr;
    if (umockdev_testbed_add_from_string(testbed.get(), record, &failure) &&
        umockdev_testbed_attach_ioctl(testbed.get(), node, handler.get(), &failure))
        return;
    const Owned<GError> owned{failure};
    throw std::runtime_error(std::string{"umockdev: "} + owned->message);
}

V4l2Testbed::~V4l2Testbed() {
    umockdev_testbed_detach_ioctl(parts_->testbed.get(), kNode, nullptr);
    umockdev_testbed_detach_ioctl(parts_->testbed.get(), kSubdevice, nullptr);
    // What umockdev's thread wrote under it last is seen here, also by the thread sanitizer.
    const std::lock_guard lock{parts_->mutex};
    ::close(parts_->backing);
}

void V4l2Testbed::give(Content content) {
    const std::lock_guard lock{parts_->mutex};
    parts_->contents.push_back(std::move(content));
}

bool V4l2Testbed::all_taken() const {
    const std::lock_guard lock{parts_->mutex};
    return parts_->contents.empty();
}

void V4l2Testbed::fail_with(int error) {
    const std::lock_guard lock{parts_->mutex};
    parts_->error = error;
}

void V4l2Testbed::fail_next(const std::string& request, int error, int times) {
    const std::lock_guard lock{parts_->mutex};
    parts_->failures.insert(parts_->failures.end(), std::size_t(times), {request, error});
}

void V4l2Testbed::refuse_writes(int count, int error) {
    const std::lock_guard lock{parts_->mutex};
    parts_->refusals = count;
    parts_->refusal = error;
}

std::vector<std::vector<std::byte>> V4l2Testbed::written() const {
    const std::lock_guard lock{parts_->mutex};
    return parts_->written;
}

std::vector<std::string> V4l2Testbed::requests() const {
    const std::lock_guard lock{parts_->mutex};
    return parts_->requests;
}

void V4l2Testbed::change_format(std::uint32_t fourcc, int width, int height) {
    const std::lock_guard lock{parts_->mutex};
    parts_->settings.fourcc = fourcc;
    parts_->settings.width = width;
    parts_->settings.height = height;
}

std::uint32_t V4l2Testbed::fourcc() const {
    const std::lock_guard lock{parts_->mutex};
    return parts_->settings.fourcc;
}

void V4l2Testbed::hide_node(bool hidden) {
    const std::string there = parts_->file, away = there + ".away";
    std::filesystem::rename(hidden ? there : away, hidden ? away : there);
}

void V4l2Testbed::change_card(const std::string& card) {
    const std::lock_guard lock{parts_->mutex};
    parts_->settings.card = card;
}

void V4l2Testbed::take_controls_away() {
    const std::lock_guard lock{parts_->mutex};
    parts_->settings.controls.clear();
}

V4l2NodeSettings::Control V4l2Testbed::control(const std::string& name) const {
    const std::lock_guard lock{parts_->mutex};
    return parts_->settings.controls.at(name);
}

}  // namespace eventide::testing_support
