// The live page of a build without cpp-httplib.
#include "pipeline/sinks/http/http_sink.h"
#include "src/core/error.h"

namespace eventide {

std::unique_ptr<HttpSink> open_http(HttpSettings settings) {
    throw Error(ErrorKind::usage,
                "--out http:" + settings.address.host + ":" +
                    std::to_string(settings.address.port) +
                    ": this eventide was built without the live page; install "
                    "libcpp-httplib-dev and build it again with -DEVENTIDE_HTTP=ON");
}

}  // namespace eventide
