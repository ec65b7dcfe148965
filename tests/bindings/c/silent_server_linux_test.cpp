// The C interface reads no addresses: a server that never answers cannot hold it up.
#include "palpate-c/palpate.h"
#include "support/silent_server.hpp"

namespace palpate::c::test {
namespace {

TEST(CVolume, an_address_is_refused_without_a_word_to_its_server) {
    const support::SilentServer server;
    palpate_volume* volume = nullptr;
    EXPECT_EQ(palpate_volume_load(server.address().c_str(), nullptr, &volume), PALPATE_INPUT);
    EXPECT_NE(std::string(palpate_last_error()).find("is a web address"), std::string::npos)
        << palpate_last_error();
    EXPECT_EQ(volume, nullptr);
    EXPECT_FALSE(server.is_asked());
}

}  // namespace
}  // namespace palpate::c::test
