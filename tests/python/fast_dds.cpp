// A node of ROS 2 on eProsima Fast DDS, for ros_test.py. It publishes the messages that it reads
// from standard input, and writes those that it receives, one per line. It shares no code with
// Palpate, and it uses the loopback only.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

namespace {

// Messages in the order of their definitions. each() visits the members.
struct Header {
    std::int32_t sec = 0;
    std::uint32_t nanosec = 0;
    std::string frame;
    void each(auto& visit) { visit(sec), visit(nanosec), visit(frame); }
};

template <std::size_t Count>
struct Stamped {  // PoseStamped, TwistStamped, WrenchStamped
    Header header;
    std::array<double, Count> numbers{};
    void each(auto& visit) {
        visit(header);
        for (double& number : numbers) visit(number);
    }
};

struct JointState {
    Header header;
    std::vector<std::string> names;
    std::vector<double> position, velocity, effort;
    void each(auto& visit) {
        visit(header), visit(names), visit(position), visit(velocity), visit(effort);
    }
};

struct Joy {
    Header header;
    std::vector<float> axes;
    std::vector<std::int32_t> buttons;
    void each(auto& visit) { visit(header), visit(axes), visit(buttons); }
};

struct KeyValue {
    std::string key, value;
    void each(auto& visit) { visit(key), visit(value); }
};

struct Status {
    std::uint8_t level = 0;
    std::string name, message, hardware;
    std::vector<KeyValue> values;
    void each(auto& visit) {
        visit(level), visit(name), visit(message), visit(hardware), visit(values);
    }
};

struct DiagnosticArray {
    Header header;
    std::vector<Status> status;
    void each(auto& visit) { visit(header), visit(status); }
};

/// Passes numbers and strings to `leaf`, and the length of each sequence before its elements.
template <typename Leaf>
struct Visit {
    Leaf leaf;
    template <typename T>
    void operator()(T& value) {
        if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            leaf(value);
        } else {
            value.each(*this);
        }
    }
    template <typename T>
    void operator()(std::vector<T>& values) {
        auto count = static_cast<std::uint32_t>(values.size());
        leaf(count);
        values.resize(count);
        for (T& value : values) (*this)(value);
    }
};

void visit(auto& message, auto leaf) {
    Visit<decltype(leaf)> all{leaf};
    message.each(all);
}

void write(std::ostream& out, auto& message) {
    visit(message, [&](auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
            out << ' ' << std::quoted(value);
        } else {
            out << ' ' << +value;
        }
    });
}

void read(std::istream& in, auto& message) {
    visit(message, [&](auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
            in >> std::quoted(value);
        } else {
            in >> value;
        }
    });
}

template <typename Message>
class Type : public fast::TopicDataType {
  public:
    explicit Type(const std::string& name) { setName(name.c_str()), m_typeSize = 65536; }

    bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
        FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
        cdr.serialize_encapsulation();
        visit(*static_cast<Message*>(data), [&](auto& value) { cdr << value; });
        payload->encapsulation = cdr.endianness() == Cdr::LITTLE_ENDIANNESS ? CDR_LE : CDR_BE;
        payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
        return true;
    }
    bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
        FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
        cdr.read_encapsulation();
        visit(*static_cast<Message*>(data), [&](auto& value) { cdr >> value; });
        return true;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
        return [this] { return m_typeSize; };
    }
    void* createData() override { return new Message; }
    void deleteData(void* data) override { delete static_cast<Message*>(data); }
    bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

void say(const std::string& line) {
    static std::mutex one;
    const std::lock_guard lock(one);
    std::cout << line << std::endl;
}

/// A publisher or a subscriber of a topic with the quality of service that ROS 2 has by default.
class Endpoint : public fast::DataWriterListener, public fast::DataReaderListener {
  public:
    virtual void publish(std::istream&) = 0;
};

