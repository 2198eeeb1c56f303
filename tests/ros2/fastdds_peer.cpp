// A node of the second vendor, Fast DDS, which most users of ROS 2 run. The type is registered by
// hand: it is the bytes.
//   fastdds-peer listen TOPIC reliable|best_effort    prints a line for each image (topics.h)
//   fastdds-peer publish TOPIC FILE                   publishes FILE, an EventPacket in CDR, when a
//   reader has come,
//                                                     and stays until it has gone
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace eprosima::fastdds::dds;
using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kMaxBytes = 8 << 20;

class RawType final : public TopicDataType {
public:
    explicit RawType(const char* name) {
        setName(name);
        m_typeSize = kMaxBytes;
        m_isGetKeyDefined = false;
    }
    bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
        const Bytes& bytes = *static_cast<Bytes*>(data);
        std::memcpy(payload->data, bytes.data(), bytes.size());
        payload->length = std::uint32_t(bytes.size());
        payload->encapsulation = CDR_LE;
        return true;
    }
    bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
        static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
        return true;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
        return [data] { return std::uint32_t(static_cast<Bytes*>(data)->size()); };
    }
    void* createData() override { return new Bytes; }
    void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
    bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

/// On loopback alone, asking at the ports that Cyclone's participants have.
DomainParticipant* join(unsigned domain) {
    DomainParticipantQos qos;
    // As Fast DDS does by itself: multicast, on all networks.
    if (std::getenv("FASTDDS_PEER_ON_NETWORK") != nullptr)
        return DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    qos.transport().use_builtin_transports = false;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->receiveBufferSize = udp->sendBufferSize = 4 << 20;
    qos.transport().user_transports.push_back(udp);
    for (unsigned i = 0; i < 60; ++i) {
        eprosima::fastrtps::rtps::Locator_t locator;
        eprosima::fastrtps::rtps::IPLocator::setIPv4(locator, 127, 0, 0, 1);
        locator.port = 7400 + 250 * domain + 10 + 2 * i;
        qos.wire_protocol().builtin.initialPeersList.push_back(locator);
    }
    return DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

unsigned long long digest(const Bytes& bytes) {
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (std::size_t i = 4; i < bytes.size(); ++i) hash = (hash ^ bytes[i]) * 0x100000001B3U;
    return hash;
}

int listen(DomainParticipant& participant, const std::string& topic_name, bool reliable) {
    TypeSupport type(new RawType("sensor_msgs::msg::dds_::Image_"));
    type.register_type(&participant);
    Topic* topic = participant.create_topic(topic_name, type.get_type_name(), TOPIC_QOS_DEFAULT);
    Subscriber* subscriber = participant.create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    DataReader* reader = subscriber->create_datareader(topic, qos);
    SubscriptionMatchedStatus status;
    for (reader->get_subscription_matched_status(status); status.current_count == 0;
         reader->get_subscription_matched_status(status))
        usleep(1000);
    std::printf("%s\n", std::string(33, '-').c_str());
    std::fflush(stdout);
    Bytes bytes;
    SampleInfo info;
    while (reader->wait_for_unread_message({60, 0})) {
        if (reader->take_next_sample(&bytes, &info) != ReturnCode_t::RETCODE_OK || !info.valid_data)
            continue;
        std::int32_t sec = 0;
        std::uint32_t nanosec = 0;
        std::memcpy(&sec, bytes.data() + 4, 4);
        std::memcpy(&nanosec, bytes.data() + 8, 4);
        std::printf("%016llx %016llx\n",
                    static_cast<unsigned long long>(sec) * 1'000'000 + nanosec / 1000,
                    digest(bytes));
        if (std::fflush(stdout) != 0) return 0;
    }
    return 1;
}

void wait_for_readers(DataWriter& writer, int n) {
    PublicationMatchedStatus status;
    for (writer.get_publication_matched_status(status); status.current_count != n;
         writer.get_publication_matched_status(status))
        usleep(1000);
}

int publish(DomainParticipant& participant, const std::string& topic_name,
            const std::string& file) {
    std::ifstream stream{file, std::ios::binary};
    Bytes bytes{std::istreambuf_iterator<char>{stream}, {}};
    TypeSupport type(new RawType("event_camera_msgs::msg::dds_::EventPacket_"));
    type.register_type(&participant);
    Topic* topic = participant.create_topic(topic_name, type.get_type_name(), TOPIC_QOS_DEFAULT);
    Publisher* publisher = participant.create_publisher(PUBLISHER_QOS_DEFAULT);
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    DataWriter* writer = publisher->create_datawriter(topic, qos);
    wait_for_readers(*writer, 1);
    writer->write(&bytes);
    wait_for_readers(*writer, 0);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) return 2;
    DomainParticipant* participant = join(unsigned(std::atoi(std::getenv("ROS_DOMAIN_ID"))));
    if (participant == nullptr) return 3;
    const std::string topic = "rt" + std::string{argv[2]};
    if (std::string{argv[1]} == "listen")
        return listen(*participant, topic, std::string{argv[3]} == "reliable");
    return publish(*participant, topic, argv[3]);
}
