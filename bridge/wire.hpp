// OpenIGTLink messages as bytes: those that Palpate sends, and those that it takes, checked before
// anything is allocated or believed. Pure functions without sockets. Format: openigtlink.org,
// protocol versions 1 to 3.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/surface.hpp"
#include "palpate/volume.hpp"

namespace palpate::bridge {

/// A message that cannot be understood; what() is one line.
class WireError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

inline constexpr std::size_t header_bytes = 58;

/// The whole message: header of version 1 and body. `type` at most 12 characters, `name` 20; longer
/// ones are cut. `time` [s, since 1970].
std::string message(std::string_view type, std::string_view name, std::string_view body,
                    double time);

/// Bodies. Points and directions come in as Palpate has them (LPS) and go out as Slicer has them
/// (RAS): x and y change their sign.
std::string transform_body(const Mat3& rotation, const Vec3& translation);
/// `code` 1: good; 13: not ready.
std::string status_body(std::uint16_t code, std::string_view text);
std::string string_body(std::string_view text);
/// Throws std::length_error for a mesh above `most_mesh_bytes`.
std::string polydata_body(const SurfaceMesh& mesh);
inline constexpr std::size_t most_mesh_bytes = std::size_t{1} << 30;

/// The longest bodies that are taken [bytes].
struct WireLimits {
    std::uint64_t image = std::uint64_t{1} << 30;
    std::uint64_t other = std::uint64_t{1} << 16;
    /// Of all peers together: messages that are not whole yet, and answers that were not taken yet.
    std::uint64_t together = (std::uint64_t{1} << 30) + (std::uint64_t{1} << 26);
};

/// A message that came in whole, with the right checksum.
struct Received {
    std::string type, name;
    std::string content;  ///< the body without the extensions of versions 2 and 3
};

/// Puts messages together from what comes in, in pieces of any size. Memory grows with what has
/// come, not with what a header promises.
class Reader {
  public:
    explicit Reader(const WireLimits& limits = {}) : limits_(limits) {}

    /// Throws WireError: nothing that follows can be trusted then.
    void feed(std::string_view bytes, std::vector<Received>& out);
    /// [bytes] Of memory, for the message that is not whole yet.
    std::uint64_t held() const { return header_.capacity() + body_.capacity(); }

  private:
    void take_header();
    Received take_body();

    WireLimits limits_;
    std::string header_, body_;
    Received next_;
    unsigned version_ = 0;
    std::uint64_t body_size_ = 0, checksum_ = 0;
};

/// Of a STRING: printable ASCII in one line, at most 4096 characters. Throws WireError.
std::string text_of(const Received& received);
/// Of an IMAGE: a whole volume of one component; int8 becomes int16, 32-bit integers and doubles
/// become float32. Throws WireError.
Volume volume_of(const Received& received);

}  // namespace palpate::bridge
