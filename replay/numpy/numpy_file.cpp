#include "replay/numpy/numpy_file.h"

#include "src/core/error.h"

namespace eventide {

NumpyFile::NumpyFile(const std::filesystem::path& path)
    : file_(path.string()),
      bytes_(file_, 0, file_.size()),
      array_(read_numpy_header(bytes_, file_.path())) {
    if (!array_.is_of_numbers_in_rows())
        throw Error(ErrorKind::input,
                    file_.path() + ": expected an array of numbers in C order, found another");
}

std::uint64_t NumpyFile::row_length() const {
    return rows() == 0 ? 0 : array_.items() / rows();
}

std::vector<double> NumpyFile::read(std::uint64_t first, std::uint64_t count) {
    if (first > rows() || count > rows() - first)
        throw Error(ErrorKind::input,
                    name() + ": expected more than " + std::to_string(rows()) + " rows");
    const std::uint64_t numbers = count * row_length(), row_bytes = row_length() * number().bytes;
    std::vector<std::byte> bytes(static_cast<std::size_t>(count * row_bytes));
    if (!bytes_.read_at(array_.data_offset + first * row_bytes, bytes))
        throw Error(ErrorKind::input, name() + ": ends before its last number");
    std::vector<double> out(static_cast<std::size_t>(numbers));
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = numpy_number(number(), bytes.data() + i * number().bytes);
    return out;
}

}  // namespace eventide
