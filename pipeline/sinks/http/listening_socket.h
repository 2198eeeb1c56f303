// A socket that listens.
#pragma once

#include "pipeline/sinks/http/http_address.h"

namespace eventide {

/// Does not block. Sets the address's port to the one it has got. Throws Error: usage for a host
/// that is not known, failed, with the system's words, for one that cannot be looked up now and for
/// a port that cannot be had.
int listen_at(HttpAddress& address);

}  // namespace eventide
