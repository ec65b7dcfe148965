// GET requests over HTTP with libcurl. See the header.
#include "stream/objects/http_client.hpp"

#include <curl/curl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <random>
#include <thread>

#include "io/system/number.hpp"

namespace palpate::stream {
namespace {

using Clock = std::chrono::steady_clock;

/// One request on its way. The thread of the client owns it until `done`; then its caller does.
struct Job {
    HttpRequest request;
    HttpAnswer answer;
    std::shared_ptr<std::uint64_t> left;  // bytes for this answer and those of the same call
    CURL* easy = nullptr;
    int attempts = 0;
    Clock::time_point not_before{};
    std::uint64_t page_bytes = 0;    // of a page that explains an error
    std::uint64_t header_bytes = 0;  // of all answers on the way, with what follows the last body
    bool too_long = false, page_was_cut = false, headers_too_long = false;
    bool cancelled = false;  // under the mutex, as what follows
    bool done = false;
    bool no_memory = false;  // words take memory, too: its caller finds them
};
/// [bytes/s] A server that is slower than this for as long as the timeout does not answer.
constexpr long least_speed = 500;
constexpr const char* no_memory_words = "there is too little memory for its bytes";

std::uint64_t most_of(const HttpRequest& request) {
    return request.range ? std::min(request.range->length, request.most) : request.most;
}

long status_of(CURL* easy) {
    long status = 0;
    curl_easy_getinfo(easy, CURLINFO_RESPONSE_CODE, &status);
    return status;
}

std::string header_of(CURL* easy, const char* name) {
    curl_header* header = nullptr;
    const bool found = curl_easy_header(easy, name, 0, CURLH_HEADER, -1, &header) == CURLHE_OK;
    return found ? header->value : "";
}

/// From the header "Content-Range: bytes 0-63/1000". Nothing for any other form.
struct ContentRange {
    std::uint64_t first = 0, last = 0;
    std::optional<std::uint64_t> whole;  ///< a server may say "*"
};
std::optional<ContentRange> content_range_of(CURL* easy) {
    const std::string text = header_of(easy, "Content-Range");
    const std::size_t space = text.find(' '), dash = text.find('-'), slash = text.find('/');
    if (space == text.npos || dash == text.npos || slash == text.npos || dash < space ||
        slash < dash) {
        return std::nullopt;
    }
    const auto first = io::number_from<std::uint64_t>(text.substr(space + 1, dash - space - 1));
    const auto last = io::number_from<std::uint64_t>(text.substr(dash + 1, slash - dash - 1));
    if (!first || !last || *last < *first || *last == UINT64_MAX) return std::nullopt;
    return ContentRange{*first, *last, io::number_from<std::uint64_t>(text.substr(slash + 1))};
}

/// The problem with the headers of a part. Empty if there is none. Bytes that were not requested
/// would be taken for samples.
std::string problem_with_part(CURL* easy, const ByteRange& range) {
    const std::string encoding = header_of(easy, "Content-Encoding");
    if (!encoding.empty() && encoding != "identity") {
        return "the server compresses what it gives (" + encoding +
               "), so that no parts can be read; copy the store from there";
    }
    const auto given = content_range_of(easy);
    if (!given) return "the server does not say which part it gives";
    const std::uint64_t length = given->last - given->first + 1;
    const bool is_end = !given->whole || given->last + 1 == *given->whole;
    if (length == range.length && (range.from_end ? is_end : given->first == range.offset)) {
        return "";
    }
    return "the server gives bytes " + std::to_string(given->first) + " to " +
           std::to_string(given->last) + ", which were not requested";
}

/// Takes bytes from libcurl. Returning fewer bytes than given ends the transfer.
std::size_t take_body(char* bytes, std::size_t one, std::size_t count, void* of) {
    constexpr std::uint64_t longest_page = std::uint64_t{64} << 10;
    Job& job = *static_cast<Job*>(of);
    const std::size_t size = one * count;
    if (status_of(job.easy) >= 300) {  // a page that explains
        job.page_bytes += size;
        job.page_was_cut = job.page_bytes > longest_page;
        return job.page_was_cut ? 0 : size;
    }
    // A server that ignores the range would send the whole object.
    const bool whole = job.request.range && status_of(job.easy) == 200;
    if (whole || size > std::min(most_of(job.request) - job.answer.body.size(), *job.left)) {
        job.too_long = true;
        return 0;
    }
    const auto* const begin = reinterpret_cast<const std::byte*>(bytes);
    try {  // libcurl is C: nothing may be thrown through it
        job.answer.body.insert(job.answer.body.end(), begin, begin + size);
        *job.left -= size;
    } catch (const std::bad_alloc&) {
        job.no_memory = true;
        return 0;
    }
    return size;
}

/// Counts headers, which libcurl keeps. Those that follow a body have no limit there.
std::size_t take_header(char*, std::size_t one, std::size_t count, void* of) {
    constexpr std::uint64_t most_headers = std::uint64_t{1} << 20;
    Job& job = *static_cast<Job*>(of);
    const std::size_t size = one * count;
    job.header_bytes += size;
    job.headers_too_long = job.header_bytes > most_headers;
    return job.headers_too_long ? 0 : size;
}

bool worth_another_attempt(CURLcode code, long status) {
    switch (code) {
        case CURLE_OK:
            return status == 408 || status == 429 || status >= 500;
        case CURLE_COULDNT_CONNECT:
        case CURLE_COULDNT_RESOLVE_HOST:
        case CURLE_OPERATION_TIMEDOUT:
        case CURLE_PARTIAL_FILE:
        case CURLE_GOT_NOTHING:
        case CURLE_SEND_ERROR:
        case CURLE_RECV_ERROR:
        case CURLE_SSL_CONNECT_ERROR:
        case CURLE_HTTP2:
        case CURLE_HTTP2_STREAM:
            return true;
        default:
            return false;
    }
}

std::string words_of(const Job& job, CURLcode code, long status) {
    if (job.too_long && job.request.range && status == 200) {
        return "the server gives whole files only, no parts of them; copy the store from there";
    }
    if (job.no_memory) return no_memory_words;
    if (job.headers_too_long) return "the server gives headers without end";
    if (job.too_long) return "the server gives more bytes than were requested";
    if (code != CURLE_OK) return curl_easy_strerror(code);
    if (status >= 400) return "the server answers with status " + std::to_string(status);
    return "the server gives fewer bytes than were requested";
}

class CurlClient : public HttpClient {
  public:
    CurlClient(const HttpLimits& limits, TrafficCount& traffic)
        : limits_(limits), traffic_(traffic) {
        static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
        multi_ = curl_multi_init();
        if (ready != CURLE_OK || multi_ == nullptr) throw std::bad_alloc();
        // Memory is reserved now, so that no request can be lost later.
        running_.reserve(static_cast<std::size_t>(limits.requests));
        idle_.reserve(static_cast<std::size_t>(limits.requests));
        curl_multi_setopt(multi_, CURLMOPT_MAX_HOST_CONNECTIONS,
                          static_cast<long>(limits.requests));
        curl_multi_setopt(multi_, CURLMOPT_PIPELINING, static_cast<long>(CURLPIPE_MULTIPLEX));
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }
    ~CurlClient() override {
        thread_.request_stop();
        curl_multi_wakeup(multi_);
        thread_.join();
        for (CURL* easy : idle_) curl_easy_cleanup(easy);
        curl_multi_cleanup(multi_);
    }
    CurlClient(const CurlClient&) = delete;
    CurlClient& operator=(const CurlClient&) = delete;

