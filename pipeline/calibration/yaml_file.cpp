// libyaml's documents as a tree.
#include "pipeline/calibration/yaml_file.h"

#include "src/core/error.h"
#include "src/io/input_file.h"

#include <yaml.h>

#include <cstring>
#include <memory>

namespace eventide {

namespace {

constexpr std::size_t kMaxNodes = 10'000, kMaxLevels = 32;

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t line,
                         const std::string& what) {
    throw Error(ErrorKind::input, file.string() + ":" + std::to_string(line) + ": " + what);
}

/// An alias is the same node once more, and may hold itself: the limits are of what is made.
class TreeMaker {
public:
    TreeMaker(const std::filesystem::path& file, yaml_document_t& document)
        : file_{file}, document_{document} {}

    YamlNode make(const yaml_node_t& from, std::size_t level = 0) {
        YamlNode node;
        node.line = from.start_mark.line + 1;
        if (++made_ > kMaxNodes || level > kMaxLevels)
            refuse(file_, node.line,
                   "expected at most " + std::to_string(kMaxNodes) + " nodes and " +
                       std::to_string(kMaxLevels) + " levels, found more");
        switch (from.type) {
            case YAML_SEQUENCE_NODE:
                node.kind = YamlNode::Kind::list;
                for (auto* item = from.data.sequence.items.start;
                     item != from.data.sequence.items.top; ++item)
                    node.items.push_back(make(at(*item), level + 1));
                break;
            case YAML_MAPPING_NODE:
                node.kind = YamlNode::Kind::map;
                for (auto* pair = from.data.mapping.pairs.start;
                     pair != from.data.mapping.pairs.top; ++pair) {
                    node.keys.push_back(make(at(pair->key), level + 1).text);
                    node.items.push_back(make(at(pair->value), level + 1));
                }
                break;
            default:
                node.text.assign(reinterpret_cast<const char*>(from.data.scalar.value),
                                 from.data.scalar.length);
        }
        return node;
    }

private:
    const yaml_node_t& at(int index) { return *yaml_document_get_node(&document_, index); }

    const std::filesystem::path& file_;
    yaml_document_t& document_;
    std::size_t made_ = 0;
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (keys[i] == key) return &items[i];
    return nullptr;
}

YamlNode read_yaml(const std::filesystem::path& file) {
    const std::string text = read_text_file(file);
    yaml_parser_t parser;
    if (yaml_parser_initialize(&parser) == 0)
        throw Error(ErrorKind::failed, file.string() + ": no memory to read it");
    const std::unique_ptr<yaml_parser_t, void (*)(yaml_parser_t*)> parser_end{&parser,
                                                                              yaml_parser_delete};
    yaml_parser_set_input_string(&parser, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
    yaml_document_t document;
    if (yaml_parser_load(&parser, &document) == 0)
        refuse(file, parser.problem_mark.line + 1,
               parser.problem == nullptr ? "expected YAML" : parser.problem);
    const std::unique_ptr<yaml_document_t, void (*)(yaml_document_t*)> document_end{
        &document, yaml_document_delete};
    const yaml_node_t* root = yaml_document_get_root_node(&document);
    if (root == nullptr) refuse(file, 1, "expected YAML, found nothing");
    return TreeMaker{file, document}.make(*root);
}

}  // namespace eventide
