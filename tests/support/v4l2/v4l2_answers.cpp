// What the testbed's V4L2 node answers to each request.
#include "tests/support/v4l2/v4l2_testbed_parts.h"

#include <sys/ioctl.h>

#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace eventide::testing_support {
namespace {

constexpr std::uint32_t kFirstControl = 0x00980900;

const char* name_of(gulong request) {
    switch (request) {
        case VIDIOC_QUERYCAP:
            return "QUERYCAP";
        case VIDIOC_G_FMT:
            return "G_FMT";
        case VIDIOC_ENUM_FMT:
            return "ENUM_FMT";
        case VIDIOC_S_FMT:
            return "S_FMT";
        case VIDIOC_REQBUFS:
            return "REQBUFS";
        case VIDIOC_QUERYBUF:
            return "QUERYBUF";
        case VIDIOC_QBUF:
            return "QBUF";
        case VIDIOC_DQBUF:
            return "DQBUF";
        case VIDIOC_STREAMON:
            return "STREAMON";
        case VIDIOC_STREAMOFF:
            return "STREAMOFF";
        default:
            return "other";
    }
}

}  // namespace

gboolean V4l2Testbed::Parts::handle(UMockdevIoctlClient* client) {
    const std::lock_guard lock{mutex};
    const gulong request = umockdev_ioctl_client_get_request(client);
    requests.emplace_back(name_of(request));
    const int failure = take_failure(requests.back());
    const int result =
        failure != 0 ? failure : answer(request, umockdev_ioctl_client_get_arg(client));
    umockdev_ioctl_client_complete(client, result == 0 ? 0 : -1, result);
    return TRUE;
}

