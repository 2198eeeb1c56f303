// Named pipes that are opened in whatever order their readers come.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

namespace eventide {

/// Whoever reads several pipes opens one after the other, and each opening waits for the other
/// side: opened in another order here, the two would wait for each other for ever. So all readers
/// are waited for at once, and what is opened while this holds the pipes finds them there.
class HeldPipes {
public:
    /// Returns once each pipe has a reader. `give_up`, which may be empty, is asked meanwhile: true
    /// ends the waiting. What cannot be opened is left to who opens it for writing.
    HeldPipes(const std::vector<std::filesystem::path>& pipes,
              const std::function<bool()>& give_up);
    ~HeldPipes();
    HeldPipes(const HeldPipes&) = delete;
    HeldPipes& operator=(const HeldPipes&) = delete;

private:
    std::vector<int> files_;
};

}  // namespace eventide
