// What is answered to which request.
#pragma once

#include "pipeline/sinks/http/http_sink.h"
#include "pipeline/sinks/http/metrics.h"
#include "pipeline/sinks/http/newest_frame.h"
#include "pipeline/sinks/http/request_guard.h"
#include "pipeline/sinks/http/slots.h"

#include <httplib.h>

#include <atomic>
#include <cstdint>

namespace eventide {

/// Thread: any, also at the same time. The settings' controls hold the pause, too.
class HttpAnswers {
public:
    HttpAnswers(const HttpSettings& settings, NewestFrame& newest);

    /// False where the request is allowed and wants its body read.
    bool answer(const httplib::Request& request, httplib::Response& response);
    void answer_post(const httplib::Request& request, httplib::Response& response);
    static constexpr const char* kPostPath = "/controls";
    bool has_viewers() const { return viewers_.taken() > 0 || listeners_.taken() > 0; }
    HttpCounters counters() const;

private:
    using Request = httplib::Request;
    using Response = httplib::Response;
    bool refuse(const Request& request, Response& response);
    void get(const Request& request, Response& response);
    void page_frames(Response& response);
    Show asked_show(const Request& request, Show otherwise) const;
    void motion_jpeg(const Request& request, Response& response);
    void one_frame(const Request& request, Response& response);
    void statistics(Response& response);
    std::string statistics_json(double event_rate) const;
    std::shared_ptr<const void> place(Slots& slots, const char* of_what, Response& response);

    const HttpSettings& settings_;
    NewestFrame& newest_;
    const GuardSettings guard_;
    Slots viewers_{HttpSink::kMaxViewers}, listeners_{HttpSink::kMaxViewers};
    std::atomic<std::uint64_t> requests_{0}, refused_{0};
};

}  // namespace eventide
