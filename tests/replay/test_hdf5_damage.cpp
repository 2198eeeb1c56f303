// HDF5 recordings that are damaged, or of which something is missing.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/replay/hdf5_files.h"
#include "tests/replay/hdf5_layouts.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

using test::Columns;
using test::Hdf5Made;
using testing::AllOf;
using testing::HasSubstr;

/// What opening says.
std::string refusal(const std::string& path, ErrorKind kind = ErrorKind::input) {
    try {
        read_everything(*open_recording(path));
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return "nothing was refused";
}

TEST(Hdf5Damage, OfTheFileIsRefusedByName) {
    const TestFolder folder;
    test::write_dsec(folder.path("a.h5"), some_events(5'000, test::kDsecOffset));
    const std::string whole = read_text(folder.path("a.h5"));
    EXPECT_THAT(refusal(folder.write("short.h5", whole.substr(0, whole.size() / 2))),
                AllOf(HasSubstr("short.h5"), HasSubstr("cut short")));
    {
        const Hdf5Made other(folder.path("other.h5"));
        other.scalar("poses/first", 3);
    }
    EXPECT_THAT(refusal(folder.path("other.h5")),
                AllOf(HasSubstr("events/x"), HasSubstr("found poses")));
}

TEST(Hdf5Damage, OfColumnsIsRefusedByName) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("events/x", columns.x, H5T_STD_U16LE);
        file.column("events/y", columns.y, H5T_STD_U16LE);
        file.column("events/t", columns.t, H5T_STD_I64LE);
    }
    EXPECT_THAT(refusal(folder.path("a.h5")), HasSubstr("events/p: expected a data set"));
    {
        const Hdf5Made file(folder.path("b.h5"));
        file.column("x", columns.x, H5T_STD_U16LE);
        file.column("y", columns.y, H5T_STD_U16LE);
        file.column("t", columns.t, H5T_STD_I64LE);
        file.column("p", std::vector<std::uint8_t>(99), H5T_STD_U8LE);
    }
    EXPECT_THAT(refusal(folder.path("b.h5")), HasSubstr("as many rows as t, 100, found 99"));
}

/// Of files that no command line names, one may be its output.
TEST(Hdf5Damage, DataOfOtherFilesAreRefused) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    test::write_dsec(folder.path("other.h5"), some_events(5'000, test::kDsecOffset));
    {
        const Hdf5Made file(folder.path("linked.h5"));
        H5Lcreate_external("other.h5", "/events", file.id(), "events", H5P_DEFAULT, H5P_DEFAULT);
    }
    EXPECT_THAT(refusal(folder.path("linked.h5")),
                AllOf(HasSubstr("expected data in the file itself, found a link to "),
                      HasSubstr("other.h5")));
    const std::string raw = folder.write("raw", std::string(200, 'x'));
    for (const bool is_virtual : {true, false}) {
        {
            const Hdf5Made file(folder.path("a.h5"));
            file.column("y", columns.y, H5T_STD_U16LE);
            file.column("t", columns.t, H5T_STD_I64LE);
            file.column("p", columns.p, H5T_STD_U8LE);
            const hsize_t rows = columns.x.size();
            const hid_t space = H5Screate_simple(1, &rows, nullptr),
                        plan = H5Pcreate(H5P_DATASET_CREATE);
            if (is_virtual)
                H5Pset_virtual(plan, space, "other.h5", "/events/x", space);
            else
                H5Pset_external(plan, raw.c_str(), 0, 2 * rows);
            H5Dclose(
                H5Dcreate2(file.id(), "x", H5T_STD_U16LE, space, H5P_DEFAULT, plan, H5P_DEFAULT));
            H5Pclose(plan);
            H5Sclose(space);
        }
        EXPECT_THAT(refusal(folder.path("a.h5")),
                    HasSubstr("x: expected data in the file itself, found a data set whose "
                              "numbers lie in other files"))
            << is_virtual;
    }
}

TEST(Hdf5Damage, RowsThatTheFileDoesNotHoldAreRefused) {
    const TestFolder folder;
    {
        const Hdf5Made file(folder.path("a.h5"));
        const hsize_t rows = hsize_t{1} << 40;
        const hid_t space = H5Screate_simple(1, &rows, nullptr);
        for (const char* name : {"x", "y", "t", "p"})
            H5Dclose(H5Dcreate2(file.id(), name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT,
                                H5P_DEFAULT));
        H5Sclose(space);
    }
    EXPECT_THAT(refusal(folder.path("a.h5")), HasSubstr("[1099511627776] numbers, found 0 bytes"));
}

TEST(Hdf5Damage, BlocksTooLargeToUnpackAreRefused) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("x", columns.x, H5T_STD_U16LE);
        file.column("y", columns.y, H5T_STD_U16LE);
        file.column("p", columns.p, H5T_STD_U8LE);
        const hsize_t rows = 100, any = H5S_UNLIMITED, block = hsize_t{1} << 28;
        const hid_t space = H5Screate_simple(1, &rows, &any), plan = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(plan, 1, &block);
        H5Dclose(H5Dcreate2(file.id(), "t", H5T_STD_I64LE, space, H5P_DEFAULT, plan, H5P_DEFAULT));
        H5Pclose(plan);
        H5Sclose(space);
    }
    EXPECT_THAT(refusal(folder.path("a.h5")), HasSubstr("blocks of at most 256 MiB"));
}

std::size_t no_filter(unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*,
                      void**) {
    return bytes;
}

