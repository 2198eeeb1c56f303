// The contact sheet spreads a run of unknown length over a few rows.
#include "pipeline/sinks/contact_sheet.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/system/process.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <array>
#include <fstream>
#include <string>
#include <utility>

namespace eventide {
namespace {

using test::TempFolder;

cv::Mat sheet_of(int frames, ContactSheetSettings settings, bool with_events = false) {
    const auto path = settings.path;
    ContactSheetSink sink{std::move(settings)};
    for (int n = 0; n < frames; ++n) {
        Frame frame = test::ramp_frame(80, 30, n, from_us(1000 * n));
        if (with_events) frame.event_preview = frame.intensity;
        sink.write(frame);
    }
    sink.close();
    return cv::imread(path.string());
}

TEST(ContactSheet, APipeThatNobodyReadsIsGivenUp) {
    const TempFolder temp;
    const std::string pipe = temp / "sheet.png";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    int asked = 0;
    PipeReader why = PipeReader::takes;
    ContactSheetSink sink{{.path = pipe,
                           .give_up = [&] { return ++asked == 2; },
                           .unread = [&](const std::string&, PipeReader told) { why = told; }}};
    sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
    sink.close();
    EXPECT_EQ(asked, 2);
    EXPECT_EQ(why, PipeReader::never_came);
}

TEST(ContactSheet, HasARowForEachOfAFewFramesAndAColumnForWhatThereIs) {
    const TempFolder temp;
    const cv::Mat two = sheet_of(50, {.path = temp / "two.png", .rows = 3});
    const cv::Mat four =
        sheet_of(50,
                 {.path = temp / "four.png",
                  .rows = 3,
                  .draw_truth = [](SensorTime, const Window&,
                                   cv::Mat& image) { image = cv::Mat(30, 40, CV_8UC1, 200.0); }},
                 true);
    ASSERT_FALSE(two.empty());
    ASSERT_FALSE(four.empty());
    EXPECT_EQ(two.rows, four.rows);
    EXPECT_EQ(two.rows, 22 + 3 * (30 + 22) + 2 * 10);  // times nearer to the row that they are of
    double least = 0;
    cv::minMaxLoc(two.rowRange(74, 84).reshape(1), &least);
    EXPECT_EQ(least, 255) << "nothing between a time and the row after it";
    EXPECT_EQ(four.cols - two.cols, two.cols - 4);                  // twice the columns, one margin
    EXPECT_EQ(four.at<cv::Vec3b>(30, 20), cv::Vec3b(60, 60, 220));  // ON events
    EXPECT_EQ(four.at<cv::Vec3b>(30, four.cols - 20), cv::Vec3b(200, 200, 200));
}

/// The left half of the sensor is dark and without events, the right half not.
TEST(ContactSheet, ShowsOfEventsAndTruthThePartThatFramesShow) {
    const TempFolder temp;
    ContactSheetSettings settings{.path = temp / "part.png", .rows = 1};
    settings.draw_truth = [](SensorTime, const Window&, cv::Mat& image) {
        image = cv::Mat(60, 80, CV_8UC1, 200.0);
        image.colRange(0, 40) = 0.0;
    };
    settings.part = {.left = .5, .top = .25, .width = .5, .height = .5};
    ContactSheetSink sink{settings};
    Frame frame = test::ramp_frame(80, 30, 0, from_us(0));
    frame.event_preview = Array2<float>(60, 80);
    for (int y = 0; y < 60; ++y)
        for (int x = 40; x < 80; ++x) frame.event_preview(y, x) = 1;
    sink.write(frame);
    sink.close();
    const cv::Mat sheet = cv::imread(settings.path.string());
    for (const int x : {6, 80}) {  // of the cell's 80, which begin at 4
        EXPECT_EQ(sheet.at<cv::Vec3b>(30, x), cv::Vec3b(60, 60, 220));
        EXPECT_EQ(sheet.at<cv::Vec3b>(30, sheet.cols - x - 1), cv::Vec3b(200, 200, 200));
    }
}

/// A caption is wider than the image of a small sensor.
TEST(ContactSheet, HasRoomForTheCaptionsOfImagesHoweverSmall) {
    const TempFolder temp;
    ContactSheetSink sink{{.path = temp / "small.png", .rows = 1}};
    Frame frame = test::ramp_frame(16, 12, 0, from_us(0));
    frame.event_preview = frame.intensity;
    sink.write(frame);
    sink.close();
    const cv::Mat sheet = cv::imread(temp / "small.png");
    const int column = (sheet.cols - 4) / 3;
    for (int c = 0; c < 3; ++c) {
        const std::string name = std::array{"events", "intensity", "sigma"}[std::size_t(c)];
        cv::Mat caption(22, column, CV_8UC3, cv::Scalar{255, 255, 255});
        cv::putText(caption, name, {2, 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {40, 40, 40}, 1,
                    cv::LINE_AA);
        const cv::Mat found = sheet(cv::Rect{4 + c * column, 0, column, 22});
        EXPECT_EQ(cv::norm(found, caption, cv::NORM_INF), 0) << name;
    }
}

TEST(ContactSheet, NamesTheReferenceImagesAsItIsTold) {
    const TempFolder temp;
    const auto sheet = [&](const std::string& caption) {
        ContactSheetSettings settings{.path = temp / (caption + ".png"), .rows = 1};
        settings.draw_truth = [](SensorTime, const Window&, cv::Mat& image) {
            image = cv::Mat(30, 40, CV_8UC1, 200.0);
        };
        settings.truth_caption = caption;
        return sheet_of(2, settings);
    };
    const cv::Mat difference = cv::abs(sheet("APS") - sheet("truth"));
    const cv::Mat caption = difference.rowRange(0, 22),
                  rest = difference.rowRange(22, difference.rows);
    EXPECT_GT(cv::sum(caption)[0], 0);
    EXPECT_EQ(cv::sum(rest)[0], 0);
}

/// The image nearest to a frame may come after it.
TEST(ContactSheet, AsksForTheTruthOnceItsImagesHaveCome) {
    const TempFolder temp;
    SensorTime now{};
    std::vector<SensorDuration> delays;
    ContactSheetSettings settings{.path = temp / "a.png", .rows = 2};
    settings.draw_truth = [&](SensorTime t, const Window&, cv::Mat&) { delays.push_back(now - t); };
    ContactSheetSink sink{settings};
    for (int n = 0; n < 100; ++n) {
        now = from_us(20'000 * n);
        sink.write(test::ramp_frame(40, 30, n, now));
    }
    ASSERT_GT(delays.size(), 2U);
    for (const SensorDuration delay : delays) EXPECT_GE(delay, kTruthDelay);
    const std::size_t until_then = delays.size();
    sink.close();
    EXPECT_GT(delays.size(), until_then) << "at the end for those that are left";
}

/// Of twenty frames in four rows, of which every other one was kept in the end, the middles of four
/// equal parts, each above its time from the first frame on.
TEST(ContactSheet, ShowsTheMiddlesOfEqualPartsWithTheirTimes) {
    const TempFolder temp;
    const std::string file = temp / "a.png";
    ContactSheetSink sink{{.path = file, .rows = 4}};
    for (int n = 0; n < 20; ++n) {
        Frame frame = test::ramp_frame(90, 30, n, from_us(7'000'000 + 10'000 * n));
        for (float& v : frame.intensity.values()) v = float(10 * n) / 255;
        sink.write(frame);
    }
    sink.close();
    const cv::Mat sheet = cv::imread(file);
    int top = 22;
    for (const auto& [frame, time] :
         {std::pair{2, "0.020 s"}, {6, "0.060 s"}, {12, "0.120 s"}, {16, "0.160 s"}}) {
        EXPECT_EQ(int(sheet.at<cv::Vec3b>(top + 10, 20)[0]), 10 * frame);
        cv::Mat caption(22, sheet.cols, CV_8UC3, cv::Scalar{255, 255, 255});
        cv::putText(caption, time, {6, 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {40, 40, 40}, 1,
                    cv::LINE_AA);
        EXPECT_EQ(cv::norm(sheet.rowRange(top + 30, top + 52), caption, cv::NORM_INF), 0) << time;
        top += 30 + 22 + 10;
    }
}

TEST(ContactSheet, KeepsOneSizeHoweverLongTheRun) {
    const TempFolder temp;
    EXPECT_EQ(sheet_of(5, {.path = temp / "a.png"}).size(),
              sheet_of(1000, {.path = temp / "b.png"}).size());
    EXPECT_LT(sheet_of(1, {.path = temp / "c.png"}).rows,
              sheet_of(5, {.path = temp / "d.png"}).rows);
}

TEST(ContactSheet, ShowsTheSigmaThatIsAskedForAsWhite) {
    const TempFolder temp;
    for (const float white : {.1f, .2f}) {
        const std::string file = temp / ("white" + std::to_string(white) + ".png");
        ContactSheetSink sink{{.path = file, .sigma_white = white, .rows = 1}};
        Frame frame = test::ramp_frame(80, 30, 0, from_us(0));
        for (float& v : frame.sigma.values()) v = .1f;
        sink.write(frame);
        sink.close();
        const cv::Mat sheet = cv::imread(file);
        EXPECT_EQ(int(sheet.at<cv::Vec3b>(30, sheet.cols - 20)[0]), white == .1f ? 255 : 128);
    }
}

TEST(ContactSheet, KeepsAFileThatAppearedWhileItWasMade) {
    const TempFolder temp;
    const std::string file = temp / "a.png";
    ContactSheetSink sink{{.path = file}};
    sink.write(test::ramp_frame(80, 30, 0, from_us(0)));
    std::ofstream{file} << "another's";
    EXPECT_THROW(sink.close(), Error);
    std::string kept;
    std::getline(std::ifstream{file}, kept);
    EXPECT_EQ(kept, "another's");
}

TEST(ContactSheet, WantsTheImageFormatsName) {
    const TempFolder temp;
    EXPECT_THROW((ContactSheetSink{{.path = temp / "a.xyz"}}), Error);
}

}  // namespace
}  // namespace eventide
