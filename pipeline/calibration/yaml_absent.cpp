// Built in place of yaml_file.cpp where there is no libyaml.
#include "pipeline/calibration/yaml_file.h"

#include "src/core/error.h"

namespace eventide {

const YamlNode* YamlNode::find(std::string_view) const {
    return nullptr;
}

YamlNode read_yaml(const std::filesystem::path& file) {
    throw Error(ErrorKind::usage,
                file.string() +
                    ": this eventide was built without EVENTIDE_CALIBRATION; install libyaml-dev "
                    "(scripts/install-packages.sh does) and build eventide again");
}

}  // namespace eventide
