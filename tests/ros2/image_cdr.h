// sensor_msgs/Image as CDR, written down by itself: what the sinks' bytes are held against.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace eventide::test {

class CdrWriter {
public:
    template <typename T>
    void number(T value) {
        while ((bytes_.size() - kHead) % sizeof(T) != 0) bytes_.push_back(0);
        const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
        bytes_.insert(bytes_.end(), raw, raw + sizeof(T));  // tests run on little-endian machines
    }
    void text(const std::string& text) {
        number(std::uint32_t(text.size() + 1));
        bytes_.insert(bytes_.end(), text.begin(), text.end());
        bytes_.push_back(0);
    }
    void octets(const std::vector<std::uint8_t>& values) {
        number(std::uint32_t(values.size()));
        bytes_.insert(bytes_.end(), values.begin(), values.end());
    }
    /// The end is padded to four bytes, and the options say by how many.
    std::vector<std::uint8_t> finish() {
        while (bytes_.size() % 4 != 0) {
            bytes_.push_back(0);
            ++bytes_[3];
        }
        return bytes_;
    }

private:
    static constexpr std::size_t kHead = 4;
    std::vector<std::uint8_t> bytes_{0, 1, 0, 0};  // CDR_LE
};

inline std::vector<std::uint8_t> image_cdr(std::int64_t stamp_us, const std::string& frame_id,
                                           std::uint32_t width, std::uint32_t height,
                                           const std::string& encoding, std::uint32_t step,
                                           const std::vector<std::uint8_t>& data) {
    CdrWriter cdr;
    cdr.number(std::int32_t(stamp_us / 1'000'000));
    cdr.number(std::uint32_t(stamp_us % 1'000'000 * 1000));
    cdr.text(frame_id);
    cdr.number(height);
    cdr.number(width);
    cdr.text(encoding);
    cdr.number(std::uint8_t{0});
    cdr.number(step);
    cdr.octets(data);
    return cdr.finish();
}

}  // namespace eventide::test
