// Headers, checksums, and the bodies that are sent.
#include "bridge/wire.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bridge/bytes.hpp"

namespace palpate::bridge {
namespace {

constexpr std::size_t extension_bytes = 12;  // of versions 2 and 3, at least

/// ECMA-182, the highest bit first, from 0.
constexpr std::array<std::uint64_t, 256> checksum_table = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::uint64_t i = 0; i < 256; ++i) {
        std::uint64_t sum = i << 56;
        for (int bit = 0; bit < 8; ++bit) {
            sum = (sum >> 63) != 0 ? sum << 1 ^ 0x42F0E1EBA9EA3693ULL : sum << 1;
        }
        table[i] = sum;
    }
    return table;
}();

std::uint64_t checksum(std::string_view bytes) {
    std::uint64_t sum = 0;
    for (const char c : bytes) {
        sum = checksum_table[(sum >> 56 ^ static_cast<unsigned char>(c)) & 0xFF] ^ sum << 8;
    }
    return sum;
}

/// The text in a field that zeros fill up. Throws WireError for what is not printable ASCII: it
/// goes to a terminal.
std::string text_in(std::string_view field) {
    const std::string text(field.substr(0, field.find('\0')));
    const bool printable =
        std::ranges::all_of(text, [](unsigned char c) { return c >= ' ' && c < 0x7F; });
    if (!printable) throw WireError("a header whose type or name is no text");
    return text;
}

/// LPS to RAS, and back.
Vec3 turned(const Vec3& v) {
    return {-v[0], -v[1], v[2]};
}

void put_vector(std::string& to, const Vec3& v) {
    for (int i = 0; i < 3; ++i) put(to, static_cast<float>(v[i]));
}

}  // namespace

std::string message(std::string_view type, std::string_view name, std::string_view body,
                    double time) {
    std::string bytes;
    bytes.reserve(header_bytes + body.size());
    put(bytes, std::uint16_t{1});
    put_text(bytes, type, 12);
    put_text(bytes, name, 20);
    const double whole = std::floor(time);
    put(bytes, static_cast<std::uint64_t>(whole) << 32 |
                   static_cast<std::uint64_t>((time - whole) * 4294967296.0));
    put(bytes, std::uint64_t{body.size()});
    put(bytes, checksum(body));
    bytes += body;
    return bytes;
}

std::string transform_body(const Mat3& rotation, const Vec3& translation) {
    std::string body;
    for (int column = 0; column < 3; ++column) put_vector(body, turned(rotation.col(column)));
    put_vector(body, turned(translation));
    return body;
}

std::string status_body(std::uint16_t code, std::string_view text) {
    std::string body;
    put(body, code);
    put(body, std::int64_t{0});
    put_text(body, code == 1 ? "" : "not ready", 20);
    body += text;
    body += '\0';
    return body;
}

std::string string_body(std::string_view text) {
    std::string body;
    const std::string_view cut = text.substr(0, 0xFFFF);
    put(body, std::uint16_t{3});  // US-ASCII, by its number at IANA
    put(body, static_cast<std::uint16_t>(cut.size()));
    body += cut;
    return body;
}

std::string polydata_body(const SurfaceMesh& mesh) {
    const std::size_t points = mesh.vertices.size(), polygons = mesh.triangles.size();
    if (12 * points + 16 * polygons > most_mesh_bytes) {
        throw std::length_error("the surface has " + std::to_string(polygons) +
                                " triangles: too many to send");
    }
    std::string body;
    body.reserve(40 + 12 * points + 16 * polygons);
    put(body, static_cast<std::uint32_t>(points));
    for (int i = 0; i < 4; ++i) put(body, std::uint32_t{0});  // vertices and lines: none
    put(body, static_cast<std::uint32_t>(polygons));
    put(body, static_cast<std::uint32_t>(16 * polygons));
    for (int i = 0; i < 3; ++i) put(body, std::uint32_t{0});  // strips and attributes: none
    for (const Vec3& v : mesh.vertices) put_vector(body, turned(v));
    for (const auto& triangle : mesh.triangles) {
        put(body, std::uint32_t{3});
        for (const std::uint32_t corner : triangle) put(body, corner);
    }
    return body;
}

void Reader::feed(std::string_view bytes, std::vector<Received>& out) {
    while (!bytes.empty()) {
        const bool in_header = header_.size() < header_bytes;
        std::string& part = in_header ? header_ : body_;
        const std::uint64_t whole = in_header ? header_bytes : body_size_;
        const std::uint64_t missing = whole - part.size();
        const std::string_view now =
            bytes.substr(0, std::min<std::uint64_t>(missing, bytes.size()));
        if (part.capacity() < part.size() + now.size()) {
            part.reserve(std::min<std::uint64_t>(whole, 2 * (part.size() + now.size())));
        }
        part += now;
        bytes.remove_prefix(now.size());
        if (in_header && header_.size() == header_bytes) take_header();
        if (header_.size() == header_bytes && body_.size() == body_size_) {
            out.push_back(take_body());
        }
    }
}

void Reader::take_header() {
    version_ = number_at<std::uint16_t>(header_, 0);
    if (version_ < 1 || version_ > 3) throw WireError("no OpenIGTLink message of version 1 to 3");
    next_.type = text_in(std::string_view(header_).substr(2, 12));
    next_.name = text_in(std::string_view(header_).substr(14, 20));
    body_size_ = number_at<std::uint64_t>(header_, 42);
    checksum_ = number_at<std::uint64_t>(header_, 50);
    const std::uint64_t most = next_.type == "IMAGE" ? limits_.image : limits_.other;
    if (body_size_ > most) {
        throw WireError(next_.type + " of " + std::to_string(body_size_) + " bytes: at most " +
                        std::to_string(most) + " are taken");
    }
}

Received Reader::take_body() {
    if (checksum(body_) != checksum_) throw WireError(next_.type + " with a wrong checksum");
    Received received = std::move(next_);
    std::string body = std::move(body_);
    const bool extended = version_ > 1;
    header_.clear();
    body_.clear();
    next_ = {};
    body_size_ = 0;
    if (!extended || body.empty()) {
        received.content = std::move(body);
        return received;
    }
    const auto refuse = [&] { throw WireError(received.type + " with extensions longer than it"); };
    if (body.size() < extension_bytes) refuse();
    const std::uint64_t before = number_at<std::uint16_t>(body, 0);
    const std::uint64_t after =
        std::uint64_t{number_at<std::uint16_t>(body, 2)} + number_at<std::uint32_t>(body, 4);
    if (before < extension_bytes || before + after > body.size()) refuse();
    body.resize(body.size() - after);
    body.erase(0, before);
    received.content = std::move(body);
    return received;
}

std::string text_of(const Received& received) {
    const std::string_view content = received.content;
    if (content.size() < 4) throw WireError("a STRING that is cut off");
    const std::size_t length = number_at<std::uint16_t>(content, 2);
    if (length > content.size() - 4) throw WireError("a STRING that is cut off");
    if (length > 4096) throw WireError("a STRING of more than 4096 characters");
    return text_in(content.substr(4, length));
}

}  // namespace palpate::bridge
