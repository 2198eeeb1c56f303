// eventide convert, as a user runs it.
#include "tests/system/commands_test.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

namespace eventide::test {
namespace {

TEST_F(Commands, ConvertLosesNoEventAndSaysWhatHasNoPlace) {
    const Json original = info(recording());
    std::string from = recording();
    for (const char* to : {"a.txt", "b.raw", "c.aedat4"}) {
        const Result result = eventide({"convert", from, to});
        ASSERT_EQ(result.exit_code, 0) << to << result.error;
        expect_same_events(info(temp_ / to), original);
        from = to;
    }
    const Result result = eventide({"convert", recording(), "d.raw", "--strict"});
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_NE(result.error.find("11 images"), std::string::npos) << result.error;
    EXPECT_EQ(eventide({"convert", recording(), "d.raw"}).exit_code, 2) << "it exists already";
}

TEST_F(Commands, ConvertWritesAFolderOfTheEventCameraDatasetAndReadsItBack) {
    const Json original = info(recording());
    const Result result = eventide({"convert", recording(), "ecd/"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    expect_same_events(info(temp_ / "ecd"), original);
    EXPECT_EQ(info(temp_ / "ecd")["frames"], original["frames"]);
    EXPECT_EQ(probe(temp_ / "ecd/images/frame_00000000.png", "width,height"), "64,48\n");
    ASSERT_EQ(eventide({"convert", "ecd/", "back.aedat4"}).exit_code, 0);
    expect_same_events(info(temp_ / "back.aedat4"), original);
    EXPECT_EQ(info(temp_ / "back.aedat4")["frames"], original["frames"]);

    EXPECT_EQ(eventide({"convert", recording(), "ecd/"}).exit_code, 2) << "it holds something";
    EXPECT_EQ(eventide({"convert", recording(), "ecd/", "--overwrite"}).exit_code, 0);
    EXPECT_EQ(eventide({"convert", "ecd/", "ecd/", "--overwrite"}).exit_code, 2) << "its own input";
    EXPECT_EQ(eventide({"convert", recording(), "b/", "--to-format", "text"}).exit_code, 2);
}

TEST_F(Commands, ConvertSaysWhatItWritesWhereTheTargetIsNoneOfThat) {
    const Result csv = eventide({"convert", recording(), "a.csv"});
    EXPECT_EQ(csv.exit_code, 2);
    EXPECT_NE(csv.error.find(".aedat4, "), std::string::npos) << csv.error;
    EXPECT_NE(csv.error.find(".txt"), std::string::npos) << csv.error;
    for (const char* name : {"evt2", "csv"}) {  // one is read only, the other is none at all
        const Result result = eventide({"convert", recording(), "a.raw", "--to-format", name});
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_NE(result.error.find("--to-format: expected one of aedat4"), std::string::npos)
            << result.error;
        EXPECT_NE(result.error.find("hdf5"), std::string::npos) << result.error;
    }
}

TEST_F(Commands, ConvertWritesTextToStandardOutput) {
    const Result result =
        eventide({"convert", recording(), "-", "--to-format", "text", "--to", "10ms"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.output.substr(0, 6), "64 48\n");
}

TEST_F(Commands, ConvertTakesAPart) {
    ASSERT_EQ(eventide({"convert", recording(), "a.aedat4", "--from", "100ms", "--to", "200ms"})
                  .exit_code,
              0);
    const Json part = info(temp_ / "a.aedat4"), whole = info(recording());
    EXPECT_GE(part["first_us"].get<long long>(), whole["first_us"].get<long long>() + 100'000);
    EXPECT_LE(part["last_us"].get<long long>(), whole["first_us"].get<long long>() + 200'000);
    EXPECT_GT(part["events"].get<int>(), 0);
}

TEST_F(Commands, ConvertCountsTimesOfFiltersFromTheFirstEventOfTheRecording) {
    ASSERT_EQ(eventide({"convert", recording(), "a.aedat4", "--from", "100ms", "--filter",
                        "time:150ms..200ms"})
                  .exit_code,
              0);
    ASSERT_EQ(eventide({"run", recording(), "--from", "100ms", "--warmup", "0s", "--filter",
                        "time:150ms..200ms", "--out", "null", "--events-out", "b.aedat4"})
                  .exit_code,
              0);
    const long long first = info(recording())["first_us"].get<long long>();
    for (const char* file : {"a.aedat4", "b.aedat4"}) {
        const Json part = info(temp_ / file);
        EXPECT_GE(part["first_us"].get<long long>(), first + 150'000) << file;
        EXPECT_LT(part["first_us"].get<long long>(), first + 155'000) << file;
        EXPECT_LE(part["last_us"].get<long long>(), first + 200'000) << file;
    }
}

TEST_F(Commands, ConvertSendsDatagrams) {
    const int reader = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof here;
    ASSERT_EQ(bind(reader, reinterpret_cast<sockaddr*>(&here), length), 0);
    getsockname(reader, reinterpret_cast<sockaddr*>(&here), &length);
    const std::string to = "udp://127.0.0.1:" + std::to_string(ntohs(here.sin_port));
    const Result sent = eventide({"convert", recording(), to, "--to", "5ms"});
    EXPECT_EQ(sent.exit_code, 0) << sent.error;
    const auto received = [reader] {
        std::size_t bytes = 0;
        char datagram[2048];
        for (ssize_t n; (n = recv(reader, datagram, sizeof datagram, MSG_DONTWAIT)) > 0;)
            bytes += std::size_t(n);
        return bytes;
    };
    const std::size_t bytes = received();
    const Result of_run =
        eventide({"run", recording(), "--to", "5ms", "--out", "null", "--events-out", to});
    EXPECT_EQ(of_run.exit_code, 0) << of_run.error;
    EXPECT_GT(received(), 0U);
    close(reader);
    ASSERT_EQ(eventide({"convert", recording(), "a.aedat4", "--to", "5ms"}).exit_code, 0);
    EXPECT_EQ(bytes, 13 * info(temp_ / "a.aedat4")["events"].get<std::size_t>());
    // Nobody listens any more.
    const Result lost = eventide({"convert", recording(), to, "--strict"});
    EXPECT_EQ(lost.exit_code, 5);
    EXPECT_NE(lost.error.find("that nobody received"), std::string::npos) << lost.error;
    const Result format = eventide({"convert", recording(), to, "--to-format", "text"});
    EXPECT_EQ(format.exit_code, 2);
    EXPECT_NE(format.error.find("?format=t64"), std::string::npos) << format.error;
}

}  // namespace
}  // namespace eventide::test
