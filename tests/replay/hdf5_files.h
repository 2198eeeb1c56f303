// HDF5 files as data sets have them, written with the library itself.
#pragma once

#include "src/core/event.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <string>
#include <vector>

namespace eventide::test {

/// A file being made. Names are paths; groups on the way are made.
class Hdf5Made {
public:
    explicit Hdf5Made(const std::string& path)
        : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)),
          links_(H5Pcreate(H5P_LINK_CREATE)) {
        EXPECT_GE(file_, 0) << path;
        H5Pset_create_intermediate_group(links_, 1);
    }
    ~Hdf5Made() {
        H5Pclose(links_);
        H5Fclose(file_);
    }
    Hdf5Made(const Hdf5Made&) = delete;
    Hdf5Made& operator=(const Hdf5Made&) = delete;

    hid_t id() const { return file_; }

    /// `block`: rows per packed block, 0 for one that is not packed.
    void array(const std::string& name, std::vector<hsize_t> shape, hid_t memory,
               const void* values, hid_t stored, hsize_t block = 0) const {
        const hid_t space = H5Screate_simple(int(shape.size()), shape.data(), nullptr);
        const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
        if (block > 0) {
            shape[0] = std::min(block, shape[0]);
            H5Pset_chunk(plan, int(shape.size()), shape.data());
            H5Pset_shuffle(plan);
            H5Pset_deflate(plan, 4);
        }
        const hid_t set = H5Dcreate2(file_, name.c_str(), stored, space, links_, plan, H5P_DEFAULT);
        EXPECT_GE(H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0) << name;
        H5Dclose(set);
        H5Pclose(plan);
        H5Sclose(space);
    }
    template <typename T>
    void column(const std::string& name, const std::vector<T>& values, hid_t stored,
                hsize_t block = 4096) const {
        array(name, {values.size()}, native<T>(), values.data(), stored, block);
    }
    void scalar(const std::string& name, std::int64_t value) const {
        const hid_t space = H5Screate(H5S_SCALAR);
        const hid_t set =
            H5Dcreate2(file_, name.c_str(), H5T_STD_I64LE, space, links_, H5P_DEFAULT, H5P_DEFAULT);
        H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
        H5Dclose(set);
        H5Sclose(space);
    }
    template <typename T>
    void attribute(const std::string& object, const char* name,
                   const std::vector<T>& values) const {
        const hid_t opened = H5Oopen(file_, object.c_str(), H5P_DEFAULT);
        const hsize_t count = values.size();
        const hid_t space =
            count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr);
        const hid_t made = H5Acreate2(opened, name, native<T>(), space, H5P_DEFAULT, H5P_DEFAULT);
        EXPECT_GE(H5Awrite(made, native<T>(), values.data()), 0) << name;
        H5Aclose(made);
        H5Sclose(space);
        H5Oclose(opened);
    }
    void text_attribute(const char* name, const std::string& text) const {
        const hid_t kind = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
        H5Tset_size(kind, text.size());
        const hid_t made = H5Acreate2(file_, name, kind, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(made, kind, text.data());
        H5Aclose(made);
        H5Sclose(space);
        H5Tclose(kind);
    }

private:
    template <typename T>
    static hid_t native() {
        if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
        if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
        if constexpr (std::is_same_v<T, std::uint16_t>) return H5T_NATIVE_UINT16;
        if constexpr (std::is_same_v<T, std::int8_t>) return H5T_NATIVE_INT8;
        return H5T_NATIVE_UINT8;
    }
    hid_t file_, links_;
};

/// The columns of some events.
struct Columns {
    std::vector<std::uint16_t> x, y;
    std::vector<std::int64_t> t;
    std::vector<double> t_s;
    std::vector<std::uint8_t> p;

    /// Times less `offset_us`.
    explicit Columns(const std::vector<Event>& events, std::int64_t offset_us = 0) {
        for (const Event& event : events) {
            x.push_back(event.x);
            y.push_back(event.y);
            t.push_back(to_us(event.t) - offset_us);
            t_s.push_back(double(to_us(event.t)) / 1e6);
            p.push_back(std::uint8_t(event.polarity));
        }
    }
    /// As DSEC and M3ED have it.
    std::vector<std::int64_t> ms_index() const {
        std::vector<std::int64_t> rows;
        for (std::size_t i = 0; i < t.size(); ++i)
            while (std::int64_t(rows.size()) * 1000 <= t[i]) rows.push_back(std::int64_t(i));
        return rows;
    }
};

}  // namespace eventide::test
