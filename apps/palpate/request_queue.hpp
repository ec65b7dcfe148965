// A queue of requests for edits and files, carried out in order by a thread of its own: a large one
// must not delay Ctrl-C.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace palpate::app {

/// Returns a sentence for the person who asked, or nothing. What it throws is reported, except for
/// io::Cancelled, once `stop` is requested.
using Work = std::function<std::string(const std::stop_token& stop)>;

/// The destructor is as end().
class RequestQueue {
  public:
    RequestQueue() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

    /// `is_scripted`: problem() tells if it fails. A person sees the message.
    void put(Work work, bool is_scripted = false);
    struct Message {
        std::string text;
        bool is_problem;
    };
    /// Sentences for the person who asked, since the last call.
    std::vector<Message> messages();
    /// Waits until all is done, or for Ctrl-C.
    void finish();
    /// Stops the work under way, waits for its end and drops the rest.
    void end();
    /// Why a volume could not be written, or something scripted could not be done; empty if all
    /// could.
    std::string problem() const;

  private:
    void run(const std::stop_token& stop);
    struct Waiting {
        Work work;
        bool is_scripted;
    };
    void do_one(const Waiting& one, const std::stop_token& stop);
    void say(const std::string& text, bool is_problem);

    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Waiting> waiting_;
    std::vector<Message> messages_;
    std::string problem_;
    bool busy_ = false;
    std::jthread thread_;  // last: it uses all of the above
};

}  // namespace palpate::app
