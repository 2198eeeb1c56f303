// Several cameras of a kind on one bus: the first that can be used is the one that is opened.
#include "drivers/usb/dvs128_camera.h"
#include "tests/drivers/davis_streams.h"
#include "tests/drivers/usb_sessions.h"
#include "tests/support/keep_in.h"
#include "tests/support/usb/dvs128_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::Dvs128Model;
using testing_support::UsbTestbed;

/// Two places, of which libusb may list either first.
class FirstCamera : public testing::TestWithParam<int> {
protected:
    UsbTestbed& one() { return GetParam() == 0 ? bed_ : neighbour_; }
    UsbTestbed& other() { return GetParam() == 0 ? neighbour_ : bed_; }
    void plug_in(std::shared_ptr<testing_support::UsbModel> into_one,
                 std::shared_ptr<testing_support::UsbModel> into_other) {
        one().plug_in(std::move(into_one), {.port = 2 + GetParam(), .address = 5 + GetParam()});
        other().plug_in(std::move(into_other), {.port = 3 - GetParam(), .address = 6 - GetParam()});
    }
    static std::shared_ptr<DavisModel> davis(const char* serial, std::uint32_t logic = 18) {
        DavisModelSettings settings;
        settings.serial = serial;
        settings.logic = logic;
        return std::make_shared<DavisModel>(settings);
    }
    DavisOptions any() {
        DavisOptions options = at_once();
        options.warn = keep_in(warnings_);
        return options;
    }

    UsbTestbed bed_, neighbour_{bed_};
    std::vector<std::string> warnings_;
};
INSTANTIATE_TEST_SUITE_P(AtEitherPlace, FirstCamera, testing::Values(0, 1));

TEST_P(FirstCamera, IsOneThatNoOtherProgramHas) {
    plug_in(davis("00000042"), davis("00000043"));
    one().give_to_another_program();
    for (int times = 0; times < 2; ++times) EXPECT_EQ(DavisCamera{any()}.info().serial, "00000043");
    for (const std::string& warning : warnings_)
        EXPECT_THAT(warning,
                    AllOf(HasSubstr("'00000042'"), HasSubstr("in use by another program")));
}

TEST_P(FirstCamera, IsOneWhoseProtocolIsKnown) {
    plug_in(davis("00000042", 20), davis("00000043"));
    EXPECT_EQ(DavisCamera{any()}.info().serial, "00000043");
    for (const std::string& warning : warnings_)
        EXPECT_THAT(warning, AllOf(HasSubstr("'00000042'"), HasSubstr("another protocol")));
}

TEST_P(FirstCamera, WhereNoneCanBeUsedEachSaysWhy) {
    plug_in(davis("00000042"), davis("00000043", 20));
    one().give_to_another_program();
    EXPECT_THAT(failure_of([&] { DavisCamera{any()}; }),
                AllOf(HasSubstr("none of the 2 DAVIS found can be used"),
                      HasSubstr("the DAVIS '00000042'"), HasSubstr("in use by another program"),
                      HasSubstr("the DAVIS '00000043'"), HasSubstr("another protocol")));
    EXPECT_THAT(warnings_, ElementsAre());
}

TEST_P(FirstCamera, IsNoOtherThanTheOneThatWasNamed) {
    plug_in(davis("00000042"), davis("00000043"));
    one().give_to_another_program();
    DavisOptions named = any();
    named.serial = "00000042";
    EXPECT_THAT(failure_of([&] { DavisCamera{named}; }),
                AllOf(HasSubstr("'00000042'"), HasSubstr("in use by another program"),
                      Not(HasSubstr("00000043"))));
}

TEST_P(FirstCamera, IsNamedByTheFirstEightCharactersOfItsSerialNumber) {
    plug_in(davis("0123456789AB"), davis("00000043"));
    DavisOptions named = any();
    named.serial = "01234567";
    EXPECT_EQ(DavisCamera{named}.info().serial, "01234567");
}

