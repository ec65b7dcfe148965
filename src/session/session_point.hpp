// Stops a session at a point and goes on from one.
#pragma once

#include "palpate/session.hpp"

namespace palpate {

/// No device reaches farther from its origin [device mm].
inline constexpr double farthest_hand = 1e4;

/// Throws std::invalid_argument, saying what is wrong, for a point that no session with these
/// settings and such a field comes to.
void check(const SessionPoint& point, const RendererSettings& settings, const FieldKind& field);
/// For a point that passed check().
void resume(Session& session, const SessionPoint& point) noexcept;

}  // namespace palpate
