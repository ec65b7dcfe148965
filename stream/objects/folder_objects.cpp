// Objects that are files in a folder.
#include <sys/stat.h>

#include <cerrno>
#include <stdexcept>

#include "io/process/helper_process.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "stream/objects/objects.hpp"

namespace palpate::stream {
namespace {

class FolderObjects : public Objects {
  public:
    FolderObjects(std::filesystem::path folder, std::filesystem::path name, std::stop_token stop)
        : folder_(std::move(folder)), name_(std::move(name)), stop_(std::move(stop)) {}

    std::string name_of(const std::string& key) const override {
        return (key.empty() ? name_ : name_ / key).string();
    }
    Traffic traffic() const override { return traffic_.now(); }
    std::optional<std::uint64_t> size_of(const std::string& key) const override {
        std::error_code error;
        const std::uintmax_t size = std::filesystem::file_size(folder_ / key, error);
        return error ? std::nullopt : std::optional<std::uint64_t>(size);
    }

    bool list(const std::string& folder,
              const std::function<bool(const std::string&, bool)>& enough) const override {
        std::error_code error;
        for (std::filesystem::directory_iterator entry(folder_ / folder, error), end;
             entry != end && !error; entry.increment(error)) {
            if (stop_.stop_requested()) throw Cancelled{};
            std::error_code unknown;
            if (enough(entry->path().filename().string(), entry->is_directory(unknown))) break;
        }
        return !error || error == std::errc::no_such_file_or_directory ||
               error == std::errc::not_a_directory;
    }

    std::optional<Bytes> get(const Wanted& wanted, std::stop_token stop) const override {
        if (!stop.stop_possible()) stop = stop_;
        if (stop.stop_requested()) throw Cancelled{};
        const io::Descriptor file(io::open_to_read(folder_ / wanted.key));
        if (file.number() < 0) {
            if (errno == ENOENT || errno == ENOTDIR || errno == EISDIR) {
                if (wanted.lasting) require_folder(wanted.key);
                return std::nullopt;
            }
            if (errno == ENXIO) fail(wanted.key, "is no file; make the folder again");
            fail(wanted.key, io::reason(errno) + "; check its permissions");
        }
        const std::string identity =
            wanted.identity ? io::identity_of(file.number()) : std::string();
        struct stat status {};
        if (fstat(file.number(), &status) != 0) fail(wanted.key, io::reason(errno));
        const auto size = static_cast<std::uint64_t>(status.st_size);
        ByteRange range{0, size};
        if (wanted.range) range = *wanted.range;
        if (range.length > size || (!range.from_end && range.offset > size - range.length)) {
            fail(wanted.key, "is shorter than its metadata say; copy it again");
        }
        if (range.from_end) range.offset = size - range.length;
        if (range.length > wanted.most) fail_too_long(name_of(wanted.key), wanted);
        Bytes bytes = read(wanted.key, file.number(), range);
        if (wanted.identity) {
            const std::string after = io::identity_of(file.number());
            // Else what was read is of no known file.
            *wanted.identity = after == identity ? identity : identity + " to " + after;
        }
        return bytes;
    }

  private:
    [[noreturn]] void fail(const std::string& key, const std::string& what) const {
        throw io::InputError(name_of(key) + ": " + what);
    }

    /// Where a disk has gone, no chunk is there; none of them is just not stored.
    void require_folder(const std::string& key) const {
        std::error_code error;
        if (!std::filesystem::is_directory(folder_, error)) {
            fail(key, "its folder is not there any more; put it back");
        }
    }

    Bytes read(const std::string& key, int file, const ByteRange& range) const {
        Bytes bytes(range.length);
        const auto got = io::read_at(file, bytes.data(), bytes.size(), range.offset);
        if (got < 0) fail(key, io::reason(errno) + "; check the disk");
        if (got < std::ssize(bytes)) fail(key, "became shorter while it was read; try again");
        traffic_.request(bytes.size());
        return bytes;
    }

    std::filesystem::path folder_, name_;
    std::stop_token stop_;
    mutable TrafficCount traffic_;
};

}  // namespace

void fail_too_long(const std::string& name, const Wanted& wanted) {
    throw io::InputError(name + ": has more bytes than its metadata allow; copy it again" +
                         (wanted.probe ? ", or allow more memory" : ""));
}

std::vector<std::optional<Bytes>> Objects::get_all(std::span<const Wanted> wanted,
                                                   std::uint64_t most, std::stop_token stop) const {
    std::vector<std::optional<Bytes>> all;
    for (Wanted one : wanted) {
        one.most = std::min(one.most, most);
        all.push_back(get(one, stop));
        if (all.back()) most -= all.back()->size();
    }
    return all;
}

bool Objects::list(const std::string&, const std::function<bool(const std::string&, bool)>&) const {
    return false;
}

std::shared_ptr<const Objects> folder_objects(const std::filesystem::path& folder,
                                              std::stop_token stop) {
    // Absolute, so that it is found when the working folder has gone.
    std::error_code error;
    const std::filesystem::path whole = std::filesystem::absolute(folder, error);
    return std::make_shared<FolderObjects>(error ? folder : whole, folder, std::move(stop));
}

std::string key_below(const std::string& folder, const std::string& name) {
    std::string key = folder;
    for (std::size_t at = 0; at <= name.size();) {
        const std::size_t end = std::min(name.find('/', at), name.size());
        const std::string part = name.substr(at, end - at);
        at = end + 1;
        if (part.empty() || part == ".") continue;
        if (part == ".." || part.find('\0') != std::string::npos) {
            throw std::invalid_argument("the path '" + name + "' leads out of it");
        }
        key += (key.empty() ? "" : "/") + part;
    }
    return key;
}

}  // namespace palpate::stream
