// Shared by all jobs of palpate-io-helper. See the header.
#include "io/process/io_helper.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <system_error>

#include "io/system/system.hpp"
#include "io/web_page.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

namespace {

/// Throws InputError if the file has only the address of its data, or is a server's answer.
void check_content(const fs::path& path) {
    std::string start(web_page_start, '\0');
    std::ifstream in(path, std::ios::binary);
    in.read(start.data(), std::ssize(start));
    start.resize(static_cast<std::size_t>(in.gcount()));
    const std::string name = path.string();
    if (start.starts_with("version https://git-lfs.github.com/spec/")) {
        throw InputError(name + ": has only the address of its data (Git LFS); run git lfs pull");
    }
    if (start.starts_with("/annex/objects/")) {
        throw InputError(name +
                         ": has only the address of its data (git-annex, DataLad); run git annex "
                         "get or datalad get");
    }
    if (is_web_page(start)) throw InputError(name + ": " + web_page_message);
}

}  // namespace

double bytes_in(const fs::path& path) {
    std::error_code error;
    if (!fs::is_directory(path, error)) return static_cast<double>(fs::file_size(path, error));
    double bytes = 0;
    for (fs::directory_iterator entry(path, error), end; entry != end && !error;
         entry.increment(error)) {
        std::error_code of_entry;
        const auto size = entry->file_size(of_entry);
        if (!of_entry) bytes += static_cast<double>(size);
    }
    return bytes;
}

void check_readable(const fs::path& path) {
    const std::string name = path.empty() ? "(no name)" : path.string();
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found && is_web_address(name)) {
        throw InputError(name +
                         ": is a web address, and only files can be read here; convert it "
                         "with palpate convert");
    }
    if (status.type() == fs::file_type::not_found && name.find("://") != std::string::npos) {
        throw InputError(
            name + ": begins with none of http://, https:// and s3://" +
            (name.starts_with("file:")
                 ? "; of a file or folder of this machine, give the path alone"
             : name.starts_with("gs:")
                 ? "; Google's storage is read as https://storage.googleapis.com/BUCKET/NAME"
                 : ""));
    }
    constexpr std::array one_slash = {"http:/", "https:/", "s3:/"};
    if (status.type() == fs::file_type::not_found &&
        std::ranges::any_of(one_slash,
                            [&](const char* begin) { return name.starts_with(begin); })) {
        throw InputError(name +
                         ": an address has two slashes behind the colon, of which pathlib.Path "
                         "takes one away; give it as text");
    }
    if (status.type() == fs::file_type::not_found) {
        throw InputError(name + ": does not exist; check the name");
    }
    if (status.type() == fs::file_type::none) {
        throw InputError(name + ": " + error.message() + "; check the name and its permissions");
    }
    if (status.type() != fs::file_type::regular && status.type() != fs::file_type::directory) {
        throw InputError(name + ": is neither a file nor a folder; give a file");
    }
    const bool folder = status.type() == fs::file_type::directory;
    if (const int problem = why_unreadable(path, folder); problem != 0) {
        throw InputError(name + ": " + reason(problem) + "; check its permissions");
    }
    if (!folder && fs::file_size(path, error) == 0) {
        throw InputError(name + ": is empty (0 bytes); copy or download it again");
    }
    if (!folder) check_content(path);
}

void fail_without_answer(const fs::path& path) {
    throw InputError(path.string() +
                     ": the helper process gave no sensible answer; check that "
                     "palpate-io-helper belongs to this version of Palpate");
}

HelperResult result_of(const fs::path& path, const HelperJob& job) {
    HelperResult result = run_helper(job);
    if (!result.failure.empty()) throw InputError(path.string() + ": " + result.failure);
    return result;
}

}  // namespace palpate::io
