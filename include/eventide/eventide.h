/** @file
 * The library for C and for whatever can call C. Times are microseconds of the sensor's clock,
 * sizes and coordinates are pixels with the origin at the top left.
 *
 * Functions that can fail return an eventide_status; eventide_error_message() then says what was
 * expected and what was found. Nothing is thrown. Any may return EVENTIDE_FAILED (too little
 * memory) and EVENTIDE_USAGE (NULL where it is not allowed); the others its comment names. A handle
 * is used by one thread at a time, different ones by as many as there are. NULL for a handle is
 * refused, but may be closed, and is what `*opened` becomes where nothing is opened. */
#ifndef EVENTIDE_EVENTIDE_H
#define EVENTIDE_EVENTIDE_H

#include <eventide/version.h>

#include <stddef.h>
#include <stdint.h>

/* C has words of its own: no `using`, and names that nothing else has. */
/* NOLINTBEGIN(modernize-use-using,readability-identifier-naming) */
#ifdef __cplusplus
extern "C" {
#endif

/** What a function that can fail returns. */
typedef enum eventide_status {
    EVENTIDE_OK = 0,     /**< it was done */
    EVENTIDE_FAILED = 1, /**< something went wrong while running: a full disk, too little memory */
    EVENTIDE_USAGE = 2,  /**< an argument or option: the caller's to change */
    EVENTIDE_INPUT = 3,  /**< a recording or model that cannot be read or is not what it says */
    EVENTIDE_DEVICE = 4, /**< a camera that is missing, cannot be used, or was lost */
    EVENTIDE_NONE = 5    /**< no error: no frame yet, or the end of a recording */
} eventide_status;

/** "1.0.0", of the library that is loaded. */
EVENTIDE_API const char* eventide_version(void);

/** What the last call on this thread that failed said; empty before the first. Valid until the next
 * failure on this thread. */
EVENTIDE_API const char* eventide_error_message(void);

/** Sets what eventide_error_message() says on this thread, cut after 1023 bytes, and returns
 * `status`. For code around these functions, as a binding, that reports its own failures so. */
EVENTIDE_API eventide_status eventide_set_error(eventide_status status, const char* message);

/** One change of brightness at one pixel. */
typedef struct eventide_event {
    int64_t t;  /**< us */
    uint16_t x; /**< px, from the left */
    uint16_t y; /**< px, from the top */
    uint8_t on; /**< 0: darker; anything else: brighter */
} eventide_event;

/* ---- frames ---------------------------------------------------------------------------------- */

/** A part of a frame. */
typedef struct eventide_region {
    int x;      /**< px, its left edge */
    int y;      /**< px, its top edge */
    int width;  /**< px; 0: to the frame's right edge */
    int height; /**< px; 0: to the frame's bottom edge */
} eventide_region;

/** How large a frame is to be, and which part is wanted. */
typedef struct eventide_frame_size {
    int width;              /**< px, of the whole frame, 1 to 16384; 0: the sensor's */
    int height;             /**< px, likewise */
    eventide_region region; /**< all 0: the whole frame */
} eventide_frame_size;

/** Fill it by eventide_options_init(), then change what is to differ. Texts are copied. */
typedef struct eventide_options {
    size_t struct_size;       /**< set by eventide_options_init() */
    const char* window;       /**< "model", "auto", "50ms", "20000ev", "0.35epp", "aps" */
    int lookahead;            /**< 0, 1 or 2: event windows a frame waits for */
    const char* fps;          /**< of eventide_next(): "30", "30000/1001", "frame" */
    eventide_frame_size size; /**< of the frames */
    int sigma;                /**< 0: frames have none, and are rendered faster */
    const char* hot_pixels;   /**< "off", "learn", or a file that lists pixels */
    const char* precision;    /**< "auto", "f32", "bf16" */
    const char* kernels;      /**< "auto", "own", "onednn" */
    int threads;              /**< 0: as many as the process may run on */
    int reset_on_gap;         /**< forget the scene where data were lost */
    int allow_silence;        /**< any number of frames in a row without events */
    const char* noise_filter; /**< "model", "auto", "off", or a time such as "10ms" */
    int images;               /**< frames are corrected by the camera's images that are pushed */
    const char* lamp_flicker; /**< "auto", "off", or a time such as "16ms" */
    int self_ensemble; /**< 1, 2 or 4 networks of mirrored views, whose frames' mean is given */
} eventide_options;

/** The defaults, those of ReconstructorOptions. `struct_size` is sizeof(eventide_options). */
EVENTIDE_API void eventide_options_init(eventide_options* options, size_t struct_size);

/** A rendered frame. The pixels are rows of `width` floats without gaps, valid until the next call
 * with the same reconstructor. */
typedef struct eventide_frame {
    int64_t t;              /**< us, the instant it shows */
    int64_t window_begin;   /**< us; the event window t lies in is (begin, end] */
    int64_t window_end;     /**< us */
    uint64_t index;         /**< number on the frame clock */
    uint64_t events;        /**< in that event window */
    int width;              /**< px */
    int height;             /**< px */
    const float* intensity; /**< 0 black to 1 white; may lie a little outside */
    const float* sigma;     /**< standard deviation of intensity; NULL where not asked for */
    int gap_before;         /**< data were lost before */
} eventide_frame;

/** A network at work on the stream of one sensor. */
typedef struct eventide_reconstructor eventide_reconstructor;

/** `model`: a name ("default", "small", "thesis") or a safetensors file; names are looked for in
 * $EVENTIDE_MODELS, then where the library is installed. The sensor is 1 to 4096 px each way.
 * `options` may be NULL: the defaults. */
EVENTIDE_API eventide_status eventide_reconstructor_open(const char* model, int width, int height,
                                                         const eventide_options* options,
                                                         eventide_reconstructor** opened);
/** Frees it; NULL may be closed. */
EVENTIDE_API void eventide_reconstructor_close(eventide_reconstructor* reconstructor);

/** Events in order of time. One that is earlier than the one before, outside the sensor or at an
 * impossible time is left out and counted (eventide_counters). `events` may be NULL where `count`
 * is 0. EVENTIDE_USAGE after eventide_finish(). */
EVENTIDE_API eventide_status eventide_push(eventide_reconstructor* reconstructor,
                                           const eventide_event* events, size_t count);

/** An image that the camera took beside its events, for options.images and window "aps". */
typedef struct eventide_image {
    int64_t t;              /**< us, the middle of its exposure */
    int64_t exposure_begin; /**< us; equal to t where it is not known */
    int64_t exposure_end;   /**< us; likewise */
    int x;                  /**< px, its left edge in the sensor */
    int y;                  /**< px, its top edge */
    int width;              /**< px, at least 1 */
    int height;             /**< px, at least 1 */
    const uint16_t* pixels; /**< grey, 0 to 65535: `height` rows of `width` without gaps; copied */
} eventide_image;

/** Images in order of time, each before the events that follow its exposure. eventide_read_into()
 * does this by itself. EVENTIDE_USAGE after eventide_finish(), for a width or height outside 1 to
 * 4096 px, a corner further than 4096 px from the sensor's, and an exposure that ends before it
 * begins. */
EVENTIDE_API eventide_status eventide_push_image(eventide_reconstructor* reconstructor,
                                                 const eventide_image* image);

/** Every event before `now` has been pushed: time goes on where nothing moves. For cameras;
 * eventide_source_clock() gives such a time. EVENTIDE_USAGE after eventide_finish() and for a time
 * further than 2^60 us from zero. */
EVENTIDE_API eventide_status eventide_advance(eventide_reconstructor* reconstructor, int64_t now);

/** Data were lost here: the next frame carries gap_before. */
EVENTIDE_API eventide_status eventide_mark_gap(eventide_reconstructor* reconstructor);

/** The stream has ended; `end` may be NULL, or the time until which its clock went on.
 * EVENTIDE_USAGE for an end further than 2^60 us from zero: then the stream goes on. */
EVENTIDE_API eventide_status eventide_finish(eventide_reconstructor* reconstructor,
                                             const int64_t* end);

/** The next frame at the rate of the options. EVENTIDE_NONE where it has to wait for events, and
 * after eventide_finish() once all were given. EVENTIDE_INPUT where the network gives no finite
 * numbers, and for more than a million frames in a row without events (times that are wrong;
 * options.allow_silence), which are then skipped. */
EVENTIDE_API eventide_status eventide_next(eventide_reconstructor* reconstructor,
                                           eventide_frame* frame);

/** EVENTIDE_OK where a frame of this time can be rendered, else EVENTIDE_NONE. Where
 *  eventide_next() gives frames: no further ahead than it can follow. */
EVENTIDE_API eventide_status eventide_ready(eventide_reconstructor* reconstructor, int64_t t);

/** The newest time that can be rendered, as for eventide_ready(); EVENTIDE_NONE where there is
 *  none. */
EVENTIDE_API eventide_status eventide_newest(eventide_reconstructor* reconstructor, int64_t* t);

/** The frame of one instant. `size` may be NULL: that of the options. EVENTIDE_USAGE where
 * eventide_ready() does not return EVENTIDE_OK for `t`, and for an impossible size; EVENTIDE_INPUT
 * where the network gives no finite numbers. */
EVENTIDE_API eventide_status eventide_render(eventide_reconstructor* reconstructor, int64_t t,
                                             const eventide_frame_size* size,
                                             eventide_frame* frame);

/** As opened: a new stream begins. */
EVENTIDE_API eventide_status eventide_reset(eventide_reconstructor* reconstructor);

/** What the network remembers of the scene: bytes, valid until the next call with the same
 * reconstructor, for eventide_restore() of any of that model, sensor size and self_ensemble. */
EVENTIDE_API eventide_status eventide_state(eventide_reconstructor* reconstructor,
                                            const void** bytes, size_t* size);
/** A new stream, with what eventide_state() told. EVENTIDE_INPUT where it is none, or that of
 * another model, sensor size or self_ensemble: then nothing has changed. */
EVENTIDE_API eventide_status eventide_restore(eventide_reconstructor* reconstructor,
                                              const void* bytes, size_t size);

/** eventide_state() as a file. EVENTIDE_USAGE for one that exists without `overwrite`,
 * EVENTIDE_FAILED where it cannot be written. */
EVENTIDE_API eventide_status eventide_save_state(eventide_reconstructor* reconstructor,
                                                 const char* file, int overwrite);
/** eventide_restore() from such a file, with the same statuses. */
EVENTIDE_API eventide_status eventide_restore_state(eventide_reconstructor* reconstructor,
                                                    const char* file);

/** What became of what was pushed, since the reconstructor was opened. */
typedef struct eventide_counters {
    uint64_t events;         /**< pushed */
    uint64_t off_sensor;     /**< left out: x or y outside the sensor */
    uint64_t time_backwards; /**< left out: earlier than the event before */
    uint64_t bad_time;       /**< left out: further than 2^60 us from zero */
    uint64_t filtered;       /**< left out: of hot pixels, or noise */
    uint64_t late;        /**< moved later: eventide_advance() had promised that none would come */
    uint64_t left_out;    /**< more in one microsecond than memory is meant to hold */
    uint64_t time_resets; /**< how often the sensor's clock was reset */
    uint64_t event_windows;  /**< steps of the network */
    uint64_t frames;         /**< rendered */
    uint64_t used_images;    /**< corrected frames */
    uint64_t dropped_images; /**< came too late for it, or before a clock reset */
} eventide_counters;

/** The counters so far. */
EVENTIDE_API eventide_status eventide_count(const eventide_reconstructor* reconstructor,
                                            eventide_counters* counters);

/* ---- recordings and cameras ------------------------------------------------------------------ */

/** A recording or a camera. */
typedef struct eventide_source eventide_source;

/** Any format that eventide reads. `format` may be NULL (found from the content), width and height
 * 0 (what the recording says). */
EVENTIDE_API eventide_status eventide_recording_open(const char* path, const char* format,
                                                     int width, int height,
                                                     eventide_source** opened);

/** "davis:", "dvxplorer:", "dvs128:" (the first one that can be used), "davis:SERIAL",
 * "v4l2:/dev/video0", "ros2:/TOPIC", "udp://HOST:PORT?size=640x480", "sim:demo"; `settings` may be
 * NULL, or a file of settings; `reconnect` not 0: an unplugged camera is waited for. */
EVENTIDE_API eventide_status eventide_camera_open(const char* name, const char* settings,
                                                  int reconnect, eventide_source** opened);

/** What a source or writer asks and tells, on the thread that calls it; functions may be NULL. */
typedef struct eventide_callbacks {
    size_t struct_size; /**< sizeof(eventide_callbacks) */
    void* context;      /**< what the functions are called with */
    /** Whether to give up waiting: not 0 does, and the call that waits is EVENTIDE_FAILED. Asked
     * every 20 ms or so while the first message of a topic is waited for, which with `reconnect`
     * may be for ever, while standard input or a pipe has no bytes, and while a pipe takes none. */
    int (*give_up)(void* context);
    /** Told, in sentences for people, what makes no call fail: what had to be guessed of a
     * recording, why a camera was passed over for the next one, why one is waited for and not back
     * yet. `text` is valid until it returns. */
    void (*warn)(void* context, const char* text);
} eventide_callbacks;

/** What a recording's bytes do not say, or say wrongly; 0 and NULL: what they do. */
typedef struct eventide_recording_options {
    size_t struct_size; /**< sizeof(eventide_recording_options) */
    const char* format; /**< "aedat4", "evt3", "text", ...; NULL: found from the content */
    int width;          /**< px, of the sensor; both or neither */
    int height;         /**< px */
    /** Of a recording with events of several cameras, whose are read, as eventide_callbacks.warn is
     * told their names: the topic of a bag, "davis/right" of an HDF5 file, the number of a source
     * of AEDAT 3 or of a stream of AEDAT 4. NULL: the first. */
    const char* stream;
} eventide_recording_options;

/** Options may be NULL. Callbacks are copied; NULL: none. */
EVENTIDE_API eventide_status eventide_recording_open_with(const char* path,
                                                          const eventide_recording_options* options,
                                                          const eventide_callbacks* callbacks,
                                                          eventide_source** opened);
/** eventide_camera_open() with callbacks, which are copied; NULL: none. */
EVENTIDE_API eventide_status eventide_camera_open_with(const char* name, const char* settings,
                                                       int reconnect,
                                                       const eventide_callbacks* callbacks,
                                                       eventide_source** opened);
/** Frees it; NULL may be closed. */
EVENTIDE_API void eventide_source_close(eventide_source* source);

/** Puts a filter behind the source and its other filters, before anything is read from it:
 * "flicker", "region:10,20,100x50", ..., as `eventide run --filter` takes them. EVENTIDE_USAGE for
 * one that is none, where a recording does not say its size, and once something was read. */
EVENTIDE_API eventide_status eventide_source_add_filter(eventide_source* source,
                                                        const char* filter);

/** px, of the sensor behind its filters; 0 where a recording does not say. */
EVENTIDE_API int eventide_source_width(const eventide_source* source);
/** px, of the sensor behind its filters; 0 where a recording does not say. */
EVENTIDE_API int eventide_source_height(const eventide_source* source);

/** eventide_reconstructor_open() for the sensor of this source. */
EVENTIDE_API eventide_status eventide_reconstructor_open_for(const eventide_source* source,
                                                             const char* model,
                                                             const eventide_options* options,
                                                             eventide_reconstructor** opened);

/** The next events, valid until the next call with the same source; EVENTIDE_NONE at the end. No
 * events and EVENTIDE_OK: go on. EVENTIDE_INPUT where a recording cannot be read, EVENTIDE_DEVICE
 * where a camera is lost. */
EVENTIDE_API eventide_status eventide_read(eventide_source* source, const eventide_event** events,
                                           size_t* count);

/** Reads on and pushes what came: events, images, marks of lost data, a camera's clock.
 * EVENTIDE_NONE at the end, which eventide_finish() is told with the recording's last time
 * (eventide_source_clock()). Else as eventide_read() and eventide_push(); EVENTIDE_USAGE also where
 * the source's sensor has another size than the reconstructor's. */
EVENTIDE_API eventide_status eventide_read_into(eventide_source* source,
                                                eventide_reconstructor* reconstructor);

/** The next frame of a source at the rate of the options: reads on until there is one.
 * EVENTIDE_NONE where the source has ended and all its frames were given; else as
 * eventide_read_into() and eventide_next(). */
EVENTIDE_API eventide_status eventide_read_frame(eventide_source* source,
                                                 eventide_reconstructor* reconstructor,
                                                 eventide_frame* frame);

/** The newest time the source told so far; EVENTIDE_NONE before the first. Of a camera it is what
 * eventide_advance() wants: every event before it has been read, and it goes on in silence. At the
 * end of a recording it is what eventide_finish() wants. */
EVENTIDE_API eventide_status eventide_source_clock(const eventide_source* source, int64_t* t);

/** Of a recording: goes on from `t`, with the first event and image from then on. A reconstructor
 * that saw others wants eventide_reset() first. Does nothing on standard input and on pipes.
 * EVENTIDE_USAGE for a camera. */
EVENTIDE_API eventide_status eventide_seek(eventide_source* source, int64_t t);

/** A recording being written. */
typedef struct eventide_writer eventide_writer;

/** The file appears whole, with eventide_writer_finish(); `format` NULL: by the extension. */
EVENTIDE_API eventide_status eventide_writer_open(const char* path, const char* format, int width,
                                                  int height, int overwrite,
                                                  eventide_writer** opened);
/** eventide_writer_open() with callbacks, which are copied; NULL: none. While a pipe has no reader
 * or is full, `give_up` ends this call, eventide_write() and eventide_writer_finish(). */
EVENTIDE_API eventide_status eventide_writer_open_with(const char* path, const char* format,
                                                       int width, int height, int overwrite,
                                                       const eventide_callbacks* callbacks,
                                                       eventide_writer** opened);
/** Must follow what was written before in time. EVENTIDE_USAGE for an event earlier than the one
 * before it and for what the format cannot hold, EVENTIDE_FAILED where the disk is full. */
EVENTIDE_API eventide_status eventide_write(eventide_writer* writer, const eventide_event* events,
                                            size_t count);
/** Ends the stream and shows the file; nothing can be written after it. */
EVENTIDE_API eventide_status eventide_writer_finish(eventide_writer* writer);
/** Frees it; NULL may be closed. Without eventide_writer_finish() nothing is left behind. */
EVENTIDE_API void eventide_writer_close(eventide_writer* writer);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-use-using,readability-identifier-naming) */

#endif
