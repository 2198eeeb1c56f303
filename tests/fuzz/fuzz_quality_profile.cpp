// Any bytes as what was measured of a processor: refused with words, or the same when written and
// read again.
#include "apps/cli/run/quality/quality_profile.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    using namespace eventide::app;
    const ProfileKey key{"cpu", "AVX2", "auto", "1.0", "default", "01", 8, 6};
    try {
        const QualityProfile profile = parse_profile(std::string{text_of_input(data, size)}, key);
        const std::string text = profile_text(profile);
        if (profile_text(parse_profile(text, key)) != text) std::abort();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) std::abort();
    }
    return 0;
}
