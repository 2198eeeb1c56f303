// Control requests that a DAVIS answers late, never, or with a refusal.
#include "tests/drivers/davis_streams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::DavisModelSettings;

TEST(DavisRequests, SlowAnswersToControlRequestsChangeNothing) {
    PluggedIn camera_side;
    camera_side.bed.delay_control(20);
    EXPECT_EQ(streamed_by(camera_side).data.events, camera_side.seen.events);
}

/// Whose first request of a start is one to be idle.
DavisModelSettings without_counters() {
    DavisModelSettings settings;
    settings.mux_statistics = false;
    return settings;
}

TEST(DavisRequests, AControlRequestThatIsNeverAnsweredIsAnErrorAfterASecond) {
    PluggedIn camera_side{without_counters()};
    DavisCamera camera{at_once()};
    camera_side.bed.delay_control(testing_support::UsbTestbed::kNever);
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                HasSubstr("register 1.3: the camera did not answer in time"));
    camera_side.bed.delay_control(0);
}

TEST(DavisRequests, ARefusedControlRequestNamesItsRegister) {
    PluggedIn camera_side{without_counters()};
    DavisCamera camera{at_once()};
    camera_side.bed.stall_control(1);
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                HasSubstr("register 1.3: the camera refused the request"));
}

}  // namespace
}  // namespace eventide::test