gboolean V4l2Testbed::Parts::handle_write(UMockdevIoctlClient* client) {
    const std::lock_guard lock{mutex};
    UMockdevIoctlData* data = umockdev_ioctl_client_get_arg(client);
    if (error != 0 || refusals > 0) {
        umockdev_ioctl_client_complete(client, -1, error != 0 ? error : refusal);
        if (refusals > 0) --refusals;
        return TRUE;
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(data->data);
    written.emplace_back(bytes, bytes + data->data_len);
    umockdev_ioctl_client_complete(client, data->data_len, 0);
    return TRUE;
}

int V4l2Testbed::Parts::take_failure(const std::string& name) {
    const auto found = std::find_if(failures.begin(), failures.end(),
                                    [&](const auto& failure) { return failure.first == name; });
    if (found == failures.end()) return 0;
    const int failure = found->second;
    failures.erase(found);
    return failure;
}

int V4l2Testbed::Parts::answer(gulong request, UMockdevIoctlData* arg) {
    for (const auto part :
         {&Parts::answer_format, &Parts::answer_buffers, &Parts::answer_controls}) {
        const int result = (this->*part)(request, arg);
        if (result != ENOTTY) return result;
    }
    return ENOTTY;
}

/// What the node is and what it delivers.
int V4l2Testbed::Parts::answer_format(gulong request, UMockdevIoctlData* arg) {
    switch (request) {
        case VIDIOC_QUERYCAP:
            return with<v4l2_capability>(arg, [&](v4l2_capability& c, auto*) {
                settings.card.copy(reinterpret_cast<char*>(c.card), sizeof c.card - 1);
                c.device_caps = settings.output         ? V4L2_CAP_VIDEO_OUTPUT
                                : settings.multi_planar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE
                                                        : V4L2_CAP_VIDEO_CAPTURE;
                const bool streams = settings.streams && !settings.output;
                c.device_caps |= streams ? V4L2_CAP_STREAMING : V4L2_CAP_READWRITE;
                c.capabilities = c.device_caps | V4L2_CAP_DEVICE_CAPS;
                return 0;
            });
        case VIDIOC_G_FMT:
            return with<v4l2_format>(arg, [&](v4l2_format& f, auto*) {
                if (!settings.output && f.type != capture_type()) return EINVAL;
                say_format(f);
                return 0;
            });
        case VIDIOC_ENUM_FMT:
            return with<v4l2_fmtdesc>(arg, [&](v4l2_fmtdesc& d, auto*) {
                if (d.type != capture_type() || d.index >= settings.offers.size()) return EINVAL;
                d.pixelformat = settings.offers[d.index];
                return 0;
            });
        case VIDIOC_S_FMT:
            return with<v4l2_format>(arg, [&](v4l2_format& f, auto*) { return set_format(f); });
        case VIDIOC_SUBDEV_G_SELECTION:
            return with<v4l2_subdev_selection>(arg, [&](v4l2_subdev_selection& s, auto*) {
                s.r = {0, 0, std::uint32_t(settings.sensor_width),
                       std::uint32_t(settings.sensor_height)};
                const bool is_known =
                    s.which == V4L2_SUBDEV_FORMAT_ACTIVE && s.target == V4L2_SEL_TGT_CROP_BOUNDS;
                return settings.sensor_width == 0 ? ENOTTY : is_known ? 0 : EINVAL;
            });
        default:
            return ENOTTY;
    }
}

/// Streaming, as between a client and videobuf2.
int V4l2Testbed::Parts::answer_buffers(gulong request, UMockdevIoctlData* arg) {
    switch (request) {
        case VIDIOC_REQBUFS:
            return with<v4l2_requestbuffers>(arg, [&](v4l2_requestbuffers& r, auto*) {
                queued.clear();  // buffers that a node closed without streaming had
                buffers = r.count = std::min(r.count, settings.most_buffers);
                return ::ftruncate(backing, off_t(buffers * settings.buffer_bytes)) == 0 ? 0
                                                                                         : ENOMEM;
            });
        case VIDIOC_QUERYBUF:
            return with<v4l2_buffer>(arg, [&](v4l2_buffer& b, UMockdevIoctlData* data) {
                const auto offset = std::uint32_t(b.index * settings.buffer_bytes);
                Owned<UMockdevIoctlData> holder;
                if (v4l2_plane* plane = settings.multi_planar ? plane_of(data, holder) : nullptr) {
                    plane->length = std::uint32_t(settings.buffer_bytes);
                    plane->m.mem_offset = offset;
                } else {
                    b.length = std::uint32_t(settings.buffer_bytes);
                    b.m.offset = offset;
                }
                return b.index < buffers ? 0 : EINVAL;
            });
        case VIDIOC_QBUF:
            return with<v4l2_buffer>(arg, [&](v4l2_buffer& b, auto*) {
                if (b.index >= buffers || std::count(queued.begin(), queued.end(), b.index) > 0)
                    return EINVAL;
                queued.push_back(b.index);
                return 0;
            });
        case VIDIOC_DQBUF:
            return with<v4l2_buffer>(
                arg, [&](v4l2_buffer& b, UMockdevIoctlData* data) { return dequeue(b, data); });
        case VIDIOC_STREAMON:
            return 0;
        case VIDIOC_STREAMOFF:
            queued.clear();
            return 0;
        default:
            return ENOTTY;
    }
}

int V4l2Testbed::Parts::answer_controls(gulong request, UMockdevIoctlData* arg) {
    switch (request) {
        case VIDIOC_QUERY_EXT_CTRL:
            return with<v4l2_query_ext_ctrl>(
                arg, [&](v4l2_query_ext_ctrl& q, auto*) { return query_control(q); });
        case VIDIOC_S_CTRL:
            return with<v4l2_control>(arg, [&](v4l2_control& c, auto*) {
                auto* control = find_control(c.id);
                if (control == nullptr) return EINVAL;
                if (!control->deaf) control->value = c.value;
                return 0;
            });
        case VIDIOC_G_CTRL:
            return with<v4l2_control>(arg, [&](v4l2_control& c, auto*) {
                const auto* control = find_control(c.id);
                if (control == nullptr || control->disabled) return EINVAL;
                c.value = control->value;
                return 0;
            });
        default:
            return ENOTTY;
    }
}

std::uint32_t V4l2Testbed::Parts::capture_type() const {
    return settings.multi_planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

void V4l2Testbed::Parts::say_format(v4l2_format& format) const {
    const auto say = [this](auto& pixels) {
        pixels.pixelformat = settings.fourcc;
        pixels.width = std::uint32_t(settings.width);
        pixels.height = std::uint32_t(settings.height);
    };
    if (settings.multi_planar)
        say(format.fmt.pix_mp);
    else
        say(format.fmt.pix);
}

/// What is asked for and not known becomes a format that is.
int V4l2Testbed::Parts::set_format(v4l2_format& format) {
    if (settings.refuse_format_with != 0) return settings.refuse_format_with;
    const auto knows = [](const auto& formats, std::uint32_t fourcc) {
        return std::find(formats.begin(), formats.end(), fourcc) != formats.end();
    };
    if (settings.output) {  // as v4l2loopback does
        const auto& takes = settings.takes;
        if (!knows(takes, format.fmt.pix.pixelformat))
            format.fmt.pix.pixelformat = takes.empty() ? 0 : takes.front();
        return 0;
    }
    const std::uint32_t asked =
        settings.multi_planar ? format.fmt.pix_mp.pixelformat : format.fmt.pix.pixelformat;
    if (knows(settings.offers, asked)) settings.fourcc = asked;
    say_format(format);
    return 0;
}

v4l2_plane* V4l2Testbed::Parts::plane_of(UMockdevIoctlData* buffer,
                                         Owned<UMockdevIoctlData>& holder) {
    holder.reset(umockdev_ioctl_data_resolve(buffer, offsetof(v4l2_buffer, m.planes),
                                             sizeof(v4l2_plane), nullptr));
    return holder ? reinterpret_cast<v4l2_plane*>(holder->data) : nullptr;
}

int V4l2Testbed::Parts::dequeue(v4l2_buffer& buffer, UMockdevIoctlData* data) {
    if (error != 0) return error;
    if (contents.empty() || queued.empty()) return EAGAIN;
    const Content content = std::move(contents.front());
    contents.pop_front();
    buffer.index = queued.front();
    queued.pop_front();
    buffer.sequence = sequence += content.skipped_before;
    ++sequence;
    buffer.flags = V4L2_BUF_FLAG_MAPPED | V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
    if (content.error_flag) buffer.flags |= V4L2_BUF_FLAG_ERROR;
    const std::size_t offset = settings.multi_planar ? settings.data_offset : 0;
    const std::size_t n = std::min(content.bytes.size(), settings.buffer_bytes - offset);
    Owned<UMockdevIoctlData> holder;
    if (v4l2_plane* plane = settings.multi_planar ? plane_of(data, holder) : nullptr) {
        // With what lies before the data.
        plane->bytesused = content.says_bytes.value_or(std::uint32_t(offset + n));
        plane->data_offset = std::uint32_t(offset);
    } else {
        buffer.bytesused = content.says_bytes.value_or(std::uint32_t(n));
    }
    const auto at = off_t(buffer.index * settings.buffer_bytes + offset);
    buffer.index = content.says_index.value_or(buffer.index);
    return ::pwrite(backing, content.bytes.data(), n, at) == ssize_t(n) ? 0 : EIO;
}

/// Enumeration by V4L2_CTRL_FLAG_NEXT_CTRL, ids in the order of the names.
int V4l2Testbed::Parts::query_control(v4l2_query_ext_ctrl& query) const {
    const std::uint32_t after =
        query.id & ~std::uint32_t(V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND);
    std::uint32_t id = kFirstControl;
    for (const auto& [name, control] : settings.controls) {
        if (id++ < after + 1 && after != 0) continue;
        query = {};
        query.id = id - 1;
        std::strncpy(query.name, name.c_str(), sizeof query.name - 1);
        query.minimum = control.minimum;
        query.maximum = control.maximum;
        query.flags = control.disabled    ? V4L2_CTRL_FLAG_DISABLED
                      : control.read_only ? V4L2_CTRL_FLAG_READ_ONLY
                                          : 0;
        return 0;
    }
    return EINVAL;
}

V4l2NodeSettings::Control* V4l2Testbed::Parts::find_control(std::uint32_t id) {
    std::uint32_t at = kFirstControl;
    for (auto& [name, control] : settings.controls)
        if (at++ == id) return &control;
    return nullptr;
}

}  // namespace eventide::testing_support
