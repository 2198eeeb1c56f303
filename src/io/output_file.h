// A file being written: the one place where files of the user are made or replaced.
#pragma once

#include "src/io/output_paths.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace eventide {

/// When a file shows under its name.
enum class Appears {
    /// At publish(): until then it is written beside, as NAME.part, and then renamed, so that there
    /// is a whole file or, when that fails, the one from before; by close() also after a power cut.
    whole,
    /// From its first byte, for what others read while it grows or a killed run must leave behind:
    /// videos, streams, recordings of cameras. What was there is kept until that first byte.
    growing
};

/// What became of whoever reads a pipe; of all other files always `takes`.
enum class PipeReader {
    takes,
    never_came,  ///< nobody opened it until the wait was given up
    stalled,     ///< took nothing until the wait was given up
    left         ///< closed it
};

/// What to say behind a pipe's name and a colon: "nobody read it", "its reader went away".
std::string_view text_of(PipeReader reader);

struct OutputOptions {
    bool overwrite = false;
    Appears appears = Appears::whole;
    /// Asked while a named pipe waits for its reader, and while a pipe is full: true gives up, of a
    /// full one after a second in which its reader took nothing. May be empty.
    std::function<bool()> give_up = {};
    /// Told once, by whichever call notices it, when nothing more goes into a pipe. Must not throw;
    /// may be empty.
    std::function<void(const std::string& name, PipeReader)> unread = {};
};

class OutputFile {
public:
    /// "-" is standard output. Pipes and devices are written to, not replaced. Throws Error: usage
    /// for a folder, for a file with something in it without `overwrite`, and for a growing one
    /// that another writes; failed when it cannot be made.
    explicit OutputFile(const std::filesystem::path& path, const OutputOptions& options = {});
    /// Without publish() or close() what was written beside is removed.
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    const std::string& name() const { return name_; }  ///< for messages
    bool is_seekable() const { return seekable_; }
    /// Others see what is written as it is written.
    bool is_shown() const { return part_.empty(); }
    /// Without one that takes it nothing is written any more, which is no error.
    PipeReader reader() const { return reader_; }
    bool is_read() const { return reader_ == PipeReader::takes; }

    /// A pipe holds about so many bytes from now on, if it held more; at least a page of memory.
    void hold_at_most(std::size_t bytes);

    /// False where a pipe is full, as whoever reads it is behind.
    bool takes_at_once() const;
    /// Throws Error (failed) with the system's words.
    void write(std::span<const std::byte> bytes);
    void write(std::string_view text);
    /// Over bytes that were written; only where is_seekable().
    void write_at(std::uint64_t offset, std::span<const std::byte> bytes);

    std::uint64_t size() const;  ///< bytes; only where is_seekable()

    /// A path under which a library that opens its files itself writes to this one, from now on
    /// alone; only where is_seekable().
    std::string path_to_reopen();

    /// Shows the file under its name; it may be written on.
    void publish();
    /// publish(), and the end. A growing file that never got a byte is not left behind.
    void close();

private:
    void open_pipe();
    void open_again();
    bool wait_for_room(int& asked);
    void lose_reader(PipeReader why);
    void open_growing(bool overwrite);
    void take_alone();
    void open_beside(bool overwrite);
    void begin();
    void bring_to_disk();
    void rename_part();
    void forget_new_file();
    [[noreturn]] void fail(const char* doing, int error) const;

    std::filesystem::path path_;  // without links
    std::filesystem::path part_;  // beside it; empty when there is none (any more)
    std::string name_;
    std::function<bool()> give_up_;
    std::function<void(const std::string&, PipeReader)> unread_;
    int file_ = -1;
    bool owned_ = true;  // standard output is not ours to close
    PipeReader reader_ = PipeReader::takes;
    bool seekable_ = false;
    bool replaces_ = false;         // a file was there, and may go
    bool had_earlier_ = false;      // it held something
    bool has_other_names_ = false;  // what was there: hard links
    bool made_ = false;             // by us, under its own name
    bool begun_ = false;            // it got a byte
};

/// A whole file at once. Throws as OutputFile.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                bool overwrite);
void write_file(const std::filesystem::path& path, std::string_view text, bool overwrite);

}  // namespace eventide
