// A bridge to 3D Slicer and others by OpenIGTLink. It sends hand, proxy and force, and receives
// volumes and commands. The owner of the run shows it snapshots and carries out its requests. The
// run never waits for it. docs/bridge.md.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#include "bridge/wire.hpp"
#include "palpate/servo.hpp"

struct pollfd;  // poll.h

namespace palpate::bridge {

struct Settings {
    std::string host = "127.0.0.1";
    int port = 18944;     ///< 0, of a server: any that is free
    bool client = false;  ///< connects to a server, again and again, instead of waiting for clients
    WireLimits limits;
};

/// `[HOST:]PORT`. Throws std::invalid_argument.
Settings settings_from(const std::string& text, bool client);
/// Whether only programs of this machine can reach it.
bool is_local(const Settings& settings);

/// What somebody at the other end asked for, and who.
struct WordsAsked {
    std::string text;
};
struct VolumePushed {
    Volume volume;
    std::string name;
};
struct SurfaceAsked {};
struct Request {
    int peer = 0;
    std::variant<WordsAsked, VolumePushed, SurfaceAsked> what;
};

class Bridge {
  public:
    static constexpr std::size_t most_peers = 8;
    static constexpr std::size_t most_requests = 64;  ///< that wait; others are refused

    /// Listens, or starts to connect. Throws std::runtime_error with what is wrong with the
    /// address.
    explicit Bridge(const Settings& settings, Pace pace = Pace::own_thread);
    ~Bridge();
    Bridge(const Bridge&) = delete;
    Bridge& operator=(const Bridge&) = delete;

    int port() const { return port_; }
    /// Exchanges what the network is ready for, without waiting. The thread does so whenever there
    /// is something. A peer for which memory does not suffice is disconnected.
    void step(std::chrono::steady_clock::time_point now);

    // By the owner's thread; none of these waits for the network.

    /// Sends the state to all: poses, force, status. A peer that has not taken the last one yet
    /// misses this one. `with_tool`: a rigid tool is felt, not a point.
    void show(const Snapshot& now, bool with_tool);
    /// Since the last call, in order.
    std::vector<Request> requests();
    /// A sentence for a peer, as a STRING named `PalpateReply`. For one that has gone: nothing.
    void reply(int peer, const std::string& text) { send(peer, "STRING", string_body(text)); }
    /// POLYDATA named `PalpateSurface`. Any thread. Throws std::length_error.
    void send_surface(int peer, const SurfaceMesh& mesh);
    /// What people should know: who came, went or was refused.
    std::vector<std::string> notes();

  private:
    struct Peer;
    struct Outgoing {
        int peer;
        std::string bytes;
    };

    std::vector<pollfd> poll(int milliseconds) const;
    void wake() const;
    void send(int peer, std::string_view type, const std::string& body);
    void note(std::initializer_list<std::string_view> parts) noexcept;
    void accept_peers(int listening);
    void try_to_connect();
    void end_attempt(int error);
    void add_peer(int socket, const std::string& who) noexcept;
    void drop(Peer& peer, std::string_view why) noexcept;
    template <class Work>
    void serve(Peer& peer, Work&& work) noexcept;
    void bound_memory();
    std::uint64_t waiting() const;
    void take_from(Peer& peer);
    void take(Peer& peer, const Received& received);
    void ask(Peer& peer, Request request);
    void hand_out();
    void answer(Peer& peer, const std::string& bytes);
    void flush(Peer& peer) const;
    void drop_the_gone();

    Settings settings_;
    int port_ = 0;
    std::vector<int> listening_;
    int connecting_ = -1, event_ = -1;
    int failures_ = 0;  // of attempts to connect
    bool has_noted_failure_ = false;
    std::chrono::steady_clock::time_point now_, next_try_;
    std::vector<std::unique_ptr<Peer>> peers_;  // the thread's
    int next_peer_ = 1;

    std::atomic<bool> done_{false};
    std::mutex mutex_;                  // of what follows
    std::optional<std::string> frame_;  // the newest state, not handed out yet
    std::vector<Outgoing> outgoing_;
    std::vector<Request> requests_;
    std::vector<std::string> notes_;
    std::thread thread_;  // last: it uses all of the above
};

/// The messages of one state, as show() sends them. `time` [s, since 1970].
std::string frame_of(const Snapshot& now, bool with_tool, double time);

}  // namespace palpate::bridge
