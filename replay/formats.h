// The formats of recordings, in one table, and how to open one for reading or writing.
#pragma once

#include "replay/data_reader.h"
#include "replay/file_writer.h"
#include "replay/open_options.h"
#include "replay/recording.h"
#include "replay/stream/file_recording.h"
#include "src/codec/stream.h"
#include "src/io/output_file.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace eventide {

/// What kinds of data a format has records for.
struct FormatHolds {
    bool events = true, images = false, imu = false, triggers = false;
    /// Where it has records for some kinds of triggers only: which. Null: for all.
    bool (*trigger)(const Trigger&) = nullptr;
    /// Its records share one clock: a trigger that comes behind later events has their time.
    bool in_time_order = false;
    /// It can say a clock reset: events step back there, and its readers see a new stream.
    bool clock_resets = false;
    /// It can hold events of several cameras, of which one is read (OpenOptions::stream).
    bool streams = false;
    /// Says which colour filter was before the sensor of images that are mosaics.
    bool colour_filter = false;
    /// It says that filter with each image; else once for all, before the first.
    bool colour_filter_of_each = false;
};

struct DataCounts {
    std::uint64_t events = 0, images = 0, imu = 0, triggers = 0;
    friend bool operator==(const DataCounts&, const DataCounts&) = default;
    DataCounts& operator+=(const DataCounts& more);
};

/// "3 events, 1 image"; what there is none of goes unsaid.
std::string text_of(const DataCounts& counts);

/// Takes out what a format has no record for; returns how much that was.
DataCounts remove_not_held(Batch& batch, const FormatHolds& holds);

struct Format {
    std::string_view name;       ///< as in StreamHeader::format
    std::string_view title;      ///< for people
    std::string_view extension;  ///< what files of this kind are usually called, with the dot
    FormatHolds holds;
    /// True when a file beginning with these bytes is of this format.
    bool (*matches)(std::span<const std::byte> first_bytes);
    /// Reads the header from the first bytes of a file (all of it, or kHeadBytes). Throws Error
    /// (input) when it is not what it says.
    OpenedStream (*open)(std::span<const std::byte> first_bytes, const OpenOptions& options);
    std::unique_ptr<StreamWriter> (*make_writer)();  ///< null: no stream of bytes is written
    /// Set instead of `open` for what is no stream of bytes: reads a file by its path.
    std::unique_ptr<DataReader> (*open_path)(const std::string& path,
                                             const OpenOptions& options) = nullptr;
    /// Set instead of make_writer for what is no stream of bytes.
    std::unique_ptr<FileWriter> (*make_file_writer)(OutputFile& file,
                                                    const StreamHeader& header) = nullptr;
    /// How many bytes of the data behind the header `matches` and `open` look at.
    std::size_t looks_at = 1;

    bool is_written() const { return make_writer != nullptr || make_file_writer != nullptr; }
};

/// No header is longer than this (AEDAT 2.0 files carry the recorder's preferences, 200 kB).
constexpr std::size_t kHeadBytes = std::size_t(1) << 20;

/// In the order in which they are tried on a file.
std::span<const Format> all_formats();
/// "aedat4, evt3, ...": of those that are written.
std::string names_of_writable();
/// ".aedat4, .raw, ...": of the same, in the same order.
std::string extensions_of_writable();

/// Null when there is no format of that name.
const Format* find_format(std::string_view name);

/// The format of a file that begins with these bytes; null when none matches.
const Format* detect_format(std::span<const std::byte> first_bytes);

/// The format a file of this name is to be written in: by its extension. Null when unknown.
const Format* format_for_writing(const std::string& path);

/// Opens a recording by its content, whatever it is called: a file, a folder in the manner of the
/// Event Camera Dataset (or its events.txt), or "-" for standard input. Throws Error (input) naming
/// the path, what was expected and what was found.
std::unique_ptr<Recording> open_recording(const std::string& path, const OpenOptions& options = {});

/// Throws Error (usage) for a format that is unknown, read only, or no stream of bytes.
std::unique_ptr<StreamWriter> open_writer(std::string_view format);

}  // namespace eventide
