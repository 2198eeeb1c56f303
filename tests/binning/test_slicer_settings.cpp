// What --window takes.
#include "src/binning/slicer_settings.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

#include <string>

namespace eventide {
namespace {

using namespace std::chrono_literals;

TEST(WindowText, NamesADuration) {
    EXPECT_EQ(parse_window("50ms").rule, WindowRule::duration);
    EXPECT_EQ(parse_window("50ms").width, 50ms);
    EXPECT_EQ(parse_window("0.5s").width, 500ms);
    EXPECT_EQ(parse_window("33333us").width, SensorDuration{33'333});
    EXPECT_EQ(parse_window("16.667ms").width, SensorDuration{16'667});
}

TEST(WindowText, NamesANumberOfEvents) {
    const SlicerSettings count = parse_window("20000ev");
    EXPECT_EQ(count.rule, WindowRule::count);
    EXPECT_EQ(count.events, 20'000U);
    EXPECT_EQ(count.max_width, 100ms);
    EXPECT_EQ(parse_window("1ev,200ms").max_width, 200ms);
    EXPECT_EQ(parse_window("0.35epp").rule, WindowRule::count);
    EXPECT_EQ(parse_window("0.35epp").events_per_pixel, 0.35);
}

TEST(WindowText, NamesReferenceImages) {
    EXPECT_EQ(parse_window("aps").rule, WindowRule::reference);
    EXPECT_EQ(parse_window("aps").max_width, 1s);
    EXPECT_EQ(parse_window("aps,2s").max_width, 2s);
}

TEST(WindowText, NamesContent) {
    EXPECT_EQ(parse_window("auto").rule, WindowRule::content);
    EXPECT_EQ(parse_window("auto").events_per_pixel, .4);
    EXPECT_EQ(parse_window("auto").max_width, 100ms);
    EXPECT_EQ(parse_window("auto").min_width, 1ms);
    EXPECT_EQ(parse_window("auto,20ms").max_width, 20ms);
    EXPECT_EQ(parse_window("auto,20ms").min_width, 1ms);
    EXPECT_EQ(parse_window("auto,20ms,5ms").max_width, 20ms);
    EXPECT_EQ(parse_window("auto,20ms,5ms").min_width, 5ms);
    EXPECT_EQ(parse_window("auto,5ms,5ms").min_width, 5ms);
}

TEST(WindowText, IsReadBackAsItWasWritten) {
    for (const std::string text : {"50ms", "7us", "2s", "20000ev,100ms", "0.35epp,333us", "aps,1s",
                                   "auto,50ms", "auto,500us,1us", "auto,50ms,10ms"})
        EXPECT_EQ(window_text(parse_window(text)), text);
}

TEST(WindowText, RefusesByName) {
    for (const std::string text : {"",
                                   "50",
                                   "ms",
                                   "50 ms",
                                   "-5ms",
                                   "0ms",
                                   "0.2us",
                                   "1e9s",
                                   "nanms",
                                   "infms",
                                   "1.5ev",
                                   "0ev",
                                   "2e9ev",
                                   "0epp",
                                   "-1epp",
                                   "1001epp",
                                   "50mss",
                                   "aps ",
                                   "50ms,100ms",
                                   "20000ev,",
                                   "20000ev,5ev",
                                   "auto,",
                                   "auto,50ms,",
                                   "auto,50ms,5",
                                   "auto,5ms,50ms",
                                   "auto,500us",
                                   "aps,1s,5ms",
                                   "auto,50ms,5ms,1ms"})
        try {
            parse_window(text);
            ADD_FAILURE() << "took '" << text << "'";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_NE(std::string{error.what()}.find("'" + text + "'"), std::string::npos);
        }
}

TEST(SlicerSettings, NoWindowHasMoreEventsThanMemoryIsFor) {
    SlicerSettings settings = parse_window("1000000000ev");
    EXPECT_EQ(events_per_window(settings, 240, 180), settings.max_events);
    settings = parse_window("1000epp");
    EXPECT_EQ(events_per_window(settings, 1280, 720), settings.max_events);
    EXPECT_EQ(events_per_window(parse_window("50ms"), 240, 180), settings.max_events);
}

TEST(SlicerSettings, SilenceIsMergedAfterAWindowAtTheEarliest) {
    SlicerSettings settings = parse_window("50ms");
    settings.silent_windows = 1;
    check_slicer_settings(settings, 240, 180);
    settings.silent_windows = 0;
    EXPECT_THROW(check_slicer_settings(settings, 240, 180), Error);
}

}  // namespace
}  // namespace eventide
