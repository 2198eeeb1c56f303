// Folders in the manner of the Event Camera Dataset: events with their images.
#include "replay/ecd_folder.h"

#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/replay/recording_files.h"

namespace eventide {
namespace {

/// A grey image, as text: netpbm is the one format a test can spell out.
std::string photo(int width, int height, int value) {
    return "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
           std::string(std::size_t(width * height), char(value));
}

void write_folder(const TestFolder& folder) {
    folder.write("r/events.txt", "0.10 1 2 1\n0.20 3 4 0\n0.30 5 6 1\n0.40 7 8 1\n");
    folder.write("r/images.txt",
                 "0.35 images/c.pgm\n0.05 images/a.pgm\n0.20 images/b.pgm\n"
                 "0.25 images/missing.pgm\nno time\n0.9 images/d.pgm\n");
    for (const char* name : {"a", "b", "c", "d"})
        folder.write(std::string("r/images/") + name + ".pgm", photo(20, 10, name[0]));
}

TEST(EcdFolder, GivesItsImagesInTimeOrderWithTheEvents) {
    const TestFolder folder;
    write_folder(folder);
    for (const char* name : {"r", "r/events.txt"}) {
        const auto recording = open_recording(folder.path(name));
        EXPECT_EQ(recording->info().width, 20);
        EXPECT_EQ(recording->info().height, 10);
        const Batch batch = read_everything(*recording);
        EXPECT_EQ(batch.events.size(), 4U);
        ASSERT_EQ(batch.images.size(), 4U);
        EXPECT_EQ(batch.images[1].t, from_us(200000));
        EXPECT_EQ(batch.images[1].pixels(9, 19), 'b' * 257);
        EXPECT_EQ(batch.images[3].t, from_us(900000));
    }
    // The missing image and the line without a time.
    EXPECT_EQ(summarize(*open_recording(folder.path("r"))).damaged[DamageReason::bad_record], 2U);
}

TEST(EcdFolder, SaysWhichImagesAreLeftOut) {
    const TestFolder folder;
    write_folder(folder);
    const auto remarks = open_recording(folder.path("r"))->remarks();
    ASSERT_EQ(remarks.size(), 2U);
    EXPECT_NE(remarks[0].find("found \"no time\"; 1 "), std::string::npos) << remarks[0];
    EXPECT_NE(remarks[1].find("images/missing.pgm"), std::string::npos) << remarks[1];
    EXPECT_NE(remarks[1].find("1 of 5 images"), std::string::npos) << remarks[1];
}

TEST(EcdFolder, ImagesAloneAreRead) {
    const TestFolder folder;
    folder.write("r/events.txt", "20 10\n");
    folder.write("r/images/a.pgm", photo(20, 10, 'a'));
    folder.write("r/images.txt", "0.11 images/a.pgm\n");
    const Summary summary = summarize(*open_recording(folder.path("r")));
    EXPECT_EQ(summary.events, 0U);
    EXPECT_EQ(summary.frames, 1U);
    EXPECT_EQ(summary.damaged.total(), 0U);
}

TEST(EcdFolder, ReadsNoImageOutsideTheFolder) {
    const TestFolder folder;
    const std::string secret = folder.write("secret.pgm", photo(20, 10, 's'));
    folder.write("r/events.txt", "20 10\n0.10 1 2 1\n0.20 3 4 0\n");
    folder.write("r/images/a.pgm", photo(20, 10, 'a'));
    folder.write("r/images.txt", "0.11 " + secret + "\n0.12 ../secret.pgm\n" +
                                     "0.13 images/../../secret.pgm\n0.14 .\n" +
                                     "0.15 images/../images/./a.pgm\n0.16 " +
                                     folder.path("r/images/a.pgm") + "\n");
    const Batch batch = read_everything(*open_recording(folder.path("r")));
    ASSERT_EQ(batch.images.size(), 2U);
    for (const ReferenceImage& image : batch.images) EXPECT_EQ(image.pixels(0, 0), 'a' * 257);
    EXPECT_EQ(summarize(*open_recording(folder.path("r"))).damaged[DamageReason::bad_record], 4U);
}

TEST(EcdFolder, AnImageComesOnceTheEventsHavePassedIt) {
    const TestFolder folder;
    write_folder(folder);
    OpenOptions as_they_come;
    as_they_come.text.reorder = SensorDuration{0};
    const auto recording = open_recording(folder.path("r"), as_they_come);
    const auto parser = recording->make_parser();
    const auto parse = [&](std::string_view text, Batch& into) {
        parser->parse(std::as_bytes(std::span(text)), into);
        return into.images.size();
    };
    Batch batch;
    EXPECT_EQ(parse("0.10 1 2 1\n", batch), 0U);  // the first event waits for another
    EXPECT_EQ(parse("0.19 1 2 1\n", batch), 1U);
    EXPECT_EQ(parse("0.25 1 2 1\n", batch), 2U);
    parser->resync();
    EXPECT_EQ(parse("\n0.06 1 2 1\n", batch), 2U);            // jumped back behind the first
    EXPECT_EQ(parse("0.15 1 2 1\n0.21 1 2 1\n", batch), 3U);  // the second once more
    parser->finish(batch);
    EXPECT_EQ(batch.images.size(), 5U);
}

TEST(EcdFolder, ExposuresAreReadWhereEachImageHasOne) {
    const TestFolder folder;
    folder.write("r/events.txt", "0.10 1 2 1\n0.90 3 4 0\n");
    folder.write("r/images.txt", "0.35 a.pgm\n0.05 b.pgm\n");
    folder.write("r/exposure.txt", "0.30 0.40\n0.04 0.06\n");
    folder.write("r/a.pgm", photo(20, 10, 1));
    folder.write("r/b.pgm", photo(20, 10, 2));
    const auto images = read_everything(*open_recording(folder.path("r"))).images;
    ASSERT_EQ(images.size(), 2U);
    EXPECT_EQ(images[0].exposure_begin, from_us(40'000));
    EXPECT_EQ(images[1].exposure_end, from_us(400'000));
    folder.write("r/exposure.txt", "0.30 0.40\n");
    EXPECT_EQ(read_everything(*open_recording(folder.path("r"))).images[1].exposure_end,
              from_us(350'000));
}

TEST(EcdFolder, AStatedSizeIsTaken) {
    const TestFolder folder;
    write_folder(folder);
    EXPECT_EQ(open_recording(folder.path("r"), {.width = 64, .height = 48})->info().width, 64);
}

TEST(EcdFolder, ALineAsLongAsAFileIsShownInPart) {
    const TestFolder folder;
    write_folder(folder);
    const std::string endless(100'000, 'x');
    folder.write("r/images.txt", endless + "\n0.1 images/" + endless + "\n");
    for (const std::string& remark : open_recording(folder.path("r"))->remarks())
        EXPECT_LT(remark.size(), 1000U);
}

TEST(EcdFolder, AnImageOfAnotherSizeIsLeftOut) {
    const TestFolder folder;
    write_folder(folder);
    folder.write("r/events.txt", "20 10\n0.10 1 2 1\n0.20 3 4 0\n0.30 5 6 1\n0.40 7 8 1\n");
    folder.write("r/images/b.pgm", photo(10, 20, 'b'));
    folder.write("r/images/c.pgm", photo(40, 20, 'c'));
    const auto recording = open_recording(folder.path("r"));
    EXPECT_EQ(recording->remarks().size(), 2U);  // the missing image and the line without a time
    const Batch batch = read_everything(*recording);
    ASSERT_EQ(batch.images.size(), 2U);
    EXPECT_EQ(batch.images[0].pixels(0, 0), 'a' * 257);
    EXPECT_EQ(batch.images[1].pixels(0, 0), 'd' * 257);
    EXPECT_EQ(summarize(*open_recording(folder.path("r"))).damaged[DamageReason::bad_record], 4U);
}

TEST(EcdFolder, SaysThatImagesAreNotOfTheSensorsSize) {
    const TestFolder folder;
    folder.write("r/events.txt", "64 48\n0.10 1 2 1\n0.20 3 4 0\n");
    folder.write("r/images/a.pgm", photo(20, 10, 'a'));
    folder.write("r/images.txt", "0.11 images/a.pgm\n");
    const auto recording = open_recording(folder.path("r"));
    ASSERT_EQ(recording->remarks().size(), 1U);
    EXPECT_NE(recording->remarks()[0].find("the sensor's size, 64x48, found one of 20x10"),
              std::string::npos)
        << recording->remarks()[0];
    EXPECT_TRUE(read_everything(*recording).images.empty());
}

TEST(EcdFolder, WithoutImagesTheSizeIsThatOfTheEvents) {
    const TestFolder folder;
    folder.write("r/events.txt", "0.10 1 2 1\n0.20 3 4 0\n");
    const auto recording = open_recording(folder.path("r"));
    EXPECT_EQ(recording->info().width, 128);
    EXPECT_TRUE(read_everything(*recording).images.empty());
}

}  // namespace
}  // namespace eventide
