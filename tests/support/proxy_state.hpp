// Compares proxies and results bit for bit, and hashes them.
#pragma once

#include <bit>
#include <cstdint>

#include "palpate/proxy.hpp"

namespace palpate::support {

/// FNV-1a, 64 bit, over the bits of what it is given.
class Hash {
  public:
    void add(std::uint64_t bits) {
        for (int i = 0; i < 8; ++i) {
            value_ = (value_ ^ (bits >> (8 * i) & 255)) * 0x100000001b3u;
        }
    }
    void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
    void add(const Vec3& v) {
        for (int i = 0; i < 3; ++i) add(v[i]);
    }
    void add(const Proxy& proxy) {
        for (int i = 0; i < 3; ++i) {
            add(static_cast<std::uint64_t>(proxy.scp.tetrahedron.cell[i]));
            add(static_cast<std::uint64_t>(proxy.scp.tetrahedron.axis[i]));
            add(static_cast<std::uint64_t>(proxy.scp.tetrahedron.sign[i]));
        }
        add(proxy.scp.folded);
        add(proxy.scp_physical);
        add(proxy.isovalue);
        add(static_cast<std::uint64_t>(proxy.mode));
        add(static_cast<std::uint64_t>(proxy.placed));
        add(static_cast<std::uint64_t>(proxy.sliding));
        add(proxy.recovery_reach);
    }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

inline std::uint64_t hash_of(const Proxy& proxy) {
    Hash hash;
    hash.add(proxy);
    return hash.value();
}

}  // namespace palpate::support
