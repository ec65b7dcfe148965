// A tool's proxy as a value: its tool, and the memory of its updates.
#include "tool_proxy/kept.hpp"

#include <algorithm>
#include <utility>

namespace palpate {
namespace tool {

Keeper::Keeper() : kept_(std::make_unique<Kept>()) {}
Keeper::Keeper(const Keeper& other) : kept_(std::make_unique<Kept>(*other)) {}
Keeper::Keeper(Keeper&&) noexcept = default;
Keeper& Keeper::operator=(Keeper other) noexcept {
    kept_ = std::move(other.kept_);
    return *this;
}
Keeper::~Keeper() = default;

}  // namespace tool

ToolProxy::ToolProxy(std::shared_ptr<const Tool> tool) {
    make_room(tool->points().size());
    use(std::move(tool));
}

void ToolProxy::make_room(std::size_t points) {
    tool::Kept& kept = *kept_;
    const std::size_t room = std::max(points, kept.arms.size());
    kept.arms.resize(room);
    kept.expiry.resize(room);
    kept.suspects.resize(room);
}

bool ToolProxy::use(std::shared_ptr<const Tool> tool) noexcept {
    const auto points = tool->points();
    tool::Kept& kept = *kept_;
    if (points.size() > kept.arms.size()) return false;
    std::ranges::transform(points, kept.arms.begin(), [](const Vec3& p) { return p.norm(); });
    contact_count = 0;
    kept.renewed = true;
    tool_ = std::move(tool);
    return true;
}

}  // namespace palpate
