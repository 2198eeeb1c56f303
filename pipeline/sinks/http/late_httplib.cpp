// cpp-httplib, loaded when the first page is opened: it brings OpenSSL and Brotli with it, of which
// a run without a page has nothing. Its headers are compiled as usual; the functions of the library
// that are called are defined here, and go on to it.
#include "src/io/late_library.h"

#include <httplib.h>

#include <string>
#include <utility>

namespace httplib {

namespace {

using eventide::LateLibrary;
using Text = std::string;
using Finished = std::function<void(bool)>;

/// As the library has them; members take the object first.
struct Library {
    bool (*process_request)(Server*, Stream&, bool, bool&, const std::function<void(Request&)>&);
    Server& (*set_payload_max_length)(Server*, std::size_t);
    Server& (*set_pre_routing_handler)(Server*, Server::HandlerWithResponse);
    Server& (*post)(Server*, const Text&, Server::Handler);
    void (*set_header)(Response*, const Text&, const Text&);
    void (*set_content)(Response*, const Text&, const Text&);
    void (*set_content_provider)(Response*, const Text&, ContentProviderWithoutLength, Finished);
    void (*set_chunked)(Response*, const Text&, ContentProviderWithoutLength, Finished);
    Text (*param_value)(const Request*, const Text&, std::size_t);
    Text (*header_value)(const Request*, const Text&, std::size_t);
    std::size_t (*header_count)(const Request*, const Text&);
    bool (*has_param)(const Request*, const Text&);

    Library() {
        const LateLibrary library{EVENTIDE_HTTPLIB, "--out http:", "libcpp-httplib0.11"};
#define EVENTIDE_TEXT "RKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
#define EVENTIDE_PROVIDER "St8functionIFbmRNS_8DataSinkEEES9_IFvbEE"
        library.find(process_request,
                     "_ZN7httplib6Server15process_requestERNS_6StreamEbRbRKSt8functionIFvRNS_"
                     "7RequestEEE");
        library.find(set_payload_max_length, "_ZN7httplib6Server22set_payload_max_lengthEm");
        library.find(set_pre_routing_handler,
                     "_ZN7httplib6Server23set_pre_routing_handlerESt8functionIFNS0_"
                     "15HandlerResponseERKNS_7RequestERNS_8ResponseEEE");
        library.find(post, "_ZN7httplib6Server4PostE" EVENTIDE_TEXT
                           "St8functionIFvRKNS_7RequestERNS_8ResponseEEE");
        library.find(set_header, "_ZN7httplib8Response10set_headerE" EVENTIDE_TEXT "S8_");
        library.find(set_content, "_ZN7httplib8Response11set_contentE" EVENTIDE_TEXT "S8_");
        library.find(set_content_provider, "_ZN7httplib8Response20set_content_providerE"  //
                     EVENTIDE_TEXT EVENTIDE_PROVIDER);
        library.find(set_chunked, "_ZN7httplib8Response28set_chunked_content_providerE"  //
                     EVENTIDE_TEXT EVENTIDE_PROVIDER);
        library.find(param_value, "_ZNK7httplib7Request15get_param_valueE" EVENTIDE_TEXT "m");
        library.find(header_value, "_ZNK7httplib7Request16get_header_valueE" EVENTIDE_TEXT "m");
        library.find(header_count, "_ZNK7httplib7Request22get_header_value_countE" EVENTIDE_TEXT);
        library.find(has_param, "_ZNK7httplib7Request9has_paramE" EVENTIDE_TEXT);
#undef EVENTIDE_PROVIDER
#undef EVENTIDE_TEXT
    }
};

const Library& library() {
    static const Library loaded;
    return loaded;
}

}  // namespace

/// Throws eventide::Error (failed) where the library is not there. Its own constructor prepares
/// sockets and a pool of threads, which are ours here (http_server.h).
Server::Server() {
    static_cast<void>(library());
}
Server::~Server() = default;
bool Server::is_valid() const {
    return true;
}
bool Server::process_and_close_socket(socket_t) {
    return false;  // of connections that it accepts itself
}
bool Server::process_request(Stream& stream, bool close, bool& closed,
                             const std::function<void(Request&)>& prepare) {
    return library().process_request(this, stream, close, closed, prepare);
}
Server& Server::set_payload_max_length(std::size_t length) {
    return library().set_payload_max_length(this, length);
}
Server& Server::set_pre_routing_handler(HandlerWithResponse handler) {
    return library().set_pre_routing_handler(this, std::move(handler));
}
Server& Server::Post(const std::string& pattern, Handler handler) {
    return library().post(this, pattern, std::move(handler));
}

void Response::set_header(const std::string& key, const std::string& value) {
    library().set_header(this, key, value);
}
void Response::set_content(const std::string& content, const std::string& type) {
    library().set_content(this, content, type);
}
void Response::set_content_provider(const std::string& type, ContentProviderWithoutLength provider,
                                    ContentProviderResourceReleaser finished) {
    library().set_content_provider(this, type, std::move(provider), std::move(finished));
}
void Response::set_chunked_content_provider(const std::string& type,
                                            ContentProviderWithoutLength provider,
                                            ContentProviderResourceReleaser finished) {
    library().set_chunked(this, type, std::move(provider), std::move(finished));
}

std::string Request::get_param_value(const std::string& key, std::size_t id) const {
    return library().param_value(this, key, id);
}
std::string Request::get_header_value(const std::string& key, std::size_t id) const {
    return library().header_value(this, key, id);
}
std::size_t Request::get_header_value_count(const std::string& key) const {
    return library().header_count(this, key);
}
bool Request::has_param(const std::string& key) const {
    return library().has_param(this, key);
}

}  // namespace httplib
