// The stand-in: one thread, one connection at a time, and only asynchronous reading, so that it can
// misbehave at any moment.
#include "devices/haply/mock_service.hpp"

// A context here belongs to one thread at a time; the thread sanitizer does not know fences.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include <utility>  // Boost 1.74's Asio forgets it in C++20

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <mutex>
#include <thread>

#include "devices/haply/force_in.hpp"

namespace palpate::support {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using namespace std::chrono_literals;

}  // namespace

struct MockService::Server {
    using Stream = websocket::stream<tcp::socket, false>;

    mutable std::mutex mutex;  // guards the next group
    std::string greeting;
    Answer answer;
    std::size_t messages = 0;
    std::vector<Vec3> forces;

    std::atomic<bool> quit{false}, hang{false}, http{false};
    std::atomic<bool> drop{false}, closed_politely{false};
    std::atomic<int> connections{0};

    asio::io_context context;
    tcp::acceptor acceptor{context, tcp::endpoint(asio::ip::address_v4::loopback(), 0)};
    std::thread thread;

    void run() {
        acceptor.non_blocking(true);
        while (!quit) {
            error_code error;
            tcp::socket socket(context);
            acceptor.accept(socket, error);
            if (error) {
                std::this_thread::sleep_for(1ms);
                continue;
            }
            socket.non_blocking(false);
            serve(std::move(socket));
        }
    }

    void serve(tcp::socket socket) {
        socket.set_option(tcp::no_delay(true));
        drop = false;
        while (hang && !quit && !drop) std::this_thread::sleep_for(1ms);
        if (quit || drop) return;
        error_code error;
        if (http) {
            asio::write(socket, asio::buffer(std::string("HTTP/1.1 404 Not Found\r\n\r\n")), error);
            return;
        }
        Stream stream(std::move(socket));
        stream.accept(error);
        if (error) return;
        ++connections;
        std::string first;
        {
            const std::lock_guard lock(mutex);
            first = greeting;
        }
        if (!first.empty()) stream.write(asio::buffer(first), error);
        if (!error) converse(stream);
    }

    void converse(Stream& stream) {
        boost::beast::flat_buffer incoming;
        std::deque<Reply> due;
        bool reading = false, arrived = false;
        error_code error;
        while (!quit && !drop && !error) {
            if (hang) {
                std::this_thread::sleep_for(1ms);
                continue;
            }
            if (!reading) {
                reading = true;
                stream.async_read(incoming, [&](error_code e, std::size_t) {
                    error = e;
                    arrived = !e;
                });
            }
            context.restart();
            context.run_one_for(1ms);
            if (std::exchange(arrived, false)) {
                const auto bytes = incoming.cdata();
                take({static_cast<const char*>(bytes.data()), bytes.size()}, due);
                incoming.clear();
                reading = false;
            }
            for (; !due.empty() && !error; due.pop_front()) {
                stream.binary(due.front().binary);
                stream.write(asio::buffer(due.front().text), error);
            }
        }
        if (error == websocket::error::closed) closed_politely = true;
        // The read that may be underway refers to what ends here.
        error_code ignored;
        stream.next_layer().close(ignored);
        context.restart();
        context.run();
    }

    void take(const std::string& message, std::deque<Reply>& due) {
        const std::lock_guard lock(mutex);
        ++messages;
        if (const auto force = force_in(message)) forces.push_back(*force);
        if (!answer) return;
        if (auto reply = answer(message)) due.push_back(std::move(*reply));
    }
};

MockService::MockService() : server_(std::make_unique<Server>()) {
    server_->thread = std::thread([this] { server_->run(); });
}

MockService::~MockService() {
    server_->quit = true;
    server_->thread.join();
}

std::uint16_t MockService::port() const {
    return server_->acceptor.local_endpoint().port();
}

void MockService::greet(std::string snapshot) {
    const std::lock_guard lock(server_->mutex);
    server_->greeting = std::move(snapshot);
}
void MockService::answer(Answer answer) {
    const std::lock_guard lock(server_->mutex);
    server_->answer = std::move(answer);
}
void MockService::answer(std::string text) {
    answer([text = std::move(text)](const std::string&) { return Reply{text}; });
}
void MockService::hang(bool on) {
    server_->hang = on;
}
void MockService::speak_http(bool on) {
    server_->http = on;
}
void MockService::drop() {
    server_->drop = true;
}

int MockService::connections() const {
    return server_->connections;
}
bool MockService::closed_politely() const {
    return server_->closed_politely;
}
std::size_t MockService::messages() const {
    const std::lock_guard lock(server_->mutex);
    return server_->messages;
}
std::vector<Vec3> MockService::forces() const {
    const std::lock_guard lock(server_->mutex);
    return server_->forces;
}

}  // namespace palpate::support
