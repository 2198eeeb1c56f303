// EVT2.1 from arbitrary words, in both orders of halves.
#include "src/codec/prophesee/evt2.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    for (const auto order :
         {Evt21Parser::Order::lower_half_first, Evt21Parser::Order::upper_half_first})
        fuzz_parser(bytes, 640, 480,
                    [&] { return std::make_unique<Evt21Parser>(640, 480, order); });
    return 0;
}
