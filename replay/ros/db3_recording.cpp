// ROS 2 bags in SQLite files: tables of topics and messages.
#include "replay/ros/bag_recording.h"
#include "replay/ros/ros_reader.h"
#include "src/core/error.h"
#include "src/io/late_library.h"

#include <sqlite3.h>

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace eventide {

namespace {

/// SQLite, loaded with the first of such files.
struct Sqlite {
    decltype(&sqlite3_open_v2) open_v2;
    decltype(&sqlite3_close) close;
    decltype(&sqlite3_prepare_v2) prepare_v2;
    decltype(&sqlite3_step) step;
    decltype(&sqlite3_finalize) finalize;
    decltype(&sqlite3_column_int64) column_int64;
    decltype(&sqlite3_column_text) column_text;
    decltype(&sqlite3_column_blob) column_blob;
    decltype(&sqlite3_column_bytes) column_bytes;
    decltype(&sqlite3_errmsg) errmsg;
    decltype(&sqlite3_errstr) errstr;

    Sqlite() {
        const LateLibrary library{"libsqlite3.so.0", "ROS 2 bags in SQLite files", "libsqlite3-0"};
        library.find(open_v2, "sqlite3_open_v2");
        library.find(close, "sqlite3_close");
        library.find(prepare_v2, "sqlite3_prepare_v2");
        library.find(step, "sqlite3_step");
        library.find(finalize, "sqlite3_finalize");
        library.find(column_int64, "sqlite3_column_int64");
        library.find(column_text, "sqlite3_column_text");
        library.find(column_blob, "sqlite3_column_blob");
        library.find(column_bytes, "sqlite3_column_bytes");
        library.find(errmsg, "sqlite3_errmsg");
        library.find(errstr, "sqlite3_errstr");
    }
};

const Sqlite& sqlite() {
    static const Sqlite library;
    return library;
}

using File = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Rows = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

/// Of a recorder that was not closed: what SQLite's journal beside the file still holds. Empty
/// where there is none.
std::string journal_text(const std::string& path) {
    const std::string journal = path + "-wal";
    std::error_code none;
    const auto bytes = std::filesystem::file_size(journal, none);
    if (none || bytes == 0) return {};
    return journal + ", what the recorder had not moved into the file yet, is not read: sqlite3 " +
           path + " 'pragma wal_checkpoint' moves it";
}

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
        : RosReader(path, options.stream), file_(open_file(path)) {
        const Rows topics = prepare("select id, name, type, serialization_format from topics");
        while (sqlite().step(topics.get()) == SQLITE_ROW)
            if (text(topics, 3) == "cdr")
                add_topic(std::uint32_t(sqlite().column_int64(topics.get(), 0)), text(topics, 1),
                          text(topics, 2), RosWire::cdr);
        const Rows count = prepare("select count(*) from messages");
        if (sqlite().step(count.get()) == SQLITE_ROW)
            count_ = sqlite().column_int64(count.get(), 0);
        rewind();
        open("db3", options);
    }

    double progress() const override { return count_ < 1 ? 1 : double(read_) / double(count_); }

    std::vector<std::string> remarks() const override {
        std::vector<std::string> all = RosReader::remarks();
        if (std::string text = journal_text(path_); !text.empty()) all.push_back(std::move(text));
        return all;
    }

protected:
    bool read_part(Damage& damage) override {
        const int status = sqlite().step(messages_in_.get());
        if (status == SQLITE_DONE) return false;
        if (status != SQLITE_ROW) {
            damage.count(DamageReason::truncated);  // a page that is missing or makes no sense
            return false;
        }
        ++read_;
        const auto* data =
            static_cast<const std::byte*>(sqlite().column_blob(messages_in_.get(), 1));
        const auto size = std::size_t(sqlite().column_bytes(messages_in_.get(), 1));
        add_message(std::uint32_t(sqlite().column_int64(messages_in_.get(), 0)), {data, size});
        return true;
    }
    void rewind() override {
        messages_in_ = prepare("select topic_id, data from messages order by timestamp, id");
        read_ = 0;
    }

private:
    static File open_file(const std::string& path) {
        sqlite3* opened = nullptr;
        const int status = sqlite().open_v2(address_of(path).c_str(), &opened,
                                            SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
        File file{opened, sqlite().close};
        if (status != SQLITE_OK)
            throw Error(ErrorKind::input, path + ": cannot be opened: " + sqlite().errstr(status));
        return file;
    }

    Rows prepare(const char* query) const {
        sqlite3_stmt* made = nullptr;
        if (sqlite().prepare_v2(file_.get(), query, -1, &made, nullptr) != SQLITE_OK) {
            const std::string journal = journal_text(path_);
            throw Error(
                ErrorKind::input,
                path_ + ": expected a ROS 2 bag, found an SQLite file without its tables (" +
                    sqlite().errmsg(file_.get()) + ")" + (journal.empty() ? "" : "; " + journal));
        }
        return {made, sqlite().finalize};
    }

    static std::string text(const Rows& rows, int column) {
        const auto* found = reinterpret_cast<const char*>(sqlite().column_text(rows.get(), column));
        return found == nullptr ? "" : found;
    }

    File file_;
    Rows messages_in_{nullptr, sqlite().finalize};
    std::int64_t count_ = 0, read_ = 0;
};

}  // namespace

std::unique_ptr<DataReader> open_db3(const std::string& path, const OpenOptions& options) {
    return std::make_unique<Db3Reader>(path, options);
}

}  // namespace eventide
