// Objects behind http://, https:// and s3:// addresses.
#include <array>
#include <atomic>
#include <cctype>
#include <map>
#include <mutex>

#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "stream/objects/http_client.hpp"
#include "stream/objects/remote_objects.hpp"

namespace palpate::stream {
namespace {

/// A key in a URL, all characters escaped but those that stay.
std::string escaped(const std::string& key, bool (*stays)(char c)) {
    static constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (const char c : key) {
        const auto byte = static_cast<unsigned char>(c);
        if (stays(c)) {
            text += c;
        } else {
            text += {'%', digits[byte >> 4], digits[byte & 15]};
        }
    }
    return text;
}

bool stays_for_servers(char c) {
    constexpr std::string_view plain = "-._~/";
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || plain.find(c) != plain.npos;
}

/// The others would end the name, or stand for another character.
bool stays_for_people(char c) {
    return c != '?' && c != '#' && c != '%';
}

constexpr std::string_view s3 = "s3://";  // in letters of any case; the other schemes are longer

/// A bucket with dots has no certificate of its own.
std::string url_of_s3(const std::string& address) {
    const std::string rest = address.substr(s3.size());
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string bucket = rest.substr(0, slash), key = rest.substr(slash);
    if (bucket.empty()) {
        throw io::InputError(address + ": has no bucket; the form is s3://BUCKET/KEY");
    }
    if (bucket.find('.') != std::string::npos) return "https://s3.amazonaws.com/" + bucket + key;
    return "https://" + bucket + ".s3.amazonaws.com" + key;
}

class HttpObjects : public Objects {
  public:
    HttpObjects(const std::string& address, const StoreOptions& options, std::stop_token stop)
        : forbidden_is_missing_(options.forbidden_is_missing),
          stop_(std::move(stop)),
          client_(http_client({options.requests, options.timeout_s, options.attempts}, traffic_)) {
        base_ = address.find("://") == s3.find("://") ? url_of_s3(address) : address;
        for (std::size_t at = 0; (at = base_.find(' ', at)) != std::string::npos;) {
            base_.replace(at, 1, "%20");
        }
        const std::size_t question = std::min(base_.find('?'), base_.size());
        query_ = base_.substr(question);
        base_.resize(question);
        while (base_.ends_with('/')) base_.pop_back();
    }

    std::string name_of(const std::string& key) const override {
        return io::without_secrets(key.empty() ? base_
                                               : base_ + "/" + escaped(key, stays_for_people));
    }
    Traffic traffic() const override { return traffic_.now(); }

    /// As the answer to a request for the first byte says, or to one for the size.
    std::optional<std::uint64_t> size_of(const std::string& key) const override {
        const HttpRequest first = first_byte_of(url_of(key));
        HttpAnswer answer = std::move(client_->get({&first, 1}, stop_).front());
        const auto size = size_in(answer, first.url, stop_);
        const bool is_told = !answer.version.empty();
        const bool is_there = body_of({.key = key}, std::move(answer)).has_value();
        if (is_there && !is_told) tells_changes_ = false;
        return is_there ? size : std::nullopt;
    }

    /// Signatures in the query change each time and do not belong to the object.
    std::string version() const override {
        std::string all = io::query_of_object(query_);
        const std::lock_guard lock(mutex_);
        for (const auto& [key, version] : versions_) all += '\n' + key + '\n' + version;
        return std::to_string(std::hash<std::string>{}(all));
    }

    bool tells_changes() const override { return tells_changes_; }

    std::optional<Bytes> get(const Wanted& wanted, std::stop_token stop) const override {
        return std::move(get_all(std::array{wanted}, UINT64_MAX, std::move(stop)).front());
    }

    std::vector<std::optional<Bytes>> get_all(std::span<const Wanted> wanted, std::uint64_t most,
                                              std::stop_token stop) const override {
        std::vector<HttpRequest> requests;
        for (const Wanted& one : wanted) {
            requests.push_back({url_of(one.key), one.range, one.most});
        }
        if (!stop.stop_possible()) stop = stop_;
        if (knows_no_suffixes_) place_suffixes(requests, stop);
        std::vector<HttpAnswer> answers = client_->get(requests, stop, most);
        get_suffixes_otherwise(requests, answers, stop);
        std::vector<std::optional<Bytes>> all;
        for (std::size_t i = 0; i < answers.size(); ++i) {
            const std::string version = std::move(answers[i].version);
            if (wanted[i].identity) {
                const auto size = answers[i].whole_size.value_or(answers[i].body.size());
                // A part tells no size where the server leaves it open.
                const bool is_open = answers[i].status == 206 && !answers[i].whole_size;
                *wanted[i].identity = version + (is_open ? "" : std::to_string(size));
            }
            all.push_back(body_of(wanted[i], std::move(answers[i])));
            if (!wanted[i].lasting && all.back()) remember(wanted[i].key, version, *all.back());
        }
        return all;
    }

