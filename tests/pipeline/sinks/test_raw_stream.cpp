// Streams: ffprobe and our own eyes read what was written.
#include "pipeline/sinks/raw_stream.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/pipeline/sinks/written_streams.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace eventide {
namespace {

using test::TempFolder;

TEST(StreamSink, FfprobeReadsY4m) {
    const TempFolder temp;
    StreamSink sink{{.path = temp / "a.y4m", .fps = 200}};
    for (int n = 0; n < 20; ++n) sink.write(test::ramp_frame(31, 17, n, test::odd_time(n)));
    sink.close();
    EXPECT_EQ(
        test::probe(temp / "a.y4m", "width,height,pix_fmt,r_frame_rate,nb_read_frames,color_range"),
        "32,18,yuv420p,pc,200/1,20\n");
}

TEST(StreamSink, HeadsY4mWithTheRateAsItWasAskedFor) {
    const TempFolder temp;
    const auto rate_in = [&](double fps, const FrameRate& rate) {
        StreamSink sink{{.path = temp / "a.y4m", .overwrite = true, .fps = fps, .rate = rate}};
        sink.write(test::ramp_frame(16, 8, 0, test::odd_time(0)));
        sink.close();
        const std::string text = test::read_text(temp / "a.y4m");
        const auto at = text.find(" F") + 2;
        return text.substr(at, text.find(' ', at) - at);
    };
    EXPECT_EQ(rate_in(30000. / 1001, {30000, 1001}), "30000:1001");
    EXPECT_EQ(rate_in(1. / 3600, {1, 3600}), "1:3600");
    EXPECT_EQ(rate_in(1. / 3600, {}), "1:3600");
    EXPECT_EQ(rate_in(1. / 30, {}), "1:30");
    EXPECT_EQ(rate_in(29.97, {}), "2997:100");
    EXPECT_EQ(rate_in(1. / 3, {1'000'000'000, 3'000'000'000}), "333:1000");
    EXPECT_EQ(rate_in(100, {300'000'000'000, 3'000'000'000}), "100:1") << "more than 31 bits";
}

TEST(StreamSink, Y4mFramesTellTheSensorsTimeInATagThatReadersPassOver) {
    const TempFolder temp;
    StreamSink sink{{.path = temp / "a.y4m", .fps = 30}};
    std::vector<std::int64_t> times;
    for (int n = 0; n < 5; ++n) {
        times.push_back(to_us(test::odd_time(n)));
        sink.write(test::ramp_frame(32, 16, n, test::odd_time(n)));
    }
    sink.close();
    EXPECT_EQ(test::y4m_times(test::read_text(temp / "a.y4m")), times);
    EXPECT_EQ(test::probe(temp / "a.y4m", "width,r_frame_rate,nb_read_frames"), "32,30/1,5\n");
}

TEST(StreamSink, AStampTellsNumberTimeAndWhatHappened) {
    const TempFolder temp;
    StreamSink sink{{.path = temp / "a", .format = StreamFormat::gray8, .stamp = true}};
    Frame frame = test::ramp_frame(4, 2, 0x0102, from_us(0x0A0B0C0D0E0F));
    frame.gap_before = true;
    sink.write(frame);
    sink.close();
    const std::string bytes = test::read_text(temp / "a");
    EXPECT_EQ(bytes.size(), FrameStamp::kBytes + 8);
    EXPECT_EQ(bytes.substr(0, FrameStamp::kBytes),
              std::string("EVF\x01\x02\x01\0\0\x0F\x0E\x0D\x0C\x0B\x0A\0\0", 16));
}

TEST(StreamSink, MonoKeepsOddSizesAndExactGreys) {
    const TempFolder temp;
    const Frame frame = test::ramp_frame(31, 17, 3, test::odd_time(0));
    StreamSink sink{{.path = temp / "a.y4m", .format = StreamFormat::y4m_mono, .fps = 29.97}};
    sink.write(frame);
    sink.close();
    EXPECT_EQ(test::probe(temp / "a.y4m", "width,height,pix_fmt,r_frame_rate,nb_read_frames"),
              "31,17,gray,2997/100,1\n");
    const std::string bytes = test::read_text(temp / "a.y4m");
    const std::string pixels = bytes.substr(bytes.find('\n', bytes.find("FRAME")) + 1);
    ASSERT_EQ(pixels.size(), 31U * 17U);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        EXPECT_EQ(int(std::uint8_t(pixels[i])), std::lround(frame.intensity.values()[i] * 255));
}

TEST(StreamSink, RefusesWhatAFormatCannotCarry) {
    const TempFolder temp;
    for (const auto& [format, how] : {std::pair{StreamFormat::y4m, Uncertainty::alpha},
                                      std::pair{StreamFormat::y4m, Uncertainty::separate},
                                      std::pair{StreamFormat::y4m_mono, Uncertainty::overlay},
                                      std::pair{StreamFormat::gray8, Uncertainty::overlay}})
        EXPECT_THROW((StreamSink{{.path = temp / "x", .format = format, .uncertainty = how}}),
                     Error);
}

TEST(StreamSink, AFullDiskIsAnError) {
    StreamSink sink{{.path = "/dev/full", .format = StreamFormat::gray8}};
    EXPECT_THROW(sink.write(test::ramp_frame(8, 8, 0, from_us(0))), Error);
}

TEST(StreamSink, KeepsAFileThatExists) {
    const TempFolder temp;
    test::write_text(temp / "a.raw", "precious");
    EXPECT_THROW((StreamSink{{.path = temp / "a.raw"}}), Error);
    EXPECT_EQ(test::read_text(temp / "a.raw"), "precious");
}

}  // namespace
}  // namespace eventide
