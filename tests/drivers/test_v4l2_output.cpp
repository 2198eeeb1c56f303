// The loopback sink against a video node in software: order of ioctls, bytes of each frame,
// refusals.
#include "pipeline/sinks/v4l2_output.h"
#include "src/core/error.h"
#include "tests/support/holdings.h"
#include "tests/support/preload.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <linux/videodev2.h>

#include <cerrno>

namespace eventide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

V4l2NodeSettings loopback(std::vector<std::uint32_t> takes) {
    V4l2NodeSettings settings;
    settings.output = true;
    settings.takes = std::move(takes);
    return settings;
}

Frame frame(int width, int height) {
    Frame f;
    f.intensity = Array2<float>{height, width};
    f.sigma = Array2<float>{height, width};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) f.intensity(y, x) = float(10 * y + x) / 255;
    return f;
}

V4l2OutputSettings node() {
    V4l2OutputSettings settings;
    settings.node = "/dev/video0";
    return settings;
}

std::vector<int> numbers(const std::vector<std::byte>& bytes) {
    std::vector<int> all;
    for (const std::byte b : bytes) all.push_back(int(b));
    return all;
}

std::string failure_of(const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST(V4l2Output, FixesTheFormatOnceAndWritesWholeGreyFrames) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_GREY})};
    V4l2OutputSink sink{node()};
    sink.write(frame(3, 2));
    sink.write(frame(3, 2));
    ASSERT_EQ(bed.written().size(), 2U);
    EXPECT_THAT(numbers(bed.written()[0]), ElementsAre(0, 1, 2, 10, 11, 12));
    // YUYV is offered first and turned into GREY by the device, which is then asked for by name.
    EXPECT_THAT(bed.requests(), ElementsAre("QUERYCAP", "S_FMT", "S_FMT"));
}

/// As webcams send it and programs take it: black is 16, white 235 (BT.601, limited range).
TEST(V4l2Output, YuyvHasNoColourAndEvenSides) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_YUYV})};
    V4l2OutputSink sink{node()};
    sink.write(frame(3, 3));
    ASSERT_EQ(bed.written().size(), 1U);
    EXPECT_THAT(numbers(bed.written()[0]), ElementsAre(16, 128, 17, 128, 25, 128, 25, 128));
}

TEST(V4l2Output, WhiteIsWhiteForWhoeverReadsIt) {
    Frame white = frame(2, 2);
    for (float& v : white.intensity.values()) v = 1;
    for (const auto& [fourcc, luma] : {std::pair{V4L2_PIX_FMT_YUYV, 235},
                                       {V4L2_PIX_FMT_YUV420, 235},
                                       {V4L2_PIX_FMT_GREY, 255}}) {
        V4l2Testbed bed{loopback({std::uint32_t(fourcc)})};
        V4l2OutputSink sink{node()};
        sink.write(white);
        EXPECT_EQ(numbers(bed.written().at(0)).front(), luma);
    }
}

TEST(V4l2Output, Yu12HasFlatChromaPlanes) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_YUV420})};
    V4l2OutputSink sink{node()};
    sink.write(frame(2, 2));
    EXPECT_THAT(numbers(bed.written().at(0)), ElementsAre(16, 17, 25, 25, 128, 128));
}

TEST(V4l2Output, SigmaGoesBesideTheIntensity) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_GREY})};
    V4l2OutputSettings settings = node();
    settings.uncertainty = Uncertainty::side;
    V4l2OutputSink sink{settings};
    Frame f = frame(2, 2);
    for (float& s : f.sigma.values()) s = kSigmaWhite;
    sink.write(f);
    EXPECT_THAT(numbers(bed.written().at(0)), ElementsAre(0, 1, 255, 255, 10, 11, 255, 255));
    settings.uncertainty = Uncertainty::alpha;
    EXPECT_THAT(failure_of([&] { V4l2OutputSink{settings}; }),
                HasSubstr("none or side, not as alpha"));
}

TEST(V4l2Output, NeverWaitsForADeviceThatTakesNothing) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_GREY})};
    V4l2OutputSink sink{node()};
    bed.refuse_writes(3, EAGAIN);
    for (int i = 0; i < 5; ++i) sink.write(frame(4, 4));
    EXPECT_EQ(bed.written().size(), 2U);
    EXPECT_EQ(sink.skipped(), 3U);
}

TEST(V4l2Output, AFrameIsWrittenThoughSignalsInterruptIt) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_GREY})};
    V4l2OutputSink sink{node()};
    bed.refuse_writes(2, EINTR);
    sink.write(frame(3, 2));
    ASSERT_EQ(bed.written().size(), 1U);
    EXPECT_THAT(numbers(bed.written()[0]), ElementsAre(0, 1, 2, 10, 11, 12));
    EXPECT_EQ(sink.skipped(), 0U);
}

TEST(V4l2Output, OpenedAndClosedLeavesNothingBehind) {
    V4l2Testbed bed{loopback({V4L2_PIX_FMT_GREY})};
    test::expect_nothing_left([] {
        V4l2OutputSink sink{node()};
        sink.write(frame(3, 2));
        sink.close();
    });
}

TEST(V4l2Output, SaysWhyItCannotWrite) {
    EXPECT_THAT(failure_of([] { V4l2OutputSink{node()}; }), HasSubstr("modprobe v4l2loopback"));
    {
        V4l2NodeSettings camera;
        camera.fourcc = V4L2_PIX_FMT_GREY;
        V4l2Testbed bed{camera};
        EXPECT_THAT(failure_of([] { V4l2OutputSink{node()}; }), HasSubstr("takes no video"));
    }
    {
        V4l2Testbed bed{loopback({V4L2_PIX_FMT_MJPEG})};
        V4l2OutputSink sink{node()};
        EXPECT_THAT(failure_of([&] { sink.write(frame(4, 4)); }), HasSubstr("does not take 4x4"));
    }
    {
        V4l2NodeSettings busy = loopback({V4L2_PIX_FMT_GREY});
        busy.refuse_format_with = EBUSY;
        V4l2Testbed bed{busy};
        V4l2OutputSink sink{node()};
        EXPECT_THAT(failure_of([&] { sink.write(frame(4, 4)); }),
                    HasSubstr("another program writes to it"));
    }
    {
        V4l2Testbed bed{loopback({V4L2_PIX_FMT_GREY})};
        V4l2OutputSink sink{node()};
        sink.write(frame(4, 4));
        for (const auto& [width, height] : {std::pair{8, 8}, {6, 4}, {4, 6}, {3, 4}, {4, 3}})
            EXPECT_THAT(failure_of([&] { sink.write(frame(width, height)); }),
                        HasSubstr("opened at 4x4"));
        bed.fail_with(ENODEV);
        EXPECT_THAT(failure_of([&] { sink.write(frame(4, 4)); }),
                    HasSubstr("takes no more frames"));
    }
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
