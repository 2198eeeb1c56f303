// Whether an AEDAT4 file's header and its packets agree on what streams there are, and whether it
// is one file.
#pragma once

#include "replay/stream/byte_file.h"
#include "src/codec/aedat4/aedat4_header.h"

#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// Walks from packet to packet without unpacking more than the first of each stream. A sentence for
/// people per stream that the packets have and the header does not, or that the header calls by
/// another kind; then also for those that have no packets. Empty where they agree, and for what
/// lies behind damage.
std::vector<std::string> compare_aedat4_streams(const ByteFile& file, const Aedat4Header& header);

/// A file ends with its table: another that was joined behind it is not read, which this says.
/// Empty where there is none.
std::optional<std::string> find_joined_aedat4(const ByteFile& file, const Aedat4Header& header);

}  // namespace eventide
