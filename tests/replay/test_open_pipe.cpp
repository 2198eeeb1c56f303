// Recordings in pipes: read as they come, waited for, and given up.
#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/replay/made_formats.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <string>
#include <thread>

namespace eventide {
namespace {

using testing::HasSubstr;

/// A pipe whose reading end open_recording() can name.
class Pipe {
public:
    Pipe() { EXPECT_EQ(::pipe(ends_.data()), 0); }
    ~Pipe() {
        ::close(ends_[0]);
        close_writing();
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    std::string path() const { return "/dev/fd/" + std::to_string(ends_[0]); }
    void write(const std::string& text) {
        EXPECT_EQ(::write(ends_[1], text.data(), text.size()), ssize_t(text.size()));
    }
    void close_writing() {
        if (ends_[1] >= 0) ::close(ends_[1]);
        ends_[1] = -1;
    }

private:
    std::array<int, 2> ends_{-1, -1};
};

TEST(OpenPipe, APipeOfTextIsReadAsItComes) {
    Pipe pipe;
    pipe.write("240 180\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n");
    const auto recording = open_recording(pipe.path());  // the writer is not done
    EXPECT_EQ(recording->info().width, 240);
    EXPECT_EQ(recording->size_bytes(), 0U);
    pipe.write("0.4 7 8 1\n");
    pipe.close_writing();
    recording->seek(from_us(1));  // a pipe cannot: nothing is lost
    EXPECT_EQ(read_everything(*recording).events.size(), 4U);
}

TEST(OpenPipe, CommentsInAPipeOfTextAreNoRows) {
    Pipe pipe;
    pipe.write("240 180\n# a\n# b\n# c\n");
    OpenOptions options;
    int waits = 0;
    options.give_up = [&] {  // asked before each read
        if (++waits == 2) {
            pipe.write("100 1 2 1\n200 3 4 0\n300 5 6 1\n400 7 8 1\n");
            pipe.close_writing();
        }
        return false;
    };
    const Batch batch = read_everything(*open_recording(pipe.path(), options));
    ASSERT_EQ(batch.events.size(), 4U);
    EXPECT_EQ(batch.events[0].t, from_us(100));
}

TEST(OpenPipe, APipeOfPacketsIsReadToo) {
    const TestFolder folder;
    const auto events = some_events(50);
    Pipe pipe;
    pipe.write(read_text(write_recording(folder.path("a"), "aedat3", events)));
    pipe.close_writing();
    EXPECT_TRUE(read_everything(*open_recording(pipe.path())).events == events);
}

/// Of what comes in two parts; it is given up where both are not enough.
std::unique_ptr<Recording> open_in_parts(Pipe& pipe, const std::string& first,
                                         const std::string& second) {
    OpenOptions options;
    int waits = 0;
    options.give_up = [&] {  // asked before each read
        if (++waits == 2) pipe.write(second);
        return waits > 2;
    };
    pipe.write(first);
    auto recording = open_recording(pipe.path(), options);
    if (waits < 2) pipe.write(second);
    return recording;
}

TEST(OpenPipe, ACamerasEventsAreReadAsTheyComeInEveryFormat) {
    const TestFolder folder;
    const auto events = some_events(1000);
    for (const char* format :
         {"aedat4", "aedat3", "aedat2", "aedat1", "evt3", "evt2", "evt21", "dat", "es", "text"}) {
        const std::string whole = read_text(write_as(folder, format, events));
        for (const std::size_t cut : {3U, 20U, 40U, 300U}) {
            Pipe pipe;
            // The writer is not done.
            const auto recording = open_in_parts(pipe, whole.substr(0, cut), whole.substr(cut));
            EXPECT_EQ(recording->info().width, 128) << format << " cut at " << cut;
            pipe.close_writing();
            EXPECT_TRUE(read_everything(*recording).events == events)
                << format << " cut at " << cut;
        }
    }
}

TEST(OpenPipe, APipeWithoutASizeIsRefusedAndTheOptionNamed) {
    Pipe pipe;
    pipe.write("0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n0.4 5 6 1\n");
    try {
        open_recording(pipe.path());
        FAIL() << "it was opened";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), HasSubstr("--input-size"));
    }
}

TEST(OpenPipe, StopEndsAReadThatWaits) {
    Pipe pipe;
    pipe.write("240 180\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n");
    const auto recording = open_recording(pipe.path());
    RawPacket packet;
    ASSERT_EQ(recording->read(packet), ReadStatus::data);
    std::jthread stopper([&] { recording->stop(); });
    EXPECT_EQ(recording->read(packet), ReadStatus::end);  // the pipe is open and empty
}

TEST(OpenPipe, APipeWithoutWriterOrBytesIsGivenUpOnRequest) {
    const TestFolder folder;
    const std::string named = folder.path("pipe");
    ASSERT_EQ(::mkfifo(named.c_str(), 0600), 0);
    const Pipe silent;
    for (const std::string& path : {named, silent.path()}) {
        int asked = 0;
        OpenOptions options;
        options.give_up = [&] { return ++asked == 3; };
        try {
            open_recording(path, options);
            ADD_FAILURE() << path;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::failed);
            EXPECT_THAT(error.what(), HasSubstr(path + ": stopped while waiting"));
        }
        EXPECT_EQ(asked, 3);
    }
}

TEST(OpenPipe, AWaitingThatIsInterruptedCanBeTakenUpAgain) {
    struct Interrupted {};
    Pipe pipe;
    bool interrupts = true;
    OpenOptions options;
    options.while_waiting = [&] {
        if (interrupts) throw Interrupted{};
        pipe.write("0.4 7 8 1\n");
    };
    EXPECT_THROW(open_recording(pipe.path(), options), Interrupted);
    pipe.write("240 180\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n");
    interrupts = false;
    const auto recording = open_recording(pipe.path(), options);
    RawPacket packet;
    ASSERT_EQ(recording->read(packet), ReadStatus::data);
    interrupts = true;
    EXPECT_THROW(recording->read(packet), Interrupted);
    interrupts = false;
    ASSERT_EQ(recording->read(packet), ReadStatus::data);
    EXPECT_EQ(packet.bytes.size(), 10U);
}

TEST(OpenPipe, ANamedPipeWaitsForItsWriter) {
    const TestFolder folder;
    const std::string named = folder.path("pipe");
    ASSERT_EQ(::mkfifo(named.c_str(), 0600), 0);
    OpenOptions options;
    std::jthread writer;
    options.give_up = [&] {  // asked once nobody has written: now someone does
        if (!writer.joinable())
            writer = std::jthread{[&] { folder.write("pipe", "240 180\n0.1 1 2 1\n0.2 3 4 0\n"); }};
        return false;
    };
    EXPECT_EQ(read_everything(*open_recording(named, options)).events.size(), 2U);
}

}  // namespace
}  // namespace eventide
