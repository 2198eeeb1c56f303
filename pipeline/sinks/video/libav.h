// FFmpeg's libraries, loaded when the first video is written: a hundred others come with them, of
// which a run without a video has nothing.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

namespace eventide {

// What is used of each.
#define EVENTIDE_AVCODEC_FUNCTIONS(X)  \
    X(av_packet_alloc)                 \
    X(av_packet_free)                  \
    X(av_packet_rescale_ts)            \
    X(av_packet_unref)                 \
    X(avcodec_alloc_context3)          \
    X(avcodec_find_encoder_by_name)    \
    X(avcodec_free_context)            \
    X(avcodec_open2)                   \
    X(avcodec_parameters_from_context) \
    X(avcodec_receive_packet)          \
    X(avcodec_send_frame)

#define EVENTIDE_AVFORMAT_FUNCTIONS(X) \
    X(av_guess_format)                 \
    X(av_write_frame)                  \
    X(av_write_trailer)                \
    X(avformat_alloc_output_context2)  \
    X(avformat_free_context)           \
    X(avformat_new_stream)             \
    X(avformat_write_header)           \
    X(avio_alloc_context)              \
    X(avio_context_free)               \
    X(avio_flush)

#define EVENTIDE_AVUTIL_FUNCTIONS(X) \
    X(av_d2q)                        \
    X(av_dict_free)                  \
    X(av_dict_set)                   \
    X(av_dict_set_int)               \
    X(av_frame_alloc)                \
    X(av_frame_free)                 \
    X(av_frame_get_buffer)           \
    X(av_frame_make_writable)        \
    X(av_freep)                      \
    X(av_get_pix_fmt)                \
    X(av_malloc)                     \
    X(av_opt_set)                    \
    X(av_opt_set_double)             \
    X(av_opt_set_int)                \
    X(av_rescale_q)                  \
    X(av_strerror)

/// Each under its own name.
struct Libav {
// NOLINTBEGIN(bugprone-macro-parentheses): names of members.
#define EVENTIDE_LIBAV_FUNCTION(name) decltype(&::name) name = nullptr;
    // NOLINTEND(bugprone-macro-parentheses)
    EVENTIDE_AVCODEC_FUNCTIONS(EVENTIDE_LIBAV_FUNCTION)
    EVENTIDE_AVFORMAT_FUNCTIONS(EVENTIDE_LIBAV_FUNCTION)
    EVENTIDE_AVUTIL_FUNCTIONS(EVENTIDE_LIBAV_FUNCTION)
#undef EVENTIDE_LIBAV_FUNCTION
};

/// Loads them the first time. Throws Error (failed) where one is missing, naming the package.
/// Thread: any.
const Libav& libav();

}  // namespace eventide