    std::vector<HttpAnswer> get(std::span<const HttpRequest> requests, std::stop_token stop,
                                std::uint64_t most) override {
        std::vector<std::shared_ptr<Job>> jobs;
        const auto left = std::make_shared<std::uint64_t>(most);
        for (const HttpRequest& request : requests) {
            jobs.push_back(std::make_shared<Job>());
            jobs.back()->request = request;
            jobs.back()->left = left;
        }
        {
            const std::lock_guard lock(mutex_);
            waiting_.insert(waiting_.end(), jobs.begin(), jobs.end());
        }
        curl_multi_wakeup(multi_);
        std::unique_lock lock(mutex_);
        const bool all = finished_.wait(lock, stop, [&] {
            return std::ranges::all_of(jobs, [](const auto& job) { return job->done; });
        });
        if (!all) {
            for (const auto& job : jobs) job->cancelled = true;
            lock.unlock();
            curl_multi_wakeup(multi_);
            throw Cancelled{};
        }
        std::vector<HttpAnswer> answers;
        for (const auto& job : jobs) {
            if (job->no_memory && job->answer.error.empty()) job->answer.error = no_memory_words;
            answers.push_back(std::move(job->answer));
        }
        return answers;
    }

  private:
    void run(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            try {
                step();
            } catch (const std::bad_alloc&) {  // there may be some memory later
            }
            curl_multi_poll(multi_, nullptr, 0, pause_ms(), nullptr);
        }
        for (const auto& job : running_) curl_multi_remove_handle(multi_, job->easy);
        for (const auto& job : running_) curl_easy_cleanup(job->easy);
    }

