// config/cameras/*.toml -> DavisSettings, with every key and range checked.
#include "drivers/usb/davis_settings.h"
#include "src/core/error.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <functional>
#include <sstream>
#include <string>

namespace eventide {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const toml::source_region& where,
                         const std::string& what) {
    throw Error(ErrorKind::usage,
                file.string() + ":" + std::to_string(where.begin.line) + ": " + what);
}

/// One key of the file and where it goes.
struct Key {
    std::string name;
    std::function<void(const toml::node&)> take;
};

class Reader {
public:
    Reader(const std::filesystem::path& file, const toml::table& table)
        : file_(file), table_(table) {}

    void flag(const char* name, bool& into) {
        keys_.push_back({name, [this, name, &into](const toml::node& node) {
                             const auto value = node.value_exact<bool>();
                             if (!value)
                                 refuse(file_, node.source(),
                                        std::string{name} + ": expected true or false");
                             into = *value;
                         }});
    }
    void number(const char* name, int& into, std::int64_t least, std::int64_t most) {
        keys_.push_back({name, [this, name, &into, least, most](const toml::node& node) {
                             into = int(checked(node, name, least, most));
                         }});
    }
    void choice(const char* name, int& into, std::initializer_list<int> allowed) {
        keys_.push_back(
            {name,
             [this, name, &into, allowed = std::vector<int>(allowed)](const toml::node& node) {
                 const std::int64_t value = checked(node, name, allowed.front(), allowed.back());
                 if (std::find(allowed.begin(), allowed.end(), int(value)) == allowed.end()) {
                     std::string text;
                     for (const int a : allowed)
                         text += (text.empty() ? "" : ", ") + std::to_string(a);
                     refuse(file_, node.source(),
                            std::string{name} + ": expected one of " + text + ", found " +
                                std::to_string(value));
                 }
                 into = int(value);
             }});
    }
    void custom(const char* name, std::function<void(const toml::node&)> take) {
        keys_.push_back({name, std::move(take)});
    }

    std::int64_t checked(const toml::node& node, const std::string& name, std::int64_t least,
                         std::int64_t most) const {
        const auto value = node.value_exact<std::int64_t>();
        if (!value || *value < least || *value > most)
            refuse(file_, node.source(),
                   name + ": expected a whole number from " + std::to_string(least) + " to " +
                       std::to_string(most) +
                       (value ? ", found " + std::to_string(*value) : std::string{}));
        return *value;
    }

    /// Takes every key of the table; a key nobody asked for is refused.
    void read() {
        for (const auto& [name, node] : table_) {
            const auto key = std::find_if(
                keys_.begin(), keys_.end(),
                [&, wanted = std::string{name.str()}](const Key& k) { return k.name == wanted; });
            if (key == keys_.end())
                refuse(file_, node.source(), "unknown key '" + std::string{name.str()} + "'");
            key->take(node);
        }
    }

private:
    const std::filesystem::path& file_;
    const toml::table& table_;
    std::vector<Key> keys_;
};

toml::table parse(const std::filesystem::path& file) {
    try {
        return toml::parse_file(file.string());
    } catch (const toml::parse_error& error) {
        throw Error(ErrorKind::usage, file.string() + ":" +
                                          std::to_string(error.source().begin.line) + ": " +
                                          std::string{error.description()});
    }
}

}  // namespace

DavisSettings load_davis_settings(const std::filesystem::path& file) {
    const toml::table table = parse(file);
    DavisSettings settings;
    Reader reader{file, table};
    reader.flag("frames", settings.frames);
    reader.flag("global_shutter", settings.global_shutter);
    reader.number("exposure_us", settings.exposure_us, 0, 4194303);
    reader.number("frame_interval_us", settings.frame_interval_us, 0, 8388607);
    reader.flag("auto_exposure", settings.auto_exposure);
    reader.flag("imu", settings.imu);
    reader.choice("accel_range_g", settings.accel_range_g, {2, 4, 8, 16});
    reader.choice("gyro_range_dps", settings.gyro_range_dps, {250, 500, 1000, 2000});
    reader.flag("activity_filter", settings.activity_filter);
    reader.number("activity_time_us", settings.activity_time_us, 250, 1000000);
    reader.number("skip_every", settings.skip_every, 0, 255);
    reader.flag("detect_pulses", settings.detect_pulses);
    reader.flag("detect_edges", settings.detect_edges);
    reader.number("transfers", settings.transfers.transfers, 2, 256);
    reader.number("early_packet_delay_us", settings.early_packet_delay_us, 125, 100000);
    int transfer_kib = int(settings.transfers.bytes / 1024);
    reader.number("transfer_kib", transfer_kib, 1, 4096);
    reader.custom("roi", [&](const toml::node& node) {
        const toml::array* numbers = node.as_array();
        if (numbers == nullptr || numbers->size() != 4)
            refuse(file, node.source(), "roi: expected [x, y, width, height]");
        std::array<int, 4> roi{};
        for (std::size_t i = 0; i < 4; ++i)
            roi[i] = int(reader.checked(*numbers->get(i), "roi", i < 2 ? 0 : 1, 1023));
        settings.roi = {roi[0], roi[1], roi[2], roi[3]};
    });
    reader.custom("biases", [&](const toml::node& node) {
        const toml::table* biases = node.as_table();
        if (biases == nullptr)
            refuse(file, node.source(), "biases: expected a table of names and 16-bit words");
        for (const auto& [name, value] : *biases)
            settings.biases[std::string{name.str()}] = std::uint16_t(
                reader.checked(value, "biases." + std::string{name.str()}, 0, 0xFFFF));
    });
    reader.read();
    settings.transfers.bytes = std::size_t(transfer_kib) * 1024;
    return settings;
}

}  // namespace eventide
