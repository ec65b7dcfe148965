// Chooses the kind of store that an address names.
#include "palpate/stream/store.hpp"

#include "io/plain_samples.hpp"
#include "palpate/io/error.hpp"
#include "stream/stores.hpp"

namespace palpate::stream {
namespace {

bool is_plain(const std::string& address, const StoreOptions& options) {
    io::ReadOptions read;
    read.raw = options.raw;
    return io::may_be_plain(address, read);
}

void check_number(const std::string& address, const std::string& what, int wanted, int count) {
    if (wanted >= 0 && wanted < count) return;
    throw io::InputError(address + ": there is no " + what + " " + std::to_string(wanted) +
                         ": it has " + std::to_string(count) +
                         (count == 1 ? ", number 0" : ", numbered from 0; choose one of them"));
}

}  // namespace

void check_choice(const StoreInfo& info, const StoreOptions& options) {
    check_number(info.address, "time", options.time, info.times);
    check_number(info.address, "channel", options.channel,
                 info.channels.empty() ? 1 : static_cast<int>(info.channels.size()));
}

bool is_store(const std::string& address, const StoreOptions& options) {
    return is_plain(address, options);
}

std::shared_ptr<const Store> open_store(const std::string& address, const StoreOptions& options) {
    return open_plain_file(address, options);
}

}  // namespace palpate::stream
