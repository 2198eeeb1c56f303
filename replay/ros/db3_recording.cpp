// ROS 2 bags in SQLite files: tables of topics and messages.
#include "replay/ros/bag_recording.h"
#include "replay/ros/ros_reader.h"
#include "src/core/error.h"

#include <sqlite3.h>

#include <filesystem>
#include <memory>

namespace eventide {

namespace {

using File = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Rows = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

/// As an address, in which some characters stand for others.
std::string address_of(const std::string& path) {
    std::string address = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
        constexpr const char* kDigits = "0123456789ABCDEF";
        const auto code = static_cast<unsigned char>(c);
        if (c == '%' || c == '?' || c == '#')
            address += std::string("%") + kDigits[code >> 4] + kDigits[code & 15];
        else
            address += c;
    }
    // Nothing is written, no journal beside it is looked for.
    return address + "?mode=ro&immutable=1";
}

class Db3Reader final : public RosReader {
public:
    Db3Reader(const std::string& path, const OpenOptions& options)
        : RosReader(path, RosWire::cdr), file_(open_file(path)) {
        const Rows topics = prepare("select id, name, type, serialization_format from topics");
        while (sqlite3_step(topics.get()) == SQLITE_ROW)
            if (text(topics, 3) == "cdr")
                add_topic(std::uint32_t(sqlite3_column_int64(topics.get(), 0)), text(topics, 1),
                          text(topics, 2));
        const Rows count = prepare("select count(*) from messages");
        if (sqlite3_step(count.get()) == SQLITE_ROW) count_ = sqlite3_column_int64(count.get(), 0);
        rewind();
        open("db3", options);
    }

    double progress() const override { return count_ < 1 ? 1 : double(read_) / double(count_); }

protected:
    bool read_part(Damage& damage) override {
        const int status = sqlite3_step(messages_in_.get());
        if (status == SQLITE_DONE) return false;
        if (status != SQLITE_ROW) {
            damage.count(DamageReason::truncated);  // a page that is missing or makes no sense
            return false;
        }
        ++read_;
        const auto* data =
            static_cast<const std::byte*>(sqlite3_column_blob(messages_in_.get(), 1));
        const auto size = std::size_t(sqlite3_column_bytes(messages_in_.get(), 1));
        add_message(std::uint32_t(sqlite3_column_int64(messages_in_.get(), 0)), {data, size});
        return true;
    }
    void rewind() override {
        messages_in_ = prepare("select topic_id, data from messages order by timestamp, id");
        read_ = 0;
    }

private:
    static File open_file(const std::string& path) {
        sqlite3* opened = nullptr;
        const int status = sqlite3_open_v2(address_of(path).c_str(), &opened,
                                           SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
        File file{opened, sqlite3_close};
        if (status != SQLITE_OK)
            throw Error(ErrorKind::input, path + ": cannot be opened: " + sqlite3_errstr(status));
        return file;
    }

    Rows prepare(const char* query) const {
        sqlite3_stmt* made = nullptr;
        if (sqlite3_prepare_v2(file_.get(), query, -1, &made, nullptr) != SQLITE_OK)
            throw Error(ErrorKind::input,
                        path_ +
                            ": expected a ROS 2 bag, found an SQLite file without its tables (" +
                            sqlite3_errmsg(file_.get()) + ")");
        return {made, sqlite3_finalize};
    }

    static std::string text(const Rows& rows, int column) {
        const auto* found = reinterpret_cast<const char*>(sqlite3_column_text(rows.get(), column));
        return found == nullptr ? "" : found;
    }

    File file_;
    Rows messages_in_{nullptr, sqlite3_finalize};
    std::int64_t count_ = 0, read_ = 0;
};

}  // namespace

std::unique_ptr<DataReader> open_db3(const std::string& path, const OpenOptions& options) {
    return std::make_unique<Db3Reader>(path, options);
}

}  // namespace eventide
