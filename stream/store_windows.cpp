// Which stores there are on Windows: raw files. The codecs of chunked formats and the library that
// fetches over HTTP are not built there.
#include "io/plain_samples.hpp"
#include "palpate/io/error.hpp"
#include "palpate/stream/store.hpp"
#include "stream/remote_objects.hpp"
#include "stream/stores.hpp"

namespace palpate::stream {
namespace {

void check_number(const std::string& address, const std::string& what, int wanted) {
    if (wanted == 0) return;
    throw io::InputError(address + ": there is no " + what + " " + std::to_string(wanted) +
                         ": it has 1, number 0");
}

}  // namespace

void check_choice(const StoreInfo& info, const StoreOptions& options) {
    check_number(info.address, "time", options.time);
    check_number(info.address, "channel", options.channel);
}

bool is_store(const std::string& address, const StoreOptions& options) {
    std::error_code error;
    if (std::filesystem::path(address).extension() == ".zarr") return true;  // to be refused
    return options.raw && std::filesystem::is_regular_file(address, error);
}

std::shared_ptr<const Store> open_store(const std::string& address, const StoreOptions& options) {
    if (options.raw) return open_plain_file(address, options);
    throw io::InputError(address +
                         ": Palpate for Windows streams raw files only; convert it on Linux");
}

}  // namespace palpate::stream
