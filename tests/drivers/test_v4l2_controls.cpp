// Controls of an event sensor in software behind V4L2.
#include "tests/drivers/v4l2_sensor.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide {
namespace {

using testing::HasSubstr;
using namespace testing_support::v4l2;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

TEST(V4l2Controls, ControlsAreSetByNameAndChecked) {
    V4l2NodeSettings settings = sensor();
    settings.controls = {{"bias_fo", {-10, 10, 0}},
                         {"bias_refr", {-10, 10, 3, false, true}},
                         {"serial", {0, 100, 7, true}},
                         {"unused", {.maximum = 9, .disabled = true}}};
    V4l2Testbed bed{settings};
    const auto with = [](const std::string& name, int value) {
        V4l2Settings wanted;
        wanted.controls[name] = value;
        return failure_of([&] { open(wanted); });
    };
    EXPECT_EQ(with("bias_fo", 5), "nothing was thrown");
    EXPECT_EQ(bed.control("bias_fo").value, 5);
    EXPECT_THAT(with("bias_fo", 50), HasSubstr("expected -10 to 10, found 50"));
    EXPECT_THAT(with("bias_fo", -50), HasSubstr("expected -10 to 10, found -50"));
    EXPECT_THAT(with("bias_refr", 5), HasSubstr("set to 5, reads back as 3"));
    EXPECT_EQ(with("bias_refr", 3), "nothing was thrown");
    EXPECT_THAT(with("bias_hpf", 1), HasSubstr("no control 'bias_hpf'"));
    EXPECT_THAT(with("serial", 1), HasSubstr("cannot be written: expected its value, 7, found 1"));
    EXPECT_THAT(with("unused", 1), HasSubstr("cannot be written: expected it left out, found 1"));
}

/// v4l2-ctl lists "Vertical Flip" as vertical_flip.
TEST(V4l2Controls, ControlsMayBeNamedAsV4l2CtlListsThem) {
    V4l2NodeSettings settings = sensor();
    settings.controls = {{"Vertical Flip", {0, 1, 0}}, {"(Gain) analogue, x2", {0, 10, 0}}};
    V4l2Testbed bed{settings};
    V4l2Settings wanted;
    wanted.controls = {{"vertical_flip", 1}, {"gain_analogue_x2", 7}};
    open(wanted);
    EXPECT_EQ(bed.control("Vertical Flip").value, 1);
    EXPECT_EQ(bed.control("(Gain) analogue, x2").value, 7);
    wanted.controls = {{"Vertical Flip", 0}};
    open(wanted);
    EXPECT_EQ(bed.control("Vertical Flip").value, 0);
}

TEST(V4l2Controls, WithControlsItSaysAsWellWhyItCannotBeOpened) {
    V4l2Settings wanted;
    wanted.controls = {{"bias_fo", 1}};
    EXPECT_THAT(failure_of([&] { open(wanted); }), HasSubstr("is the driver loaded"));
}

TEST(V4l2Controls, ASubdeviceThatIsNotThereIsNamed) {
    V4l2Testbed bed{sensor()};
    V4l2Settings wanted;
    wanted.subdevice = "/dev/v4l-subdev7";
    EXPECT_THAT(failure_of([&] { open(wanted); }),
                HasSubstr("the camera /dev/v4l-subdev7 cannot be opened: No such file"));
}

}  // namespace
}  // namespace eventide
