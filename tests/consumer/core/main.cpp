// The smallest use of Palpate: press a hand into a slab and see where the proxy stays.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

#include "palpate/field.hpp"
#include "palpate/proxy.hpp"

int main() {
    // 8 x 8 x 8 samples, 1 mm apart; density 10 z, so the surface of isovalue 35 is at z = 3.5 mm
    // and the solid is above it.
    palpate::Geometry geometry;
    geometry.size = {8, 8, 8};
    std::vector<std::uint8_t> samples;
    for (int i = 0; i < 8 * 8 * 8; ++i) samples.push_back(std::uint8_t(10 * (i / 64)));
    const palpate::Field field(palpate::Volume(geometry, std::move(samples)));

    palpate::Proxy proxy;
    proxy.isovalue = 35;
    palpate::ProxyUpdate update;
    for (double z = 1; z <= 5; z += 0.5) {
        update = palpate::update_exact(proxy, field, {3.3, 4.1, z});
        std::cout << "HIP z " << z << " mm, SCP z " << update.scp.z() << " mm\n";
    }
    const bool right = update.mode == palpate::Mode::constrained &&
                       (update.scp - palpate::Vec3(3.3, 4.1, 3.5)).norm() < 1e-9;
    return right ? 0 : 1;
}
