// Part of every test program: tests run beside each other, each in a process of its own, and each
// process gets a temporary folder of its own (TMPDIR, TEST_TMPDIR) that goes with it. So a file of
// a fixed name in testing::TempDir() or std::filesystem::temp_directory_path() is never another
// test's.
#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace {

namespace fs = std::filesystem;

/// Names the folder and the process it belongs to: a device test starts itself again, as the same
/// process. Not an EVENTIDE_ name: the program under test would warn of it.
constexpr const char* kOwner = "TEST_FOLDER_OF";

class OwnTemporaryFolder {
public:
    OwnTemporaryFolder() {
        const char* owner = getenv(kOwner);
        if (owner == nullptr || owner != std::to_string(getpid())) make();
        folder_ = fs::temp_directory_path();
    }
    ~OwnTemporaryFolder() {
        std::error_code ignored;
        // A forked child (a death test) leaves it to its parent.
        if (const char* owner = getenv(kOwner); owner && owner == std::to_string(getpid()))
            fs::remove_all(folder_, ignored);
    }
    OwnTemporaryFolder(const OwnTemporaryFolder&) = delete;
    OwnTemporaryFolder& operator=(const OwnTemporaryFolder&) = delete;

private:
    static void make() {
        // Short: sockets of the test buses live below it, and a socket's path has 107 bytes.
        std::string name = (fs::temp_directory_path() / "evXXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) {
            std::perror(name.c_str());
            std::abort();
        }
        setenv("TMPDIR", name.c_str(), 1);
        setenv("TEST_TMPDIR", name.c_str(), 1);
        setenv(kOwner, std::to_string(getpid()).c_str(), 1);
    }

    fs::path folder_;
};

const OwnTemporaryFolder own_temporary_folder;

}  // namespace