    void step() {
        drop_cancelled();
        start_some();
        int running = 0;
        curl_multi_perform(multi_, &running);
        int left = 0;
        while (const CURLMsg* const message = curl_multi_info_read(multi_, &left)) {
            if (message->msg == CURLMSG_DONE) finish(message->easy_handle, message->data.result);
        }
    }

    void drop_cancelled() {
        std::vector<std::shared_ptr<Job>> gone;
        {
            const std::lock_guard lock(mutex_);
            std::erase_if(waiting_, [](const auto& job) { return job->cancelled; });
            std::ranges::copy_if(running_, std::back_inserter(gone),
                                 [](const auto& job) { return job->cancelled; });
        }
        for (const auto& job : gone) release(job);
    }

    /// The first ones that may go, as far as there is room.
    void start_some() {
        while (running_.size() < static_cast<std::size_t>(limits_.requests)) {
            const std::shared_ptr<Job> job = next_to_start();
            if (!job) return;
            or_no_memory(job, [&] { start(job); });
        }
    }

    std::shared_ptr<Job> next_to_start() {
        const auto now = Clock::now();
        const std::lock_guard lock(mutex_);
        const auto found =
            std::ranges::find_if(waiting_, [&](const auto& job) { return job->not_before <= now; });
        if (found == waiting_.end()) return nullptr;
        std::shared_ptr<Job> job = std::move(*found);
        waiting_.erase(found);
        return job;
    }

    void start(const std::shared_ptr<Job>& job) {
        if (idle_.empty()) {
            job->easy = curl_easy_init();
            if (job->easy == nullptr) throw std::bad_alloc();
        } else {
            job->easy = idle_.back();
            idle_.pop_back();
        }
        running_.push_back(job);
        ++job->attempts;
        *job->left += job->answer.body.size();
        job->answer = {};
        job->page_bytes = job->header_bytes = 0;
        job->too_long = job->no_memory = job->page_was_cut = job->headers_too_long = false;
        set_up(*job);
        if (curl_multi_add_handle(multi_, job->easy) != CURLM_OK) throw std::bad_alloc();
    }

    /// Does a part of a request. Without memory for that its caller is told so, instead of waiting
    /// for good.
    template <class Work>
    void or_no_memory(const std::shared_ptr<Job>& job, Work&& work) {
        try {
            work();
        } catch (const std::bad_alloc&) {
            if (job->easy != nullptr) release(job);
            job->answer.body = {};
            job->no_memory = true;
            give(job, {});
        }
    }

