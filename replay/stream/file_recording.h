// A recording in one file, read in chunks of bounded size.
#pragma once

#include "replay/recording.h"
#include "replay/stream/byte_file.h"
#include "replay/stream/seek.h"
#include "src/codec/stream.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide {

/// What a format makes of a file's beginning.
struct OpenedStream {
    StreamHeader header;
    /// Makes a parser for the bytes after header.data_offset. The header given has its geometry
    /// completed.
    MakeParser make_parser;
    SeekMeans seek{};
    std::vector<std::string> remarks{};  ///< see Recording::remarks()
};

class FileRecording : public Recording {
public:
    static constexpr std::size_t kChunkBytes = std::size_t(128) << 10;

    /// `ahead` holds the bytes after the header that were already read from a file that cannot
    /// seek.
    FileRecording(ByteFile file, OpenedStream stream, std::vector<std::byte> ahead = {});

    const SensorInfo& info() const override { return info_; }
    const StreamHeader& header() const { return stream_.header; }
    /// After a seek.
    bool begins_in_the_middle() const { return begin_.position != stream_.header.data_offset; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { file_.stop(); }
    std::unique_ptr<Parser> make_parser() const override;
    std::vector<std::string> remarks() const override { return stream_.remarks; }
    void seek(SensorTime t) override;
    std::uint64_t size_bytes() const override { return file_.size(); }
    std::uint64_t position_bytes() const override { return file_.position(); }

private:
    std::size_t next_chunk_bytes() const;

    ByteFile file_;
    OpenedStream stream_;
    SensorInfo info_;
    std::vector<std::byte> ahead_;
    SeekPoint begin_;  ///< of what is read
    std::uint64_t packets_ = 0;
};

}  // namespace eventide
