// Events in the layouts of HDF5 that are read, as their programs write them.
#pragma once

#include "src/core/event.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide::test {

/// us, in DSEC's file beside the times.
constexpr std::int64_t kDsecOffset = 49'599'523;

void write_dsec(const std::string& path, const std::vector<Event>& events);
void write_m3ed(const std::string& path, const std::vector<Event>& events);
void write_mvsec(const std::string& path, const std::vector<Event>& events);
void write_prophesee(const std::string& path, const std::vector<Event>& events);
void write_event_utils(const std::string& path, const std::vector<Event>& events);
void write_e2calib(const std::string& path, const std::vector<Event>& events);
/// What eventide itself writes.
void write_hdf5(const std::string& path, const std::vector<Event>& events);

}  // namespace eventide::test
