// GET and HEAD requests over HTTP, many at a time on one thread: kept connections, HTTP/2 where the
// server has it, bounded numbers, retries, cancelling. Private to stream/.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "stream/objects/objects.hpp"

namespace palpate::stream {

struct HttpRequest {
    std::string url;
    std::optional<ByteRange> range = std::nullopt;
    std::uint64_t most = UINT64_MAX;  ///< bytes of the answer, unpacked; more is an error
    bool is_head = false;             ///< HEAD: the size alone
};

struct HttpAnswer {
    long status = 0;  ///< of HTTP; 0 if there was no answer
    Bytes body;       ///< of 200 and 206
    /// [bytes] Of the object that a range or the size was asked of, where the server tells.
    std::optional<std::uint64_t> whole_size = std::nullopt;
    std::string version;    ///< ETag and Last-Modified; empty if the server tells neither
    std::string error;      ///< what went wrong after all attempts; empty: nothing
    bool too_long = false;  ///< an error: there are more bytes than asked for
};

struct HttpLimits {
    int requests = 8;  ///< at a time
    double timeout_s =
        10;            ///< without a byte; a whole request may take as long, and 10 s for each MB
    int attempts = 5;  ///< of one request
};

class HttpClient {
  public:
    virtual ~HttpClient() = default;

    /// Answers in the order of the requests, when all are there. An answer has a body, or a status
    /// of 400 and above, or an error, also if all bodies have more than `most` bytes. Throws
    /// Cancelled at once when `stop` is requested.
    virtual std::vector<HttpAnswer> get(std::span<const HttpRequest> requests, std::stop_token stop,
                                        std::uint64_t most = UINT64_MAX) = 0;
};

/// `traffic` must live as long.
std::unique_ptr<HttpClient> http_client(const HttpLimits& limits, TrafficCount& traffic);

}  // namespace palpate::stream
