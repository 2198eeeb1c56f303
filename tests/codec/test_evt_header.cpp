// RAW headers through the years.
#include "src/codec/prophesee/evt_header.h"
#include "src/core/error.h"
#include "tests/codec/parser_checks.h"

namespace eventide {
namespace {

TEST(EvtHeader, SaysTheSensorInManyWays) {
    const auto name = [](const std::string& lines) {
        return read_evt_header(to_bytes("% evt 3.0\n" + lines)).stream.sensor_name;
    };
    EXPECT_EQ(name("% sensor_name IMX646\n% sensor_generation 4.2\n% system_ID 49\n"), "IMX646");
    EXPECT_EQ(name("% camera_integration_name DAVIS346\n"), "DAVIS346");
    EXPECT_EQ(name("% sensor_generation 4.2\n"), "IMX636");
    EXPECT_EQ(name("% sensor_generation 3.1\n"), "Gen3.1");
    EXPECT_EQ(name("% system_ID 48\n"), "Gen4.1");
    EXPECT_EQ(name("% system_ID 99\n"), "99");
    EXPECT_EQ(name(""), "");
}

TEST(EvtHeader, WithoutAWordOnItEarlySystemsSwapTheHalvesOfEvt21) {
    const auto swapped = [](const std::string& lines) {
        return read_evt_header(to_bytes("% evt 2.1\n" + lines)).halves_swapped;
    };
    for (const char* lines :
         {"% system_ID 49\n", "% system_ID 54\n% integrator_name Prophesee\n",
          "% plugin_integrator_name Prophesee\n% camera_integrator_name Prophesee\n"
          "% system_ID 49\n"})
        EXPECT_TRUE(swapped(lines)) << lines;
    for (const char* lines :
         {"", "% system_ID 0\n", "% system_ID 55\n", "% system_ID 49\n% endianness little\n",
          "% system_ID 49\n% format EVT21;endianness=little\n",
          "% system_ID 49\n% camera_integrator_name Other\n",
          "% system_ID 49\n% plugin_integrator_name Other\n"})
        EXPECT_FALSE(swapped(lines)) << lines;
}

TEST(EvtHeader, SaysFormatAndSizeInManyWays) {
    struct Case {
        const char* text;
        const char* format;
        int width, height;
        bool swapped;
    };
    for (const Case& c :
         {Case{"% format EVT3;height=720;width=1280\n% end\n", "evt3", 1280, 720, false},
          Case{"% evt 3.0\n% geometry 320x320\n", "evt3", 320, 320, false},
          Case{"% evt 2.1\n% endianness legacy\n% system_ID 49\n", "evt21", 1280, 720, true},
          Case{"% format EVT21;endianness=legacy;height=5;width=6\r\n", "evt21", 6, 5, true},
          Case{"% evt 2.0\n% system_ID 21\n", "evt2", 640, 480, false},
          Case{"% system_ID 21\n", "evt2", 640, 480, false},
          Case{"% system_ID 40\n% integrator_name Prophesee\n", "evt3", 640, 480, false},
          Case{"% system_ID 49\n% serial_number 1\n", "evt3", 1280, 720, false},
          Case{"% evt 3.0\n% system_ID 49\n% plugin_integrator_name Other\n", "evt3", 0, 0, false},
          Case{"% evt 2.0\n% geometry -5xfoo\n", "evt2", 0, 0, false}}) {
        Bytes bytes = to_bytes(c.text);
        const std::size_t header_bytes = bytes.size();
        for (const int b : {0x25, 0x80, 0x0A, 0xFF}) bytes.push_back(std::byte(b));
        const EvtHeader header = read_evt_header(bytes);
        EXPECT_EQ(header.stream.format, c.format);
        EXPECT_EQ(header.stream.width, c.width) << c.text;
        EXPECT_EQ(header.stream.height, c.height);
        EXPECT_EQ(header.halves_swapped, c.swapped);
        EXPECT_EQ(header.stream.data_offset, header_bytes);
    }
    EXPECT_THROW(read_evt_header(to_bytes("% evt 9.0\n")), Error);
    EXPECT_THROW(read_evt_header(to_bytes("% evt 9.0\n% system_ID 49\n")), Error);
    EXPECT_THROW(read_evt_header(to_bytes("% system_ID 99\n")), Error);
    EXPECT_THROW(read_evt_header(to_bytes("")), Error);
}

}  // namespace
}  // namespace eventide