TEST_P(FirstCamera, IsListedByItsPlaceWhereItsSerialNumberIsNoWord) {
    plug_in(davis("12:34"), davis("42 \x1B[m"));
    std::vector<std::string> sources;
    for (const CameraDescription& camera : list_davis_cameras()) sources.push_back(camera.source);
    EXPECT_THAT(sources, testing::UnorderedElementsAre("davis:1:5", "davis:1:6"));
}

TEST_P(FirstCamera, IsTheOneAtThePlaceThatWasNamed) {
    plug_in(davis("00000042"), davis("00000043"));
    const auto at = [&](int bus, int address) {
        DavisOptions options = any();
        std::tie(options.bus, options.address) = std::pair{bus, address};
        return options;
    };
    EXPECT_EQ(DavisCamera{at(1, 5 + GetParam())}.info().serial, "00000042");
    EXPECT_EQ(DavisCamera{at(1, 6 - GetParam())}.info().serial, "00000043");
    EXPECT_THAT(failure_of([&] { DavisCamera{at(2, 5)}; }),
                HasSubstr("no DAVIS on bus 2 at address 5 found"));
    EXPECT_THAT(failure_of([&] { DavisCamera{at(1, 9)}; }), HasSubstr("at address 9 found"));
}

TEST_P(FirstCamera, OfAnotherKindIsFoundInTheSameWay) {
    plug_in(std::make_shared<Dvs128Model>(), std::make_shared<Dvs128Model>());
    one().give_to_another_program();
    Dvs128Options options;
    options.waits = kNoWaits;
    EXPECT_EQ(Dvs128Camera{options}.info().name, "DVS128");
}

TEST_P(FirstCamera, OneWhoseSerialNumberAnotherHasTooIsTakenBackAtItsPortAlone) {
    plug_in(davis("00000042"), davis("00000042"));
    DavisOptions named = any();
    std::tie(named.bus, named.address) = std::pair{1, 5 + GetParam()};
    named.reconnect = true;
    DavisCamera camera{named};
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr("2 DAVIS say that their serial number is "
                                                 "'00000042'")));
    unplug_while_sending(camera, one());
    RawPacket packet;
    for (int look = 0; look < 5; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U) << "the other is not taken for it";
    one().plug_in(davis("00000042"), {.port = 2 + GetParam(), .address = 9});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.reopened);
}

TEST_P(FirstCamera, OneThatSaysTheSameSerialNumberAndCameLaterIsNotTakenForIt) {
    one().plug_in(davis("00000042"), {.port = 2 + GetParam(), .address = 5 + GetParam()});
    DavisOptions named = any();
    named.reconnect = true;
    DavisCamera camera{named};
    other().plug_in(davis("00000042"), {.port = 3 - GetParam(), .address = 6 - GetParam()});
    unplug_while_sending(camera, one());
    RawPacket packet;
    for (int look = 0; look < 5; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr("2 DAVIS say that their serial number is "
                                                 "'00000042'"),
                                       HasSubstr("at port 1-" + std::to_string(2 + GetParam()))));
    one().plug_in(davis("00000042"), {.port = 2 + GetParam(), .address = 9});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.reopened);
}

/// Whichever of the two libusb lists first.
TEST_P(FirstCamera, NorInThePlaceOfOneThatStalls) {
    one().plug_in(davis("00000042"), {.port = 2 + GetParam(), .address = 5 + GetParam()});
    DavisOptions named = any();
    named.reconnect = true;
    DavisCamera camera{named};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    const auto namesake = davis("00000042");
    other().plug_in(namesake, {.port = 3 - GetParam(), .address = 6 - GetParam()});
    one().halt_data(1000);
    while (warnings_.size() < 2) camera.read(packet);
    one().halt_data(0);
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.reopened);
    EXPECT_TRUE(namesake->writes().empty());
}

TEST_P(FirstCamera, CamerasThatSayTheSameSerialNumberAreListedByTheirPlaces) {
    plug_in(davis("00000042"), davis("00000042"));
    std::vector<std::string> sources;
    for (const CameraDescription& camera : list_davis_cameras()) sources.push_back(camera.source);
    EXPECT_THAT(sources, testing::UnorderedElementsAre("davis:1:5", "davis:1:6"));
}

}  // namespace
}  // namespace eventide::test
