/// @file
/// Events in, frames with uncertainty out: one network at work on one sensor's stream.
#pragma once

#include <eventide/arithmetic.h>
#include <eventide/event.h>
#include <eventide/frame.h>
#include <eventide/version.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// The defaults are those of `eventide run --quality fixed` on a camera: frames as early as they
/// can be. For a recording, which can wait, `eventide run` takes window "auto", lookahead 2 and
/// lamp_flicker "16ms", which are better.
struct ReconstructorOptions {
    /// How events are cut into event windows, each of which is one step of the network: "model"
    /// (what the model was trained for), "auto" (by content: short where much moves, 100 ms at
    /// most), "50ms" (constant time: us, ms or s), "20000ev" (constant number), "0.35epp" (events
    /// per pixel), "aps" (between reference images); after a comma the longest: "20000ev,200ms",
    /// and for "auto" after another one the shortest: "auto,50ms,5ms".
    std::string window = "model";
    int lookahead =
        0;  ///< 0, 1 or 2: event windows a frame waits for; more: higher quality, more latency
    /// The frames that next() gives, per second of sensor time: "120", "29.97", "30000/1001", at
    /// most 1000000; "frame": one at the end of each event window.
    std::string fps = "30";
    FrameSize size{};   ///< of the frames
    bool sigma = true;  ///< false: Frame::sigma stays empty, and rendering is faster
    /// Leaves out noise, which is events that fewer than two of the eight pixels around them
    /// support within some time: "10ms", for example; "auto": 10 to 500 ms, by the noise that is
    /// found; "off"; "model": as the model was trained.
    std::string noise_filter = "model";
    /// While light flickers (80 to 800 Hz), leaves out the pairs of on and off events that it adds.
    /// Events wait as long as the second of a pair may come: "auto", three quarters of a period; a
    /// time, such as "16ms", which is better and later (`eventide run` takes it for recordings);
    /// "off".
    std::string lamp_flicker = "auto";
    /// Frames are corrected by the images that a camera takes beside its events, where they are
    /// pushed with them (push(const Batch&)), as `eventide run` does. Memory: some 190 bytes a
    /// pixel of the sensor, from the first image on.
    bool images = true;
    std::string hot_pixels = "off";  ///< "off", "learn", or a file that lists pixels, "x,y" a line
    Precision precision = Precision::automatic;  ///< of the network's products
    Kernels kernels = Kernels::automatic;        ///< whose convolutions
    int threads = 0;  ///< the network may use; 0: as many as the process may run on
    /// 1, 2 or 4 networks see the scene as it is and mirrored, and frames are the mean of theirs: a
    /// smaller error for that many times the work and memory.
    int self_ensemble = 1;
    bool reset_on_gap = false;   ///< forget the scene where data were lost
    bool allow_silence = false;  ///< next(): any number of frames in a row without events
};

/// What became of what was pushed, since construction.
struct ReconstructorCounters {
    std::uint64_t events = 0;          ///< pushed
    std::uint64_t off_sensor = 0;      ///< left out: x or y outside the sensor
    std::uint64_t time_backwards = 0;  ///< left out: earlier than the event before
    std::uint64_t bad_time = 0;        ///< left out: further from zero than kFarthestTime
    std::uint64_t filtered = 0;        ///< left out: of hot pixels, or noise
    std::uint64_t late = 0;            ///< moved later: advance() had promised that none would come
    std::uint64_t left_out = 0;        ///< more in one microsecond than memory is meant to hold
    std::uint64_t time_resets = 0;     ///< how often the sensor's clock was reset
    std::uint64_t event_windows = 0;   ///< steps of the network
    std::uint64_t frames = 0;          ///< rendered
    std::uint64_t used_images = 0;     ///< corrected frames
    std::uint64_t dropped_images = 0;  ///< came too late for it, or before a clock reset
};

/// Events of one sensor are pushed as they come, in order of time; frames are asked for. The
/// network works where frames are asked for, not in push(): until then events wait, 16 bytes each,
/// and images, 2 bytes a pixel.
///
/// Frames are found in two ways, which may be mixed: next() gives those at a constant rate, one
/// after the other; render() gives any time, as long as ready() says so. The network remembers some
/// five event windows, so ask in the order of time; where images correct frames, one of an earlier
/// event window than the newest reached so far is corrected less well. Once next() has given a
/// frame it gives every one after it, and ready() and newest() go no further ahead than it can
/// follow: call it until it is false first. Before, frames that it would have given are left out.
///
/// How the events are split into calls changes nothing. With the same model, window, lookahead,
/// precision and kernels (not automatic ones, which are measured anew in each process) frames are
/// those of `eventide run`, bit for bit, with any number of threads (without images: those of
/// `--frames ignore`; where the images are of a colour camera, nearly).
///
/// Thread: one at a time; several objects may work side by side. Once warm (the same batch sizes
/// as before, and no more than two frame sizes in turns), nothing here allocates memory with
/// Kernels::own and one thread, but for images. All functions but those marked noexcept may throw
/// Error; an object that threw may be used on.
class EVENTIDE_API Reconstructor {
public:
    /// us: no time is further from zero (36000 years).
    static constexpr std::int64_t kFarthestTime = std::int64_t{1} << 60;

