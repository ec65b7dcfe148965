// A queue of requests for edits and files, carried out in order by a thread of its own: a large one
// must not delay Ctrl-C.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "apps/palpate/data_commands.hpp"

namespace palpate::app {

class RequestQueue {
  public:
    explicit RequestQueue(const run::Run& run);
    /// Waits for the request under way and drops the others.
    ~RequestQueue();
    RequestQueue(const RequestQueue&) = delete;
    RequestQueue& operator=(const RequestQueue&) = delete;

    void put(const DataRequest& request, const Snapshot& now);
    struct Message {
        std::string text;
        bool is_problem;
    };
    /// Sentences for the person who asked, since the last call.
    std::vector<Message> messages();
    /// Waits until all are done.
    void finish();
    /// Why a volume could not be written; empty if all could.
    std::string unsaved() const;

  private:
    struct Waiting {
        DataRequest request;
        double isovalue;  // felt when it was asked for
    };
    void work();
    void carry_out_one(const Waiting& waiting);
    void say(const std::string& text, bool is_problem);

    const run::Run& run_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Waiting> waiting_;
    std::vector<Message> messages_;
    std::string unsaved_;
    bool busy_ = false, stop_ = false;
    std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::app
