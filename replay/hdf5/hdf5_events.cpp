// Events as columns or rows of numbers.
#include "replay/hdf5/hdf5_tables.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace eventide {

namespace {

/// A data set, or a member of one of records.
class Column {
public:
    Column(const Hdf5File& file, const Hdf5Columns& columns, const std::string& name)
        : data_(file.data(columns.records.empty() ? name : columns.records)), member_(name) {
        const bool records = !columns.records.empty();
        if (data_.shape().size() != 1)
            data_.refuse("one number per event", "an array of " + data_.shape_text());
        if (records ? !data_.has_member(name)
                    : data_.kind() != Hdf5Data::Kind::integer &&
                          data_.kind() != Hdf5Data::Kind::floating)
            data_.refuse(records ? "records with a member '" + name + "'" : "numbers",
                         "something else");
        if (!records) member_.clear();
    }
    std::uint64_t rows() const { return data_.rows(); }
    bool is_floating() const { return data_.kind() == Hdf5Data::Kind::floating; }
    const Hdf5Data& data() const { return data_; }

    template <typename T>
    bool read(std::uint64_t first, std::span<T> into) const {
        return data_.read<T>(first, into, member_.empty() ? nullptr : member_.c_str());
    }
    template <typename T>
    std::optional<T> number(std::uint64_t row) const {
        return data_.number<T>(row, member_.empty() ? nullptr : member_.c_str());
    }

private:
    Hdf5Data data_;
    std::string member_;
};

class ColumnTable final : public EventTable {
public:
    ColumnTable(const Hdf5File& file, const Hdf5Columns& columns)
        : x_(file, columns, columns.x),
          y_(file, columns, columns.y),
          t_(file, columns, columns.t),
          p_(file, columns, columns.p),
          offset_us_(columns.offset_us) {
        for (const Column* other : {&x_, &y_, &p_})
            if (other->rows() != t_.rows())
                other->data().refuse(
                    "as many rows as " + columns.t + ", " + std::to_string(t_.rows()),
                    std::to_string(other->rows()));
        if (!columns.index.empty() && file.has(columns.index))
            index_.emplace(file.data(columns.index));
        if (index_ && index_->shape().size() != 1) index_.reset();
    }

    std::uint64_t rows() const override { return t_.rows(); }

    bool read(std::uint64_t first, std::size_t count, EventRows& into) override {
        into.resize(count);
        small_.resize(count);
        if (!read_times(first, into.t_us) || !x_.read<std::int32_t>(first, into.x) ||
            !y_.read<std::int32_t>(first, into.y) || !p_.read<std::int32_t>(first, small_))
            return false;
        std::ranges::transform(small_, into.on.begin(),
                               [](std::int32_t p) { return std::uint8_t(p > 0); });
        return true;
    }

    std::int64_t time_us(std::uint64_t row) override {
        if (t_.is_floating()) {
            const auto t = t_.number<double>(row);
            return t ? us_from_integer(us_from_seconds(*t), offset_us_) : kNoTimeUs;
        }
        const auto t = t_.number<std::int64_t>(row);
        return t ? us_from_integer(*t, offset_us_) : kNoTimeUs;
    }

    std::optional<std::uint64_t> look_up(std::int64_t t_us) override {
        if (!index_ || index_->rows() == 0) return {};
        // Unsigned, as a file may say an offset of any 64 bits.
        const std::uint64_t us =
            t_us <= offset_us_ ? 0 : std::uint64_t(t_us) - std::uint64_t(offset_us_);
        if (us / 1000 >= index_->rows()) return {};
        const auto row = index_->number<std::int64_t>(us / 1000);
        return row ? std::optional(std::uint64_t(*row)) : std::nullopt;
    }

private:
    bool read_times(std::uint64_t first, std::span<std::int64_t> into) {
        if (!t_.is_floating()) {
            if (!t_.read<std::int64_t>(first, into)) return false;
            for (std::int64_t& t : into) t = us_from_integer(t, offset_us_);
            return true;
        }
        seconds_.resize(into.size());
        if (!t_.read<double>(first, seconds_)) return false;
        for (std::size_t i = 0; i < into.size(); ++i)
            into[i] = us_from_integer(us_from_seconds(seconds_[i]), offset_us_);
        return true;
    }

    Column x_, y_, t_, p_;
    std::optional<Hdf5Data> index_;
    std::int64_t offset_us_;
    std::vector<std::int32_t> small_;
    std::vector<double> seconds_;
};

class MatrixTable final : public EventTable {
public:
    MatrixTable(const Hdf5File& file, const std::string& name) : data_(file.data(name)) {
        if (data_.shape().size() != 2 || data_.shape()[1] != 4)
            data_.refuse("[event][x y t p]", data_.shape_text());
    }
    std::uint64_t rows() const override { return data_.rows(); }

    bool read(std::uint64_t first, std::size_t count, EventRows& into) override {
        numbers_.resize(4 * count);
        if (!data_.read<double>(first, numbers_)) return false;
        into.resize(count);
        const auto place = [](double at) {
            return at >= 0 && at < 1e9 ? std::int32_t(at) : std::int32_t{-1};
        };
        for (std::size_t i = 0; i < count; ++i) {
            into.x[i] = place(numbers_[4 * i]);
            into.y[i] = place(numbers_[4 * i + 1]);
            into.t_us[i] = us_from_seconds(numbers_[4 * i + 2]);
            into.on[i] = std::uint8_t(numbers_[4 * i + 3] > 0);
        }
        return true;
    }
    std::int64_t time_us(std::uint64_t row) override {
        const auto t = data_.number<double>(row, nullptr, 2);
        return t ? us_from_seconds(*t) : kNoTimeUs;
    }

private:
    Hdf5Data data_;
    std::vector<double> numbers_;
};

}  // namespace

std::unique_ptr<EventTable> open_hdf5_columns(const Hdf5File& file, const Hdf5Columns& columns) {
    return std::make_unique<ColumnTable>(file, columns);
}

std::unique_ptr<EventTable> open_hdf5_matrix(const Hdf5File& file, const std::string& name) {
    return std::make_unique<MatrixTable>(file, name);
}

}  // namespace eventide
