// Carries out commands, and keeps their effects.
#include "apps/viewer/panel/effect.hpp"

#include <exception>
#include <utility>

#include "apps/viewer/panel/sentences.hpp"

namespace palpate::viewer {
namespace {

/// Snapshots come thirty times a second, and a command takes effect within a tick: a fourth one
/// that differs means that it was not carried out.
constexpr int late_snapshots = 3;

}  // namespace

void Effect::begin(const Field& field, double isovalue, const RendererSettings& settings,
                   const DeviceInfo& device, const run::Histogram& histogram, CarryOut carry_out) {
    session_ = Session{{field, settings, {}, {}}, {}};
    session_->renderer.proxy.isovalue = isovalue;
    if (settings.tool) session_->renderer.tool_proxy.emplace(settings.tool);
    device_ = device;
    histogram_ = histogram;
    carry_out_ = std::move(carry_out);
    awaited_ = 0;
    Q_EMIT begun();
    Q_EMIT changed();
}

void Effect::end() {
    session_.reset();
    carry_out_ = nullptr;
    Q_EMIT ended();
}

bool Effect::request(const Command& command) {
    if (!there()) return false;
    const QString why = refusal_of(command);
    Q_EMIT answered(command, why);
    if (there()) Q_EMIT changed();
    return why.isEmpty();
}

/// Empty: it was carried out.
QString Effect::refusal_of(const Command& command) {
    if (!carry_out_) return tr("A recording is played: nothing here changes it.");
    if (std::holds_alternative<command::Isovalue>(command) && have_surfaces(settings().layers)) {
        return tr("layers are felt, not an isovalue: choose No layers to feel one");
    }
    try {
        Session next = *session_;
        apply(next, command);
        carry_out_(command);
        session_ = std::move(next);
        awaited_ = late_snapshots;
    } catch (const std::exception& error) {
        return in_words(error.what());
    }
    return {};
}

void Effect::observe(const Snapshot& snapshot) {
    if (!there()) return;
    RendererSettings& settings = session_->renderer.settings;
    const SessionTick& now = snapshot.session;
    const bool same = session_->frozen == now.frozen && session_->clutched == now.clutched &&
                      settings.forces_on == snapshot.forces_on &&
                      settings.transform.scale == now.transform.scale;
    if (same) awaited_ = 0;
    if (awaited_ > 0) {
        --awaited_;
    } else {
        session_->frozen = now.frozen;
        session_->clutched = now.clutched;
        settings.forces_on = snapshot.forces_on;
        settings.transform = now.transform;
    }
    Q_EMIT observed(snapshot);
}

}  // namespace palpate::viewer
