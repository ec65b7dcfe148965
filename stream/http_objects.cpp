// Objects behind http://, https:// and s3:// addresses.
#include <array>
#include <cctype>

#include "palpate/io/error.hpp"
#include "stream/http_client.hpp"
#include "stream/remote_objects.hpp"

namespace palpate::stream {
namespace {

/// A key as it stands in a URL.
std::string escaped(const std::string& key) {
    static constexpr std::string_view plain = "-._~/";
    static constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (const char c : key) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) != 0 || plain.find(c) != std::string_view::npos) {
            text += c;
        } else {
            text += {'%', digits[byte >> 4], digits[byte & 15]};
        }
    }
    return text;
}

/// A bucket with dots has no certificate of its own.
std::string url_of_s3(const std::string& address) {
    constexpr std::string_view scheme = "s3://";
    const std::string rest = address.substr(scheme.size());
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
    HttpObjects(const std::string& address, const StoreOptions& options)
        : client_({options.requests, options.timeout_s, options.attempts}, traffic_) {
        base_ = address.starts_with("s3://") ? url_of_s3(address) : address;
        const std::size_t question = std::min(base_.find('?'), base_.size());
        query_ = base_.substr(question);
        base_.resize(question);
        while (base_.ends_with('/')) base_.pop_back();
        for (std::size_t at = 0; (at = base_.find(' ', at)) != std::string::npos;) {
            base_.replace(at, 1, "%20");
        }
    }

    std::string name_of(const std::string& key) const override {
        return key.empty() ? base_ : base_ + "/" + key;
    }
    Traffic traffic() const override { return traffic_.now(); }

    /// As the answer to a request for the first byte says.
    std::optional<std::uint64_t> size_of(const std::string& key) const override {
        const HttpRequest first{base_ + "/" + escaped(key) + query_, ByteRange{0, 1}};
        HttpAnswer answer = std::move(client_.get({&first, 1}, {}).front());
        const auto size = answer.whole_size;
        return body_of({.key = key}, std::move(answer)) ? size : std::nullopt;
    }

    std::optional<Bytes> get(const Wanted& wanted, std::stop_token stop) const override {
        return std::move(get_all(std::array{wanted}, std::move(stop)).front());
    }

    std::vector<std::optional<Bytes>> get_all(std::span<const Wanted> wanted,
                                              std::stop_token stop) const override {
        std::vector<HttpRequest> requests;
        for (const Wanted& one : wanted) {
            requests.push_back({base_ + "/" + escaped(one.key) + query_, one.range, one.most});
        }
        std::vector<HttpAnswer> answers = client_.get(requests, std::move(stop));
        std::vector<std::optional<Bytes>> all;
        for (std::size_t i = 0; i < answers.size(); ++i) {
            all.push_back(body_of(wanted[i], std::move(answers[i])));
        }
        return all;
    }

  private:
    std::optional<Bytes> body_of(const Wanted& wanted, HttpAnswer answer) const {
        if (!answer.error.empty()) {
            throw io::InputError(name_of(wanted.key) + ": " + answer.error +
                                 "; check the address and the network, and try again");
        }
        const long status = answer.status;
        constexpr long forbidden = 403, not_found = 404, gone = 410;
        if (status == not_found || status == gone || (wanted.probe && status == forbidden)) {
            return std::nullopt;
        }
        if (status >= 300) {
            throw io::InputError(name_of(wanted.key) + ": the server answers with status " +
                                 std::to_string(status) +
                                 (status == 401 || status == forbidden
                                      ? "; only what everybody may read can be opened"
                                      : "; check the address"));
        }
        return std::move(answer.body);
    }

    std::string base_, query_;
    mutable TrafficCount traffic_;
    mutable HttpClient client_;
};

}  // namespace

bool is_remote(const std::string& address) {
    return address.starts_with("http://") || address.starts_with("https://") ||
           address.starts_with("s3://");
}

std::shared_ptr<const Objects> http_objects(const std::string& address,
                                            const StoreOptions& options) {
    return std::make_shared<HttpObjects>(address, options);
}

}  // namespace palpate::stream
