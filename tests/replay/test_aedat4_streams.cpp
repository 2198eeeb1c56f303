// A header that lies about the streams of an AEDAT4 file is told from its packets.
#include "replay/formats.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

using testing::HasSubstr;

/// Events, and where asked for images, IMU samples and triggers.
std::string file_of(bool everything) {
    const TestFolder folder;
    StreamHeader header;
    header.width = 346;
    header.height = 260;
    Batch batch;
    batch.events = some_events(3000);
    if (everything) {
        ReferenceImage image;
        image.pixels = Array2<std::uint16_t>(260, 346);
        batch.images.push_back(image);
        batch.imu.push_back({});
        batch.triggers.push_back({from_us(5), Trigger::Kind::rising, 0});
    }
    RecordingFile file(folder.path("made"), true, open_writer("aedat4"), header);
    file.write(batch);
    file.finish();
    return read_text(folder.path("made"));
}

/// The file with the first `was` after `key` made `is`, of the same length.
std::string changed(std::string file, const std::string& key, const std::string& was,
                    const std::string& is) {
    const std::size_t at = file.find(was, file.find(key));
    EXPECT_NE(at, file.npos) << key;
    return file.replace(at, was.size(), is);
}

std::vector<std::string> remarks_of(const std::string& content) {
    const TestFolder folder;
    return open_recording(folder.write("a.aedat4", content), {.width = 346, .height = 260})
        ->remarks();
}

TEST(Aedat4Streams, OfASoundFileNothingIsSaid) {
    EXPECT_TRUE(remarks_of(file_of(true)).empty());
    EXPECT_TRUE(remarks_of(file_of(false)).empty()) << "streams without packets are usual";
}

TEST(Aedat4Streams, AFileThatWasJoinedBehindIsNamedWithItsPlace) {
    const std::string file = file_of(true);
    const auto remarks = remarks_of(file + file);
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_THAT(remarks[0], HasSubstr("joined to it, at byte " + std::to_string(file.size())));
}

TEST(Aedat4Streams, EventsOfAnotherCameraAreNamedAndHowTheyAreRead) {
    const auto remarks = remarks_of(changed(file_of(false), "outInfo", "FRME", "EVTS"));
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_THAT(remarks[0], HasSubstr("the events of stream 1 ("));
    EXPECT_THAT(remarks[0], HasSubstr("those of stream 0 are read; --input-stream 1 ("));
}

TEST(Aedat4Streams, OnesThatTheHeaderDoesNotNameAreSaid) {
    // One flipped bit: the node of the event stream is called 4 instead of 0.
    const auto remarks = remarks_of(changed(file_of(true), "outInfo", "name=\"0\"", "name=\"@\""));
    ASSERT_FALSE(remarks.empty());
    EXPECT_THAT(remarks[0], HasSubstr("stream 0 (EVTS) are left out: the header names no such"));
}

TEST(Aedat4Streams, OnesThatTheHeaderCallsOtherwiseAreSaid) {
    const auto remarks = remarks_of(changed(file_of(true), "outInfo", "FRME", "FREE"));
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_THAT(remarks[0], HasSubstr("(FRME) are left out: the header calls them 'FREE'"));
}

TEST(Aedat4Streams, OnesWithoutPacketsAreNamedBesideThem) {
    const auto remarks = remarks_of(changed(file_of(true), "outInfo", "name=\"0\"", "name=\"8\""));
    EXPECT_THAT(remarks, testing::ElementsAre(HasSubstr("stream 0 (EVTS)"),
                                              HasSubstr("names a stream 8 ('EVTS')")));
}

}  // namespace
}  // namespace eventide
