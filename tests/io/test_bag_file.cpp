// HQF's bags give what the same recording gives as text; whatever is wrong with one is named.
#include "apps/evaluate/evreal_sequence.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/io/bag_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>

namespace eventide::test {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kEvents = 3, kImages = 5, kOther = 6;

fs::path save(const std::string& name, const BagBytes& bytes) {
    const fs::path path = fs::path{testing::TempDir()} / ("eventide_" + name + ".bag");
    std::ofstream{path, std::ios::binary} << bytes;
    return path;
}

/// Messages of 100 events, images between them, in chunks of several messages.
BagBytes messages_of(const ReferenceSequence& sequence, const std::string& packing) {
    BagBytes content, part = connection(kOther, "sensor_msgs/Imu") +
                             connection(kEvents, "dvs_msgs/EventArray") +
                             connection(kImages, "sensor_msgs/Image") + message(kOther, "imu");
    auto next_image = sequence.images.begin();
    for (std::size_t i = 0; i < sequence.events.size(); i += 100) {
        const auto events = std::span{sequence.events}.subspan(
            i, std::min<std::size_t>(100, sequence.events.size() - i));
        for (; next_image != sequence.images.end() && next_image->t <= events.front().t;
             ++next_image)
            part += message(kImages, image(*next_image));
        part += message(kEvents, event_array(sequence.width, sequence.height, events));
        if (i % 300 == 200) content += chunk(packing, std::exchange(part, {}));
    }
    for (; next_image != sequence.images.end(); ++next_image)
        part += message(kImages, image(*next_image));
    return content + chunk(packing, part);
}

/// The most memory this process had since forget_peak_memory(), bytes.
std::size_t peak_memory() {
    std::ifstream status{"/proc/self/status"};
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) << 10;
    return 0;
}
void forget_peak_memory() {
    std::ofstream{"/proc/self/clear_refs"} << "5";
}

std::string refusal(const fs::path& path) {
    try {
        read_evreal_sequence(path, {}, {});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return "nothing was refused";
}

class BagFiles : public testing::Test {
protected:
    const ReferenceSequence text_ =
        read_reference_sequence(write_recording(fresh_folder("bag_text"), 1.05, .001, .1));
};

TEST_F(BagFiles, GiveTheSameAsText) {
    for (const char* packing : {"none", "bz2", "lz4"}) {
        const fs::path path = save(packing, bag(messages_of(text_, packing)));
        const ReferenceSequence whole = read_evreal_sequence(path, {}, {});
        EXPECT_EQ(whole.events, text_.events) << packing;
        EXPECT_EQ(whole.images, text_.images) << packing;
        EXPECT_EQ(whole.width, text_.width);
        EXPECT_EQ(whole.height, text_.height);
        EXPECT_EQ(whole.name, "eventide_" + std::string{packing});
        EXPECT_EQ(evreal_sequences(path), std::vector{path});
    }
}

TEST_F(BagFiles, AreCutInTime) {
    const fs::path path = save("cut", bag(messages_of(text_, "lz4")));
    const ReferenceSequence part = read_evreal_sequence(path, .2, .5);
    EXPECT_EQ(part.images.size(), 4U);
    EXPECT_EQ(part.events.size(), 301U);
}

TEST_F(BagFiles, CutShortSaySoBesideWhatIsThere) {
    const BagBytes whole = bag(messages_of(text_, "none"));
    const ReferenceSequence part =
        read_evreal_sequence(save("short", whole.substr(0, whole.size() / 2)), {}, {});
    EXPECT_LT(part.events.size(), text_.events.size());
    EXPECT_EQ(part.damaged[DamageReason::truncated], 1U);
    EXPECT_EQ(read_evreal_sequence(save("whole", whole), {}, {}).damaged.total(), 0U);
}

TEST_F(BagFiles, TakeNoMemoryForWhatIsOnlySaid) {
    for (const char* packing : {"bz2", "lz4"})
        for (const std::uint32_t said : {0x0FFFFFFFU, 0x3FFFFFFFU}) {
            forget_peak_memory();
            const std::size_t before = peak_memory();
            EXPECT_THAT(
                refusal(
                    save("said", bag(record(5, {{"compression", packing}, {"size", little(said)}},
                                            packed(packing, "a few bytes"))))),
                HasSubstr("expected messages with events"));
            EXPECT_LT(peak_memory(), before + (std::size_t{32} << 20)) << packing;
        }
    EXPECT_THAT(
        refusal(save("sensor",
                     bag(chunk("none", connection(kEvents, "dvs_msgs/EventArray") +
                                           message(kEvents, event_array(65535, 65535, {})))))),
        HasSubstr("found dvs_msgs/EventArray, and damage"));
}

}  // namespace
}  // namespace eventide::test