    /// `model`: a name ("default", "small", "thesis") or a safetensors file. Names are looked for
    /// in $EVENTIDE_MODELS, then where the library is installed. width, height: px of the sensor, 1
    /// to 4096. Throws Error: input where the model cannot be found or used, usage for an option or
    /// size out of range.
    Reconstructor(const std::string& model, int width, int height,
                  const ReconstructorOptions& options = {});
    ~Reconstructor();
    Reconstructor(Reconstructor&&) noexcept;             ///< leaves the other empty
    Reconstructor& operator=(Reconstructor&&) noexcept;  ///< leaves the other empty

    int width() const noexcept;       ///< px, of the sensor
    int height() const noexcept;      ///< px, of the sensor
    std::string description() const;  ///< which kernels and numbers run, for people

    /// Events in order of time. One that is earlier than the one before it, outside the sensor or
    /// at an impossible time is left out and counted. Throws Error (usage) after finish().
    void push(std::span<const Event> events);

    /// The same with images, of all of the sensor or a part of it: they correct frames
    /// (ReconstructorOptions::images), and window "aps" is cut at their times. An event earlier
    /// than the one before means here that the sensor's clock was reset, as readers and cameras
    /// tell it: the frames of the time before are finished, and a new stream begins. Throws Error
    /// (usage) after finish() and for images of impossible channels, corner or exposure.
    void push(const Batch& batch);

    /// Every event before `now` has been pushed: time goes on where nothing moves. For live
    /// sources, and only as far as is certain: events before are late. Where those pushed stay more
    /// than a second before it for a second on the host's clock, it was wrong, and they begin a new
    /// stream. Throws Error (usage) after finish() and for times beyond kFarthestTime.
    void advance(SensorTime now);

    /// Data were lost here: the next frame carries gap_before.
    void mark_gap() noexcept;

    /// The stream has ended (at `end`, where its clock went on after the last event): what is left
    /// becomes the last event window, and its frames no longer wait for later ones. Throws Error
    /// (usage) for an end beyond kFarthestTime: then the stream goes on.
    void finish(std::optional<SensorTime> end = {});

    /// The next frame at the rate of the options, from the first event's time on, or from the
    /// first that advance() told. False where it has to wait for more events, or after finish() for
    /// ever. Throws Error (input) where the
    /// network gives no finite numbers, or for more than a million frames in a row without events
    /// (times that are wrong), which are then skipped.
    bool next(Frame& frame);

    /// Whether a frame of this time can be rendered; takes the network so far as that needs, and as
    /// next() can follow where it is used.
    Readiness readiness(SensorTime t);
    /// Whether readiness() says so.
    bool ready(SensorTime t) { return readiness(t) == Readiness::ready; }

    /// The frame of one instant, in the size of the options. Buffers of `frame` are used again
    /// where they fit. Throws Error: usage where it is not ready or the size is impossible, input
    /// where the network gives no finite numbers, failed where there is too little memory.
    void render(SensorTime t, Frame& frame);
    /// The same in another size, or a part of it.
    void render(SensorTime t, const FrameSize& size, Frame& frame);

    /// The newest time that can be rendered, after all events pushed so far have gone through the
    /// network, or those that next() can follow where it is used; empty where there is none. What
    /// was not asked for until then may be gone.
    std::optional<SensorTime> newest();

    /// As constructed: a new stream begins. Counters and the hot pixels that were learned stay.
    void reset();

    /// What the network remembers of the scene, after the event windows so far: bytes for restore()
    /// of any Reconstructor of the same model, sensor size and self_ensemble.
    std::vector<std::byte> state() const;

    /// reset(), and the network remembers what state() told. Throws Error (input) where these are
    /// no state, or one of another model, sensor size or self_ensemble: then nothing has changed.
    void restore(std::span<const std::byte> state);

    /// state() as a file, which restore_state() and `eventide run --state-in` read. Throws Error:
    /// failed where it cannot be written, usage for a file that exists without `overwrite`.
    void save_state(const std::filesystem::path& file, bool overwrite = false) const;

    /// restore() from a file.
    void restore_state(const std::filesystem::path& file);

    ReconstructorCounters counters() const noexcept;  ///< so far

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eventide
