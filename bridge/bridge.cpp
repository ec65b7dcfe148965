// Runs the bridge: one loop over all its sockets.
#include "bridge/bridge.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <ctime>

#include "bridge/sockets.hpp"

namespace palpate::bridge {
namespace {

using Time = std::chrono::steady_clock::time_point;

constexpr std::chrono::seconds between_tries{1};  // to connect
constexpr std::chrono::seconds patience{10};      // with a peer that takes nothing
/// While more than this waits for a peer, answers to it are left out; a surface may be longer.
constexpr std::size_t most_waiting = std::size_t{1} << 20;
constexpr std::size_t piece_bytes = std::size_t{1} << 16;  // read at once
constexpr int pieces_a_round = 16;                         // so that one peer cannot hold up others

double wall_time() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

}  // namespace

struct Bridge::Peer {
    int number;
    int socket;
    std::string who;
    Reader reader;
    std::string out;  // what it has not taken yet, from `sent` on
    std::size_t sent = 0;
    Time moved;  // when it last took something
    bool gone = false;

    std::size_t waiting() const { return out.size() - sent; }
    void append(const std::string& bytes, Time now) {
        if (waiting() == 0) moved = now;
        out.erase(0, sent);
        sent = 0;
        out += bytes;
    }
};

Settings settings_from(const std::string& text, bool client) {
    Settings settings;
    settings.client = client;
    const auto colon = text.rfind(':');
    const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
    if (colon != std::string::npos) settings.host = text.substr(0, colon);
    if (settings.host.size() > 2 && settings.host.front() == '[' && settings.host.back() == ']') {
        settings.host = settings.host.substr(1, settings.host.size() - 2);  // [::1]:18944
    }
    const auto [end, error] =
        std::from_chars(port.data(), port.data() + port.size(), settings.port);
    if (error != std::errc() || end != port.data() + port.size() || settings.port > 65535 ||
        settings.port < (client ? 1 : 0) || settings.host.empty()) {
        throw std::invalid_argument("'" + text +
                                    "' is no address for OpenIGTLink: [HOST:]PORT, as in 18944");
    }
    return settings;
}

bool is_local(const Settings& settings) {
    return is_loopback(settings.host);
}

Bridge::Bridge(const Settings& settings, Pace pace) : settings_(settings), port_(settings.port) {
    if (settings_.client) {
        is_loopback(settings_.host);  // throws for a host that there is not
    } else {
        Listening listening = listen_at(settings_.host, settings_.port);
        listening_ = std::move(listening.sockets);
        port_ = listening.port;
    }
    event_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (pace == Pace::by_steps) return;
    thread_ = std::thread([this] {
        while (!done_) {
            try {
                step(std::chrono::steady_clock::now());
                (void)poll(200);
            } catch (const std::exception&) {  // no memory at all: there may be some later
                std::this_thread::sleep_for(between_tries);
            }
        }
    });
}

Bridge::~Bridge() {
    done_ = true;
    wake();
    if (thread_.joinable()) thread_.join();
    for (const auto& peer : peers_) ::close(peer->socket);
    for (const int socket : listening_) ::close(socket);
    for (const int socket : {connecting_, event_}) {
        if (socket >= 0) ::close(socket);
    }
}

void Bridge::wake() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t ignored = ::write(event_, &one, sizeof one);
}

void Bridge::show(const Snapshot& now, bool with_tool) {
    std::string frame = frame_of(now, with_tool, wall_time());
    {
        const std::scoped_lock lock(mutex_);
        frame_ = std::move(frame);
    }
    wake();
}

std::vector<Request> Bridge::requests() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(requests_, {});
}

std::vector<std::string> Bridge::notes() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(notes_, {});
}

void Bridge::note(std::initializer_list<std::string_view> parts) noexcept {
    try {
        std::string text = "OpenIGTLink: ";
        for (const std::string_view part : parts) text += part;
        const std::scoped_lock lock(mutex_);
        if (notes_.size() < most_requests) notes_.push_back(std::move(text));
    } catch (const std::exception&) {  // no memory for words
    }
}

/// Its memory is free at once, its socket at the end of the step.
void Bridge::drop(Peer& peer, std::string_view why) noexcept {
    peer.gone = true;
    peer.reader = Reader(settings_.limits);
    peer.out = {};
    peer.sent = 0;
    note({peer.who, " was disconnected: ", why});
}

