// Edits and files that a session's attendant was asked for, carried out in order by a thread of
// their own: a large one must not hold up Ctrl-C.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "apps/palpate/data_commands.hpp"

namespace palpate::app {

class Errands {
  public:
    explicit Errands(DataInHand& data);
    /// Waits for the one that is under way; the others are dropped.
    ~Errands();
    Errands(const Errands&) = delete;
    Errands& operator=(const Errands&) = delete;

    void put(const DataRequest& request, const Snapshot& now);
    struct Word {
        std::string text;
        bool is_problem;
    };
    /// Sentences for the person, since the last call.
    std::vector<Word> words();
    /// Waits until all are done.
    void finish();
    /// Why a volume could not be written; empty if all could.
    std::string unsaved() const;

  private:
    struct Errand {
        DataRequest request;
        Snapshot now;
    };
    void run();
    void carry_out_one(const Errand& errand);
    void say(const std::string& text, bool is_problem);

    DataInHand& data_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Errand> waiting_;
    std::vector<Word> words_;
    std::string unsaved_;
    bool busy_ = false, stop_ = false;
    std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::app
