// What the V4L2 testbed is made of: for its own sources alone.
#pragma once

#include "tests/support/glib_owned.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <umockdev.h>

#include <cerrno>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

struct v4l2_buffer;
struct v4l2_format;
struct v4l2_plane;
struct v4l2_query_ext_ctrl;

namespace eventide::testing_support {

struct V4l2Testbed::Parts {
    V4l2NodeSettings settings;
    Owned<UMockdevTestbed> testbed;
    Owned<UMockdevIoctlBase> handler;
    mutable std::mutex mutex;  // for all below: requests come on umockdev's thread
    std::string file;          // the node's, for real
    int backing = -1;          // that, opened
    std::deque<std::uint32_t> queued;
    std::deque<Content> contents;
    std::uint32_t sequence = 0, buffers = 0;
    int error = 0, refusals = 0, refusal = 0;
    std::deque<std::pair<std::string, int>> failures;  // of requests by name, with this errno
    std::vector<std::vector<std::byte>> written;
    std::vector<std::string> requests;

    static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer parts) {
        return static_cast<Parts*>(parts)->handle(client);
    }
    static gboolean on_write(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer parts) {
        return static_cast<Parts*>(parts)->handle_write(client);
    }
    void make_node(const char* node, const char* record);
    gboolean handle(UMockdevIoctlClient* client);
    gboolean handle_write(UMockdevIoctlClient* client);
    /// 0 or an errno. Each part answers ENOTTY to what is not its own.
    int answer(gulong request, UMockdevIoctlData* arg);
    /// The errno this request is to fail with; 0: none.
    int take_failure(const std::string& name);
    int answer_format(gulong request, UMockdevIoctlData* arg);
    int answer_buffers(gulong request, UMockdevIoctlData* arg);
    int answer_controls(gulong request, UMockdevIoctlData* arg);
    template <typename T, typename Fill>
    static int with(UMockdevIoctlData* arg, Fill fill) {
        const Owned<UMockdevIoctlData> data{
            umockdev_ioctl_data_resolve(arg, 0, sizeof(T), nullptr)};
        return data ? fill(*reinterpret_cast<T*>(data->data), data.get()) : EFAULT;
    }
    std::uint32_t capture_type() const;
    void say_format(v4l2_format& format) const;
    int set_format(v4l2_format& format);
    /// The plane of a multi-planar buffer, in the client's memory.
    static v4l2_plane* plane_of(UMockdevIoctlData* buffer, Owned<UMockdevIoctlData>& holder);
    int dequeue(v4l2_buffer& buffer, UMockdevIoctlData* data);
    int query_control(v4l2_query_ext_ctrl& query) const;
    V4l2NodeSettings::Control* find_control(std::uint32_t id);
};

}  // namespace eventide::testing_support
