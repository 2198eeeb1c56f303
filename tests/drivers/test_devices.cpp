// Names of sources, and those that nearly are some.
#include "drivers/devices.h"
#include "drivers/settings_file.h"
#include "src/core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide {
namespace {

using testing::HasSubstr;

TEST(Devices, ASourceWithoutItsColonOrWithAWrongLetterIsSuggested) {
    for (const char* typed : {"davis", "daviss:", "Davis:42", "davis346:", "davi:00000042"})
        EXPECT_EQ(source_suggestion(typed), "; did you mean davis:?") << typed;
    EXPECT_EQ(source_suggestion("dvxplorer"), "; did you mean dvxplorer:?");
    EXPECT_EQ(source_suggestion("dvs182:"), "; did you mean dvs128:?");
    EXPECT_EQ(source_suggestion("v4l:/dev/video0"), "; did you mean v4l2:?");
    EXPECT_EQ(source_suggestion("ros:/events"), "; did you mean ros2:?");
    EXPECT_EQ(source_suggestion("upd://:3333?size=640x480"), "; did you mean udp:?");
    EXPECT_EQ(source_suggestion("sim"), "; did you mean sim:?");
}

TEST(Devices, AFileThatIsMissingIsNoSource) {
    for (const char* typed : {"", "-", "a", "recording.aedat4", "davis.aedat4", "./davis",
                              "x/davis:", "metavision:", "flight.raw"})
        EXPECT_EQ(source_suggestion(typed), "") << typed;
}

TEST(Devices, ANameThatIsNoCameraSaysWhatWasMeant) {
    try {
        open_camera("dvxplore:", {});
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_THAT(error.what(),
                    HasSubstr("names no camera: expected davis:, dvxplorer:, dvs128:, v4l2:, "
                              "ros2:, udp: or sim:"));
        EXPECT_THAT(error.what(), HasSubstr("; did you mean dvxplorer:?"));
    }
}

TEST(Devices, CameraSettingsUnderANameThatNoFileCanHaveAreRefused) {
    EXPECT_THROW(read_camera_settings(std::string(300, 'x'), {}), Error);
}

}  // namespace
}  // namespace eventide
