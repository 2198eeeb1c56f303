// Writes npz files for tests: stored or deflated, float32.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace eventide {

class NpzWriter {
public:
    /// Raw bytes of one entry; what an .npy file holds, or on purpose something else.
    void add_bytes(const std::string& name, const std::string& npy, bool deflated) {
        const auto offset = std::uint32_t(out_.size());
        const std::string packed = deflated ? deflate_of(npy) : npy;
        const auto crc =
            std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(npy.data()), uInt(npy.size())));
        const auto fields = [&](std::string& to) {
            number(to, std::uint16_t{20});
            number(to, std::uint16_t{0});
            number(to, std::uint16_t(deflated ? 8 : 0));
            number(to, std::uint32_t{0});  // date and time
            number(to, crc);
            number(to, std::uint32_t(packed.size()));
            number(to, std::uint32_t(npy.size()));
            number(to, std::uint16_t(name.size() + 4));
            number(to, std::uint16_t{0});
        };
        number(out_, std::uint32_t{0x04034b50});
        fields(out_);
        out_ += name + ".npy" + packed;
        number(directory_, std::uint32_t{0x02014b50});
        number(directory_, std::uint16_t{20});
        fields(directory_);
        directory_.append(10, '\0');  // comment length, disk, attributes
        number(directory_, offset);
        directory_ += name + ".npy";
        ++count_;
    }

    void add(const std::string& name, const std::vector<std::int64_t>& shape,
             const std::vector<float>& values, bool deflated) {
        std::string tuple = "(";
        for (const auto n : shape) tuple += std::to_string(n) + ", ";
        const std::string header =
            "{'descr': '<f4', 'fortran_order': False, 'shape': " + tuple + "), }\n";
        std::string npy{"\x93NUMPY\x01\x00", 8};
        number(npy, std::uint16_t(header.size()));
        npy += header;
        npy.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
        add_bytes(name, npy, deflated);
    }

    std::string bytes() const {
        std::string all = out_ + directory_;
        number(all, std::uint32_t{0x06054b50});
        number(all, std::uint32_t{0});
        number(all, count_);
        number(all, count_);
        number(all, std::uint32_t(directory_.size()));
        number(all, std::uint32_t(out_.size()));
        number(all, std::uint16_t{0});
        return all;
    }

    void write(const std::filesystem::path& path) const {
        std::ofstream{path, std::ios::binary} << bytes();
    }

private:
    template <typename T>
    static void number(std::string& to, T value) {
        to.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    static std::string deflate_of(const std::string& bytes) {
        z_stream z{};
        deflateInit2(&z, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
        std::string out(deflateBound(&z, uLong(bytes.size())), '\0');
        z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
        z.avail_in = uInt(bytes.size());
        z.next_out = reinterpret_cast<Bytef*>(out.data());
        z.avail_out = uInt(out.size());
        deflate(&z, Z_FINISH);
        out.resize(z.total_out);
        deflateEnd(&z);
        return out;
    }

    std::string out_, directory_;
    std::uint16_t count_ = 0;
};

}  // namespace eventide
