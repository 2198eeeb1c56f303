// What a fuzz target is run with where there is no libFuzzer: its kept corpus, and changes of it
// that are the same in every run.
//     fuzz_evt2 CORPUS RUNS
#include <sanitizer/common_interface_defs.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* argc, char*** argv);

namespace {

using Input = std::vector<std::uint8_t>;

constexpr std::size_t kShortest = 64;  // bytes that any input may have; else twice its seed's

Input current;  // told where it breaks the target

/// Writes the input, as hexadecimal text.
void tell() {
    static const char digits[] = "0123456789abcdef";
    static const char what[] = "\nbroken by: ";
    std::string text{what};
    for (const std::uint8_t byte : current) {
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    text += '\n';
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

/// The target found that something does not hold.
void tell_and_exit(int) {
    tell();
    std::_Exit(1);
}

Input read(const std::filesystem::path& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

class Mutations {
public:
    explicit Mutations(const std::vector<Input>& seeds) : seeds_{seeds} {}

    Input next() {
        const Input& seed = seeds_[below(seeds_.size())];
        Input input = seed;
        const std::size_t most = std::max(2 * seed.size(), kShortest);
        for (std::size_t n = 1 + below(6); n > 0; --n) change(input);
        input.resize(std::min(input.size(), most));
        return input;
    }

private:
    std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

    void change(Input& input) {
        const auto at = input.begin() + std::ptrdiff_t(below(input.size() + 1));
        const auto rest = std::size_t(input.end() - at);
        switch (below(6)) {
            case 0:
                if (rest > 0) *at = std::uint8_t(*at ^ 1U << below(8));
                break;
            case 1:
                if (rest > 0) *at = std::uint8_t(random_());
                break;
            case 2:
                input.erase(at, at + std::ptrdiff_t(below(std::min<std::size_t>(rest, 16) + 1)));
                break;
            case 3:
                input.insert(at, 1 + below(4), std::uint8_t(below(2) * 255));
                break;
            case 4: {  // a piece of itself or of another
                const Input from = below(2) == 0 ? input : seeds_[below(seeds_.size())];
                const std::size_t begin = below(from.size()), size = below(from.size() - begin + 1);
                const auto piece = from.begin() + std::ptrdiff_t(begin);
                input.insert(at, piece, piece + std::ptrdiff_t(std::min<std::size_t>(size, 64)));
                break;
            }
            default:
                input.erase(at + std::ptrdiff_t(below(rest + 1)), input.end());
                break;
        }
    }

    const std::vector<Input>& seeds_;
    std::mt19937 random_{1};
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: %s CORPUS RUNS\n", argv[0]);
        return 2;
    }
    if (LLVMFuzzerInitialize != nullptr) LLVMFuzzerInitialize(&argc, &argv);
    std::vector<std::filesystem::path> files;
    if (std::filesystem::is_directory(argv[1]))
        for (const auto& entry : std::filesystem::directory_iterator{argv[1]})
            if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<Input> seeds{Input{}};
    for (const auto& file : files) seeds.push_back(read(file));
    std::signal(SIGABRT, tell_and_exit);
    __sanitizer_set_death_callback(tell);
    const auto run = [](Input input) {
        current = std::move(input);
        LLVMFuzzerTestOneInput(current.data(), current.size());
    };
    for (const Input& seed : seeds) run(seed);
    Mutations mutations{seeds};
    const long runs = std::strtol(argv[2], nullptr, 10);
    for (long n = 0; n < runs; ++n) run(mutations.next());
    std::printf("%zu seeds and %ld changes of them\n", seeds.size(), runs);
    return 0;
}
