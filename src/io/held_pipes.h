// Named pipes that are opened in whatever order their readers come.
#pragma once

#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

namespace eventide {

/// Whoever reads several pipes opens one after the other, and each opening waits for the other
/// side: opened in another order here, the two would wait for each other for ever. So all readers
/// are waited for at once, and what is opened while this holds the pipes finds them there. Who
/// first waits for something else, such as what the same program will write to another pipe, looks
/// for readers meanwhile.
class HeldPipes {
public:
    explicit HeldPipes(std::vector<std::filesystem::path> pipes) : waiting_(std::move(pipes)) {}
    ~HeldPipes() { let_go(); }
    HeldPipes(const HeldPipes&) = delete;
    HeldPipes& operator=(const HeldPipes&) = delete;

    /// Holds those that have a reader by now. What cannot be opened is left to who opens it for
    /// writing.
    void look();
    /// Returns once each pipe has had a reader. `give_up`, which may be empty, is asked meanwhile:
    /// true ends the waiting.
    void wait(const std::function<bool()>& give_up);
    /// Who opened them for writing has them.
    void let_go();

private:
    std::vector<std::filesystem::path> waiting_;
    std::vector<int> files_;
};

}  // namespace eventide
