// A camera in software that another program has, through the library: who asked for any other hears
// of it, in C++, C and Python.
#include "tests/drivers/usb_sessions.h"
#include "tests/support/keep_in.h"
#include "tests/support/preload.h"
#include "tests/support/usb/davis_model.h"

#include <eventide/camera.h>
#include <eventide/eventide.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CameraWarnings : public testing::Test {
protected:
    CameraWarnings() {
        const auto davis = [](const char* serial) {
            testing_support::DavisModelSettings settings;
            settings.serial = serial;
            return std::make_shared<testing_support::DavisModel>(settings);
        };
        bed_.plug_in(davis("00000042"), {.port = 2, .address = 5});
        neighbour_.plug_in(davis("00000043"), {.port = 3, .address = 6});
        taken_ = EventCamera{"davis:"}.info().serial;
        (taken_ == "00000042" ? bed_ : neighbour_).give_to_another_program();
    }
    auto tells_of_it() const {
        return AllOf(HasSubstr("the DAVIS '" + taken_ + "'"),
                     HasSubstr("in use by another program"), HasSubstr("the next one is used"));
    }

    testing_support::UsbTestbed bed_, neighbour_{bed_};
    std::string taken_;
};

TEST_F(CameraWarnings, ReachCpp) {
    std::vector<std::string> warnings;
    CameraSettings settings;
    settings.warn = keep_in(warnings);
    EXPECT_NE((EventCamera{"davis:", settings}.info().serial), taken_);
    EXPECT_THAT(warnings, testing::ElementsAre(tells_of_it()));
}

TEST_F(CameraWarnings, ReachC) {
    std::string warning;
    const auto keep = [](void* context, const char* text) {
        *static_cast<std::string*>(context) += text;
    };
    const eventide_callbacks callbacks{sizeof callbacks, &warning, nullptr, keep};
    eventide_source* source = nullptr;
    ASSERT_EQ(eventide_camera_open_with("davis:", nullptr, 0, &callbacks, &source), EVENTIDE_OK)
        << eventide_error_message();
    eventide_source_close(source);
    EXPECT_THAT(warning, tells_of_it());
}

TEST_F(CameraWarnings, ReachPythonsLog) {
#ifdef EVENTIDE_PYTHON
    const std::string command =
        std::string{"PYTHONPATH='" EVENTIDE_MODULE_DIR "' '"} + EVENTIDE_PYTHON +
        "' -c 'import eventide, logging\n" +
        "logging.basicConfig(format=\"%(name)s %(levelname)s %(message)s\")\n" +
        "eventide.open_camera(\"davis:\")' 2>&1";
    FILE* python = popen(command.c_str(), "re");
    ASSERT_NE(python, nullptr);
    std::string said;
    for (int c = 0; (c = std::fgetc(python)) != EOF;) said += char(c);
    EXPECT_EQ(pclose(python), 0) << said;
    EXPECT_THAT(said, AllOf(testing::StartsWith("eventide WARNING "), tells_of_it()));
#else
    GTEST_SKIP() << "built without the Python module";
#endif
}

/// Reads until the camera that is unplugged is missed.
eventide_status status_when_unplugged(testing_support::UsbTestbed& bed, int reconnect) {
    std::string warning;
    const auto keep = [](void* context, const char* text) {
        *static_cast<std::string*>(context) += text;
    };
    const eventide_callbacks callbacks{sizeof callbacks, &warning, nullptr, keep};
    eventide_source* source = nullptr;
    EXPECT_EQ(eventide_camera_open_with("davis:", nullptr, reconnect, &callbacks, &source),
              EVENTIDE_OK)
        << eventide_error_message();
    bed.unplug();
    eventide_status status = EVENTIDE_OK;
    const eventide_event* events = nullptr;
    for (std::size_t count = 0; status == EVENTIDE_OK && warning.empty();)
        status = eventide_read(source, &events, &count);
    eventide_source_close(source);
    return status;
}

TEST(UnpluggedCameras, AreWaitedForInCWhereThatIsWanted) {
    testing_support::UsbTestbed bed;
    for (const bool is_wanted : {false, true}) {
        bed.plug_in(
            std::make_shared<testing_support::DavisModel>(testing_support::DavisModelSettings{}));
        EXPECT_EQ(status_when_unplugged(bed, is_wanted), is_wanted ? EVENTIDE_OK : EVENTIDE_DEVICE);
    }
}

}  // namespace
}  // namespace eventide::test

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleMock(&argc, argv);
    return RUN_ALL_TESTS();
}
