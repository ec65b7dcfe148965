// Opening a store in a folder ends between two files when asked to: each may be on a slow disk.
#include <gtest/gtest.h>

#include "stream/formats/stores.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::stream::test {
namespace {

using support::put_bytes;
using support::ScratchFolder;

TEST(Stopping, opening_a_folder_of_zarr_or_n5_ends_when_asked_to) {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder / "v.zarr");
    std::filesystem::create_directories(folder / "v.n5");
    put_bytes(folder / "v.zarr/.zarray",
              R"({"zarr_format":2,"shape":[2,4,4],"chunks":[2,4,4],"dtype":"|u1",)"
              R"("compressor":null,"fill_value":0,"order":"C","filters":null})");
    put_bytes(folder / "v.n5/attributes.json",
              R"({"dimensions":[4,4,2],"blockSize":[4,4,2],"dataType":"uint8",)"
              R"("compression":{"type":"raw"}})");
    for (const char* name : {"v.zarr", "v.n5"}) {
        const std::string address = (folder / name).string();
        std::stop_source stop;
        EXPECT_EQ(open_until(stop.get_token(), address, {})->info().levels.size(), 1U);
        stop.request_stop();
        EXPECT_THROW((void)open_until(stop.get_token(), address, {}), Cancelled) << name;
    }
}

}  // namespace
}  // namespace palpate::stream::test