TEST(Hdf5Damage, AMissingPlugInIsNamedWithItsRemedy) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    const struct {
        H5Z_filter_t number;
        const char* remedy;
    } filters[] = {{32001,
                    "blosc (HDF5 filter 32001), whose plug-in the HDF5 library does not "
                    "find; Debian's package is hdf5-filter-plugin-blosc-serial"},
                   {0x8ECF, "github.com/prophesee-ai/hdf5_ecf"},
                   {31999, "an unknown filter (HDF5 filter 31999)"}};
    for (const auto& [number, remedy] : filters) {
        if (H5Zfilter_avail(number) > 0) continue;
        const H5Z_class2_t filter{H5Z_CLASS_T_VERS, number,  1,       1,
                                  "test",           nullptr, nullptr, no_filter};
        H5Zregister(&filter);
        {
            const Hdf5Made file(folder.path("a.h5"));
            const hsize_t rows = 100;
            const hid_t space = H5Screate_simple(1, &rows, nullptr),
                        plan = H5Pcreate(H5P_DATASET_CREATE);
            H5Pset_chunk(plan, 1, &rows);
            H5Pset_filter(plan, number, 0, 0, nullptr);
            for (const char* name : {"events/x", "events/y", "events/t", "events/p"}) {
                const hid_t links = H5Pcreate(H5P_LINK_CREATE);
                H5Pset_create_intermediate_group(links, 1);
                const hid_t set =
                    H5Dcreate2(file.id(), name, H5T_STD_I64LE, space, links, plan, H5P_DEFAULT);
                H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, columns.t.data());
                H5Dclose(set);
                H5Pclose(links);
            }
            H5Pclose(plan);
            H5Sclose(space);
        }
        H5Zunregister(number);
        EXPECT_THAT(refusal(folder.path("a.h5")), AllOf(HasSubstr("events/x"), HasSubstr(remedy)));
    }
}

TEST(Hdf5Damage, OfABlockCostsTheRowsInItAndIsCounted) {
    const TestFolder folder;
    const auto events = some_events(200'000, test::kDsecOffset, 20, 240, 180);
    test::write_dsec(folder.path("a.h5"), events);
    std::string bytes = read_text(folder.path("a.h5"));
    // In the middle lie the packed times.
    for (std::size_t i = 0; i < 40; ++i) bytes[bytes.size() / 2 + i] ^= char(0x5A);
    OpenOptions options;
    options.width = 240;
    options.height = 180;
    const auto recording = open_recording(folder.write("b.h5", bytes), options);
    const Summary sum = summarize(*recording);
    EXPECT_GT(sum.damaged.total(), 0U);
    EXPECT_LT(sum.events, events.size());
    EXPECT_GT(sum.events, events.size() - 40'000);
}

TEST(Hdf5Damage, OfRowsIsCountedByReason) {
    const TestFolder folder;
    const auto events = some_events(1'000, 1'000'000, 20, 100, 100);
    Columns columns(events);
    columns.x[100] = 4000;
    columns.t[200] -= 10'000;
    columns.t[300] = std::int64_t{1} << 62;
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("x", columns.x, H5T_STD_U16LE);
        file.column("y", columns.y, H5T_STD_U16LE);
        file.column("t", columns.t, H5T_STD_I64LE);
        file.column("p", columns.p, H5T_STD_U8LE);
    }
    const Summary sum =
        summarize(*open_recording(folder.path("a.h5"), {.width = 128, .height = 128}));
    EXPECT_EQ(sum.damaged[DamageReason::out_of_range], 1U);
    EXPECT_EQ(sum.damaged[DamageReason::time_backwards], 1U);
    EXPECT_EQ(sum.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(sum.events, 997U);
}

TEST(Hdf5Damage, OfTheIndexIsCountedAndTheTimeFoundAllTheSame) {
    const TestFolder folder;
    const auto events = some_events(50'000, test::kDsecOffset, 20, 240, 180);
    Columns columns(events, test::kDsecOffset);
    auto index = columns.ms_index();
    for (auto& row : index) row = 49'000;  // far behind what it should say
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("events/x", columns.x, H5T_STD_U16LE);
        file.column("events/y", columns.y, H5T_STD_U16LE);
        file.column("events/t", columns.t, H5T_STD_U32LE);
        file.column("events/p", columns.p, H5T_STD_U8LE);
        file.column("ms_to_idx", index, H5T_STD_U64LE);
        file.scalar("t_offset", test::kDsecOffset);
    }
    const auto recording = open_recording(folder.path("a.h5"));
    recording->seek(events[20'000].t);
    const Summary sum = summarize(*recording);
    EXPECT_EQ(sum.damaged[DamageReason::bad_table], 1U);
    EXPECT_EQ(sum.damaged.total(), 1U);
    EXPECT_GE(sum.events, 30'000U);
    EXPECT_LT(sum.events, 30'010U);
}

TEST(Hdf5Damage, CannotBeReadFromAPipe) {
    const TestFolder folder;
    test::write_dsec(folder.path("a.h5"), some_events(5'000, test::kDsecOffset));
    std::FILE* pipe = ::popen(("cat " + folder.path("a.h5")).c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    EXPECT_THAT(refusal("/dev/fd/" + std::to_string(::fileno(pipe))),
                AllOf(HasSubstr("HDF5"), HasSubstr("a pipe")));
    ::pclose(pipe);
}

}  // namespace
}  // namespace eventide
