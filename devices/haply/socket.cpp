// Boost.Beast, all of it that Palpate uses. Its operations are asynchronous, because only those can
// be given up at a deadline; a call here runs them until it has what it waits for.
#include "devices/haply/socket.hpp"

// A context here belongs to one thread at a time; the thread sanitizer does not know fences.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include <utility>  // Boost 1.74's Asio forgets it in C++20

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstddef>

namespace palpate::devices::haply {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using TcpSocket = asio::basic_stream_socket<tcp, asio::io_context::executor_type>;

/// Memory of the one write underway: a stack that is empty again when the write is done. Sending
/// must not wait for the heap, whose lock a crashed thread may hold.
class WriteMemory {
  public:
    void* take(std::size_t size) {
        size = (size + alignof(std::max_align_t) - 1) / alignof(std::max_align_t) *
               alignof(std::max_align_t);
        if (used_ + size > bytes_.size()) return ::operator new(size);
        void* place = bytes_.data() + used_;
        used_ += size;
        ++taken_;
        return place;
    }
    void give_back(void* place) noexcept {
        const auto* byte = static_cast<const std::byte*>(place);
        if (byte < bytes_.data() || byte >= bytes_.data() + bytes_.size()) {
            ::operator delete(place);
        } else if (--taken_ == 0) {
            used_ = 0;
        }
    }

  private:
    alignas(std::max_align_t) std::array<std::byte, 8192> bytes_{};
    std::size_t used_ = 0;
    int taken_ = 0;
};

template <class T>
struct WriteAllocator {
    using value_type = T;
    WriteMemory* memory;
    explicit WriteAllocator(WriteMemory* its_memory) : memory(its_memory) {}
    template <class U>
    WriteAllocator(const WriteAllocator<U>& other) : memory(other.memory) {}
    T* allocate(std::size_t count) { return static_cast<T*>(memory->take(count * sizeof(T))); }
    void deallocate(T* place, std::size_t) noexcept { memory->give_back(place); }
    template <class U>
    bool operator==(const WriteAllocator<U>& other) const {
        return memory == other.memory;
    }
};

/// How an operation ended, once it has.
struct Outcome {
    bool done = false;
    error_code error;
};

struct WriteHandler {
    using allocator_type = WriteAllocator<std::byte>;
    Outcome* outcome;
    WriteMemory* memory;
    allocator_type get_allocator() const noexcept { return allocator_type(memory); }
    void operator()(error_code error, std::size_t) const { *outcome = {true, error}; }
};

}  // namespace

/// Everything of one connection. What the operations refer to comes first, so that it outlives
/// them.
struct Socket::Connection {
    WriteMemory write_memory;
    Outcome read, written, other;
    boost::beast::flat_buffer incoming;
    asio::io_context context{1};
    websocket::stream<TcpSocket, false> stream{context};
    bool reading = false;

    /// True if the operation ended by the deadline.
    bool run(const Outcome& outcome, Clock::time_point deadline) {
        context.restart();
        while (!outcome.done && context.run_one_until(deadline) > 0) {
        }
        while (!outcome.done && context.poll_one() > 0) {
        }
        return outcome.done;
    }

    std::string connect_to(const tcp::endpoint& endpoint, Clock::time_point deadline) {
        other = {};
        TcpSocket& socket = stream.next_layer();
        error_code ignored;
        socket.close(ignored);
        socket.async_connect(endpoint, [this](error_code error) { other = {true, error}; });
        if (!run(other, deadline)) return "no answer";
        if (other.error) return other.error.message();
        socket.set_option(tcp::no_delay(true), ignored);
        return {};
    }

    std::string shake_hands(const Address& address, Clock::time_point deadline) {
        const bool colons = address.host.find(':') != std::string::npos;
        const std::string host =
            (colons ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
        other = {};
        stream.async_handshake(host, "/", [this](error_code error) { other = {true, error}; });
        if (!run(other, deadline)) return "it does not answer as a WebSocket";
        return other.error ? "it is no WebSocket (" + other.error.message() + ")" : std::string{};
    }
};

Address look_up(const std::string& host, std::uint16_t port) {
    Address address{host, port, {}};
    if (host == "localhost") {  // everywhere, also where no file says so (RFC 6761)
        address.numeric = {asio::ip::address_v4::loopback().to_string(),
                           asio::ip::address_v6::loopback().to_string()};
        return address;
    }
    asio::io_context context;
    tcp::resolver resolver(context);
    error_code error;
    for (const auto& entry : resolver.resolve(host, std::to_string(port), error)) {
        address.numeric.push_back(entry.endpoint().address().to_string());
    }
    return address;
}

Socket::Socket(std::size_t longest_message) : longest_message_(longest_message) {}
Socket::~Socket() = default;

void Socket::drop() noexcept {
    connection_.reset();
}

void Socket::fail(const std::string& what) {
    error_ = what;
    connection_.reset();
}

bool Socket::connect(const Address& address, Clock::time_point deadline) {
    fail("no such host");
    auto left = static_cast<int>(address.numeric.size());
    for (const std::string& numeric : address.numeric) {
        const auto now = Clock::now();
        const auto until = now + (deadline - now) / left--;
        try {
            const auto ip = asio::ip::make_address(numeric);
            connection_ = std::make_unique<Connection>();
            error_ = connection_->connect_to({ip, address.port}, until);
            if (error_.empty()) error_ = connection_->shake_hands(address, until);
        } catch (const boost::system::system_error& error) {
            error_ = error.what();
        }
        if (!error_.empty()) continue;
        connection_->stream.read_message_max(longest_message_);
        connection_->stream.auto_fragment(false);
        connection_->stream.text(true);
        return true;
    }
    connection_.reset();
    return false;
}

bool Socket::send(std::string_view message, Clock::time_point deadline) {
    if (!connection_) return false;
    Connection& c = *connection_;
    c.written = {};
    c.stream.async_write(asio::const_buffer(message.data(), message.size()),
                         WriteHandler{&c.written, &c.write_memory});
    if (c.run(c.written, deadline) && !c.written.error) return true;
    fail(c.written.done ? c.written.error.message() : "it takes no messages");
    return false;
}

Received Socket::receive(Clock::time_point deadline) {
    if (!connection_) return {Received::What::closed, false, {}};
    Connection& c = *connection_;
    if (!c.reading) {
        c.incoming.clear();
        c.read = {};
        c.reading = true;
        c.stream.async_read(c.incoming, [&c](error_code error, std::size_t) {
            c.read = {true, error};
        });
    }
    if (!c.run(c.read, deadline)) return {};
    c.reading = false;
    if (c.read.error) {
        fail(c.read.error == websocket::error::message_too_big ? "it sent more than 1 MB at once"
                                                               : c.read.error.message());
        return {Received::What::closed, false, {}};
    }
    const auto bytes = c.incoming.cdata();
    return {Received::What::message,
            c.stream.got_binary(),
            {static_cast<const char*>(bytes.data()), bytes.size()}};
}

void Socket::close(Clock::time_point deadline) {
    if (!connection_) return;
    Connection& c = *connection_;
    c.other = {};
    c.stream.async_close(websocket::close_code::normal, [&c](error_code error) {
        c.other = {true, error};
    });
    c.run(c.other, deadline);
    connection_.reset();
}

}  // namespace palpate::devices::haply
