// Which stores there are on Windows: raw files. The codecs of chunked formats and the library that
// fetches over HTTP are not built there.
#include "io/plain_samples.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/sequence.hpp"
#include "palpate/stream/convert.hpp"
#include "palpate/stream/edits.hpp"
#include "palpate/stream/read_files.hpp"
#include "palpate/stream/store.hpp"
#include "stream/formats/stores.hpp"
#include "stream/objects/remote_objects.hpp"

namespace palpate::stream {
namespace {

const char* const no_chunks =
    ": Palpate for Windows does not write chunked formats; use a file, or Linux";

}  // namespace

bool is_chunked(const std::string& address) {
    return std::filesystem::path(address).extension() == ".zarr";  // to be refused
}

void check_edits_name(const std::filesystem::path& out) {
    throw std::invalid_argument(out.string() + no_chunks);
}

std::string content_below_edits(const Store&, int, const std::stop_token&) {
    return {};
}

bool is_read_from(const std::filesystem::path& path, const std::filesystem::path& source) {
    return io::is_read_from(path, source);
}

void check_edits_place(const std::filesystem::path& out, const Opened&) {
    check_edits_name(out);
}

void check_zarr_place(const std::filesystem::path& out) {
    throw io::OutputError(out.string() + no_chunks);
}

void save_edits(const Store&, const Opened&, int, const Samples&, const std::filesystem::path& out,
                const io::Progress&) {
    check_edits_name(out);
}

Converted convert_to_zarr(const Store&, int, const std::filesystem::path& out,
                          const ConvertOptions&) {
    throw io::OutputError(out.string() + no_chunks);
}

bool is_store(const std::string& address, const StoreOptions& options) {
    std::error_code error;
    if (std::filesystem::path(address).extension() == ".zarr") return true;  // to be refused
    return options.raw && std::filesystem::is_regular_file(address, error);
}

std::shared_ptr<const Store> open_store(const std::string& address, const StoreOptions& options,
                                        const io::Progress&) {
    if (options.raw) return open_plain_file(address, options);
    throw io::InputError(address +
                         ": Palpate for Windows streams raw files only; convert it on Linux");
}

}  // namespace palpate::stream
