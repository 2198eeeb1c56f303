// Naming model files.
#include "apps/cli/settings/model_path.h"

#include "src/core/error.h"

namespace eventide::app {

std::filesystem::path found_model(const std::string& name) {
    try {
        return find_model(name);
    } catch (const Error&) {
        return {};
    }
}

}  // namespace eventide::app
