// Our place in a DDS domain.
#include "pipeline/ros2/participant.h"

#include "src/core/environment.h"
#include "src/core/error.h"

#include <dds/ddsrt/log.h>

#include <mutex>
#include <utility>

namespace eventide {

namespace {

dds_duration_t dds_duration(std::chrono::milliseconds duration) {
    return DDS_MSECS(duration.count());
}

/// What Cyclone says goes to standard error otherwise, past all our own output.
class HeardWords {
public:
    HeardWords() { dds().dds_set_log_sink(hear, this); }
    ~HeardWords() { dds().dds_set_log_sink(nullptr, nullptr); }
    HeardWords(const HeardWords&) = delete;
    HeardWords& operator=(const HeardWords&) = delete;

    /// One line, the first thing said.
    std::string text() {
        const std::lock_guard lock{mutex_};
        return words_.substr(0, words_.find('\n'));
    }

private:
    static void hear(void* self, const dds_log_data_t* data) {
        auto& heard = *static_cast<HeardWords*>(self);
        const std::lock_guard lock{heard.mutex_};
        constexpr std::size_t kMax = 4096;
        if (heard.words_.size() < kMax) heard.words_.append(data->message, data->size);
    }

    std::mutex mutex_;
    std::string words_;
};

std::string with_words(const std::string& doing, const std::string& words) {
    return words.empty() ? doing : doing + " (" + words + ")";
}

}  // namespace

void check_dds(dds_return_t code, const std::string& doing) {
    if (code < 0)
        throw Error(ErrorKind::failed,
                    "Cyclone DDS cannot " + doing + ": " + dds().dds_strretcode(code));
}

DdsEntity::DdsEntity(dds_entity_t handle, const std::string& doing) : handle_{handle} {
    check_dds(handle, doing);
}

DdsEntity::~DdsEntity() {
    if (handle_ > 0) dds().dds_delete(handle_);
}

DdsEntity::DdsEntity(DdsEntity&& other) noexcept : handle_{std::exchange(other.handle_, 0)} {}

DdsEntity& DdsEntity::operator=(DdsEntity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
}

DdsQos make_dds_qos() {
    return {dds().dds_create_qos(), dds().dds_delete_qos};
}

std::shared_ptr<Participant> Participant::join() {
    static std::mutex mutex;
    static std::weak_ptr<Participant> joined;
    const std::lock_guard lock{mutex};
    std::shared_ptr<Participant> participant = joined.lock();
    if (!participant) {
        participant = std::make_shared<Participant>(ros2_environment(environment_value));
        joined = participant;
    }
    return participant;
}

Participant::Participant(Ros2Environment environment) : environment_{std::move(environment)} {
    HeardWords heard;
    const std::string number = std::to_string(environment_.domain);
    const dds_entity_t domain =
        dds().dds_create_domain(environment_.domain, environment_.config.c_str());
    const char* needed = environment_.configured ? ", with what CYCLONEDDS_URI says"
                                                 : ", which takes a network interface that is up";
    domain_ = DdsEntity{
        domain, with_words("set up domain " + number + needed, domain < 0 ? heard.text() : "")};
    const dds_entity_t participant =
        dds().dds_create_participant(environment_.domain, nullptr, nullptr);
    participant_ = DdsEntity{
        participant, with_words("join domain " + number, participant < 0 ? heard.text() : "")};
    warnings_ = heard.text();
}

std::string dds_topic_name(std::string_view ros_name) {
    return "rt" + std::string{ros_name};
}

Ros2Writer::Ros2Writer(std::shared_ptr<Participant> participant, const MessageType& type,
                       const std::string& ros_name)
    : participant_{std::move(participant)},
      name_{ros_name},
      topic_{dds().dds_create_topic(participant_->handle(), &type.descriptor,
                                    dds_topic_name(ros_name).c_str(), nullptr, nullptr),
             "create the topic " + ros_name} {
    const DdsQos qos = make_dds_qos();
    // DDS's default; Cyclone waits for no reader where the history keeps only the last few.
    dds().dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds().dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kDepth);
    dds().dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
    dds().dds_qset_writer_data_lifecycle(qos.get(), false);
    const std::string user_data = "typehash=" + std::string{type.hash} + ";";
    dds().dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
    writer_ =
        DdsEntity{dds().dds_create_writer(participant_->handle(), topic_.get(), qos.get(), nullptr),
                  "create a writer of " + ros_name};
}

int Ros2Writer::readers() const {
    dds_publication_matched_status_t status{};
    check_dds(dds().dds_get_publication_matched_status(writer_.get(), &status),
              "count the readers of " + name_);
    return int(status.current_count);
}

bool Ros2Writer::wait_for_readers(int n, const std::function<bool()>& give_up) {
    const DdsEntity wait{dds().dds_create_waitset(participant_->handle()), "wait for readers"};
    check_dds(dds().dds_set_status_mask(writer_.get(), DDS_PUBLICATION_MATCHED_STATUS),
              "wait for readers");
    check_dds(dds().dds_waitset_attach(wait.get(), writer_.get(), 0), "wait for readers");
    while (readers() < n) {
        if (give_up && give_up()) return false;
        check_dds(dds().dds_waitset_wait(wait.get(), nullptr, 0, DDS_MSECS(100)),
                  "wait for readers");
    }
    return true;
}

void Ros2Writer::write(const void* message) {
    check_dds(dds().dds_write(writer_.get(), message), "write to " + name_);
}

void Ros2Writer::wait_for_readers_to_take_all(std::chrono::milliseconds at_most) {
    // A reader that has stopped is no error of ours.
    static_cast<void>(dds().dds_wait_for_acks(writer_.get(), dds_duration(at_most)));
}

}  // namespace eventide