    void set_up(Job& job) const {
        CURL* const easy = job.easy;
        curl_easy_reset(easy);
        curl_easy_setopt(easy, CURLOPT_URL, job.request.url.c_str());
        curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
        curl_easy_setopt(easy, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
        curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 1L);
        curl_easy_setopt(easy, CURLOPT_MAXREDIRS, 5L);
        curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
        // Looking up a name cannot be stopped: its thread is left alone, not waited for.
        curl_easy_setopt(easy, CURLOPT_QUICK_EXIT, 1L);
        curl_easy_setopt(easy, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_2TLS));
        // Only HTTP/2, which comes with TLS, takes several requests over one connection: waiting
        // for the first answer to see whether it does would cost plain HTTP a round trip.
        if (job.request.url.starts_with("https:")) curl_easy_setopt(easy, CURLOPT_PIPEWAIT, 1L);
        curl_easy_setopt(easy, CURLOPT_USERAGENT, "palpate");
        // Asks for no compression in transfer. Compressed answers are unpacked all the same.
        curl_easy_setopt(easy, CURLOPT_ACCEPT_ENCODING, "");
        curl_easy_setopt(easy, CURLOPT_HTTPHEADER, headers_.get());
        const double bytes =
            static_cast<double>(std::min<std::uint64_t>(most_of(job.request), 1 << 30));
        const double limit_ms = 1e3 * (limits_.timeout_s + 1e-5 * bytes);
        curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, static_cast<long>(limit_ms));
        curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS,
                         static_cast<long>(1e3 * limits_.timeout_s));
        curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, least_speed);
        curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME,
                         std::max(1L, static_cast<long>(std::ceil(limits_.timeout_s))));
        curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, &take_header);
        curl_easy_setopt(easy, CURLOPT_HEADERDATA, &job);
        curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, &take_body);
        curl_easy_setopt(easy, CURLOPT_WRITEDATA, &job);
        if (job.request.is_head) curl_easy_setopt(easy, CURLOPT_NOBODY, 1L);
        if (const auto& range = job.request.range) {
            const std::string text = range->from_end
                                         ? "-" + std::to_string(range->length)
                                         : std::to_string(range->offset) + "-" +
                                               std::to_string(range->offset + range->length - 1);
            curl_easy_setopt(easy, CURLOPT_RANGE, text.c_str());
        }
    }

    void finish(CURL* easy, CURLcode code) {
        const auto found =
            std::ranges::find_if(running_, [&](const auto& job) { return job->easy == easy; });
        const std::shared_ptr<Job> job = *found;
        or_no_memory(job, [&] { finish(job, code); });
    }

    void finish(const std::shared_ptr<Job>& job, CURLcode code) {
        CURL* const easy = job->easy;
        const long status = status_of(easy);
        curl_off_t wait_s = 0;
        curl_easy_getinfo(easy, CURLINFO_RETRY_AFTER, &wait_s);
        job->answer.status = status;
        if (const auto range = content_range_of(easy)) job->answer.whole_size = range->whole;
        curl_off_t length = -1;
        curl_easy_getinfo(easy, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
        const bool is_size = status == 200 && header_of(easy, "Content-Encoding").empty();
        if (job->request.is_head && is_size && length >= 0) {
            job->answer.whole_size = static_cast<std::uint64_t>(length);
        }
        job->answer.too_long = job->too_long && !job->request.range;
        const std::string tag = header_of(easy, "ETag"), time = header_of(easy, "Last-Modified");
        if (!tag.empty() || !time.empty()) job->answer.version = tag + '\n' + time + '\n';
        traffic_.request(job->answer.body.size());
        if (job->page_was_cut) code = CURLE_OK;  // its status says enough
        std::string wrong;
        if (status == 206 && job->request.range) {
            wrong = problem_with_part(easy, *job->request.range);
        }
        const bool complete =
            wrong.empty() && (status >= 400 || !job->request.range ||
                              job->answer.body.size() == job->request.range->length);
        release(job);
        const bool again = worth_another_attempt(code, status) || (code == CURLE_OK && !complete);
        if (!again && code == CURLE_OK) return give(job, "");
        if (again && job->attempts < limits_.attempts)
            return retry(job, static_cast<double>(wait_s));
        give(job, (wrong.empty() ? words_of(*job, code, status) : wrong) +
                      (job->attempts > 1 ? ", after " + std::to_string(job->attempts) + " attempts"
                                         : ""));
    }

    /// Each pause is about twice the one before, by chance between half and one and a half of it,
    /// so that clients that failed together do not come back together.
    void retry(const std::shared_ptr<Job>& job, double asked_s) {
        constexpr double first_s = 0.1, longest_s = 10, longest_asked_s = 30;
        traffic_.retries.fetch_add(1, std::memory_order_relaxed);
        const double chance = std::uniform_real_distribution(0.5, 1.5)(random_);
        const double pause_s =
            std::max(chance * std::min(longest_s, std::ldexp(first_s, job->attempts - 1)),
                     std::min(asked_s, longest_asked_s));
        job->not_before = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                             std::chrono::duration<double>(pause_s));
        const std::lock_guard lock(mutex_);
        waiting_.push_back(job);
    }

    void release(const std::shared_ptr<Job>& job) {
        curl_multi_remove_handle(multi_, job->easy);
        idle_.push_back(job->easy);
        job->easy = nullptr;
        std::erase(running_, job);
    }

    void give(const std::shared_ptr<Job>& job, std::string error) {
        {
            const std::lock_guard lock(mutex_);
            job->answer.error = std::move(error);
            job->done = true;
        }
        finished_.notify_all();
    }

    /// Until the next request may be tried again; new ones wake the thread up.
    int pause_ms() {
        constexpr int longest = 1000;
        const std::lock_guard lock(mutex_);
        int pause = longest;
        if (running_.size() >= static_cast<std::size_t>(limits_.requests)) return pause;
        for (const auto& job : waiting_) {
            const auto left =
                std::chrono::ceil<std::chrono::milliseconds>(job->not_before - Clock::now())
                    .count();
            pause = std::clamp(static_cast<int>(left), 0, pause);
        }
        return pause;
    }

    HttpLimits limits_;
    TrafficCount& traffic_;
    const std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers_{
        curl_slist_append(nullptr, "Accept-Encoding: identity"), &curl_slist_free_all};
    CURLM* multi_ = nullptr;
    std::vector<std::shared_ptr<Job>> running_;  // of the thread alone, as what follows
    std::vector<CURL*> idle_;                    // handles that can be used again
    std::minstd_rand random_{std::random_device{}()};
    std::mutex mutex_;
    std::condition_variable_any finished_;
    std::deque<std::shared_ptr<Job>> waiting_;
    std::jthread thread_;
};

}  // namespace

std::unique_ptr<HttpClient> http_client(const HttpLimits& limits, TrafficCount& traffic) {
    return std::make_unique<CurlClient>(limits, traffic);
}

}  // namespace palpate::stream