template <typename Message>
class Of : public Endpoint {
  public:
    Of(fast::DomainParticipant& node, std::string name, const std::string& type, bool publishes)
        : node_(node), name_(std::move(name)) {
        fast::TypeSupport support(new Type<Message>(type));
        support.register_type(&node);
        topic_ = node.create_topic("rt" + name_, type, fast::TOPIC_QOS_DEFAULT);
        if (publishes) {
            publisher_ = node.create_publisher(fast::PUBLISHER_QOS_DEFAULT);
            fast::DataWriterQos qos;
            qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
            qos.history().depth = 10;
            writer_ = publisher_->create_datawriter(topic_, qos, this);
        } else {
            subscriber_ = node.create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
            fast::DataReaderQos qos;
            qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
            qos.history().depth = 10;
            reader_ = subscriber_->create_datareader(topic_, qos, this);
        }
    }
    ~Of() override {
        if (publisher_) publisher_->delete_datawriter(writer_), node_.delete_publisher(publisher_);
        if (subscriber_)
            subscriber_->delete_datareader(reader_), node_.delete_subscriber(subscriber_);
        node_.delete_topic(topic_);
    }
    void publish(std::istream& in) override {
        Message message;
        read(in, message);
        if (in) writer_->write(&message);
    }
    void on_data_available(fast::DataReader* reader) override {
        Message message;
        fast::SampleInfo info;
        while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
            std::ostringstream line;
            line.precision(std::numeric_limits<double>::max_digits10);
            line << "message " << name_;
            write(line, message);
            if (info.valid_data) say(line.str());
        }
    }
    void on_publication_matched(fast::DataWriter*,
                                const fast::PublicationMatchedStatus& s) override {
        say("matched " + name_ + ' ' + std::to_string(s.current_count));
    }
    void on_subscription_matched(fast::DataReader*,
                                 const fast::SubscriptionMatchedStatus& s) override {
        say("matched " + name_ + ' ' + std::to_string(s.current_count));
    }

  private:
    fast::DomainParticipant& node_;
    std::string name_;
    fast::Topic* topic_ = nullptr;
    fast::Publisher* publisher_ = nullptr;
    fast::Subscriber* subscriber_ = nullptr;
    fast::DataWriter* writer_ = nullptr;
    fast::DataReader* reader_ = nullptr;
};

fast::DomainParticipant& node_on_loopback(std::uint32_t domain) {
    fast::DomainParticipantQos qos;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->maxInitialPeersRange = 32;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    rtps::Locator_t loopback;
    rtps::IPLocator::setIPv4(loopback, 127, 0, 0, 1);
    qos.wire_protocol().builtin.initialPeersList.push_back(loopback);
    return *fast::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    fast::DomainParticipant& node =
        node_on_loopback(static_cast<std::uint32_t>(std::atoi(argv[1])));
    std::map<std::string, std::unique_ptr<Endpoint>> endpoints;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::istringstream in(line);
        std::string what, name, kind;
        in >> what >> name;
        if (what == "message") {
            endpoints.at(name)->publish(in);
        } else if (what == "end") {
            endpoints.erase(name);
        } else {  // publish, subscribe
            in >> kind;
            const auto make = [&]<typename Message>(const std::string& folder) {
                endpoints[name] = std::make_unique<Of<Message>>(
                    node, name, folder + "_msgs::msg::dds_::" + kind + "_", what == "publish");
            };
            if (kind == "PoseStamped") make.operator()<Stamped<7>>("geometry");
            if (kind == "TwistStamped" || kind == "WrenchStamped")
                make.operator()<Stamped<6>>("geometry");
            if (kind == "JointState") make.operator()<JointState>("sensor");
            if (kind == "Joy") make.operator()<Joy>("sensor");
            if (kind == "DiagnosticArray") make.operator()<DiagnosticArray>("diagnostic");
        }
    }
    endpoints.clear();
    node.delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(&node);
}