/// If work for one peer fails, for example for lack of memory, only that peer is disconnected.
template <class Work>
void Bridge::serve(Peer& peer, Work&& work) noexcept {
    try {
        if (!peer.gone) work();
    } catch (const std::bad_alloc&) {
        drop(peer, "memory does not suffice for its messages and answers");
    } catch (const std::exception& e) {
        drop(peer, e.what());
    }
}

/// The peers that hold most go until the others are within the bound.
void Bridge::bound_memory() {
    const auto held = [](const auto& peer) { return peer->gone ? 0 : peer->reader.held(); };
    while (true) {
        std::uint64_t all = 0;
        for (const auto& peer : peers_) all += held(peer);
        if (all <= settings_.limits.together) return;
        drop(**std::ranges::max_element(peers_, {}, held),
             "all clients together may send " + std::to_string(settings_.limits.together) +
                 " bytes at a time");
    }
}

/// [bytes] Of answers that no peer has taken yet.
std::uint64_t Bridge::waiting() const {
    std::uint64_t all = 0;
    for (const auto& peer : peers_) all += peer->waiting();
    return all;
}

void Bridge::send(int peer, std::string_view type, const std::string& body) {
    const char* const name = type == "POLYDATA" ? "PalpateSurface" : "PalpateReply";
    std::string bytes = message(type, name, body, wall_time());
    {
        const std::scoped_lock lock(mutex_);
        outgoing_.push_back({peer, std::move(bytes)});
    }
    wake();
}

void Bridge::send_surface(int peer, const SurfaceMesh& mesh) {
    send(peer, "POLYDATA", polydata_body(mesh));
}

std::vector<pollfd> Bridge::poll(int milliseconds) const {
    std::vector<pollfd> sockets{{event_, POLLIN, 0}, {connecting_, POLLOUT, 0}};
    for (const auto& peer : peers_) {
        sockets.push_back(
            {peer->socket, static_cast<short>(POLLIN | (peer->waiting() > 0 ? POLLOUT : 0)), 0});
    }
    for (const int socket : listening_) sockets.push_back({socket, POLLIN, 0});
    ::poll(sockets.data(), sockets.size(), milliseconds);
    return sockets;
}

void Bridge::step(Time now) {
    now_ = now;
    try_to_connect();
    const std::vector<pollfd> sockets = poll(0);
    std::uint64_t woken = 0;
    [[maybe_unused]] const ssize_t ignored = ::read(event_, &woken, sizeof woken);
    for (std::size_t i = 0; i < peers_.size(); ++i) {
        if (sockets[i + 2].revents & (POLLIN | POLLHUP | POLLERR)) {
            serve(*peers_[i], [&] { take_from(*peers_[i]); });
        }
    }
    const std::size_t first = sockets.size() - listening_.size();
    for (std::size_t i = 0; i < listening_.size(); ++i) {
        if (sockets[first + i].revents & POLLIN) accept_peers(listening_[i]);
    }
    if (sockets[1].revents != 0) end_attempt(connection_error(connecting_));
    hand_out();
    drop_the_gone();
}

void Bridge::try_to_connect() {
    if (!settings_.client || connecting_ >= 0 || !peers_.empty() || now_ < next_try_) return;
    next_try_ = now_ + between_tries;
    try {
        connecting_ = connect_to(settings_.host, settings_.port, failures_);
        if (connecting_ < 0) end_attempt(errno);
    } catch (const std::runtime_error& e) {
        note({e.what()});
    }
}

/// `error`: an errno, 0 if the server has answered. The next attempt is at the next address.
void Bridge::end_attempt(int error) {
    const std::string who = settings_.host + ":" + std::to_string(settings_.port);
    const int socket = std::exchange(connecting_, -1);
    if (error == 0) {
        has_noted_failure_ = false;
        return add_peer(socket, who);
    }
    if (socket >= 0) ::close(socket);
    ++failures_;
    if (std::exchange(has_noted_failure_, true)) return;
    note({"no server answers at ", who, " (", std::strerror(error), "): trying each second"});
}

void Bridge::accept_peers(int listening) {
    for (int socket = accept_from(listening); socket >= 0; socket = accept_from(listening)) {
        if (peers_.size() == most_peers) {  // some may have left already
            for (const auto& peer : peers_) serve(*peer, [&] { take_from(*peer); });
            drop_the_gone();
        }
        if (peers_.size() < most_peers) {
            add_peer(socket, "client " + std::to_string(next_peer_));
        } else {
            ::close(socket);
            note({"a client was refused: there are ", std::to_string(most_peers), " already"});
        }
    }
}

