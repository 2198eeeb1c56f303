// Cyclone DDS, loaded when it is first used: a program that has nothing to do with ROS 2 would wait
// 10 ms for it otherwise.
#pragma once

#include <dds/dds.h>

namespace eventide {

// What is used of it.
#define EVENTIDE_DDS_FUNCTIONS(X)         \
    X(dds_create_domain)                  \
    X(dds_create_guardcondition)          \
    X(dds_create_participant)             \
    X(dds_create_qos)                     \
    X(dds_create_reader)                  \
    X(dds_create_topic)                   \
    X(dds_create_waitset)                 \
    X(dds_create_writer)                  \
    X(dds_delete)                         \
    X(dds_delete_qos)                     \
    X(dds_get_matched_publications)       \
    X(dds_get_publication_matched_status) \
    X(dds_qget_reliability)               \
    X(dds_qset_durability)                \
    X(dds_qset_history)                   \
    X(dds_qset_reliability)               \
    X(dds_qset_userdata)                  \
    X(dds_qset_writer_data_lifecycle)     \
    X(dds_read)                           \
    X(dds_return_loan)                    \
    X(dds_set_guardcondition)             \
    X(dds_set_log_sink)                   \
    X(dds_set_status_mask)                \
    X(dds_set_trace_sink)                 \
    X(dds_strretcode)                     \
    X(dds_take)                           \
    X(dds_wait_for_acks)                  \
    X(dds_waitset_attach)                 \
    X(dds_waitset_wait)                   \
    X(dds_write)

/// Each under its own name.
struct DdsLibrary {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a name that is declared stands in none.
#define EVENTIDE_DDS_MEMBER(name) decltype(&::name) name = nullptr;
    EVENTIDE_DDS_FUNCTIONS(EVENTIDE_DDS_MEMBER)
#undef EVENTIDE_DDS_MEMBER
};

/// Loads it the first time. Throws Error (failed) where it is missing, naming the package.
/// Thread: any.
const DdsLibrary& dds();

}  // namespace eventide
