// EVT2 and EVT2.1: each word with time, place and polarity; 2.1 carries 32 columns at once
// (docs/protocols.md D.4).
#pragma once

#include "src/codec/prophesee/evt_header.h"
#include "src/codec/prophesee/evt_parser.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace eventide {

/// The part that EVT2 and EVT2.1 share; times have 34 bits.
class Evt2Base : public EvtParser {
protected:
    Evt2Base(std::string_view format, int width, int height)
        : EvtParser({format, 28, 6}, width, height) {}

    /// All words but events; `upper` is an EVT2 word or the upper half of an EVT2.1 word.
    void take_other(std::uint32_t upper, bool is_padding, Batch& into);
};

class Evt2Parser final : public EvtWordParser<Evt2Base, 4> {
public:
    explicit Evt2Parser(int width = 0, int height = 0) : EvtWordParser("evt2", width, height) {}

private:
    void take(std::span<const std::byte> words, Batch& into) override;
};

class Evt21Parser final : public EvtWordParser<Evt2Base, 8> {
public:
    /// In files of "endianness legacy" and from V4L2 nodes of format PSE1 the upper half of each
    /// word comes first.
    enum class Order { lower_half_first, upper_half_first };
    static Order order_of(const EvtHeader& header);

    explicit Evt21Parser(int width = 0, int height = 0, Order order = Order::lower_half_first)
        : EvtWordParser("evt21", width, height), order_(order) {}

private:
    void take(std::span<const std::byte> words, Batch& into) override;
    void read_header(std::span<const std::byte> header) override;

    Order order_;
};

}  // namespace eventide