void Bridge::add_peer(int socket, const std::string& who) noexcept {
    set_prompt(socket);
    try {
        peers_.push_back(std::make_unique<Peer>(
            Peer{next_peer_++, socket, who, Reader(settings_.limits), {}, 0, now_}));
    } catch (const std::bad_alloc&) {
        ::close(socket);
        return;
    }
    note({who, " is connected"});
}

void Bridge::take_from(Peer& peer) {
    std::array<char, piece_bytes> piece;
    std::vector<Received> messages;
    for (int i = 0; i < pieces_a_round; ++i) {
        const ssize_t got = ::recv(peer.socket, piece.data(), piece.size(), 0);
        if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) {
            peer.gone = true;
            note({peer.who, " has left"});
        }
        if (got <= 0) break;
        try {
            peer.reader.feed({piece.data(), static_cast<std::size_t>(got)}, messages);
        } catch (const WireError& e) {
            drop(peer, std::string("it sent ") + e.what());
            break;
        }
        bound_memory();
        if (peer.gone) break;
    }
    for (const Received& received : messages) take(peer, received);
}

void Bridge::take(Peer& peer, const Received& received) {
    const std::string& type = received.type;
    try {
        if (type == "STRING") {
            ask(peer, {peer.number, WordsAsked{text_of(received)}});
        } else if (type == "IMAGE") {
            ask(peer, {peer.number, VolumePushed{volume_of(received), received.name}});
        } else if (type == "GET_POLYDATA") {
            ask(peer, {peer.number, SurfaceAsked{}});
        }  // others, as programs send them unasked, are left alone
    } catch (const WireError& e) {
        note({peer.who, " sent ", e.what()});
        reply(peer.number, std::string("not taken: ") + e.what());
    } catch (const std::bad_alloc&) {
        reply(peer.number, "not taken: there is too little memory for this " + type);
    }
}

void Bridge::ask(Peer& peer, Request request) {
    const bool is_volume = std::holds_alternative<VolumePushed>(request.what);
    {
        const std::scoped_lock lock(mutex_);
        const auto waits = std::ranges::count_if(requests_, [](const Request& other) {
            return std::holds_alternative<VolumePushed>(other.what);
        });
        if (requests_.size() < most_requests && (!is_volume || waits == 0)) {
            requests_.push_back(std::move(request));
            return;
        }
    }
    reply(peer.number, "not taken: too many requests at once");
}

/// Gives every peer what is new for it, and sends as much as it takes.
void Bridge::hand_out() {
    std::optional<std::string> frame;
    std::vector<Outgoing> outgoing;
    {
        const std::scoped_lock lock(mutex_);
        frame = std::exchange(frame_, std::nullopt);
        outgoing = std::exchange(outgoing_, {});
    }
    for (const auto& peer : peers_) {
        serve(*peer, [&] {
            for (const Outgoing& one : outgoing) {
                if (one.peer == peer->number) answer(*peer, one.bytes);
            }
            if (frame && peer->waiting() == 0) peer->append(*frame, now_);
            flush(*peer);
            if (peer->waiting() > 0 && now_ - peer->moved > patience) {
                drop(*peer, "it took nothing for 10 s");
            }
        });
    }
}

void Bridge::answer(Peer& peer, const std::string& bytes) {
    const bool has_room =
        peer.waiting() < most_waiting && waiting() + bytes.size() <= settings_.limits.together;
    if (has_room) return peer.append(bytes, now_);
    note({peer.who, " reads too slowly: an answer was left out"});
}

void Bridge::flush(Peer& peer) const {
    while (peer.waiting() > 0) {
        const ssize_t sent =
            ::send(peer.socket, peer.out.data() + peer.sent, peer.waiting(), MSG_NOSIGNAL);
        if (sent <= 0) return;  // it takes no more now; that it has gone shows in reading
        peer.sent += static_cast<std::size_t>(sent);
        peer.moved = now_;
    }
    peer.out.clear();
    peer.sent = 0;
}

void Bridge::drop_the_gone() {
    std::erase_if(peers_, [](const std::unique_ptr<Peer>& peer) {
        if (peer->gone) ::close(peer->socket);
        return peer->gone;
    });
}

}  // namespace palpate::bridge