  private:
    std::string url_of(const std::string& key) const {
        return base_ + "/" + escaped(key, stays_for_servers) + query_;
    }

    static HttpRequest first_byte_of(std::string url) { return {std::move(url), ByteRange{0, 1}}; }

    /// [bytes] Of an object, of which the answer has a part. Some servers leave its size open
    /// there ("bytes 0-0/*"), and tell it to HEAD.
    std::optional<std::uint64_t> size_in(const HttpAnswer& part, const std::string& url,
                                         const std::stop_token& stop) const {
        if (part.whole_size || part.status != 206 || !part.error.empty()) return part.whole_size;
        const HttpRequest head{.url = url, .is_head = true};
        return client_->get({&head, 1}, stop).front().whole_size;
    }

    static bool is_suffix(const HttpRequest& request) {
        return request.range && request.range->from_end;
    }

    /// Some servers know "bytes=A-B" but not "bytes=-LENGTH": they give the whole, another part, or
    /// an error.
    static bool lacks_suffixes(const HttpRequest& request, const HttpAnswer& answer) {
        const long status = answer.status;
        return is_suffix(request) && (status == 200 || status == 400 || status == 416 ||
                                      status == 501 || (status == 206 && !answer.error.empty()));
    }

    /// Asks for ends of objects by their place, as far as the server tells how long the objects
    /// are.
    void place_suffixes(std::span<HttpRequest> requests, const std::stop_token& stop) const {
        std::vector<HttpRequest> first;
        for (const HttpRequest& request : requests) {
            if (is_suffix(request)) first.push_back(first_byte_of(request.url));
        }
        const std::vector<HttpAnswer> answers = client_->get(first, stop);
        auto answer = answers.begin();
        for (HttpRequest& request : requests) {
            if (!is_suffix(request)) continue;
            const HttpAnswer& told = *answer++;
            const std::uint64_t length = request.range->length;
            if (!told.error.empty() || told.status != 206) continue;
            const auto size = size_in(told, request.url, stop);
            if (size >= length) request.range = ByteRange{*size - length, length};
        }
    }

    /// Replaces the answers of a server that knows no suffixes. That is found out once, as it can
    /// take all attempts of a request.
    void get_suffixes_otherwise(std::span<const HttpRequest> requests,
                                std::span<HttpAnswer> answers, const std::stop_token& stop) const {
        for (std::size_t i = 0; i < answers.size(); ++i) {
            if (!lacks_suffixes(requests[i], answers[i])) continue;
            HttpRequest request = requests[i];
            place_suffixes({&request, 1}, stop);
            if (is_suffix(request)) continue;
            answers[i] = std::move(client_->get({&request, 1}, stop).front());
            if (answers[i].error.empty()) knows_no_suffixes_ = true;
        }
    }

    void remember(const std::string& key, const std::string& version, const Bytes& bytes) const {
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        const std::string now = version + std::to_string(std::hash<std::string_view>{}(text));
        if (version.empty()) tells_changes_ = false;
        const std::lock_guard lock(mutex_);
        versions_[key] = now;
    }

    std::optional<Bytes> body_of(const Wanted& wanted, HttpAnswer answer) const {
        if (answer.too_long) fail_too_long(name_of(wanted.key), wanted);
        if (!answer.error.empty()) {
            throw io::InputError(name_of(wanted.key) + ": " + answer.error +
                                 "; check the address and the network, and try again");
        }
        const long status = answer.status;
        constexpr long forbidden = 403, not_found = 404, gone = 410;
        const bool may_be_missing = wanted.probe || (wanted.lasting && forbidden_is_missing_);
        if (status == not_found || status == gone || (may_be_missing && status == forbidden)) {
            return std::nullopt;
        }
        if (status >= 300) {
            throw io::InputError(name_of(wanted.key) + ": the server answers with status " +
                                 std::to_string(status) +
                                 (status == forbidden && wanted.lasting
                                      ? "; if chunks that are not stored are answered so, as by "
                                        "S3, give --forbidden-is-missing"
                                  : status == 401 || status == forbidden
                                      ? "; only what everybody may read can be opened"
                                      : "; check the address"));
        }
        return std::move(answer.body);
    }

    std::string base_, query_;
    bool forbidden_is_missing_;
    std::stop_token stop_;
    mutable std::mutex mutex_;
    mutable std::map<std::string, std::string> versions_;  // by key, of what is not lasting
    mutable std::atomic<bool> knows_no_suffixes_{false}, tells_changes_{true};
    mutable TrafficCount traffic_;
    const std::unique_ptr<HttpClient> client_;
};

}  // namespace

std::shared_ptr<const Objects> http_objects(const std::string& address, const StoreOptions& options,
                                            std::stop_token stop) {
    return std::make_shared<HttpObjects>(address, options, std::move(stop));
}

}  // namespace palpate::stream
